"""A few cases of every call of the contract; `make bench ARGS="--only fuzz"` takes tens of thousands."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.fuzz import PARTS, fuzzed

EXAMPLES = 3
"""Of each call."""
MANY_FORMS = {"new": 30, "destructive": 10}
"""Parts whose calls take any kind of link: so many examples instead of 11,000 bounds, which `make bench` tries."""


@pytest.mark.slow
@pytest.mark.timeout(200 * EXAMPLES)  # two minutes when nobody else is busy
@pytest.mark.parametrize("which", PARTS)
async def test_the_server_keeps_its_contract(tmp_path: Path, which: str) -> None:
    examples = MANY_FORMS.get(which, EXAMPLES)
    outcome = await fuzzed(which, tmp_path, examples, timed=False, every_bound=which not in MANY_FORMS)
    assert outcome.failed == 0, outcome.report
    assert outcome.cases > 0, outcome.report
