"""The fastest move of a chip with S-ramps: its bows are settings too, where they have a part in the ramp."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from app.studies.families import ramp_of
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
