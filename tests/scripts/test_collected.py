"""What a bench row has judged of its plants is kept, so that a later run goes on where an earlier one ended."""

from __future__ import annotations

import os
from functools import partial
from pathlib import Path

import pytest

from tests.bench import collected as kept
from tests.bench.collected import Keeping, at_least, at_most, collected


async def judge(seed: int, folder: Path, *, log: Path) -> int:
    """The square of a seed, and a line for each that was asked."""
    assert os.listdir(folder) == []
    with log.open("a") as file:
        file.write(f"{seed}\n")
    return seed * seed


@pytest.fixture
def log(tmp_path: Path) -> Path:
    path = tmp_path / "log"
    path.touch()
    return path


def asked(log: Path) -> list[int]:
    """Whom a row has judged since the last look."""
    found = sorted(int(line) for line in log.read_text().split())
    log.write_text("")
    return found


def test_a_later_run_judges_only_what_no_earlier_one_has(tmp_path: Path, log: Path) -> None:
    one = partial(judge, log=log)
    # No time: one plant at the least.
    assert collected("row", one, range(5), keeping=Keeping(tmp_path, 0.0)) == {0: 0}
    assert asked(log) == [0]
    assert collected("row", one, range(5), keeping=Keeping(tmp_path)) == {0: 0, 1: 1, 2: 4, 3: 9, 4: 16}
    assert asked(log) == [1, 2, 3, 4]
    collected("another", one, range(2), keeping=Keeping(tmp_path))
    assert asked(log) == [0, 1]


def test_what_other_sources_have_judged_does_not_count(
    tmp_path: Path, log: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    one = partial(judge, log=log)
    collected("row", one, range(1), keeping=Keeping(tmp_path))
    collected("row", one, range(1), keeping=Keeping(tmp_path))
    assert asked(log) == [0]
    changed, digest = Path(__file__), kept._digest  # as if the judge were another now
    monkeypatch.setattr(kept, "_digest", lambda path: "" if path == changed else digest(path))
    collected("row", one, range(1), keeping=Keeping(tmp_path))
    assert asked(log) == [0]


def test_without_a_folder_each_run_begins_anew(log: Path) -> None:
    for _ in range(2):
        collected("row", partial(judge, log=log), range(3), keeping=Keeping())
        assert asked(log) == [0, 1, 2]


def test_few_plants_say_what_they_show() -> None:
    assert at_least(37, 37) == "37 of 37: >= 0.92 with 95 %"
    assert at_most(0, 59) == "0 of 59: <= 0.05 with 95 %"
    assert at_least(0, 3) == "0 of 3: >= 0.00 with 95 %"
