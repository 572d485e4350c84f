"""Extended positions on disk: exact, readable by people, and safe from broken files and from other programs."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.calc.positions.extended import LIMIT
from app.clock import VirtualClock
from app.store.positions import FILE_NAME, PositionStore, SavedPosition
from app.store.saver import Saver

SAVED = SavedPosition("bench", "tmc428", "{}", 0, 24, -5, (1 << 62) + 1, 1.7e9)

positions = st.integers(-LIMIT, LIMIT - 1)
saved = st.builds(
    SavedPosition,
    device=st.text("abc-", min_size=1, max_size=5),
    model=st.just("tmc5160"),
    link=st.just('{"kind": "emulator"}'),
    axis=st.integers(0, 2),
    bits=st.sampled_from([24, 32]),
    count=st.integers(-(1 << 23), 1 << 23),
    position=positions,
    seen_unix_s=st.floats(0, 1e11),
    lost=st.text(max_size=10),
    microsteps_per_turn=st.none() | st.fractions(min_value=Fraction(1, 1000), max_value=1 << 40),
    gear=st.none() | st.tuples(st.integers(1, 1 << 40), st.integers(1, 1000), st.integers(1, 1000)),
    zero=positions,
    compare=st.none() | positions,
)


@given(st.lists(saved, max_size=4, unique_by=lambda one: one.key))
def test_what_is_saved_comes_back_exactly(tmp_path_factory: pytest.TempPathFactory, kept: list[SavedPosition]) -> None:
    directory = tmp_path_factory.mktemp("data")
    PositionStore(directory).save(kept)
    loaded = PositionStore(directory).load()
    assert (loaded.positions, loaded.warnings) == (kept, [])


def test_numbers_beyond_a_browser_s_are_text_and_fractions_are_exact(tmp_path: Path) -> None:
    PositionStore(tmp_path).save([replace(SAVED, microsteps_per_turn=Fraction(358_400, 3), gear=(51_200, 3, 7))])
    (entry,) = json.loads((tmp_path / FILE_NAME).read_text())["positions"]
    assert entry["position"] == str((1 << 62) + 1)
    assert entry["microsteps_per_turn"] == "358400/3"


def test_no_file_is_no_position(tmp_path: Path) -> None:
    loaded = PositionStore(tmp_path).load()
    assert (loaded.positions, loaded.warnings) == ([], [])


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"format": "stepscope-positions", "version": 2}', "\xff"])
def test_a_broken_file_is_set_aside(tmp_path: Path, text: str) -> None:
    (tmp_path / FILE_NAME).write_text(text, encoding="latin-1")
    store = PositionStore(tmp_path)
    loaded = store.load()
    assert loaded.positions == []
    assert any("kept as" in warning for warning in loaded.warnings)
    store.save([SAVED])
    assert PositionStore(tmp_path).load().positions == [SAVED]
    assert [path.read_text(encoding="latin-1") for path in tmp_path.glob("positions.broken-*")] == [text]


@pytest.mark.parametrize(
    "change",
    [
        {"position": 5},
        {"position": "x"},
        {"axis": True},
        {"microsteps_per_turn": "1/0"},
        {"gear": [1, 2]},
        {"seen_unix_s": "now"},
        {"device": None},
    ],
)
def test_one_entry_that_cannot_be_read_does_not_cost_the_others(tmp_path: Path, change: dict[str, object]) -> None:
    store = PositionStore(tmp_path)
    store.save([SAVED, replace(SAVED, device="other")])
    document = json.loads(store.path.read_text())
    document["positions"][0] |= change
    store.path.write_text(json.dumps(document))
    loaded = PositionStore(tmp_path).load()
    assert [one.device for one in loaded.positions] == ["other"]
    assert "left out" in loaded.warnings[0]


def test_two_programs_on_one_directory_keep_each_other_s_positions(tmp_path: Path) -> None:
    ours, theirs = PositionStore(tmp_path), PositionStore(tmp_path)
    ours.save([SAVED])
    theirs.save([replace(SAVED, device="theirs")])
    ours.save([replace(SAVED, count=7)])
    assert {(one.device, one.count) for one in PositionStore(tmp_path).load().positions} == {
        ("bench", 7),
        ("theirs", -5),
    }
    ours.save([])
    assert [one.device for one in PositionStore(tmp_path).load().positions] == ["theirs"]


async def test_what_changes_all_the_time_is_saved_at_a_bounded_rate_and_the_last_of_it_too(tmp_path: Path) -> None:
    clock, store = VirtualClock(), PositionStore(tmp_path)
    taken: list[float] = []
    now = SAVED

    def collect() -> list[SavedPosition]:
        taken.append(clock.now())
        return [now]

    saver = Saver(store, collect, clock, 2.0)
    for count in range(100):
        now = replace(SAVED, count=count)
        saver.request()
        await clock.advance(0.1)
    await saver.close()
    assert PositionStore(tmp_path).load().positions == [replace(SAVED, count=99)]
    # How long a save takes is the machine's; that between two of them there are two seconds is not.
    assert len(taken) <= 7
    assert all(later - earlier >= 2 - 1e-9 for earlier, later in pairwise(taken[:-1]))
