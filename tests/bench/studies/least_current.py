"""The least current on plants drawn from a seed that it does not know, tried with a warm motor and a sagging supply."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from app.studies.record import StudyRecord
from tests.bench.collected import at_least, collected
from tests.bench.table import Row
from tests.plants.axes import drawn
from tests.studies.harness import START, Studied, studied

IRUN = 31
FULL = replace(START, vmax=200_000, amax=800_000, irun=IRUN, ihold=16)
STUDY: dict[str, Any] = {
    "kind": "least_current",
    "distance": 51_200,
    "margin": 0.25,
    "loss_rate_max": 0.05,
    "coolstep": False,
}
BUDGET: dict[str, Any] = {"time_s": 3600.0}
NAMES = ("IHOLD_IRUN", "VMAX", "AMAX", "DMAX")
WARM_TORQUE, WARM_RESISTANCE, SAG = 0.95, 1.24, 0.9
"""A motor at 80 deg C: its magnets a little weaker (0.1 % a kelvin at most), its copper as tables say; the supply."""
CYCLES = 100
SHARE, FIRST = 0.95, 0


@dataclass(frozen=True)
class Judged:
    """A study on a plant; lost : of the held-out cycles of the same plant, warm, at the chosen current. Of one that
    says that the present current loses steps: of cycles at that, cold.
    """

    record: StudyRecord
    as_before: bool
    lost: int


def _warm(options: dict[str, Any]) -> dict[str, Any]:
    motor = options["motor"]
    return {
        **options,
        "motor": {
            **motor,
            "holding_torque_nm": motor["holding_torque_nm"] * WARM_TORQUE,
            "resistance_ohm": motor["resistance_ohm"] * WARM_RESISTANCE,
        },
        "supply_v": options["supply_v"] * SAG,
        "seed": options["seed"] + 1,
    }


async def _held_out(s: Studied, cycles: int, rng: random.Random) -> int:
    """How many of so many cycles lose a step; it ends with the first."""

    async def go(target: int) -> int:
        await s.device.motion.move(0, target)
        state = await s.b.state()
        while state.moving or not state.position_reached:
            await s.clock.advance(0.05)
            state = await s.b.state()
        await s.clock.advance(0.2)
        state = await s.b.state()
        return int(state.encoder_position or 0) - int(state.position)

    # A rotor that stood beside its field when it was switched on falls into step with the first move.
    in_step = await go(1024)
    for _ in range(cycles):
        begin = rng.randrange(1024)
        for target in (begin, begin + STUDY["distance"], begin):
            if abs(await go(target) - in_step) > 2 * 256:
                return 1
    return 0


async def judged(seed: int, folder: Path, cycles: int, irun: int = IRUN) -> Judged:
    options = drawn(seed)
    async with studied(folder, replace(FULL, irun=irun), **options) as s:
        before = await s.settings(*NAMES)
        record = await s.finish(s.begin(s.document(STUDY, budget=BUDGET, seed=seed)), 4000)
        as_before = await s.settings(*NAMES) == before
    if record.state == "failed" and cycles:
        async with studied(folder / "cold", replace(FULL, irun=irun), **options) as s:
            return Judged(record, as_before, await _held_out(s, cycles, random.Random(seed)))
    found = record.least_current
    if not record.improved or found is None or found.chosen is None or not cycles:
        return Judged(record, as_before, 0)
    start = replace(FULL, irun=found.chosen, ihold=min(found.chosen, 16))
    async with studied(folder / "warm", start, **_warm(options)) as s:
        return Judged(record, as_before, await _held_out(s, cycles, random.Random(seed)))


async def claimed(seed: int, folder: Path) -> tuple[bool, str] | None:
    """Whether less current is claimed of a plant that is set to the least already; None where none was found."""
    first = (await judged(seed, folder / "first", 0)).record.least_current
    if first is None or first.chosen is None:
        return None
    record = (await judged(seed, folder / "again", 0, irun=first.chosen)).record
    return bool(record.improved), record.verdict or record.message


def measure(quick: bool) -> Sequence[Row]:
    """One row; quick: a few plants."""
    plants, cycles = (4, 20) if quick else (100, CYCLES)
    row = partial(judged, cycles=cycles)
    found = collected(f"least current, {cycles} cycles", row, range(FIRST, FIRST + plants)).values()
    better = [one for one in found if one.record.improved]
    limited = [one for one in found if one.record.least_current and one.record.least_current.limited_by_supply]
    good = [one for one in better if not one.lost]
    shares = [one.record.least_current.heat_share or 1.0 for one in better if one.record.least_current is not None]
    refused = [one for one in found if one.record.state == "failed" and one.lost]
    odd = [one for one in found if (one.record.state != "done" and one not in refused) or not one.as_before]
    return [
        Row(
            what=f"least current on {len(found)} blind plants, {len(better)} with less than before, {len(limited)} "
            f"limited by their supply, {len(refused)} that do lose steps as they are; {cycles} more cycles, warm and "
            "with 10 % less supply",
            measured=f"{at_least(len(good), len(better))} lose no step; "
            f"heat {100 * np.median(shares):.0f} % of before, median",
            peer=f"{len(better)}",
            ratio=len(good) / max(1, len(better)),
            required=f">= {SHARE:g}, every axis as before",
            ok=len(good) >= SHARE * len(better) and not odd,
            notes=tuple(one.record.verdict or one.record.message for one in (*odd, *(b for b in better if b.lost))),
        ),
    ]
