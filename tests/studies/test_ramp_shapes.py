"""The fastest move where the ramp's shape is searched too: six points, and bows apart."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from app.profiles.apply import Transaction
from app.studies.document import FastestMove
from app.studies.families import shapes_of
from app.studies.fastest_move.ranges import look
from app.studies.kinds import KINDS
from app.studies.ramp_settings import (
    ACCELERATION,
    DECELERATION,
    KNEE,
    KNEE_ACCELERATION,
    KNEE_DECELERATION,
    REST_JERK,
    SPEED,
    TOP_JERK,
    RampSpace,
    document_of,
    held_of,
    least_time_s,
)
from app.studies.search import Dimension, Searcher, Space
from app.studies.store import StudyStore
from tests.devices.tmc4361.harness import START as START_4361
from tests.devices.tmc4361.harness import bench as bench_4361
from tests.devices.tmcl.harness import bench as module_bench
from tests.studies.harness import MOTOR, START, Studied, studied

MOVE: dict[str, Any] = {"kind": "fastest_move", "distance": 12_800, "repeats": 1}
SIX = {**MOVE, "shape": "six points"}
BOWS = {**MOVE, "shape": "bows"}
HEAVY = {"inertia_kgm2": 5e-4, "friction_nm": 0.05}
SLUGGISH = {**MOTOR, "inductance_h": 9e-3}
"""Its torque falls early: from about a turn a second on the supply limits the current."""
RAMP = {SPEED, ACCELERATION, KNEE, KNEE_ACCELERATION, DECELERATION, KNEE_DECELERATION}
NAMES = ("VMAX", "AMAX", "DMAX", "V1", "A1", "D1")


async def plan_of(s: Studied, study: dict[str, Any]) -> Any:
    return await KINDS["fastest_move"].plan(s.device, 0, s.document(study))


async def test_a_ramp_of_six_points_is_found_proved_and_put_back(tmp_path: Path) -> None:
    async with studied(tmp_path, motor=SLUGGISH, load=HEAVY) as s:
        before = await s.settings(*NAMES)
        record = await s.finish(s.begin(s.document(SIX, budget={"trials": 8})))
        assert (record.state, record.improved, record.left) == ("done", True, []), record.message
        assert await s.settings(*NAMES) == before
        best = record.trial(record.best)
        assert best is not None
        held = {each.name: each.value for each in best.registers}
        assert held.keys() == {*NAMES}
        assert best.setting.keys() == record.units.keys() == RAMP
        assert held["AMAX"] <= held["A1"] <= held["D1"] >= held["DMAX"] >= held["AMAX"]
        tried = [trial.setting for trial in record.trials]
        assert all(0 < each[KNEE] < each[SPEED] for each in tried)
        assert all(each[KNEE_ACCELERATION] >= each[ACCELERATION] for each in tried)
        assert any(each[DECELERATION] > 1.1 * each[ACCELERATION] for each in tried), "friction helps to brake"
        assert any(each[KNEE_ACCELERATION] > 1.2 * each[ACCELERATION] for each in tried)
        most = max(each[KNEE_DECELERATION] for each in tried)
        assert most * 1.1 <= (await plan_of(s, SIX)).acceleration_max_pps2 * 1.001, "never steeper, margin included"


async def test_a_search_may_leave_settings_out_at_first() -> None:
    space = Space((Dimension("speed", 1, 2), Dimension("knee", 0.2, 0.9)), 1, "tpe")
    searcher = Searcher(None, space, 0, aside=False)
    await searcher.open()
    asked = await searcher.ask(("knee",))
    assert asked.values.keys() == {"speed"}
    await searcher.tell(asked, [1.0], -1.0)
    assert (await searcher.ask()).values.keys() == {"speed", "knee"}
    searcher.close()


async def test_bows_near_rest_and_near_full_speed_are_searched_apart(tmp_path: Path) -> None:
    names = ("VMAX", "AMAX", "DMAX", "BOW1", "BOW2", "BOW3", "BOW4")
    async with bench_4361(replace(START_4361, stops=False), load={"inertia_kgm2": 2e-4, "friction_nm": 0.05}) as b:
        s = Studied(b, StudyStore(tmp_path, aside=False))
        before = await s.settings(*names)
        record = await s.finish(s.begin(s.document(BOWS, budget={"trials": 6})))
        assert (record.state, record.improved, record.left) == ("done", True, []), record.message
        assert await s.settings(*names) == before
        best = record.trial(record.best)
        assert best is not None
        assert best.setting.keys() == record.units.keys() == {SPEED, ACCELERATION, REST_JERK, TOP_JERK}
        held = {each.name: each.value for each in best.registers}
        assert held.keys() == {*names}
        assert (held["BOW1"], held["BOW2"]) == (held["BOW4"], held["BOW3"])
        assert any(trial.setting[REST_JERK] != pytest.approx(trial.setting[TOP_JERK]) for trial in record.trials)
        by_bows = [
            trial for trial in record.trials if trial.figures.time_s is not None and trial.expected_s is not None
        ]
        assert by_bows
        for trial in by_bows:
            plain_s = least_time_s(12_800, trial.setting[SPEED], trial.setting[ACCELERATION])
            assert trial.expected_s is not None
            assert trial.expected_s > 1.02 * plain_s, "bows take time, which the prediction has to know"


@pytest.mark.parametrize("distance", [1_000, 60_000])
async def test_the_time_of_six_points_is_what_the_chip_takes(tmp_path: Path, distance: int) -> None:
    async with studied(tmp_path) as s:
        space = RampSpace(s.device, 0, shapes_of(s.device)["six points"], await held_of(s.device))
        ramp = {SPEED: 80_000, ACCELERATION: 150_000, KNEE: 30_000, KNEE_ACCELERATION: 500_000}
        setting = space.rounded({**ramp, DECELERATION: 250_000, KNEE_DECELERATION: 800_000})
        await Transaction(s.device, document_of(s.device, space.registers(setting), "shape")).run()
        await s.device.motion.move(0, distance)
        took_s = 0.0
        while (await s.b.state()).moving:
            await s.clock.advance(0.002)
            took_s += 0.002
        assert space.least_time_s(distance, setting) == pytest.approx(took_s, abs=0.006)
        assert space.least_time_s(distance, setting) != pytest.approx(
            least_time_s(distance, setting[SPEED], setting[ACCELERATION]), abs=0.02
        )


async def test_the_search_begins_with_the_shape_that_is_set(tmp_path: Path) -> None:
    async with studied(tmp_path, replace(START, dmax=300_000, v1=20_000, a1=400_000, d1=600_000)) as s:
        six = FastestMove.model_validate(SIX)
        ranges = (await look(s.device, 0, six)).required()
        asked = ranges.asked(ranges.space.now(), 2.0)
        assert asked == pytest.approx(
            {SPEED: 100_000, ACCELERATION: 400_000, KNEE: 0.4, KNEE_ACCELERATION: 2, DECELERATION: 1.5}, rel=1e-3
        )
        assert ranges.setting(asked) == pytest.approx(
            {
                SPEED: 100_000,
                ACCELERATION: 400_000,
                KNEE: 40_000,
                KNEE_ACCELERATION: 800_000,
                DECELERATION: 600_000,
                KNEE_DECELERATION: 1_200_000,
            },
            rel=1e-3,
        )
        await s.device.registers.write("V1", 0, 0)
        ranges = (await look(s.device, 0, six)).required()
        setting = ranges.setting(ranges.asked(ranges.space.now(), 2.0))
        alike = {setting[name] for name in (ACCELERATION, DECELERATION, KNEE_ACCELERATION, KNEE_DECELERATION)}
        assert len(alike) == 1, "a trapezoid, whatever A1 holds"


async def test_the_plan_says_what_becomes_of_the_shape(tmp_path: Path) -> None:
    async with studied(tmp_path) as s:
        plan = await plan_of(s, SIX)
        assert plan.missing == []
        assert {line.split(" of ")[0] for line in plan.registers} == {*NAMES}
        assert any("six points" in line and KNEE in line for line in plan.steps)
        plan = await plan_of(s, MOVE)
        assert any("V1 set to 0" in line and "trapezoid" in line for line in plan.steps)
        assert any("could be: six points" in line for line in plan.steps)
        assert any(
            "bows cannot be searched" in line and "six points" in line for line in (await plan_of(s, BOWS)).missing
        )


async def test_bows_of_a_ramp_without_them_are_missing(tmp_path: Path) -> None:
    async with bench_4361(replace(START_4361, stops=False)) as b:
        s = Studied(b, StudyStore(tmp_path, aside=False))
        await b.device.registers.write("RAMPMODE", 0, fields={"RAMP_PROFILE": 1})
        assert any("no part in the ramp" in line for line in (await plan_of(s, BOWS)).missing)


@pytest.mark.parametrize(("model", "has"), [("pd42-1241", True), ("tmcm-1161", False)])
async def test_a_module_has_the_shape_that_its_ramp_generator_has(tmp_path: Path, model: str, has: bool) -> None:
    async with module_bench(model) as b:
        plan = await plan_of(Studied(b, StudyStore(tmp_path, aside=False)), SIX)
        if has:
            assert plan.missing == []
            names = {line.split(" of ")[0] for line in plan.registers}
            assert names >= {"velocity_v1", "acceleration_a1", "deceleration_d1"}
        else:
            assert any("six points cannot be searched" in line for line in plan.missing)
