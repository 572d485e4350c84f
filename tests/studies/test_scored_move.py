"""A move by hand on an emulated axis: scored with the settings in force, of which it sets none."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.studies.document import StudyDocument
from app.studies.kinds import KINDS
from app.studies.report import html_of
from app.studies.scored_move.noticed import MoveFinder
from app.studies.store import StudyStore
from tests.devices.tmc4361.harness import START as START_4361
from tests.devices.tmc4361.harness import bench as bench_4361
from tests.studies.harness import START, studied

MOVE: dict[str, Any] = {"kind": "scored_move", "distance": 25_600, "repeats": 2}
PLANT: dict[str, Any] = {"load": {"inertia_kgm2": 2e-4, "friction_nm": 0.02}, "full_scale_a": 2.0}


async def test_a_move_is_scored_with_the_settings_in_force(tmp_path: Path) -> None:
    async with studied(tmp_path, replace(START, irun=20), **PLANT) as s:
        document = s.document(MOVE)
        plan = await KINDS["scored_move"].plan(s.device, 0, document)
        assert (plan.missing, plan.registers, plan.moves_max) == ([], [], 4)
        slow = await s.finish(s.begin(document), 60)
        assert (slow.state, slow.left, slow.baseline) == ("done", [], []), slow.message
        found = slow.scored
        assert found is not None
        assert found.moves == 4
        assert found.time_s is not None
        assert 0.6 < found.time_s < 25_600 / 50_000 + 0.3
        assert found.interval_s is not None
        assert 0 < found.vibration_fullsteps < found.peak_fullsteps < 2
        assert found.rest_fullsteps is not None
        assert found.lost_fullsteps == 0
        assert found.load_min is not None
        trial = slow.trial(slow.best)
        assert trial is not None
        assert trial.setting["run current scale"] == 20
        assert round(trial.setting["acceleration [pps^2]"], -1) == 200_000
        assert {"IHOLD_IRUN", "CHOPCONF", "COOLCONF", "AMAX"} <= {each.name for each in trial.registers}
        assert "Settings in force" in html_of(slow)

        amax = (await s.settings("AMAX"))[0]
        await s.device.registers.write("AMAX", 0, 2 * amax)
        fast = await s.finish(s.begin(document), 60)
        assert fast.scored is not None
        assert fast.scored.time_s is not None
        assert fast.scored.time_s < found.time_s
        assert await s.settings("AMAX") == [2 * amax]


async def test_lost_steps_are_told(tmp_path: Path) -> None:
    weak = replace(START, irun=0, ihold=0, amax=5_000_000, vmax=256_000)
    async with studied(tmp_path, weak, load={"inertia_kgm2": 5e-4, "friction_nm": 0.05}) as s:
        record = await s.finish(s.begin(s.document({**MOVE, "repeats": 1})), 60)
        assert record.scored is not None, record.message
        assert record.scored.lost_fullsteps >= 4
        assert record.trials[0].state == "infeasible"
        assert "lost" in record.verdict


async def test_the_gains_of_a_loop_are_settings_by_hand_too(tmp_path: Path) -> None:
    async with studied(tmp_path) as s:
        document = s.document(MOVE)
    async with bench_4361(START_4361) as b:
        ground = (await KINDS["scored_move"].plan(b.device, 0, document)).missing
        assert ground == []


def rows(position: list[float], *, encoder: list[float] | None = None, first_s: float = 0.0) -> tuple[Any, Any]:
    """Samples of 100 Hz: position, encoder, velocity."""
    place = np.array(position, dtype=float)
    velocity = np.gradient(place) * 100
    return first_s + np.arange(len(place)) / 100, np.stack([place, np.array(encoder or position), velocity])


def test_a_move_is_found_from_rest_to_rest() -> None:
    finder = MoveFinder(3, 256)
    way = [0.0] * 30 + [float(at) for at in range(0, 2000, 100)] + [2000.0] * 60
    times, columns = rows(way, encoder=[at + 7 for at in way])
    found = []
    for begin in range(0, len(way), 7):  # in pieces, as they come
        found += finder.feed(times[begin : begin + 7], columns[:, begin : begin + 7])
    (one,) = found
    assert (one.sampled.start, one.target, one.before, one.sampled.deviation) == (0, 2000, 7, 7)
    assert one.sampled.time_s[0] == pytest.approx(-0.1, abs=0.02)
    assert one.sampled.time_s[-1] == pytest.approx(0.2 + 0.4, abs=0.03)
    assert (finder.moving, finder.missed) == (False, 0)


def test_what_is_no_whole_move_is_not_scored() -> None:
    there = [float(at) for at in range(0, 2000, 100)]
    cases = {
        "to and fro": ([0.0] * 30 + there + there[::-1] + [0.0] * 60, 1),
        "from the middle": (there + [2000.0] * 60, 1),
        "less than a full step": ([0.0] * 30 + [20.0, 40.0, 60.0, 80.0] + [100.0] * 60, 0),
    }
    for case, (way, missed) in cases.items():
        finder = MoveFinder(3, 256)
        assert finder.feed(*rows(way)) == [], case
        assert finder.missed == missed, case
    finder = MoveFinder(3, 256)
    times, columns = rows([0.0] * 30 + [5000.0] * 60)
    columns[2] = 0.0  # the counter was set at rest
    assert finder.feed(times, columns) == []
    assert finder.missed == 0
    finder = MoveFinder(3, 256)
    finder.feed(*rows([0.0] * 30 + there))
    finder.gap()
    assert finder.feed(*rows([2000.0] * 60, first_s=0.5)) == []
    assert finder.missed == 1


async def test_one_whose_server_was_killed_tells_that_the_motor_may_still_turn_and_bars_nothing(tmp_path: Path) -> None:
    store = StudyStore(tmp_path, aside=False)
    record = store.begin(StudyDocument.model_validate({"device": "slide", "study": MOVE}))
    await store.save(record)
    (found,) = StudyStore(tmp_path, aside=False).load()
    assert (found.state, found.left) == ("interrupted", [])
    assert "the motor may still turn" in found.message
