"""The fastest move of a chip with S-ramps: its bows are settings too, where they have a part in the ramp."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from app.studies.families import ramp_of
from app.studies.kinds import KINDS
from app.studies.ramp_settings import RampSpace, held_of
from app.studies.store import StudyStore
from tests.devices.tmc4361.harness import START, bench
from tests.studies.harness import Studied

MOVE = {"kind": "fastest_move", "distance": 12_800, "repeats": 1}
NAMES = ("VMAX", "AMAX", "DMAX", "BOW1", "BOW4")


async def test_bows_are_searched_too_and_all_of_it_goes_back(tmp_path: Path) -> None:
    load = {"inertia_kgm2": 2e-4, "friction_nm": 0.05}
    async with bench(replace(START, stops=False), load=load) as b:
        s = Studied(b, StudyStore(tmp_path, aside=False))
        before = await s.settings(*NAMES)
        record = await s.finish(s.begin(s.document(MOVE, budget={"trials": 5})))
        assert (record.state, record.improved, record.left) == ("done", True, []), record.message
        assert set(record.units) == {"speed", "acceleration", "jerk"}
        assert record.evidence is not None
        assert record.evidence.share < -0.2, "bows alone keep it slow"
        assert await s.settings(*NAMES) == before


async def test_without_s_ramps_the_bows_are_left_alone(tmp_path: Path) -> None:
    async with bench(replace(START, stops=False)) as b:
        await b.device.registers.write("RAMPMODE", 0, fields={"RAMP_PROFILE": 1})
        space = RampSpace(b.device, 0, ramp_of(b.device), await held_of(b.device))
        assert space.now() == pytest.approx({"speed": 50_000, "acceleration": 200_000}, rel=1e-3)
        assert {each.name for each in space.before} == {"VMAX", "AMAX", "DMAX"}


async def test_torque_is_not_told_by_ramps_that_bows_keep_gentle_and_by_others_a_switch_tells_it(
    tmp_path: Path,
) -> None:
    """With bows no ramp came to its acceleration, and the motor was said to have all of that. Without them a switch had
    stopped the motor, which swung out of it at once: it was waited for in vain."""
    inertia = 1e-3
    stage = {"left_at_fullsteps": -21.3, "right_at_fullsteps": 1e6}
    async with bench(START, load={"inertia_kgm2": inertia, "friction_nm": 0.02}, stage=stage) as b:
        s = Studied(b, StudyStore(tmp_path, aside=False))
        study = {"kind": "torque_curve", "seen_by": "left switch", "travel_turns": 200.0, "speeds": 2, "repeats": 2}
        document = s.document({**study, "inertia_kgm2": inertia}, budget={"time_s": 7200.0})
        missing = (await KINDS["torque_curve"].plan(s.device, 0, document)).missing
        assert len(missing) == 1
        assert "S-shaped" in missing[0]
        await b.device.registers.write("RAMPMODE", 0, fields={"RAMP_PROFILE": 1})
        before = await s.settings(*NAMES)
        record = await s.finish(s.begin(document), 7200)
        assert (record.state, record.left) == ("done", []), record.message
        assert record.torque is not None
        assert len(record.torque.points) == 2
        assert (await s.device.monitor.axis_state(0)).position == 0
        assert await s.settings(*NAMES) == before
