"""A recording that is looked at: any part of it, also while it grows, and never a peak hidden."""

from __future__ import annotations

import itertools
import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.store.recordings.file import RecordingWriter, Rows
from app.store.recordings.head import Column, Head, UnreadableRecording
from app.store.recordings.opened import BLOCK, PIECE_ROWS, Opened, OpenedRecordings, thinned

HEAD = Head(
    "20261121-184500-00ff", "bench", "tmc428", (Column("a.0", "pps"), Column("b.0", "")), 1000.0, 0.0, 0.0, True, 16e6
)
numbers = itertools.count()


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("opened")


def rows_of(count: int, seed: int) -> Rows:
    noise = np.random.default_rng(seed)
    columns = noise.normal(0, 1, (2, count)).cumsum(axis=1)
    columns[noise.random((2, count)) < 0.01] = np.nan
    return Rows(noise.exponential(1e-3, count).cumsum(), columns)


@given(
    batches=st.lists(st.integers(0, 900), min_size=1, max_size=12),
    looks=st.lists(st.tuples(st.floats(0, 1), st.floats(0, 1), st.integers(1, 60)), min_size=1, max_size=5),
    seed=st.integers(0, 99),
    early=st.booleans(),
    blocks_max=st.sampled_from((2, 9, 1000)),
)
@settings(max_examples=30, deadline=None)
def test_against_all_rows(
    folder: Path,
    batches: list[int],
    looks: list[tuple[float, float, int]],
    seed: int,
    early: bool,
    blocks_max: int,
) -> None:
    rows = rows_of(sum(batches), seed)
    path = folder / f"{next(numbers)}.arrows"
    writer = RecordingWriter(path, HEAD)
    opened = Opened(path, blocks_max) if early else None  # one that grows while it is looked at, or one that is over
    for begin, count in zip(np.cumsum([0, *batches]), batches, strict=False):
        writer.append(Rows(rows.time_s[begin : begin + count], rows.columns[:, begin : begin + count]))
        if opened is not None:
            opened.refresh()
            assert opened.rows == begin + count
    writer.close()
    opened = opened or Opened(path, blocks_max)
    opened.refresh()
    assert (opened.rows, opened.head) == (len(rows.time_s), HEAD)
    if opened.rows:
        assert (opened.first_s, opened.last_s) == (rows.time_s[0], rows.time_s[-1])
    for one, other, wanted in looks:
        first, last = sorted((round(one * opened.rows), round(other * opened.rows)))
        read = opened.read(first, last)
        np.testing.assert_array_equal(read.time_s, rows.time_s[first:last])
        np.testing.assert_array_equal(read.columns, rows.columns[:, first:last])
        pieces = list(opened.pieces(first, last))
        np.testing.assert_array_equal(np.concatenate([np.empty(0), *(one.time_s for one in pieces)]), read.time_s)
        assert [one.columns.shape[1] for one in pieces] == [len(one.time_s) for one in pieces]
        shown = opened.segments(first, last, wanted)
        longest = BLOCK * (1 if blocks_max == 1000 else 4 * -(-opened.rows // (BLOCK * blocks_max)))
        assert len(shown) <= max(wanted, 4 * longest) + 2
        starts = np.searchsorted(rows.time_s, shown.start_s)
        assert np.all(np.diff(starts) > 0)
        for number, (begin, end) in enumerate(itertools.pairwise([*starts, last])):
            part = rows.columns[:, begin:end]
            np.testing.assert_array_equal(shown.missing[:, number], np.isnan(part).any(axis=1))
            known = [values[~np.isnan(values)] for values in part]
            low, high = (
                [extreme(values) if len(values) else np.nan for values in known] for extreme in (np.min, np.max)
            )
            np.testing.assert_array_equal(shown.low[:, number], low)
            np.testing.assert_array_equal(shown.high[:, number], high)
    for time_s in (*rows.time_s[:: max(1, opened.rows // 7)], -1.0, 1e6):
        assert opened.row_at(time_s) == np.searchsorted(rows.time_s, time_s)
        assert opened.row_at(time_s, "right") == np.searchsorted(rows.time_s, time_s, side="right")
    path.unlink()


def test_it_reads_what_is_whole_of_a_file_that_breaks_off(tmp_path: Path) -> None:
    path = tmp_path / "a.arrows"
    writer = RecordingWriter(path, HEAD)
    writer.append(rows_of(100, 1))
    whole = path.stat().st_size
    writer.append(rows_of(100, 2))
    grown = path.read_bytes()
    path.write_bytes(grown[: whole + 300])
    opened = Opened(path)
    assert opened.rows == 100
    path.write_bytes(grown)
    opened.refresh()
    assert opened.rows == 200
    writer.close()


def test_a_long_one_is_read_in_pieces_and_its_blocks_are_few(tmp_path: Path) -> None:
    path, rows, batches = tmp_path / "a.arrows", rows_of(10_000, 1), 60
    writer = RecordingWriter(path, HEAD)
    for number in range(batches):
        writer.append(Rows(rows.time_s + number * (rows.time_s[-1] + 1e-3), rows.columns))
    writer.close()
    opened = Opened(path, blocks_max=500)
    assert opened.rows == 10_000 * batches
    assert opened.size_bytes < 1000 * (8 + 2 * 33) + batches * 24
    whole = opened.read(0, opened.rows)
    tracemalloc.start()
    try:
        at, longest = 0, 0
        for piece in opened.pieces(5, opened.rows - 5):
            assert piece.time_s[0] == whole.time_s[5 + at]
            at, longest = at + len(piece.time_s), max(longest, len(piece.time_s))
        peak_bytes = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert (at, longest < PIECE_ROWS + 10_000) == (opened.rows - 10, True)
    assert peak_bytes < 6 * PIECE_ROWS * 3 * 8 < whole.columns.nbytes


@given(st.lists(st.integers(0, 40), max_size=8), st.integers(1, 30))
def test_thinned_is_the_first_of_so_many_whatever_the_pieces_are(lengths: list[int], every: int) -> None:
    rows = rows_of(sum(lengths), 3)
    ends = np.cumsum([0, *lengths])
    pieces = (Rows(rows.time_s[first:last], rows.columns[:, first:last]) for first, last in itertools.pairwise(ends))
    time_s, columns = thinned(pieces, [1], every)
    np.testing.assert_array_equal(time_s, rows.time_s[::every])
    np.testing.assert_array_equal(columns, rows.columns[1:, ::every])


def test_memory_is_bounded_and_the_latest_stay(tmp_path: Path) -> None:
    paths = [tmp_path / f"{number}.arrows" for number in range(3)]
    for path in paths:
        writer = RecordingWriter(path, HEAD)
        writer.append(rows_of(BLOCK * 100, 1))
        writer.close()
    kept = OpenedRecordings(limit_bytes=Opened(paths[0]).size_bytes * 2)
    first, second = kept.get(paths[0]), kept.get(paths[1])
    assert kept.get(paths[0]) is first
    kept.get(paths[2])
    assert kept.get(paths[0]) is first
    assert kept.get(paths[1]) is not second
    paths[0].unlink()
    with pytest.raises(FileNotFoundError):
        kept.get(paths[0])


@pytest.mark.parametrize("content", [b"", b"nonsense"])
def test_what_is_no_recording(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "a.arrows"
    path.write_bytes(content)
    with pytest.raises(UnreadableRecording):
        OpenedRecordings().get(path)
