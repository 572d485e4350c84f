"""The shape of a ramp searched without an encoder: the edge of a switch tells which shapes have lost steps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from pydantic import ValidationError

from app.profiles.apply import Transaction
from app.studies.document import FastestMove
from app.studies.fastest_move.ranges import look
from app.studies.fastest_move.trials import MoveTrials
from app.studies.kinds import KINDS
from app.studies.ramp_settings import REST_JERK, TOP_JERK, document_of
from app.studies.record import Held
from app.studies.store import StudyStore
from app.studies.switch_edge import SLOW_FULLSTEPS
from tests.devices.tmc4361.harness import START as START_4361
from tests.devices.tmc4361.harness import bench as bench_4361
from tests.studies.harness import START, Studied, studied
from tests.studies.test_ramp_shapes import BOWS, NAMES, RAMP, SIX, SLUGGISH

FULL_STEP = 256
HEAVY = {"inertia_kgm2": 5e-4, "friction_nm": 0.1}
SHAPED = replace(START, counts_per_rev=0, dmax=300_000, v1=20_000, a1=400_000, d1=600_000)
AWAY = {"left switch": 1, "right switch": -1}
STAGES = {
    "left switch": {"left_at_fullsteps": -9.3, "right_at_fullsteps": 1e6},
    "right switch": {"left_at_fullsteps": -1e6, "right_at_fullsteps": 9.3},
}


def wish(base: dict[str, Any], by: str, *distances: int, **more: Any) -> dict[str, Any]:
    first, *others = (AWAY[by] * each for each in distances)
    return {**base, "seen_by": by, "distance": first, "distances": others, "margin": 0.0, **more}


async def test_six_points_by_a_switch_with_two_distances_are_proved_and_put_back(tmp_path: Path) -> None:
    by = "right switch"
    async with studied(tmp_path, SHAPED, motor=SLUGGISH, load=HEAVY, stage=STAGES[by]) as s:
        before = await s.settings(*NAMES)
        record = await s.finish(s.begin(s.document(wish(SIX, by, 6_400, 9_600), budget={"trials": 4})))
        assert (record.state, record.improved, record.left) == ("done", True, []), record.message
        assert await s.settings(*NAMES) == before
        best = record.trial(record.best)
        assert best is not None
        assert best.setting.keys() == RAMP
        assert len(best.figures.by_distance_s) == 2
        assert any(trial.figures.lost_fullsteps for trial in record.trials)
        # whatever was lost on the way, the counter is right again
        assert (await s.b.state()).position == 0
        assert s.b.wire.state().axes[0].truth.rotor_fullsteps == pytest.approx(0.0, abs=1.0)


async def test_bows_by_a_switch_are_proved_and_put_back(tmp_path: Path) -> None:
    by, names = "left switch", ("VMAX", "AMAX", "DMAX", "BOW1", "BOW2", "BOW3", "BOW4")
    start = replace(START_4361, counts_per_rev=0, bow=8_000_000)
    async with bench_4361(start, load={"inertia_kgm2": 3e-3, "friction_nm": 0.05}, stage=STAGES[by]) as b:
        s = Studied(b, StudyStore(tmp_path, aside=False))
        before = await s.settings(*names)
        record = await s.finish(s.begin(s.document(wish(BOWS, by, 12_800), budget={"trials": 4})))
        assert (record.state, record.improved, record.left) == ("done", True, []), record.message
        assert await s.settings(*names) == before
        assert {REST_JERK, TOP_JERK} < record.units.keys()
        assert any(trial.figures.lost_fullsteps for trial in record.trials)
        assert (await b.state()).position == 0
        assert b.wire.state().truth.rotor_fullsteps == pytest.approx(0.0, abs=1.0)


async def test_a_candidate_of_six_points_that_loses_steps_is_refuted_by_a_switch(tmp_path: Path) -> None:
    by = "left switch"
    async with studied(tmp_path, SHAPED, motor=SLUGGISH, load=HEAVY, stage=STAGES[by]) as s:
        before = await s.settings(*NAMES)
        best = (await look(s.device, 0, FastestMove.model_validate(wish(SIX, by, 12_800)))).required()
        candidate = best.setting(best.asked(best.space.now(), 6.0))
        document = s.document(wish(SIX, by, 12_800, candidate=candidate))
        record = await s.finish(s.begin(document))
        assert (record.state, record.improved, record.left) == ("done", False, []), record.message
        (trial,) = record.trials
        assert (trial.state, set(trial.setting)) == ("infeasible", RAMP)
        assert await s.settings(*NAMES) == before
        assert s.b.wire.state().axes[0].truth.rotor_fullsteps == pytest.approx(0.0, abs=1.0)


async def test_a_switch_is_gone_into_by_a_slow_trapezoid_whatever_shape_is_set(tmp_path: Path) -> None:
    """Below a knee beyond its speed it would go by A1 alone, into a switch that stops it at once."""
    async with studied(tmp_path, SHAPED, stage=STAGES["left switch"]) as s:
        wanted = FastestMove.model_validate(wish(SIX, "left switch", 12_800))
        ranges = (await look(s.device, 0, wanted)).required()
        written: list[dict[str, int]] = []

        async def apply(registers: Sequence[Held], what: str) -> None:
            written.append({each.name: each.value for each in registers})
            await Transaction(s.device, document_of(s.device, registers, what)).run()

        await s.passing(MoveTrials(s.device, 0, s.clock, wanted, ranges, 0, apply).begin())
        (slow,) = written
        units = ranges.space.registers({"speed": SLOW_FULLSTEPS * FULL_STEP})
        assert slow["VMAX"] == next(each.value for each in units if each.name == "VMAX")
        assert 0 < slow["V1"] < slow["VMAX"]
        assert slow["A1"] == slow["AMAX"] == slow["DMAX"] == slow["D1"]


@pytest.mark.parametrize(("side", "other"), [("left", "right"), ("right", "left")])
async def test_a_stop_of_a_tmc4361_that_is_off_is_missing(tmp_path: Path, side: str, other: str) -> None:
    """Its flag is that of an enabled stop alone: the study went to its end in search of an edge that nobody told."""
    by = f"{side} switch"
    async with bench_4361(replace(START_4361, counts_per_rev=0), stage=STAGES[by]) as b:
        s = Studied(b, StudyStore(tmp_path, aside=False))
        document = s.document(wish(BOWS, by, 12_800))
        await b.device.registers.write("REFERENCE_CONF", 0, fields={f"stop_{other}_en": 0})
        assert (await KINDS["fastest_move"].plan(b.device, 0, document)).missing == []
        await b.device.registers.write("REFERENCE_CONF", 0, fields={f"stop_{side}_en": 0})
        (missing,) = (await KINDS["fastest_move"].plan(b.device, 0, document)).missing
        assert f"the {side} switch is not read as the axis is set" in missing


def test_two_objectives_by_a_switch_are_refused() -> None:
    with pytest.raises(ValidationError, match="quiet is told by an encoder alone"):
        FastestMove.model_validate(wish(SIX, "left switch", 12_800, quiet=True))
