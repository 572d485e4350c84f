"""The least current of a load cycle on an emulated axis: found, proved, put back, and left where there is none."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from app.studies.kinds import KINDS
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
        assert (plan.position_from, plan.position_to) == (-25_600 - 1024, 0)
        assert plan.moves_max == 2 * (3 + 5 * 3 + 59)
        assert any("not in watts" in line for line in plan.warnings)
