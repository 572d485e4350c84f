"""The fastest move on plants drawn from a seed that it does not know; the judge reads the ground truth afterwards.

It is compared with the best of a grid of speeds and accelerations on the same plant, in order of the time that its ramp
takes: the first that holds with the study's margin as often as the study's own proof asks, after three tries that rule
out most. Time is the emulator's own, so a busy machine changes nothing but how long this takes.
"""

from __future__ import annotations

import asyncio
import math
import random
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from app.devices.core.capabilities import PositionFromEncoder
from app.procedures.procedure import Failed
from app.profiles.apply import Transaction
from app.studies.document import FastestMove
from app.studies.fastest_move.ranges import look
from app.studies.moves import MeasuredMoves
from app.studies.ramp_settings import ACCELERATION, SPEED, document_of, least_time_s
from tests.bench.collected import at_least, collected
from tests.bench.table import Row
from tests.plants.axes import drawn
from tests.studies.harness import START, STEP_S, Studied, studied

MOVE: dict[str, Any] = {
    "kind": "fastest_move",
    "distance": 51_200,
    "margin": 0.1,
    "velocity_max_pps": 1e6,
    "acceleration_max_pps2": 7.6e6,
}
"""As far as the chip goes: where it ends by itself there is no edge to find."""
FULL = replace(START, irun=31, ihold=16)
"""At the rated current while it moves."""
BUDGET: dict[str, Any] = {"trials": 25, "time_s": 3600.0}
GRID = 16
THRICE = (0, 341, 683)
PROOF = tuple(random.Random(0).sample(range(1024), 10))
"""Places of the electrical period that moves with a setting of the grid begin at: of many settings that hold three of
them the fastest does so by luck, too."""
WITHIN, SHARE, LOSS_MAX = 1.1, 0.95, 0.01
NAMES = ("VMAX", "AMAX", "DMAX", "V1")
BLIND = 3200
"""The first seed of those without an encoder: some below were looked at while the study was made."""


async def _set(s: Studied, values: dict[str, float], space: Any) -> None:
    await Transaction(s.device, document_of(s.device, space.registers(values), "grid")).run()


async def _holds(s: Studied, moves: MeasuredMoves, distance: int, places: Sequence[int] = THRICE) -> float | None:
    """The mean time there and back; None where a step was lost."""
    times: list[float] = []
    for jitter in places:
        try:
            await moves.go(jitter)
            for target in (jitter + distance, jitter):
                found = await moves.measured(target)
                if found.lost_fullsteps or found.time_s is None:
                    await s.device.need(PositionFromEncoder).position_from_encoder(0)
                    return None
                times.append(found.time_s)
        except Failed:
            await s.device.need(PositionFromEncoder).position_from_encoder(0)
            return None
    return float(np.mean(times))


async def _advanced(s: Studied, work: Any) -> Any:
    task = asyncio.ensure_future(work)
    while not task.done():
        await s.clock.advance(STEP_S)
    return await task


async def _best_of_grid(seed: int, folder: Path) -> tuple[float, float]:
    """The time of the fastest setting of the grid that holds, and that of its ramp alone [s]."""
    async with studied(folder, FULL, **drawn(seed)) as s:
        wanted = FastestMove.model_validate(MOVE)
        ranges = (await look(s.device, 0, wanted)).required()
        space, before = ranges.space, ranges.space.now()
        axes = [np.geomspace(each.low, each.high, GRID) for each in ranges.dimensions]
        grid = sorted(
            ({SPEED: float(v), ACCELERATION: float(a)} for v in axes[0] for a in axes[1]),
            key=lambda one: least_time_s(wanted.distance, one[SPEED], one[ACCELERATION]),
        )
        moves = MeasuredMoves(s.device, 0, s.clock, ranges.microsteps, wanted.band_fullsteps)

        async def search() -> tuple[float, float]:
            for setting in grid:
                await _set(s, {name: value * (1 + wanted.margin) for name, value in setting.items()}, space)
                if await _holds(s, moves, wanted.distance, (*THRICE, *PROOF)) is not None:
                    await _set(s, setting, space)
                    time_s = await _holds(s, moves, wanted.distance)
                    if time_s is not None:
                        return time_s, least_time_s(wanted.distance, setting[SPEED], setting[ACCELERATION])
                await _set(s, before, space)
                await moves.go(0)
            raise AssertionError("nothing of the grid holds")

        time_s, ramp_s = await _advanced(s, search())
        return float(time_s), float(ramp_s)


@dataclass(frozen=True)
class Judged:
    """A study on a plant. ratio : the time of what it takes for the best, over the best of the grid; ramp : the same of
    their ramps alone."""

    ratio: float
    says: str
    as_before: bool
    ramp: float = math.nan


async def judged(seed: int, folder: Path) -> Judged:
    """A study of the plant of that seed, and the best of its grid."""
    async with studied(folder / "study", FULL, **drawn(seed)) as s:
        before = await s.settings(*NAMES)
        record = await s.finish(s.begin(s.document(MOVE, budget=BUDGET, seed=seed)), 8000)
        as_before = await s.settings(*NAMES) == before
    best = record.trial(record.best)
    time_s = math.inf if best is None or not record.improved else best.figures.time_s or math.inf
    grid_s, _ = await _best_of_grid(seed, folder / "grid")
    return Judged(time_s / grid_s, record.verdict or record.message, as_before)


async def by_switch(seed: int, folder: Path) -> Judged:
    """The same without an encoder, by a switch near which the moves begin; its time is that which the encoder sees."""
    stage = {"left_at_fullsteps": -random.Random(seed).uniform(5, 60)}
    async with studied(folder / "study", replace(FULL, counts_per_rev=0), **{**drawn(seed), "stage": stage}) as s:
        before = await s.settings(*NAMES)
        study = {**MOVE, "seen_by": "left switch"}
        record = await s.finish(s.begin(s.document(study, budget=BUDGET, seed=seed)), 20_000)
        as_before = await s.settings(*NAMES) == before
    best, says = record.trial(record.best), record.verdict or record.message
    time_s: float | None = None
    ramp_s = math.inf
    if best is not None and record.improved:
        ramp_s = best.expected_s or math.inf
        async with studied(folder / "seen", FULL, **drawn(seed)) as s:
            wanted = FastestMove.model_validate(MOVE)
            ranges = (await look(s.device, 0, wanted)).required()
            moves = MeasuredMoves(s.device, 0, s.clock, ranges.microsteps, wanted.band_fullsteps)
            for target in (ranges.period, 0):  # a rotor that stood beside its field falls into step
                await _advanced(s, moves.go(target))
            await _advanced(s, _set(s, best.setting, ranges.space))
            time_s = await _advanced(s, _holds(s, moves, wanted.distance))
    grid_s, grid_ramp_s = await _best_of_grid(seed, folder / "grid")
    return Judged((math.inf if time_s is None else time_s) / grid_s, says, as_before, ramp_s / grid_ramp_s)


@dataclass(frozen=True)
class Held:
    """Moves there and back of the same plant, after the study: so many, and how many lost a step. runs : 0 where the
    study chose nothing; shown : the loss rate that it showed"""

    runs: int
    lost: int
    shown: float
    says: str


async def held(seed: int, folder: Path, *, runs: int) -> Held:
    """What a study with a bound of the loss rate chooses, set, and moved with at random places of the period."""
    async with studied(folder, FULL, **drawn(seed)) as s:
        study = {**MOVE, "loss_rate_max": LOSS_MAX}
        record = await s.finish(s.begin(s.document(study, budget={**BUDGET, "time_s": 20_000.0}, seed=seed)), 20_000)
        best, says = record.trial(record.best), record.verdict or record.message
        if best is None or record.evidence is None or not record.improved:
            return Held(0, 0, 1.0, says)
        wanted, chance = FastestMove.model_validate(study), random.Random(seed)
        ranges = (await look(s.device, 0, wanted)).required()
        moves = MeasuredMoves(s.device, 0, s.clock, ranges.microsteps, wanted.band_fullsteps)

        async def again() -> int:
            lost = 0
            await _set(s, best.setting, ranges.space)
            for _ in range(runs):
                begin = chance.randrange(ranges.period)
                await moves.go(begin)
                figures = [await moves.measured(target) for target in (begin + wanted.distance, begin)]
                if any(each.lost_fullsteps for each in figures):
                    lost += 1
                    await s.device.need(PositionFromEncoder).position_from_encoder(0)
            return lost

        return Held(runs, await _advanced(s, again()), record.evidence.loss_rate_max, says)


async def claimed(seed: int, folder: Path) -> tuple[bool, str]:
    """Whether an improvement is claimed where the space ends at the present setting."""
    margin = 1.1
    study = {**MOVE, "velocity_max_pps": 50_001.0 * margin, "acceleration_max_pps2": 200_010.0 * margin}
    async with studied(folder, FULL, **drawn(seed)) as s:
        budget = {**BUDGET, "trials": 6}
        record = await s.finish(s.begin(s.document(study, budget=budget, seed=seed)), 8000)
        return bool(record.improved), record.verdict or record.message


async def _aborted(seed: int, folder: Path) -> bool:
    """Whether the axis is as before, or what is left is told, after a stop at a random moment."""
    rng = random.Random(seed)
    async with studied(folder, FULL, **drawn(seed)) as s:
        before = await s.settings(*NAMES)
        run = s.begin(s.document(MOVE, budget=BUDGET, seed=seed))
        await s.clock.advance(rng.uniform(0.05, 40))
        await s.device.stop_axes([0], rng.choice(("ramp", "immediate")))
        record = await s.finish(run, 60)
        return await s.settings(*NAMES) == before or bool(record.left)


def measure(quick: bool) -> Sequence[Row]:
    """Four rows; quick: a few plants of each."""
    plants, aborts, holding, runs = (3, 6, 2, 100) if quick else (100, 60, 20, 1000)
    found = collected("fastest move", judged, range(plants), share=0.4)
    blind = collected("fastest move by a switch", by_switch, range(BLIND, BLIND + plants), share=0.2)
    again = collected(
        f"fastest move, {runs} more", partial(held, runs=runs), range(plants, plants + holding), share=0.3
    )
    stops = collected("fastest move aborts", _aborted, range(2000, 2000 + aborts), share=0.1).values()
    chosen = {seed: one for seed, one in again.items() if one.runs}
    lossy = {seed: one for seed, one in chosen.items() if one.lost > LOSS_MAX * one.runs}
    return [
        _row("fastest move", found),
        _row_by_switch(blind),
        Row(
            what=f"loss rate < {100 * LOSS_MAX:g} % asked for, on {len(again)} blind plants, {len(chosen)} with a "
            f"faster move: {runs} more moves of each",
            measured=f"{len(chosen) - len(lossy)} hold it; {sum(one.lost for one in chosen.values())} moves lost steps",
            peer=f"{len(chosen)}",
            ratio=1 - len(lossy) / max(1, len(chosen)),
            required=f">= {SHARE:g}, each shown by the study",
            ok=bool(chosen)
            and len(lossy) <= (1 - SHARE) * len(chosen)
            and all(one.shown <= LOSS_MAX for one in chosen.values()),
            notes=tuple(f"plant {seed}: {one.lost} of {one.runs} lost; {one.says}" for seed, one in lossy.items()),
        ),
        Row(
            what=f"studies stopped at {len(stops)} random moments",
            measured=f"{sum(stops)} as before, or told what is left",
            peer=f"{len(stops)}",
            ratio=sum(stops) / len(stops),
            required="all",
            ok=all(stops),
        ),
    ]


def _row(what: str, found: Mapping[int, Judged]) -> Row:
    ratios = [one.ratio for one in found.values()]
    within = sum(ratio <= WITHIN for ratio in ratios)
    return Row(
        what=f"{what} on {len(found)} blind plants, against the best of {GRID}x{GRID} settings",
        measured=f"{at_least(within, len(found))}, within {WITHIN:g} times; "
        f"median {np.median(ratios):.3f}, worst {max(ratios):.3f}",
        peer=f"{len(found)}",
        ratio=within / len(found),
        required=f">= {SHARE:g}, every axis as before",
        ok=within >= SHARE * len(found) and all(one.as_before for one in found.values()),
        notes=tuple(
            f"plant {seed}: {one.ratio:.2f} times the best of the grid; {one.says}"
            for seed, one in found.items()
            if one.ratio > WITHIN or not one.as_before
        ),
    )


def _row_by_switch(found: Mapping[int, Judged]) -> Row:
    """A switch sees lost steps and when a ramp is over, not how long the shaft rings: it is held to its ramps."""
    ramps, ratios = [one.ramp for one in found.values()], [one.ratio for one in found.values()]
    within = sum(ramp <= WITHIN for ramp in ramps)
    settled = sum(ratio <= WITHIN for ratio in ratios)
    return Row(
        what=f"fastest move without an encoder, lost steps seen by a switch, on {len(found)} blind plants: its ramp, "
        f"against that of the best of {GRID}x{GRID} settings",
        measured=f"{at_least(within, len(found))}, within {WITHIN:g} times; median {np.median(ramps):.3f}, "
        f"worst {max(ramps):.3f}",
        peer=f"until the shaft is at rest, as an encoder has it: {settled} within {WITHIN:g} times, "
        f"median {np.median(ratios):.3f}, worst {max(ratios):.3f}",
        ratio=within / len(found),
        required=f">= {SHARE:g}, every axis as before, no step lost",
        ok=within >= SHARE * len(found) and all(one.as_before and math.isfinite(one.ratio) for one in found.values()),
        notes=tuple(
            f"plant {seed}: {one.ramp:.2f} times the ramp of the best of the grid; {one.says}"
            for seed, one in found.items()
            if not one.ramp <= WITHIN or not one.as_before
        ),
    )
