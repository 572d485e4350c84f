"""The fastest move on plants drawn from a seed that it does not know; the judge reads the ground truth afterwards.

It is compared with the best of a grid of speeds and accelerations on the same plant, each tried three
times with the study's margin: the first that holds, in order of the time that its ramp takes. Time is the emulator's
own, so a busy machine changes nothing but how long this takes.
"""

from __future__ import annotations

import asyncio
import random
import tempfile
from collections.abc import Sequence
from dataclasses import replace
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
HOLDS_THRICE = (0, 341, 683)
"""Places of the electrical period that a setting of the grid begins at."""
WITHIN, SHARE = 1.1, 0.95
NAMES = ("VMAX", "AMAX", "DMAX", "V1")


async def _set(s: Studied, values: dict[str, float], space: Any) -> None:
    await Transaction(s.device, document_of(s.device, space.registers(values), "grid")).run()


async def _holds(s: Studied, moves: MeasuredMoves, distance: int) -> float | None:
    """The mean time there and back; None where a step was lost."""
    times: list[float] = []
    for jitter in HOLDS_THRICE:
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


async def _best_of_grid(seed: int, folder: Path) -> float:
    """The time of the fastest setting of the grid that holds."""
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

        async def search() -> float:
            for setting in grid:
                await _set(s, {name: value * (1 + wanted.margin) for name, value in setting.items()}, space)
                if await _holds(s, moves, wanted.distance) is not None:
                    await _set(s, setting, space)
                    time_s = await _holds(s, moves, wanted.distance)
                    if time_s is not None:
                        return time_s
                await _set(s, before, space)
                await moves.go(0)
            raise AssertionError("nothing of the grid holds")

        return float(await _advanced(s, search()))


async def _found(seed: int, folder: Path) -> tuple[float | None, str, bool]:
    """The time of what the study takes for the best, what it says, and whether the axis is as before."""
    async with studied(folder, FULL, **drawn(seed)) as s:
        before = await s.settings(*NAMES)
        record = await s.finish(s.begin(s.document(MOVE, budget=BUDGET, seed=seed)), 8000)
        best = record.trial(record.best)
        time_s = None if best is None or not record.improved else best.figures.time_s
        return time_s, record.verdict or record.message, await s.settings(*NAMES) == before


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
    """Two rows; quick: a few plants of each."""
    plants, aborts = (3, 6) if quick else (40, 60)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)

        async def all_of() -> tuple[list[float], list[str], list[bool], int]:
            ratios, said, put_back = [], [], 0
            for seed in range(plants):
                found, words, as_before = await _found(seed, folder / f"f{seed}")
                best = await _best_of_grid(seed, folder / f"g{seed}")
                put_back += as_before
                ratios.append(float("inf") if found is None else found / best)
                if ratios[-1] > WITHIN:
                    said.append(f"plant {seed}: {ratios[-1]:.2f} times the best of the grid; {words}")
            stops = [await _aborted(2000 + seed, folder / f"a{seed}") for seed in range(aborts)]
            return ratios, said, stops, put_back

        ratios, said, stops, put_back = asyncio.run(all_of())
    within = sum(ratio <= WITHIN for ratio in ratios)
    return [
        Row(
            what=f"fastest move on {plants} blind plants, against the best of {GRID}x{GRID} settings",
            measured=f"{within} within {WITHIN:g} times; median {np.median(ratios):.3f}, worst {max(ratios):.3f}",
            peer=f"{plants}",
            ratio=within / plants,
            required=f">= {SHARE:g}, every axis as before",
            ok=within / plants >= SHARE and put_back == plants,
            notes=tuple(said),
        ),
        Row(
            what=f"studies stopped at {aborts} random moments",
            measured=f"{sum(stops)} as before, or told what is left",
            peer=f"{aborts}",
            ratio=sum(stops) / aborts,
            required="all",
            ok=all(stops),
        ),
    ]
