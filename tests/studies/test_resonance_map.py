"""The resonance map of an emulated axis: its resonance by name, what a change does to it, and the axis as before."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from pydantic import ValidationError

from app.studies.document import ResonanceMap
from app.studies.kinds import KINDS
from app.studies.pieces import FILE
from app.studies.report import html_of
from tests.devices.tmc4361.harness import START as START_4361
from tests.devices.tmc4361.harness import bench as bench_4361
from tests.studies.harness import START, studied

FULL = replace(START, irun=31, ihold=16)
TORQUE, INERTIA, DAMPING = 0.45, 2e-5, 0.08
W = math.sqrt(50 * TORQUE / INERTIA)
HZ = W / (2 * math.pi)
PLANT: dict[str, Any] = {
    "motor": {
        "rotor_teeth": 50,
        "holding_torque_nm": TORQUE,
        "rated_current_a": 1.5,
        "rotor_inertia_kgm2": INERTIA,
        "detent_torque_nm": 0.02,
        "friction_nm": 0.01,
        "viscous_nms": 2 * DAMPING * INERTIA * W,
    },
    "full_scale_a": 1.5 * math.sqrt(2),
}
MAP: dict[str, Any] = {
    "kind": "resonance_map",
    "velocity_min_rps": 0.4,
    "velocity_max_rps": 1.8,
    "speeds": 8,
    "travel_turns": 4.0,
    "repeats": 1,
    "current_shares": [0.5],
    "other_chopper": False,
}
NAMES = ("VMAX", "AMAX", "DMAX", "V1", "IHOLD_IRUN")


async def test_it_names_the_resonance_and_what_less_current_does_to_it(tmp_path: Path) -> None:
    async with studied(tmp_path, FULL, **PLANT) as s:
        before, document = await s.settings(*NAMES), s.document(MAP)
        plan = await KINDS["resonance_map"].plan(s.device, 0, document)
        assert plan.missing == []
        record = await s.finish(s.begin(document), 300)
        found = record.resonances
        assert (record.state, record.left) == ("done", []), record.message
        assert found is not None
        assert found.resonance_hz is not None
        assert found.resonance_hz.interval.low < HZ < found.resonance_hz.interval.high
        assert found.resonance_hz.value == pytest.approx(HZ, rel=0.02)
        strongest = found.crossings[0]
        assert strongest.order == 4
        assert strongest.speed_rps.value == pytest.approx(HZ / 200, rel=0.02)
        assert [point.speed_rps for point in found.points] == sorted(point.speed_rps for point in found.points)
        assert len(found.points) > MAP["speeds"]
        change = found.changes[0]
        assert change.resonance_hz is not None
        assert change.resonance_hz.value == pytest.approx(HZ * math.sqrt(0.5), rel=0.06)
        at_resonance = min(change.points, key=lambda point: abs(point.speed_rps - strongest.speed_rps.value))
        assert at_resonance.difference_deg < 0
        assert (record.runs, record.way_fullsteps) <= (plan.moves_max, plan.way_fullsteps)
        assert await s.settings(*NAMES) == before
        assert (await s.b.state()).position == 0
        report = html_of(record)
        assert "Campbell plot" in report
        assert report.count("<svg") == 2


async def test_a_stop_puts_everything_back(tmp_path: Path) -> None:
    async with studied(tmp_path, FULL, **PLANT) as s:
        before, run = await s.settings(*NAMES), s.begin(s.document(MAP))
        while run.record.runs < 3:
            await s.clock.advance(0.2)
            assert run.running, run.record.message
        assert await s.settings("VMAX") != before[:1]
        await s.device.stop_axes([0])
        record = await s.finish(run, 60)
        assert (record.state, record.left) == ("aborted", [])
        assert await s.settings(*NAMES) == before


@pytest.mark.parametrize("points", [3, 9])
async def test_it_goes_on_with_the_speeds_and_changes_that_are_left(tmp_path: Path, points: int) -> None:
    """Killed in the map, or among the speeds around its resonance."""
    async with studied(tmp_path, FULL, **PLANT) as s:
        run = s.begin(s.document(MAP))
        await s.until(run, lambda record: record.resonances is not None and len(record.resonances.points) == points)
        await s.clock.advance(1.0)
        cut = await s.killed(run)
        assert cut.resonances is not None
        runs, made = cut.runs, list(cut.resonances.points)
        assert len(made) == points
        record = await s.finish(s.begin(cut.document, cut), 300)
        found = record.resonances
        assert (record.state, record.left) == ("done", []), record.message
        assert found is not None
        assert all(point in found.points for point in made)
        # There and back at each speed of the map that was left, and twice that at each where the change is compared.
        assert record.runs - runs == 2 * (len(found.points) - points) + 4 * len(found.changes[0].points)
        assert found.resonance_hz is not None
        assert found.resonance_hz.value == pytest.approx(HZ, rel=0.02)
        assert not (s.store.folder(record.id) / FILE).exists()


async def test_a_change_that_was_compared_is_not_compared_again(tmp_path: Path) -> None:
    async with studied(tmp_path, FULL, **PLANT) as s:
        run = s.begin(s.document({**MAP, "current_shares": [0.7, 0.5]}))
        await s.until(run, lambda record: len(record.trials) == 1)
        await s.clock.advance(1.0)
        cut = await s.killed(run)
        assert cut.resonances is not None
        found, trials = cut.resonances.model_copy(deep=True), list(cut.trials)
        record = await s.finish(s.begin(cut.document, cut), 300)
        assert record.state == "done", record.message
        assert record.resonances is not None
        assert record.resonances.points == found.points
        assert record.resonances.changes[:1] == found.changes
        assert (len(record.trials), record.trials[:1]) == (2, trials)


async def test_a_plan_tells_what_there_is_no_room_for(tmp_path: Path) -> None:
    async with studied(tmp_path, FULL, **PLANT) as s:
        document = s.document({**MAP, "velocity_max_rps": 10.0, "travel_turns": 2.0, "other_chopper": True})
        plan = await KINDS["resonance_map"].plan(s.device, 0, document)
        assert any("is the fastest with this travel" in line for line in plan.warnings)
        assert {"IHOLD_IRUN", "GCONF", "TPWMTHRS"} <= set(plan.registers)
        assert any("StealthChop" in step for step in plan.steps)
        short = s.document({**MAP, "velocity_max_rps": 10.0, "travel_turns": 1.0})
        assert any("no room" in one for one in (await KINDS["resonance_map"].plan(s.device, 0, short)).missing)


async def test_an_axis_whose_current_no_study_sets_is_mapped_without_changes(tmp_path: Path) -> None:
    async with studied(tmp_path) as s:
        document = s.document(MAP)
    async with bench_4361(START_4361) as b:
        plan = await KINDS["resonance_map"].plan(b.device, 0, document)
        assert not any("current" in step for step in plan.steps)
        assert any("no change of the current" in line for line in plan.warnings)


@pytest.mark.parametrize("wrong", [{"velocity_max_rps": 0.3}, {"current_shares": [1.0]}])
def test_a_map_without_a_range_or_with_no_change_is_refused(wrong: dict[str, Any]) -> None:
    with pytest.raises(ValidationError):
        ResonanceMap.model_validate({**MAP, **wrong})


async def test_ripple_that_the_samples_cannot_show_is_told_as_such(tmp_path: Path) -> None:
    """Ten times as fast as real time, 1,000 samples a second are 100: at half a turn a second four full steps each."""
    async with studied(tmp_path, FULL, **PLANT, time_scale=10.0) as s:
        speeds = {"velocity_min_rps": 0.5, "velocity_max_rps": 1.03, "speeds": 8}
        record = await s.finish(s.begin(s.document({**MAP, **speeds, "current_shares": []})), 300)
        found = record.resonances
        assert found is not None
        blind, *others = found.points
        assert (blind.speed_rps, blind.blind, blind.runs) == (0.5, 1, 0)
        assert (blind.ripple_deg, blind.rest_deg) == (None, None)
        assert all(point.blind == 0 and point.ripple_deg is not None for point in others)
        (told,) = (one for one in record.findings if "samples" in one.text)
        assert (told.name, told.sure) == ("0.5 turns/s", "cannot be told")
        assert "samples show none" in html_of(record)
