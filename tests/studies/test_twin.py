"""A study tried on a twin first: what a twin is made of, and that the axis decides all the same."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Any

from app.profiles.capture import capture
from app.studies.record import StudyRecord
from app.studies.twin import jobs_of, tried_on_twins
from tests.studies.harness import Studied, studied

MOTOR = {"holding_torque_nm": 0.45, "load_inertia_kgm2": 5e-4, "load_friction_nm": 0.1}
MOVE: dict[str, Any] = {"kind": "fastest_move", "distance": 12_800, "repeats": 1}
LOAD = {"inertia_kgm2": 5e-4, "friction_nm": 0.1}


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
        times = [one.time_s for one in record.twin]
        assert all(later > 1.07 * earlier for earlier, later in pairwise(times))
        first = record.trials[0].setting
        assert all(abs(first[name] / record.twin[-1].setting[name] - 1) < 0.01 for name in first)
        assert record.improved
        assert record.evidence is not None
        assert record.evidence.share < -0.4, "five trials are enough where a like twin has looked before"


async def test_a_twin_that_is_too_strong_fools_nobody(tmp_path: Path) -> None:
    async with studied(tmp_path, load=LOAD) as s:
        record = await done(s, twinned(load_inertia_kgm2=0.0, load_friction_nm=0.0))
        assert "infeasible" in {trial.state for trial in record.trials[: len(record.twin)]}
        assert record.improved is not None
        assert record.left == []


async def test_a_twin_knows_the_registers_and_what_it_is_told_and_nothing_of_the_emulator(tmp_path: Path) -> None:
    async with studied(tmp_path, load=LOAD, supply_v=37.5) as s:
        document = s.document(twinned())
        jobs = jobs_of(s.device, 0, document, await capture(s.device))
        assert "37.5" not in repr(jobs)
        assert len({job.document["seed"] for job in jobs}) == len(jobs)
        assert sum(job.document["budget"]["trials"] for job in jobs) >= 10


async def test_it_runs_in_processes_too(tmp_path: Path) -> None:
    async with studied(tmp_path, load=LOAD) as s:
        jobs = jobs_of(s.device, 0, s.document(twinned()), await capture(s.device))[:1]
        here = await tried_on_twins(jobs, 3, aside=False)
        assert await tried_on_twins(jobs, 3, aside=True) == here
