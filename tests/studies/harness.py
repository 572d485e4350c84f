"""A harness for studies: the real driver, the real emulator with a motor, and time that goes as fast as it can."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable, Coroutine
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from app.clock import VirtualClock
from app.devices.core.device import Device
from app.devices.tmc5xxx.start_up import Start
from app.procedures.procedures import Procedures
from app.studies.document import StudyDocument
from app.studies.kinds import KINDS
from app.studies.record import StudyRecord
from app.studies.run import StudyRun
from app.studies.store import StudyStore
from app.studies.twins.local import Here
from tests.devices.tmc5xxx.harness import bench

START = Start(vmax=50_000, amax=200_000, vstart=0, counts_per_rev=40_000)
MOTOR = {"rotor_teeth": 50}
STEP_S = 0.05


class Kept:
    """Keeps a study in a folder, and its marks in mind."""

    def __init__(self, store: StudyStore, study: str) -> None:
        self._store, self._study = store, study
        self.marks: list[str] = []

    @property
    def folder(self) -> Path:
        return self._store.folder(self._study)

    async def save(self, record: StudyRecord) -> None:
        await self._store.save(record)

    def mark(self, text: str) -> None:
        self.marks.append(text)


@dataclass
class Studied:
    b: Any
    store: StudyStore
    procedures: Procedures = field(init=False)

    def __post_init__(self) -> None:
        self.procedures = Procedures(self.b.clock)

    @property
    def device(self) -> Device:
        device: Device = self.b.device
        return device

    @property
    def clock(self) -> VirtualClock:
        clock: VirtualClock = self.b.clock
        return clock

    def document(self, study: dict[str, Any], **more: Any) -> StudyDocument:
        return StudyDocument.model_validate({"device": self.device.id, "study": study, **more})

    def begin(self, document: StudyDocument, record: StudyRecord | None = None) -> StudyRun:
        """A study of the kind that the document asks for, on axis 0; `record`: one to be gone on with."""
        record = record or self.store.begin(document)
        run = KINDS[document.study.kind].make(self.device, 0, self.clock, record, Kept(self.store, record.id))
        run.executor = Here
        return self.procedures.start(run)

    async def finish(self, run: StudyRun, within_s: float = 2000.0) -> StudyRecord:
        until_s = self.clock.now() + within_s
        while run.running:
            assert self.clock.now() < until_s, run.record.message
            await self.clock.advance(STEP_S)
        return run.record

    async def passing(self, work: Coroutine[Any, Any, None], within_s: float = 60.0) -> None:
        """Wait for what waits on the clock."""
        task, until_s = asyncio.create_task(work), self.clock.now() + within_s
        while not task.done():
            assert self.clock.now() < until_s
            await self.clock.advance(STEP_S)
        await task

    async def killed(self, run: StudyRun) -> StudyRecord:
        """The study as a server that is killed now leaves it and the next one finds it; the axis is put back."""
        folder = self.store.folder(run.record.id)
        kept = {path.name: path.read_bytes() for path in folder.iterdir()}
        await self.passing(run.abort("killed"))
        for path in folder.iterdir():
            path.unlink()
        for name, content in kept.items():
            (folder / name).write_bytes(content)
        self.store = StudyStore(folder.parent.parent, aside=False)
        self.store.load()
        return self.store.get(run.record.id)

    async def until(self, run: StudyRun, reached: Callable[[StudyRecord], bool], within_s: float = 600.0) -> None:
        """Let it run until its record tells that it is so far."""
        until_s = self.clock.now() + within_s
        while not reached(run.record):
            assert run.running, run.record.message
            assert self.clock.now() < until_s, run.record.message
            await self.clock.advance(STEP_S)

    async def settings(self, *names: str) -> list[int]:
        """What registers hold, also those that cannot be read."""
        kept = {reading.name: reading.value for reading in self.device.registers.kept(0)}
        return [kept[name] if name in kept else (await self.device.registers.read(name, 0)).value for name in names]


@asynccontextmanager
async def studied(tmp_path: Path, start: Start = START, **options: Any) -> AsyncIterator[Studied]:
    async with bench(start=start, **{"motor": MOTOR, **options}) as b:
        made = Studied(b, StudyStore(tmp_path, aside=False))
        try:
            yield made
        finally:
            await made.passing(made.procedures.close())
