"""A study tried on a twin first: what a twin is made of, who runs it, and that the axis decides all the same."""

from __future__ import annotations

import asyncio
import math
import os
import signal
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from app.clock import Clock
from app.devices.core.axis_limits import AxisLimits
from app.devices.core.device import Device
from app.emulators.build import options_of
from app.emulators.tmc5xxx import EmulatedTmc5xxx
from app.errors import WrongState
from app.links.emulator import EmulatorPort
from app.profiles.capture import capture
from app.studies.document import Identification, StudyDocument, TwinMotor
from app.studies.fitted import Estimate
from app.studies.identification.found import Identified
from app.studies.parts import Interval
from app.studies.record import Figures, StudyRecord, Trial
from app.studies.search import Asked, Told
from app.studies.twins.executor import JobLost
from app.studies.twins.identified import figures_of
from app.studies.twins.local import Here, Processes
from app.studies.twins.on_twin import OnTwin
from app.studies.twins.search import job_of
from app.studies.twins.twin import emulator_options, run_job
from tests.devices.tmc5xxx.harness import START, bench
from tests.studies.harness import Studied, studied
from tests.studies.twin_jobs import HELD, LOAD, MOTOR, MOVE, move_job


def twinned(**motor: Any) -> dict[str, Any]:
    return {**MOVE, "twin": {"trials": 10, "best": 3, "motor": {**MOTOR, **motor}}}


async def done(s: Studied, study: dict[str, Any], trials: int = 5) -> StudyRecord:
    record = await s.finish(s.begin(s.document(study, budget={"trials": trials})))
    assert record.state == "done", record.message
    return record


async def test_the_best_of_the_twin_come_first_and_the_axis_proves_them(tmp_path: Path) -> None:
    async with studied(tmp_path, load=LOAD) as s:
        record = await done(s, twinned())
        assert 1 <= len(record.twin) <= 3
        times = [one.value for one in record.twin]
        assert all(later > 1.07 * earlier for earlier, later in pairwise(times))
        first = record.trials[0].setting
        assert all(abs(first[name] / record.twin[-1].setting[name] - 1) < 0.01 for name in first)
        assert record.improved
        assert record.evidence is not None
        assert record.evidence.share < -0.4, "five trials are enough where a like twin has looked before"
        (found,) = (one for one in record.findings if one.name == "twin")
        assert "of 10 settings held" in found.text


async def test_a_twin_that_is_too_strong_fools_nobody(tmp_path: Path) -> None:
    async with studied(tmp_path, load=LOAD) as s:
        record = await done(s, twinned(load_inertia_kgm2=0.0, load_friction_nm=0.0))
        assert "infeasible" in {trial.state for trial in record.trials[: len(record.twin)]}
        assert record.improved is not None
        assert record.left == []


async def test_a_twin_knows_the_registers_and_what_it_is_told_and_nothing_of_the_emulator(tmp_path: Path) -> None:
    async with studied(tmp_path, load=LOAD, supply_v=37.5) as s:
        assert "37.5" not in repr(await move_job(s))


async def test_a_twin_has_what_was_identified_of_motor_machine_and_supply(tmp_path: Path) -> None:
    figures = {"rotor_inertia_kgm2": 3e-5, "friction_nm": 0.0, "viscous_nms": 4e-4, "detent_torque_nm": 0.015}
    coil = {"resistance_ohm": 1.4, "inductance_h": 2e-3}
    motor = TwinMotor(**figures, **coil, load_friction_nm=0.02, backlash_deg=0.05, supply_v=36.0, counts_per_turn=4000)
    async with studied(tmp_path, load=LOAD) as s:
        job = await move_job(s)
    made = options_of(job.model).model_validate(emulator_options(job, motor)).model_dump()
    assert {name: made["motor"][name] for name in (*figures, *coil)} == {**figures, **coil}
    assert made["load"]["friction_nm"] == 0.02
    assert made["supply_v"] == 36.0
    assert (made["encoder"]["lines"], made["encoder"]["errors"]["backlash_deg"]) == (1000, 0.05)
    # one whose encoder cannot have play is made all the same
    other = replace(job, model="tmc4361")
    assert options_of(other.model).model_validate(emulator_options(other, motor)).model_dump()["supply_v"] == 36.0


OHM = 0.15
FULL_A = {"tmc5072": 0.32 / (OHM + 0.02), "tmc5130": 0.325 / (OHM + 0.02), "tmc5160": 0.325 / OHM}
"""Peak at full scale with such sense resistors, by the data sheets (DS-TMC5072 7, DS-TMC5130 9, DS-TMC5160 9)."""


def peak_a(wire: object) -> float:
    """Of both coils as they stand: how long the vector of their currents is."""
    assert isinstance(wire, EmulatedTmc5xxx)
    truth = wire.state().axes[0].truth
    return math.hypot(truth.current_a_a, truth.current_b_a)


@pytest.mark.parametrize(
    ("model", "select", "share"),
    [("tmc5072", 1, 0.18 / 0.32), ("tmc5130", 0, 1.0), ("tmc5130", 1, 0.18 / 0.325), ("tmc5160", 96, 96 / 256)],
)
async def test_a_twin_has_the_current_that_sense_resistors_and_registers_make(
    model: str, select: int, share: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    seen: list[float] = []

    async def look(device: Device, axis: int, clock: Clock, document: StudyDocument, asked: Asked) -> Trial:
        port = device.session.port
        assert isinstance(port, EmulatorPort)
        await clock.sleep(0.1)
        seen.append(peak_a(port.wire))
        return Trial(number=asked.number, setting={}, registers=[], state="feasible", figures=Figures())

    start = replace(START, irun=31, ihold=31, select=select)
    async with bench(model, start, motor={"rotor_teeth": 50}, full_scale_a=FULL_A[model]) as b:
        document = StudyDocument.model_validate({"device": b.device.id, "study": MOVE})
        job = job_of(b.device, 0, await capture(b.device), TwinMotor(), document, Asked(0, HELD))
        await b.clock.advance(0.1)
        axis_a = peak_a(b.wire)
    monkeypatch.setattr("app.studies.kinds.StudyKind.on_twin", OnTwin(look, lambda document, trial: Told((), 0.0)))
    for limits in (AxisLimits(sense_resistor_ohm=OHM), AxisLimits(current_full_scale_a=FULL_A[model] / math.sqrt(2))):
        axes = tuple(replace(settings, limits=limits) for settings in job.axes)
        told = await asyncio.to_thread(run_job, replace(job, axes=axes))
        assert told["state"] == "feasible", told["why"]
    assert axis_a == pytest.approx(share * FULL_A[model], rel=0.05)
    assert seen == pytest.approx([axis_a] * 2)


def estimate(value: float) -> Estimate:
    return Estimate(value=value, interval=Interval(low=value - 1, high=value + 1))


def test_a_motor_has_what_was_identified_of_it_and_nothing_that_could_not_be_told() -> None:
    known: dict[str, Any] = {"microsteps_per_turn": 51_200, "run_scale": 31, "inertia_kgm2": estimate(3e-5)}
    more: dict[str, Any] = {
        "torque_nm": estimate(0.6),
        "friction_nm": estimate(0.02),
        "viscous_nms": estimate(-1e-6),
        "detent_torque_nm": estimate(0.015),
        "inductance_h": estimate(2e-3),
        "backlash_microsteps": estimate(6.0),
        "encoder_lines": 1000,
        "supply_v": 36.0,
    }

    def figures(identified: dict[str, Any], **study: Any) -> dict[str, float]:
        document = StudyDocument(device="slide", study=Identification(**study))
        record = StudyRecord(id="one", document=document, started_unix_s=0.0, identified=Identified(**identified))
        return figures_of(record)

    inertia = {"rotor_inertia_kgm2": 3e-5, "load_inertia_kgm2": 0.0}
    assert figures(known) == inertia
    told = {
        "load_friction_nm": 0.02,
        "friction_nm": 0.0,
        "viscous_nms": 0.0,
        "detent_torque_nm": 0.015,
        "inductance_h": 2e-3,
        "backlash_deg": pytest.approx(0.0422, abs=1e-4),
        "counts_per_turn": 4000,
        "supply_v": 36.0,
    }
    assert figures({**known, **more}) == {**inertia, **told}, "a torque without its current is none"
    assert figures({**known, **more}, run_current_a=1.2) == {
        **inertia,
        **told,
        "holding_torque_nm": 0.6,
        "rated_current_a": 1.2,
    }


async def test_a_setting_comes_to_the_same_wherever_its_twin_runs_and_a_dead_process_costs_nothing_else(
    tmp_path: Path,
) -> None:
    async with studied(tmp_path, load=LOAD) as s:
        job, longer = await move_job(s), await move_job(s, distance=20_000_000)
    here = await asyncio.to_thread(run_job, job)
    assert Trial.model_validate(here).state == "feasible"
    processes = Processes(1)
    try:
        assert await processes.ready() == 1
        assert await processes.submit(job) == here
        (pid,) = processes.pids
        killed = asyncio.create_task(processes.submit(longer))
        next_one = asyncio.create_task(processes.submit(job))
        await asyncio.sleep(0.2)  # it is under way
        os.kill(pid, signal.SIGKILL)
        with pytest.raises(JobLost, match="gone"):
            await killed
        assert await next_one == here
        assert processes.pids != [pid]
    finally:
        await processes.close()


async def test_a_twin_moves_by_all_distances(tmp_path: Path) -> None:
    async with studied(tmp_path, load=LOAD) as s:
        job = await move_job(s, distances=[3_200])
    figures = Trial.model_validate(await asyncio.to_thread(run_job, job)).figures
    far, short = figures.by_distance_s
    assert short < far
    assert figures.time_s == pytest.approx(far + short)


async def test_a_twin_that_cannot_be_made_costs_nothing_on_the_axis(tmp_path: Path) -> None:
    async with studied(tmp_path) as s:
        run = s.begin(s.document({**twinned(), "twin": {"trials": 5}}, budget={"trials": 2}))
        run.executor = Unready
        record = await s.finish(run)
        assert record.state == "done"
        (found,) = (one for one in record.findings if one.name == "twin")
        assert (found.sure, found.text) == ("missing", "could not be tried: nobody here")
        assert len(record.trials) >= 2


class Unready(Here):
    async def ready(self) -> int:
        raise WrongState("nobody here", "")


async def test_a_lost_worker_costs_its_setting_only(tmp_path: Path) -> None:
    async with studied(tmp_path, load=LOAD) as s:
        run = s.begin(s.document(twinned(), budget={"trials": 2}))
        run.executor = Dying
        record = await s.finish(run)
        assert record.state == "done"
        (found,) = (one for one in record.findings if one.name == "twin")
        assert "1 lost with a worker" in found.text
        assert record.twin


class Dying(Here):
    """Loses the third setting, as a worker does that is killed."""

    async def submit(self, job: Any) -> dict[str, Any]:
        if job.number == 2:
            raise JobLost("gone")
        return await super().submit(job)
