"""A share of the random programs; `make bench` runs ten thousand of each kind."""

from __future__ import annotations

import pytest

from tests.emulators.tmcl.harness import Bench
from tests.emulators.tmcl.random_programs import LATER, agree, any_bytes


@pytest.mark.parametrize("options", [{}, LATER], ids=["1.44", "later"])
def test_an_oracle_agrees_on_random_programs(options: dict[str, object]) -> None:
    bench = Bench(options)
    for seed in range(500):
        agree(seed, bench)


def test_random_bytes_run_or_stop() -> None:
    bench = Bench(LATER)
    for seed in range(300):
        any_bytes(seed, bench)
