"""Twenty thousand cases of the contract, sequences of calls among them: what is wrong or late."""

from __future__ import annotations

import asyncio
import re
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

from tests.bench.table import Row
from tests.fuzz import PARTS, WITHIN_S, fuzzed

CASES = 20_000
EXAMPLES, EXAMPLES_QUICK = 80, 2
"""Of each call."""
TITLE = re.compile(r"^_{3,} (.+) _{3,}$", re.MULTILINE)


def measure(quick: bool) -> Sequence[Row]:
    examples = EXAMPLES_QUICK if quick else EXAMPLES
    began_s = time.perf_counter()
    outcomes = []
    for part in PARTS:
        with tempfile.TemporaryDirectory(prefix="stepscope-") as folder:
            outcomes.append(asyncio.run(fuzzed(part, Path(folder), examples, timed=True)))
    took_s = time.perf_counter() - began_s
    cases = sum(outcome.cases for outcome in outcomes)
    failed = [outcome for outcome in outcomes if outcome.failed]
    return [
        Row(
            what=f"{cases:,} cases of the contract, one call after another among them",
            measured=f"{len(failed)} of {len(outcomes)} runs with a finding",
            peer=f"no 5xx, no answer over {WITHIN_S:g} s",
            ratio=float(len(failed)),
            required="0" if quick else f"0, at least {CASES:,} cases",
            ok=not failed and (quick or cases >= CASES),
            notes=(
                f"{took_s:.0f} s",
                *(title for outcome in failed for title in TITLE.findall(outcome.report)[:10]),
                *(outcome.report[-1500:] for outcome in failed),
            ),
        )
    ]
