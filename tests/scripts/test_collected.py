"""Results of a bench row that are kept by commit and seed, so that a later run goes on where an earlier one ended."""

from __future__ import annotations

from pathlib import Path

from tests.bench.collected import Keeping, at_least, at_most, cache, collected


class Judge:
    def __init__(self) -> None:
        self.asked: list[int] = []

    async def __call__(self, seed: int) -> int:
        self.asked.append(seed)
        return seed * seed


async def test_a_later_run_judges_only_what_no_earlier_one_has(tmp_path: Path) -> None:
    first, later = Judge(), Judge()
    # No time: one plant at the least.
    assert await collected("row", range(5), first, Keeping(tmp_path, 0.0)) == [0]
    assert first.asked == [0]
    assert await collected("row", range(5), later, Keeping(tmp_path)) == [0, 1, 4, 9, 16]
    assert later.asked == [1, 2, 3, 4]
    other = Judge()
    await collected("another", range(2), other, Keeping(tmp_path))
    assert other.asked == [0, 1]


async def test_without_a_folder_each_run_begins_anew() -> None:
    for _ in range(2):
        judge = Judge()
        await collected("row", range(3), judge, Keeping())
        assert judge.asked == [0, 1, 2]


def test_what_is_checked_out_names_the_folder() -> None:
    assert cache() == cache()
    assert cache().parent.name == "bench"


def test_few_plants_say_what_they_show() -> None:
    assert at_least(37, 37) == "37 of 37: >= 0.92 with 95 %"
    assert at_most(0, 59) == "0 of 59: <= 0.05 with 95 %"
    assert at_least(0, 3) == "0 of 3: >= 0.00 with 95 %"
