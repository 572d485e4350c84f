"""Undo of random sequences of writes, designs, profile applies and undo: `python -m tests.bench --only undo`.

Every model in turn. Demanded: the device as it was before, as the emulator's own registers have it, or told which
register cannot be put back.
"""

from __future__ import annotations

import asyncio
import logging
import sys
from collections.abc import Sequence

from app.registers.catalog import MODELS
from tests.bench.table import Row, render
from tests.profiles.sequences import Report, undo_of

SEQUENCES = 100
QUICK_SEQUENCES = 12
FIRST_SEED = 1000


def measure(quick: bool) -> Sequence[Row]:
    """The share of sequences after whose undo the device is as before, or it is told what is not."""
    logging.getLogger("stepscope.profiles").setLevel(logging.CRITICAL)
    models = tuple(MODELS)
    reports: list[Report] = []
    for number in range(QUICK_SEQUENCES if quick else SEQUENCES):
        report = asyncio.run(undo_of(models[number % len(models)], FIRST_SEED + number))
        if report.wrong:
            print(f"{report.model}, seed {report.seed}, {report.doings}: {report.wrong[:3]}", file=sys.stderr)
        reports.append(report)
    right = sum(not report.wrong for report in reports)
    whole = sum(not report.wrong and not report.told for report in reports)
    return [
        Row(
            what=f"undo of {len(reports)} random sequences of writes, designs, profile applies and undo",
            measured=f"{100 * right / len(reports):.4g} % as before or told",
            peer="100 %",
            ratio=right / len(reports),
            required="100 %",
            ok=right == len(reports),
            notes=(
                f"{whole} as before in every register, {right - whole} with registers told as what cannot be",
                f"{sum(report.back for report in reports)} registers put back, {sum(r.told for r in reports)} told",
                f"{len({report.model for report in reports})} models, two writers",
            ),
        )
    ]


if __name__ == "__main__":
    print(render(measure("--quick" in sys.argv)))
