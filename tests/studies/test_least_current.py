"""The least current of a load cycle on an emulated axis: found, proved, put back, and left where there is none."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from app.studies.kinds import KINDS
from app.studies.least_current.cycle import Cycle, faster
from app.studies.ramp_settings import ACCELERATION, SPEED
from app.studies.report import html_of
from tests.studies.harness import START, studied

FULL = replace(START, vmax=256_000, amax=1_000_000, irun=31, ihold=20)
CYCLE: dict[str, Any] = {
    "kind": "least_current",
    "distance": 25_600,
    "margin": 0.25,
    "loss_rate_max": 0.2,
    "resistance_ohm": 2.3,
    "run_current_a": 1.06,
}
PLANT: dict[str, Any] = {"load": {"inertia_kgm2": 5e-4, "friction_nm": 0.05}, "full_scale_a": 1.5}
NAMES = ("IHOLD_IRUN", "VMAX", "AMAX")


async def test_a_lower_current_is_found_and_proved_and_the_axis_is_as_before(tmp_path: Path) -> None:
    async with studied(tmp_path, FULL, **PLANT) as s:
        before = await s.settings(*NAMES)
        record = await s.finish(s.begin(s.document(CYCLE)), 300)
        found = record.least_current
        assert (record.state, record.improved, record.left) == ("done", True, []), record.message
        assert found is not None
        assert found.edge is not None
        assert found.chosen is not None
        assert found.proved is not None
        assert found.edge <= found.proved < found.chosen < 31
        assert (found.proved + 1) / (found.chosen + 1) <= 0.75
        assert any(one.scale == found.edge - 1 and not one.held for one in found.tried)
        proved = [one for one in found.tried if one.scale == found.proved and one.cycles == found.cycles]
        assert [one.speed_times for one in proved] == [pytest.approx(1.25, rel=0.01), 1.0]
        assert not found.limited_by_supply
        assert found.speed_times == pytest.approx(1.25, rel=0.01)
        assert found.cycles == 14
        assert found.loss_rate_max == pytest.approx(1 - 0.05 ** (1 / 14))
        share = ((found.chosen + 1) / 32) ** 2
        assert found.saving is not None
        assert found.saving.saved_w == pytest.approx(2 * 1.06**2 * 2.3 * (1 - share))
        assert await s.settings(*NAMES) == before
        state = await s.b.state()
        assert (state.position, abs(state.encoder_position or 0) < 256) == (0, True)
        best = record.trial(record.best)
        assert best is not None
        assert best.registers[0].value >> 8 & 31 == found.chosen
        assert best.registers[0].value & 31 == min(found.chosen, 20)
        report = html_of(record)
        assert "Heat of the coils, calculated" in report
        assert report.count("<svg") == 1


async def test_a_current_that_is_no_more_than_needed_stays(tmp_path: Path) -> None:
    low = replace(FULL, irun=19, ihold=8)
    async with studied(tmp_path, low, **PLANT) as s:
        before = await s.settings(*NAMES)
        record = await s.finish(s.begin(s.document({**CYCLE, "margin": 0.5})), 300)
        assert (record.state, record.improved, record.best) == ("done", False, None), record.message
        assert "stays as it is" in record.verdict
        assert await s.settings(*NAMES) == before


async def test_a_stop_in_the_proof_puts_the_current_back(tmp_path: Path) -> None:
    async with studied(tmp_path, FULL, **PLANT) as s:
        before, run = await s.settings(*NAMES), s.begin(s.document(CYCLE))
        while run.record.phase != "proof":
            await s.clock.advance(0.2)
            assert run.running, run.record.message
        await s.clock.advance(1.0)
        assert (await s.settings("IHOLD_IRUN")) != before[:1]
        await s.device.stop_axes([0])
        record = await s.finish(run, 60)
        assert (record.state, record.left) == ("aborted", [])
        assert await s.settings(*NAMES) == before


async def test_the_plan_tells_of_cycles_and_of_what_watts_need(tmp_path: Path) -> None:
    async with studied(tmp_path, FULL, **PLANT) as s:
        document = s.document({"kind": "least_current", "distance": -25_600})
        plan = await KINDS["least_current"].plan(s.device, 0, document)
        assert plan.missing == []
        # 160,000 microsteps/s are reached on the way; 1.25 times as much with the same acceleration need 40,000.
        assert plan.position_to == 0
        assert plan.position_from == pytest.approx(-1024 - 25_600 * 1.25**2, rel=0.001)
        assert plan.velocity_max_pps == pytest.approx(1.25 * 160_000, rel=0.001)
        assert plan.moves_max == 2 * (3 + 10 * 3 + 2 * 59)
        assert any("not in watts" in line for line in plan.warnings)


async def test_where_the_supply_limits_less_current_is_no_margin(tmp_path: Path) -> None:
    fast = replace(FULL, vmax=500_000, amax=1_000_000)
    async with studied(tmp_path, fast, **PLANT, supply_v=14.0) as s:
        before = await s.settings(*NAMES)
        record = await s.finish(s.begin(s.document({**CYCLE, "distance": 256_000})), 300)
        found = record.least_current
        assert (record.state, record.improved, record.best) == ("done", False, None), record.message
        assert found is not None
        assert found.limited_by_supply
        assert found.speed_times_held is not None
        assert 1.0 <= found.speed_times_held < 1.25
        assert "by the supply voltage, not by the current" in record.verdict
        assert await s.settings(*NAMES) == before


def test_more_speed_takes_more_way_or_where_there_is_none_a_harder_ramp() -> None:
    most = {SPEED: 1e6, ACCELERATION: 1e7}
    short, long = (Cycle(distance, {SPEED: 200.0, ACCELERATION: 100.0}) for distance in (-100, -1000))
    further = faster(short, 1.2, most, 1000)
    assert further is not None
    assert (further.distance, further.ramp[ACCELERATION]) == (-144, 100.0)
    assert further.peak == pytest.approx(120)
    harder = faster(short, 1.2, most, 120)
    assert harder is not None
    assert harder.distance == -100
    assert harder.ramp[ACCELERATION] == pytest.approx(144)
    straight = faster(long, 1.2, most, 1000)
    assert straight is not None
    assert straight.distance == -1000
    assert straight.ramp[SPEED] == pytest.approx(240)
    assert faster(long, 1.2, {SPEED: 201.0, ACCELERATION: 100.0}, 1000) is None
    bounded = faster(short, 1.2, {SPEED: 1e6, ACCELERATION: 121.0}, 120)
    assert bounded is not None
    assert bounded.times == pytest.approx(1.1)
