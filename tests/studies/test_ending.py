"""The end of a study is not cut off itself: what it has set goes back, or the record tells that it did not."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from app.devices.core.events import DeviceEvent, MotionCommanded
from app.devices.core.results import StopOutcome
from app.emulators.drive.documents import MotorChange
from app.emulators.tmc5xxx.options import AxisChange, Tmc5xxxPatch
from app.errors import WrongState
from app.studies.record import StudyRecord
from app.studies.run import StudyRun
from tests.studies.harness import Studied, studied

SEARCH: dict[str, Any] = {"kind": "fastest_move", "distance": 12_800, "repeats": 1}
NAMES = ("VMAX", "AMAX", "DMAX", "V1")


async def in_its_search(s: Studied) -> StudyRun:
    """A study that moves with a setting of its own."""
    before = await s.settings(*NAMES)
    run = s.begin(s.document(SEARCH, budget={"trials": 12}))
    while not (await s.b.state()).moving or await s.settings(*NAMES) == before:
        assert run.running, run.record.message
        await s.clock.advance(0.01)
    return run


def task_of(run: StudyRun) -> asyncio.Task[None]:
    return next(task for task in asyncio.all_tasks() if task.get_name() == f"study {run.device.id}.{run.axis}")


def at_its_stop(s: Studied, run: StudyRun, then: Callable[[], None]) -> None:
    """Do something in the moment in which a study begins to stop its motor, once."""

    def heard(event: DeviceEvent) -> None:
        if isinstance(event, MotionCommanded) and event.what == "stop" and run.is_own(event.by):
            unlisten()
            then()

    unlisten = s.device.listen(heard)


async def test_a_stop_while_a_failed_study_ends_does_not_keep_it_from_giving_back(tmp_path: Path) -> None:
    async with studied(tmp_path) as s:
        before = await s.settings(*NAMES)
        run = await in_its_search(s)
        stops: list[asyncio.Task[None]] = []
        at_its_stop(s, run, lambda: stops.append(asyncio.create_task(run.abort("stopped on request"))))
        s.b.patch(Tmc5xxxPatch(axes=[AxisChange(axis=0, motor=MotorChange(temperature_c=160.0))]))
        record = await s.finish(run, 60)
        assert stops, "it stops its motor as it fails"
        await asyncio.gather(*stops)
        assert record.state == "failed"
        assert record.message.startswith("ended by a fault of the driver")
        assert record.left == []
        assert await s.settings(*NAMES) == before


async def test_a_study_that_is_cut_off_as_it_stops_gives_back_all_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with studied(tmp_path) as s:
        before = await s.settings(*NAMES)
        run = await in_its_search(s)
        stop = s.device.stop
        asked: list[int] = []

        async def slow(axis: int) -> StopOutcome:
            """As over a slow link."""
            asked.append(axis)
            await s.clock.sleep(1.0)
            return await stop(axis)

        monkeypatch.setattr(s.device, "stop", slow)
        ending = asyncio.create_task(run.abort("stopped on request"))
        while not asked:
            await s.clock.advance(0.001)
        task_of(run).cancel()  # as a loop does that ends
        await s.passing(run.wait())
        await ending
        assert (run.record.state, run.record.left) == ("aborted", [])
        assert await s.settings(*NAMES) == before


async def test_a_study_that_is_cut_off_as_it_gives_back_tells_what_may_be_left(tmp_path: Path) -> None:
    async with studied(tmp_path) as s:
        run = await in_its_search(s)
        ending = asyncio.create_task(run.abort("stopped on request"))
        await s.clock.advance(0.01)
        assert run.running, "its motor comes to rest"
        task_of(run).cancel()
        await s.passing(run.wait())
        await ending
        assert run.record.state == "aborted"
        assert "it was cut off before its setting was back" in run.record.left[0]
        assert "VMAX" in run.record.left[1]
        found = s.store.get(run.record.id)
        assert found.left == run.record.left


async def test_a_held_rotation_that_ends_a_study_stops_when_nobody_holds_it(tmp_path: Path) -> None:
    async with studied(tmp_path) as s:
        before = await s.settings(*NAMES)
        run = await in_its_search(s)
        rotating = asyncio.create_task(s.procedures.rotate_held(s.device, 0, 20_000, "pps", 0.5))
        await s.clock.advance(0.3)
        assert (await s.b.state()).moving
        await s.clock.advance(1.5)
        assert not (await s.b.state()).moving, "nobody has held it for longer"
        with pytest.raises(WrongState, match="study"):
            await rotating
        record = await s.finish(run, 30)
        assert (record.state, record.left) == ("aborted", [])
        assert await s.settings(*NAMES) == before


async def test_a_study_that_cannot_be_written_is_over_all_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    async with studied(tmp_path) as s:
        run = await in_its_search(s)
        over: list[bool] = []
        run.over = lambda: over.append(True)

        async def save(record: StudyRecord) -> None:
            raise ValueError("Out of range float values are not JSON compliant")

        monkeypatch.setattr(run.keeper, "save", save)
        await s.passing(run.abort("stopped on request"))
        assert over == [True], "its recording ends by that"
        assert "has not given back" in caplog.text
