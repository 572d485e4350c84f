"""Broken axes drawn from a seed that the first look does not know: is the fault named, and no other; and none where
there is none?"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from app.emulators.tmc5xxx.options import AxisChange, EncoderChange, Tmc5xxxPatch
from tests.bench.collected import collected
from tests.bench.table import Row
from tests.plants.broken import FAULTS, drawn
from tests.studies.harness import START, studied

FULL = replace(START, irun=31, ihold=16)
"""At the rated current while it moves."""
NAMES = ("VMAX", "AMAX", "DMAX", "V1")
FIRST_SEED = 1000
"""Those below were looked at while the study was written."""
SHARE, WITHIN_S = 0.95, 300.0


@dataclass(frozen=True, slots=True)
class Judged:
    """fault : what is broken; named : what the study says is; says : its verdict, or why it failed."""

    fault: str
    named: str
    as_before: bool
    says: str


async def judged(seed: int, folder: Path) -> Judged:
    """The first look at one plant."""
    plant = drawn(seed)
    slips = itertools.cycle(plant.slips_fullsteps)
    async with studied(folder, FULL, **plant.options) as s:
        before = await s.settings(*NAMES)
        run = s.begin(s.document({"kind": "first_look", "travel_turns": 2.5}))
        while run.running and s.clock.now() < WITHIN_S:
            s.b.patch(Tmc5xxxPatch(axes=[AxisChange(axis=0, encoder=EncoderChange(slip_fullsteps=next(slips)))]))
            await s.clock.advance(plant.slips_every_s)
        named = sorted({one.fault for one in run.record.findings if one.fault})
        says = run.record.message if run.record.state != "done" else run.record.verdict
        as_before = await s.settings(*NAMES) == before
    return Judged(plant.fault or "", ", ".join(named), as_before, says)


def measure(quick: bool) -> Sequence[Row]:
    """One row for what is broken and one for what is not; quick: a few plants."""
    plants = 10 if quick else 125
    found = collected("broken plants", judged, range(FIRST_SEED, FIRST_SEED + plants))
    rows = []
    for what, wanted in (
        ("broken plants: the fault named and no other", True),
        ("healthy plants: none called broken", False),
    ):
        told = [(seed, one) for seed, one in found.items() if bool(one.fault) == wanted]
        right = sum(one.named == one.fault for _, one in told)
        each = (
            f"{fault}: {sum(one.named == one.fault for _, one in told if one.fault == fault)} of "
            f"{sum(one.fault == fault for _, one in told)}"
            for fault in FAULTS
        )
        rows.append(
            Row(
                what=what,
                measured=f"{right} right",
                peer=f"{len(told)}",
                ratio=right / len(told),
                required=f">= {SHARE:g}, every axis as before",
                ok=right / len(told) >= SHARE and all(one.as_before for _, one in told),
                notes=(
                    *([", ".join(each)] if wanted else []),
                    *(
                        f"plant {seed}: {one.fault or 'healthy'}, named {one.named or 'none'}; {one.says}"
                        for seed, one in told
                        if one.named != one.fault
                    ),
                ),
            )
        )
    return rows
