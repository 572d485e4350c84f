"""The position loop of an emulated TMC4361: its margins and steps against what was asked, and what is left."""

from __future__ import annotations

import math
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from app.calc.motors.position_loop import Gains, Plant, gains_for, margins, worst
from app.studies.closed_loop.grade import worst_mark
from app.studies.closed_loop.plan import LOADED
from app.studies.document import ClosedLoop
from app.studies.kinds import KINDS
from app.studies.pieces import FILE
from app.studies.ramp_settings import held_of, value_now
from app.studies.record import Held
from app.studies.report import html_of
from app.studies.store import StudyStore
from tests.devices.tmc4361.harness import START, bench
from tests.plants.loops import drawn
from tests.studies.harness import Studied, studied

STUDY: dict[str, Any] = {"kind": "closed_loop", "hops": 6}
NAMES = ("PID_P", "PID_I", "PID_D", "PID_DV_CLIP", "ENC_IN_CONF", "VMAX", "RAMPMODE")
TORQUE, INERTIA, DAMPING = 0.45, 3e-5, 0.1
W = math.sqrt(50 * TORQUE / INERTIA)
MOTOR = {
    "rotor_teeth": 50,
    "holding_torque_nm": TORQUE,
    "rated_current_a": 2.1 / math.sqrt(2),
    "rotor_inertia_kgm2": INERTIA,
    "viscous_nms": 2 * DAMPING * INERTIA * W,
    "friction_nm": 0.005,
    "detent_torque_nm": 0.01,
}


@asynccontextmanager
async def with_loop(tmp_path: Path) -> AsyncIterator[Studied]:
    async with bench(replace(START, stops=False), motor=MOTOR) as b:
        yield Studied(b, StudyStore(tmp_path, aside=False))


async def settings(s: Studied, *names: str) -> list[int | None]:
    """What registers hold that can be written alone, too."""
    held = await held_of(s.device)
    return [value_now(s.device, held, Held(name=name, axis=0, value=0)) for name in names]


def test_the_worst_of_the_plants_keeps_the_margins_that_are_asked_for() -> None:
    plants = [Plant(600.0, damping, 2e-4) for damping in (0.08, 0.1, 0.12)]
    gains = gains_for(plants, 2.0, 60.0)
    found = worst(gains, plants)
    assert found.gain == pytest.approx(2.0, rel=0.01)
    assert found.phase_deg == pytest.approx(60.0, abs=0.5)
    assert margins(gains, plants[0]).gain < margins(gains, plants[2]).gain
    # With P alone far below the resonance the phase margin is a right angle, less what resonance and delay take.
    slow = margins(Gains(10.0, 0.0), Plant(600.0, 0.1, 0.0))
    assert slow.phase_deg == pytest.approx(90.0, abs=1.0)
    assert slow.bandwidth_hz == pytest.approx(10 / (2 * math.pi), rel=0.01)
    assert slow.gain == pytest.approx(2 * 0.1 * 600 / 10, rel=0.02)


async def test_gains_do_as_asked_and_all_is_as_before(tmp_path: Path) -> None:
    async with with_loop(tmp_path) as s:
        before = await settings(s, *NAMES)
        plan = await KINDS["closed_loop"].plan(s.device, 0, s.document(STUDY))
        assert plan.missing == []
        record = await s.finish(s.begin(s.document(STUDY)))
        assert record.state == "done", record.message
        assert record.improved, record.verdict
        found = record.loop
        assert found is not None
        assert found.resonance_hz.value == pytest.approx(W / (2 * math.pi), rel=0.02)
        true = margins(Gains(found.proportional_per_s, found.integral_per_s2), Plant(W, DAMPING, 1e-4))
        assert true.gain == pytest.approx(2.0, rel=0.1)
        assert true.phase_deg == pytest.approx(60.0, rel=0.1)
        assert found.overshoot is not None
        assert found.overshoot.value == pytest.approx(found.expected_overshoot, rel=0.1)
        assert found.captures == record.runs <= plan.moves_max <= 25
        # A ramp takes torque: the loop holds the shaft near it, and every thing that is known has its mark.
        assert found.load is not None
        assert found.load.acceleration_pps2 == pytest.approx(START.amax, rel=0.01)
        assert (found.load.lost_fullsteps, len(found.grades)) == (0, 5)
        assert 0 < found.load.deviation_fullsteps < 0.5
        assert found.grade == worst_mark(found.grades)
        assert await settings(s, *NAMES) == before
        assert (await s.b.state()).position == 0
        report = html_of(record)
        assert "Bode" in report
        assert "Nichols" in report
        assert f"How good: {found.grade}" in report


async def test_a_loop_that_settles_as_soon_stays_as_it_is(tmp_path: Path) -> None:
    async with with_loop(tmp_path) as s:
        first = await s.finish(s.begin(s.document({**STUDY, "keep": True})))
        assert first.improved, first.verdict
        trial = first.trial(first.best)
        assert trial is not None
        assert await settings(s, "PID_P") == [next(each.value for each in trial.registers if each.name == "PID_P")]
        kept = await settings(s, *NAMES)
        again = await s.finish(s.begin(s.document(STUDY)))
        assert again.state == "done", again.message
        assert again.loop is not None
        assert again.loop.effect is not None
        assert again.improved is False, again.verdict
        assert await settings(s, *NAMES) == kept
        # A loop that is ten times slower is beaten.
        for name, less in (("PID_P", 10), ("PID_I", 100)):
            value = next(each.value for each in trial.registers if each.name == name)
            await s.device.registers.write(name, 0, value // less)
        better = await s.finish(s.begin(s.document(STUDY)))
        assert better.improved, better.verdict
        assert better.loop is not None
        assert better.loop.captures <= 25


async def test_it_goes_on_with_the_steps_that_are_left(tmp_path: Path) -> None:
    """Of those that show a loop, then of the pairs that compare it with the one before."""
    async with with_loop(tmp_path) as s:
        run = s.begin(s.document({**STUDY, "keep": True}))
        await s.until(run, lambda record: record.message.startswith("steps 3 and 4"))
        await s.clock.advance(0.5)
        cut = await s.killed(run)
        runs, loop = cut.runs, cut.loop
        assert loop is not None
        run = s.begin(cut.document, cut)
        first = await s.finish(run)
        assert (first.state, first.improved, first.left) == ("done", True, []), first.message or first.verdict
        assert first.loop is not None
        assert first.loop.ringing == loop.ringing
        assert first.loop.overshoot is not None
        assert first.runs == runs + 2 + LOADED
        run = s.begin(s.document(STUDY))
        await s.until(run, lambda record: record.message.startswith("pair 3 "))
        await s.clock.advance(0.5)
        cut = await s.killed(run)
        runs = cut.runs
        again = await s.finish(s.begin(cut.document, cut))
        assert (again.state, again.improved, again.left) == ("done", False, []), again.message or again.verdict
        assert again.loop is not None
        assert again.loop.effect is not None
        assert again.loop.effect.pairs == again.document.wanted(ClosedLoop).pairs
        assert again.runs == runs + 2 * (again.loop.effect.pairs - 2)
        assert not (s.store.folder(again.id) / FILE).exists()


async def test_a_study_begun_at_another_place_of_the_detent_torque_agrees(tmp_path: Path) -> None:
    """Of this plant one study told 24.41 % of overshoot, another 23.83 %, each with no doubt at all: steps that end at
    one place of a full step are one and the same."""
    plant = drawn(3001)
    counts = 4 * plant.options["encoder"]["lines"]
    found = []
    for seed, place in ((1, -11.18), (4, -43.40)):
        start = replace(START, stops=False, counts_per_rev=counts)
        async with bench(start, **{**plant.options, "start_fullsteps": place, "seed": seed}) as b:
            s = Studied(b, StudyStore(tmp_path / str(seed), aside=False))
            record = await s.finish(s.begin(s.document({**STUDY, "hops": 10})))
            assert record.loop is not None, record.message
            assert record.loop.overshoot is not None
            found.append(record.loop.overshoot.interval)
    one, other = found
    assert one.low <= other.high
    assert other.low <= one.high
    assert min(each.high - each.low for each in found) > 0.001


async def test_what_is_missing_is_told_before_anything_moves(tmp_path: Path) -> None:
    async with studied(tmp_path) as other:
        plan = await KINDS["closed_loop"].plan(other.device, 0, other.document(STUDY))
        assert any("no study sets a position loop" in one for one in plan.missing)
    async with with_loop(tmp_path) as s:
        await s.device.registers.write("ENC_IN_CONF", 0, None, {"regulation_modus": 1})
        plan = await KINDS["closed_loop"].plan(s.device, 0, s.document(STUDY))
        assert any("another regulation" in one for one in plan.missing)
