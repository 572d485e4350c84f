"""A few cases of every call of the contract; `make bench ARGS="--only fuzz"` takes tens of thousands."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.fuzz import PARTS, fuzzed

EXAMPLES = 4
"""Of each call."""


@pytest.mark.slow
@pytest.mark.timeout(100 * EXAMPLES)  # a minute when nobody else is busy
@pytest.mark.parametrize("which", PARTS)
async def test_the_server_keeps_its_contract(tmp_path: Path, which: str) -> None:
    outcome = await fuzzed(which, tmp_path, EXAMPLES, timed=False)
    assert outcome.failed == 0, outcome.report
    assert outcome.cases > 0, outcome.report
