"""Applying a profile with a fault at every step: `python -m tests.bench --only profiles`.

Every model, every fault (`tests.profiles.faults`) at every step that writes, at the write itself and at the
frames behind it. Demanded: always applied, taken back whole, or told exactly what is left, as the emulator's own
registers have it. Registers that cannot be read are spared only what no link can show: a chip that does not take what
has arrived.
"""

from __future__ import annotations

import asyncio
import logging
import sys
from collections import Counter
from collections.abc import Sequence

from app.profiles.document import ProfileDocument
from app.registers.catalog import MODELS
from tests.bench.table import Row, render
from tests.profiles.faults import FAULTS, NEEDS_READING, Fault, Report, target_of, try_fault

FRAMES = (0, 1)
"""Frames of a step that are spoiled: the write, and what follows it."""
SHARE = {"pd42-1241": 0.15}
"""How many registers differ: of a module, with 256 user variables among them, less than of a chip."""
SHARE_OF_A_CHIP = 0.5
QUICK_STRIDE = 9
GIVEN_UP = 40
"""Steps in a row at which a fault finds no frame to spoil."""


async def faults_of(model: str, stride: int = 1) -> list[Report]:
    """What came of every fault at every `stride`th step of applying a profile to a `model`."""
    document = await target_of(model, seed=3, share=SHARE.get(model, SHARE_OF_A_CHIP))
    found: list[Report] = []
    for fault in FAULTS:
        for frame in (0,) if fault in NEEDS_READING else FRAMES:
            found += await _at_every_step(document, fault, frame, stride)
    return found


async def _at_every_step(document: ProfileDocument, fault: Fault, frame: int, stride: int) -> list[Report]:
    found: list[Report] = []
    at = missed = 0
    while missed < GIVEN_UP and (not found or at < found[-1].of):
        report = await try_fault(document, fault, at, frame, seed=at)
        missed = missed + 1 if report is None else 0
        if report is not None:
            found.append(report)
        at += stride
    return found


def measure(quick: bool) -> Sequence[Row]:
    """The share of faults after which all was as before, or told exactly; of all models."""
    logging.getLogger("stepscope.profiles").setLevel(logging.CRITICAL)  # it tells of each fault, as it should
    counts: Counter[str] = Counter()
    for model in MODELS:
        reports = asyncio.run(faults_of(model, QUICK_STRIDE if quick else 1))
        counts.update(report.outcome for report in reports)
        for report in reports:
            if report.outcome == "wrong":
                print(f"{model}: {report.fault} at step {report.at}: {report.detail[:300]}", file=sys.stderr)
    total = sum(counts.values())
    right = total - counts["wrong"]
    return [
        Row(
            what=f"apply of a profile with a fault injected at every step, {total} faults",
            measured=f"{100 * right / total:.4g} % taken back or told",
            peer="100 %",
            ratio=right / total,
            required="100 %",
            ok=right == total,
            notes=(
                f"{counts['taken back']} taken back whole, {counts['left']} told what is left",
                f"{counts['applied']} applied all the same",
                f"{len(MODELS)} models, {len(FAULTS)} kinds of faults",
            ),
        )
    ]


if __name__ == "__main__":
    print(render(measure("--quick" in sys.argv)))
