"""Lost steps seen by a switch, without an encoder: told as they are, mended, and none claimed where none are."""

from __future__ import annotations

import asyncio
from collections.abc import Coroutine
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from app.emulators.tmc5xxx.options import AxisChange, Tmc5xxxPatch
from app.studies.kinds import KINDS
from app.studies.moves import MeasuredMoves
from app.studies.switch_edge import LEAVING, SLOW_FULLSTEPS, SwitchEdge
from app.studies.until_switch import Side
from tests.studies.harness import START, Studied, studied

FULL_STEP = 256
MOVE: dict[str, Any] = {"kind": "fastest_move", "distance": 12_800, "repeats": 1, "seen_by": "left switch"}
HEAVY = {"inertia_kgm2": 5e-4, "friction_nm": 0.1}
NEAR = {"left_at_fullsteps": -21.3}
BLIND = replace(START, counts_per_rev=0)
NAMES = ("VMAX", "AMAX", "DMAX", "V1")


def rotor_fullsteps(s: Studied) -> float:
    """The ground truth, which no study sees."""
    return float(s.b.wire.state().axes[0].truth.rotor_fullsteps)


async def test_a_faster_ramp_is_found_and_proved_by_the_switch_alone(tmp_path: Path) -> None:
    async with studied(tmp_path, BLIND, load=HEAVY, stage=NEAR) as s:
        before = await s.settings(*NAMES)
        plan = await KINDS["fastest_move"].plan(s.device, 0, s.document(MOVE))
        assert plan.missing == []
        record = await s.finish(s.begin(s.document(MOVE, budget={"trials": 8})))
        assert (record.state, record.improved, record.left) == ("done", True, []), record.message
        assert await s.settings(*NAMES) == before
        assert any(trial.state == "infeasible" and trial.figures.lost_fullsteps for trial in record.trials)
        assert all(trial.figures.deviation_fullsteps is None for trial in record.trials)
        # whatever was lost on the way, the counter is right again
        assert (await s.b.state()).position == 0
        assert rotor_fullsteps(s) == pytest.approx(0.0, abs=1.0)


async def test_several_distances_are_each_looked_at_by_the_switch(tmp_path: Path) -> None:
    async with studied(tmp_path, BLIND, load=HEAVY, stage=NEAR) as s:
        study = {**MOVE, "distances": [6_400], "margin": 0.0}
        record = await s.finish(s.begin(s.document(study, budget={"trials": 8})))
        assert (record.state, record.left) == ("done", []), record.message
        assert any(trial.figures.lost_fullsteps for trial in record.trials)
        assert all(len(trial.figures.by_distance_s) == 2 for trial in record.trials if trial.state == "feasible")
        assert (await s.b.state()).position == 0
        assert rotor_fullsteps(s) == pytest.approx(0.0, abs=1.0)


@pytest.mark.parametrize("at_s", [0.4, 5.0, 14.0])
async def test_a_stop_leaves_the_setting_as_before_and_says_what_nothing_tells(tmp_path: Path, at_s: float) -> None:
    async with studied(tmp_path, BLIND, load=HEAVY, stage=NEAR) as s:
        before = await s.settings(*NAMES)
        run = s.begin(s.document(MOVE, budget={"trials": 8}))
        await s.clock.advance(at_s)
        assert run.running
        await s.device.stop_axes([0])
        record = await s.finish(run)
        assert (record.state, record.left) == ("aborted", [])
        assert await s.settings(*NAMES) == before
        assert "search the reference" in record.next


async def test_a_heavy_load_that_a_switch_stops_at_once_loses_no_step_by_that(tmp_path: Path) -> None:
    heavy = {"inertia_kgm2": 1.5e-3, "friction_nm": 0.004}
    async with studied(tmp_path, BLIND, load=heavy, stage={"left_at_fullsteps": -30.4}) as s:
        record = await s.finish(s.begin(s.document({**MOVE, "distance": 51_200}, budget={"trials": 3})))
        assert (record.state, record.left) == ("done", []), record.message
        assert rotor_fullsteps(s) == pytest.approx(0.0, abs=1.0)


async def test_one_that_was_cut_off_looks_for_the_edge_again_and_goes_on(tmp_path: Path) -> None:
    async with studied(tmp_path, BLIND, load=HEAVY, stage=NEAR) as s:
        document = s.document(MOVE, budget={"trials": 5})
        run = s.begin(document)
        while not run.record.trials or rotor_fullsteps(s) < 0:  # one that stands in its switch is not begun with
            await s.clock.advance(0.05)
        await s.device.stop_axes([0])
        record = await s.finish(run)
        assert record.state == "aborted"
        await s.passing(s.procedures.close())
        record.state = "running"
        record = await s.finish(s.begin(document, record))
        assert (record.state, record.left) == ("done", []), record.message
        apart = rotor_fullsteps(s) - (await s.b.state()).position / FULL_STEP
        assert apart - 4 * round(apart / 4) == pytest.approx(0.0, abs=1.0)


TORQUE: dict[str, Any] = {"kind": "torque_curve", "seen_by": "left switch", "travel_turns": 200.0, "speeds": 2}


@pytest.mark.parametrize("study", [MOVE, TORQUE], ids=lambda study: study["kind"])
async def test_one_that_was_killed_in_its_switch_leaves_it_slowly_and_goes_on(
    tmp_path: Path, study: dict[str, Any]
) -> None:
    """It was refused: its switch was pressed."""
    async with studied(tmp_path, replace(BLIND, stops=False), load=HEAVY, stage=NEAR) as s:
        before = await s.settings(*NAMES)
        document = s.document(study, budget={"trials": 5})
        told = await KINDS[document.study.kind].plan(s.device, 0, document)
        assert LEAVING in told.steps
        run = s.begin(document)
        while run.record.runs < 4 or not (await s.b.state()).switches.left:
            await s.clock.advance(0.05)
            assert run.running, run.record.message
        record = await s.killed(run)
        state = await s.b.state()
        assert state.switches.left
        runs, record.state = record.runs, "running"
        run, fastest, out_of_it = s.begin(document, record), 0.0, False
        while not out_of_it:
            await s.clock.advance(0.01)
            assert run.running, run.record.message
            state = await s.b.state()
            assert state.velocity_pps >= 0, "never farther into it"
            fastest, out_of_it = max(fastest, state.velocity_pps), not state.switches.left
        assert 0 < fastest <= 1.01 * SLOW_FULLSTEPS * FULL_STEP
        assert "out of the left switch" in record.message
        await s.until(run, lambda record: record.runs > runs + 1)
        await s.device.stop_axes([0])
        record = await s.finish(run)
        assert (record.state, record.left) == ("aborted", []), record.message
        assert await s.settings(*NAMES) == before
        apart = rotor_fullsteps(s) - (await s.b.state()).position / FULL_STEP
        assert apart - 4 * round(apart / 4) == pytest.approx(0.0, abs=1.0)


async def test_one_that_does_not_get_out_of_its_switch_within_a_turn_ends(tmp_path: Path) -> None:
    """A rotor that has not turned, or another switch: nobody goes on looking for the way out."""
    async with studied(tmp_path, replace(BLIND, stops=False), load=HEAVY, stage=NEAR) as s:
        document = s.document(MOVE, budget={"trials": 5})
        run = s.begin(document)
        while run.record.runs < 1 or not (await s.b.state()).switches.left:
            await s.clock.advance(0.05)
        record = await s.killed(run)
        record.state = "running"
        s.b.patch(Tmc5xxxPatch(axes=[AxisChange(axis=0, blocked=True)]))
        at = (await s.b.state()).position
        record = await s.finish(s.begin(document, record))
        assert (record.state, record.left) == ("failed", [])
        assert "the left switch is pressed yet, a turn away" in record.message
        assert (await s.b.state()).position == at + 200 * FULL_STEP


async def test_a_new_study_does_not_begin_in_its_switch(tmp_path: Path) -> None:
    async with studied(tmp_path, BLIND, stage={"left_at_fullsteps": 3.0}) as s:
        record = await s.finish(s.begin(s.document(MOVE)))
        assert (record.state, (await s.b.state()).position) == ("failed", 0)
        assert "the left switch is pressed" in record.message


async def looked_for(s: Studied, edge: SwitchEdge) -> float:
    found: list[float] = []

    async def look() -> None:
        found.append(await edge.lost())

    await s.passing(look())
    return found[0]


async def as_it_is() -> None:
    """The ramp of the start is slow enough for these."""


async def clamped_in(s: Studied, move: Coroutine[Any, Any, Any], from_s: float, for_s: float) -> None:
    """While a move is made its shaft is clamped for a while: the counter goes on, the rotor does not."""
    going = asyncio.create_task(move)
    for pause_s, on in ((from_s, True), (for_s, False)):
        await s.clock.advance(pause_s)
        s.b.patch(Tmc5xxxPatch(axes=[AxisChange(axis=0, blocked=on)]))
    while not going.done():
        await s.clock.advance(0.05)
    await going


@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize("stops", [True, False])
@pytest.mark.parametrize(
    ("outwards", "from_s", "for_s"),
    [(True, 0.0, 3.0), (True, 0.3, 0.01), (True, 0.2, 0.1), (True, 0.35, 0.4), (False, 0.0, 3.0), (False, 0.25, 0.12)],
)
async def test_what_a_clamped_shaft_loses_is_told_and_mended(
    tmp_path: Path, side: Side, stops: bool, outwards: bool, from_s: float, for_s: float
) -> None:
    out = 1 if side == "left" else -1
    far = out * 60 * FULL_STEP
    stage = {"left_at_fullsteps": -9.4} if side == "left" else {"right_at_fullsteps": 9.4}
    async with studied(tmp_path, replace(BLIND, stops=stops), stage=stage) as s:
        moves = MeasuredMoves(s.device, 0, s.clock, FULL_STEP, 1.0, has_encoder=False)
        edge = SwitchEdge(s.device, 0, s.clock, side, moves, FULL_STEP, far, as_it_is)
        await s.passing(edge.learn(-out * 30 * FULL_STEP))
        assert await looked_for(s, edge) == 0
        for target in (far, 0):
            if (target == far) == outwards:
                await clamped_in(s, moves.measured(target), from_s, for_s)
                break
            await s.passing(moves.go(target))
        told = await looked_for(s, edge)
        truth = s.b.wire.state().axes[0].truth
        assert told == abs(truth.lost_fullsteps)
        assert (for_s > 1) <= (told > 0)
        position = (await s.b.state()).position
        assert position / FULL_STEP == pytest.approx(truth.rotor_fullsteps, abs=1.0)
        assert await looked_for(s, edge) == 0
