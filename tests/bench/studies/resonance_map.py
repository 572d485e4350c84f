"""Resonances and their orders on plants drawn from a seed that the study does not know."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from app.studies.record import StudyRecord
from tests.bench.collected import at_least, collected
from tests.bench.table import Row
from tests.plants.machines import TEETH, Machine, drawn
from tests.studies.harness import START, studied

NAMES = ("VMAX", "AMAX", "DMAX", "V1", "IHOLD_IRUN", "GCONF")
STUDY: dict[str, Any] = {"kind": "resonance_map", "repeats": 1, "current_shares": [], "other_chopper": False}
WITHIN, SHARE, COVERED = 0.02, 0.95, 0.90
FIRST = 200
"""Seeds below it were looked at while the study was written."""
DRIVEN = (1, 2, 4)
"""Orders that a motor may make; what else is named is what a large swing of these makes beside them."""


@dataclass(frozen=True)
class Judged:
    """What a study told of a plant, of which orders `driven` are true, and `may` be so besides: detent torque stiffens
    and softens the rotor's spring four times a period, and where its share is beyond the damping (Mathieu), that alone
    can make it swing at order 2. as_before : its axis is set as it was"""

    machine: Machine
    driven: frozenset[int]
    may: frozenset[int]
    record: StudyRecord
    as_before: bool

    @property
    def named(self) -> dict[int, float]:
        """Speed of each order of a motor that was named [turns/s]."""
        found = self.record.resonances
        return (
            {} if found is None else {one.order: one.speed_rps.value for one in found.crossings if one.order in DRIVEN}
        )

    @property
    def orders_right(self) -> bool:
        """Whether all orders that are there, and no other, have a name."""
        return self.driven <= set(self.named) <= self.driven | self.may

    @property
    def off(self) -> float:
        """By which share the worst of the speeds is off."""
        true = {order: self.machine.resonance_hz / (order * TEETH) for order in self.driven}
        return max((abs(self.named[order] / true[order] - 1) if order in self.named else 1.0) for order in self.driven)

    @property
    def holds(self) -> bool:
        """Whether the resonance is in its interval."""
        told = None if self.record.resonances is None else self.record.resonances.resonance_hz
        return told is not None and told.interval.low <= self.machine.resonance_hz <= told.interval.high


async def judged(seed: int, folder: Path) -> Judged:
    """A study of the plant of that seed: every other motor has uneven phases, all have detent torque."""
    machine, rng = drawn(seed), random.Random(seed + 1_000_000)
    options = {**machine.options}
    driven = {4}
    if seed % 2 == 0:
        driven.add(2)
        uneven = {"phase_unbalance": rng.uniform(0.02, 0.05), "quadrature_error_deg": rng.uniform(1, 3)}
        options["motor"] = {**options["motor"], **uneven}
    start = replace(START, irun=31, ihold=16, stops=False, counts_per_rev=4 * machine.lines)
    async with studied(folder, start, **options) as s:
        before = await s.settings(*NAMES)
        record = await s.finish(s.begin(s.document(STUDY)), 2000.0)
        share = options["motor"]["detent_torque_nm"] / options["motor"]["holding_torque_nm"]
        may = frozenset({2} if share > machine.damping else ())
        return Judged(machine, frozenset(driven), may, record, await s.settings(*NAMES) == before)


def measure(quick: bool) -> Sequence[Row]:
    """Two rows of a batch of plants; quick: a few."""
    found = collected("resonance map", judged, range(FIRST, FIRST + (4 if quick else 100)))
    plants, count = found.values(), len(found)
    near = [one for one in plants if one.off <= WITHIN]
    right = [one for one in plants if one.orders_right]
    good = [one for one in plants if one.off <= WITHIN and one.orders_right]
    odd = [one.record.message for one in plants if one.record.state != "done" or not one.as_before]
    said = [
        f"plant {seed}: {sorted(one.named)} for {sorted(one.driven)}, {100 * one.off:.1f} % off, damping "
        f"{one.machine.damping:.3f}; {one.record.verdict or one.record.message}"
        for seed, one in found.items()
        if one not in good
    ]
    holds = sum(one.holds for one in plants)
    return [
        Row(
            what=f"resonance map of {count} blind plants: speeds of resonance within 2 %, their orders right",
            measured=f"{at_least(len(good), count)}: speeds {len(near)}, orders {len(right)}",
            peer=f"{count}",
            ratio=len(good) / count,
            required=f">= {SHARE:g}, every axis as before",
            ok=len(good) >= SHARE * count and not odd,
            notes=(*said, *odd),
        ),
        Row(
            what="the same: resonance inside the told 95 % interval",
            measured=f"{holds}",
            peer=f"{count}",
            ratio=holds / count,
            required=f">= {COVERED:g}",
            ok=holds >= COVERED * count,
        ),
    ]
