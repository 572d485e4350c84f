"""A study tried on an emulated twin of an axis first: in processes of its own, as fast as they can.

A twin is made of what a study may know: the axis's registers as a profile, its settings, its clock, and the motor as
the study's document tells it. Never of the options of an emulated device: those are its ground truth.
"""

from __future__ import annotations

import asyncio
import logging
import math
import multiprocessing
import os
import tempfile
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..clock import Clock, VirtualClock
from ..devices.core.config import AxisSettings, DeviceConfig
from ..devices.core.device import Device
from ..devices.manager import DeviceManager
from ..emulators.build import build_emulator, options_of
from ..links.emulator import EmulatorPort
from ..links.port import FramePort
from ..links.registry import Link
from ..procedures.procedures import Procedures
from ..profiles.apply import Transaction
from ..profiles.document import ProfileDocument, parse
from .document import Budget, FastestMove, StudyDocument, TwinMotor
from .record import StudyRecord, TwinSetting
from .store import StudyStore

log = logging.getLogger("stepscope.studies")

BEAT_S = 0.05
DEVICE_S_MAX = 20_000.0
"""A twin lives no longer than that [s of its own clock]."""
PROCESSES_MAX = 4
APART = 0.08
"""Share of the time that two settings of a twin have to be apart to be worth a trial each."""
SQRT_2 = math.sqrt(2)


@dataclass(frozen=True, slots=True)
class TwinJob:
    """What a process needs to know: it can be pickled."""

    model: str
    clock_hz: float
    axes: tuple[AxisSettings, ...]
    axis: int
    profile: dict[str, Any]
    document: dict[str, Any]


def jobs_of(device: Device, axis: int, document: StudyDocument, profile: ProfileDocument) -> list[TwinJob]:
    """As many as there are processors, each a search of its own from another seed, with its share of the trials."""
    study = document.study
    assert isinstance(study, FastestMove)
    assert study.twin is not None
    count = max(1, min(os.cpu_count() or 1, PROCESSES_MAX, study.twin.trials // 5))
    budget = Budget(trials=math.ceil(study.twin.trials / count), time_s=86_400.0)
    axes = tuple(each.settings for each in device.axes)
    jobs = []
    for index in range(count):
        one = document.model_copy(update={"seed": document.seed + index, "budget": budget})
        jobs.append(
            TwinJob(
                device.model, device.clock_hz, axes, axis, profile.model_dump(mode="json"), one.model_dump(mode="json")
            )
        )
    return jobs


async def tried_on_twins(jobs: Sequence[TwinJob], best: int, *, aside: bool) -> list[TwinSetting]:
    """The best settings of all of them, the fastest first. Raises what went wrong in one of them.

    `aside`: in processes, which end with this call however it ends; else here, while everything waits.
    """
    if aside:
        with_processes = multiprocessing.get_context("spawn").Pool(len(jobs))
        try:
            loop = asyncio.get_running_loop()
            waiting = [loop.run_in_executor(None, with_processes.apply, run_twin, (job,)) for job in jobs]
            found = await asyncio.gather(*waiting)
        finally:
            with_processes.terminate()
    else:
        with ThreadPoolExecutor(1) as thread:
            found = [thread.submit(run_twin, job).result() for job in jobs]
    return apart(sorted((setting for one in found for setting in one), key=lambda setting: setting.time_s), best)


def apart(settings: Sequence[TwinSetting], count: int) -> list[TwinSetting]:
    """Up to `count` of them, the fastest first, each slower than the one before by `APART`.

    So one of the slower ones holds where the axis is weaker than its twin. `settings` in order of their time.
    """
    chosen: list[TwinSetting] = []
    for setting in settings:
        if len(chosen) < count and (not chosen or setting.time_s >= chosen[-1].time_s * (1 + APART)):
            chosen.append(setting)
    return chosen


def run_twin(job: TwinJob) -> list[TwinSetting]:
    """One search on one twin: settings that held, the fastest first. Blocks until it is over."""
    return asyncio.run(_live(job))


async def _live(job: TwinJob) -> list[TwinSetting]:
    clock = VirtualClock()
    manager = DeviceManager({"emulator": _port}, clock)
    document = StudyDocument.model_validate(job.document)
    study = document.study
    assert isinstance(study, FastestMove)
    assert study.twin is not None
    link = {"kind": "emulator", **_options(job, study.twin.motor)}
    with tempfile.TemporaryDirectory() as folder:
        try:
            device = await manager.add(DeviceConfig("twin", job.model, link, job.clock_hz, job.axes))
            if device.problem is not None:
                raise device.problem
            await Transaction(device, parse(job.profile)).run()
            alone = study.model_copy(update={"twin": None})
            record = await _search(device, clock, job.axis, document.model_copy(update={"study": alone}), Path(folder))
        finally:
            closing = asyncio.create_task(manager.close())
            while not closing.done():  # letting go of a device may wait for its motor, on the clock
                await clock.advance(BEAT_S)
            await closing
    return [
        TwinSetting(setting=trial.setting, time_s=trial.figures.time_s)
        for trial in sorted(record.trials, key=lambda trial: trial.figures.time_s or math.inf)
        if trial.state == "feasible" and trial.figures.time_s is not None
    ]


async def _search(device: Device, clock: VirtualClock, axis: int, document: StudyDocument, folder: Path) -> StudyRecord:
    from .fastest_move.study import FastestMoveStudy

    store = StudyStore(folder, aside=False)
    record = store.begin(document)
    run = FastestMoveStudy(device, axis, clock, record, _Kept(store, record.id), proves=False)
    Procedures(clock).start(run)
    while run.running and clock.now() < DEVICE_S_MAX:
        await clock.advance(BEAT_S)
    if record.state != "done":
        log.info("a twin's search ended %s: %s", record.state, record.message)
    return record


@dataclass(slots=True)
class _Kept:
    """Keeps nothing longer than the search."""

    store: StudyStore
    study: str

    @property
    def folder(self) -> Path:
        return self.store.folder(self.study)

    async def save(self, record: StudyRecord) -> None:
        del record

    def mark(self, text: str) -> None:
        del text


def _options(job: TwinJob, motor: TwinMotor) -> dict[str, Any]:
    known = options_of(job.model).model_fields
    full_a = job.axes[job.axis].limits.current_full_scale_a
    options: dict[str, Any] = {
        "motor": {
            "holding_torque_nm": motor.holding_torque_nm,
            "rated_current_a": motor.rated_current_a,
            "resistance_ohm": motor.resistance_ohm,
            "inductance_h": motor.inductance_h,
            "rotor_inertia_kgm2": motor.rotor_inertia_kgm2,
            "rotor_teeth": job.axes[job.axis].full_steps_per_rev // 4,
        },
        "load": {"inertia_kgm2": motor.load_inertia_kgm2, "friction_nm": motor.load_friction_nm},
        "supply_v": motor.supply_v,
        "clock_hz": job.clock_hz,
        "encoder": {"lines": motor.counts_per_turn // 4},
        "full_scale_a": None if full_a is None else full_a * SQRT_2,
    }
    return {name: value for name, value in options.items() if name in known and value is not None}


def _port(model: str, link: Link, clock: Clock) -> FramePort:
    options = {name: value for name, value in link.items() if name != "kind"}
    return EmulatorPort(build_emulator(model, clock, options_of(model).model_validate(options)))
