"""The file of a recording: what goes in comes out, also while it grows and where it breaks off."""

from __future__ import annotations

import json
import os
import tempfile
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from app.store.recordings import marks
from app.store.recordings.file import RecordingWriter, Rows, read_head, read_rows
from app.store.recordings.head import Column, Head, UnreadableRecording
from app.store.recordings.marks import Mark

HEAD = Head(
    id="20261121-184500-00ff",
    device="bench",
    model="tmc428",
    columns=(Column("position.0", "microsteps"), Column("velocity.0", "pps")),
    rate_hz=100.0,
    started_unix_s=1_795_000_000.0,
    time_origin_unix_s=1_794_000_000.0,
    chip_timed=True,
    clock_hz=16e6,
    trigger={"kind": "now"},
    configuration={"registers": [{"name": "v_max", "axis": 0, "raw": 3, "value": 3}]},
)
BATCHES = st.lists(st.integers(0, 20), max_size=8)


def rows_of(counts: list[int], seed: int = 0) -> list[Rows]:
    noise = np.random.default_rng(seed)
    return [Rows(noise.random(count), noise.random((2, count))) for count in counts]


@given(BATCHES, st.integers(0, 1000))
@settings(max_examples=40, deadline=None)
def test_what_goes_in_comes_out(counts: list[int], seed: int) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "r.arrows"
        writer = RecordingWriter(path, HEAD)
        batches = rows_of(counts, seed)
        for batch in batches:
            writer.append(batch)
        before = read_rows(path)
        writer.close()
        writer.close()
        after = read_rows(path)
        assert read_head(path) == HEAD
    expected = np.concatenate(
        [np.empty((3, 0)), *(np.vstack((batch.time_s, batch.columns)) for batch in batches)], axis=1
    )
    for found in (before, after):
        np.testing.assert_array_equal(np.vstack((found.time_s, found.columns)), expected)
    assert writer.rows == sum(counts)


@given(st.lists(st.integers(1, 20), min_size=1, max_size=6), st.floats(0, 1))
@settings(max_examples=60, deadline=None)
def test_wherever_it_breaks_off_the_whole_batches_are_there(counts: list[int], share: float) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "r.arrows"
        writer = RecordingWriter(path, HEAD)
        begun = path.stat().st_size
        sizes = []
        for batch in rows_of(counts):
            writer.append(batch)
            sizes.append(path.stat().st_size)
        writer.close()
        kept = begun + int(share * (sizes[-1] - begun))
        os.truncate(path, kept)
        assert read_head(path) == HEAD
        whole = sum(count for count, size in zip(counts, sizes, strict=True) if size <= kept)
        assert len(read_rows(path).time_s) == whole


def test_a_missing_sample_stays_missing(tmp_path: Path) -> None:
    path = tmp_path / "r.arrows"
    writer = RecordingWriter(path, HEAD)
    writer.append(Rows(np.array([1.0]), np.array([[np.nan], [2.0]])))
    writer.close()
    np.testing.assert_array_equal(read_rows(path).columns, [[np.nan], [2.0]])


def test_nothing_is_written_over(tmp_path: Path) -> None:
    RecordingWriter(tmp_path / "r.arrows", HEAD).close()
    with pytest.raises(FileExistsError):
        RecordingWriter(tmp_path / "r.arrows", HEAD)


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="a disk that is always full is Linux's")
def test_a_full_disk_is_told(tmp_path: Path) -> None:
    writer = RecordingWriter(tmp_path / "r.arrows", HEAD)
    whole = os.dup(writer._file.fileno())
    full = os.open("/dev/full", os.O_WRONLY)
    os.dup2(full, writer._file.fileno())
    with pytest.raises(OSError, match="No space"):
        writer.append(rows_of([100])[0])
    os.dup2(whole, writer._file.fileno())
    os.close(full)
    os.close(whole)
    writer.close()


@pytest.mark.parametrize("content", [b"", b"nonsense", b"\xff" * 1000, HEAD.encode()])
def test_what_is_no_recording(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "r.arrows"
    path.write_bytes(content)
    for read in (read_head, read_rows):
        with pytest.raises(UnreadableRecording):
            read(path)


def test_a_stream_of_another_program(tmp_path: Path) -> None:
    path = tmp_path / "r.arrows"
    with pa.OSFile(str(path), "wb") as sink, pa.ipc.new_stream(sink, pa.schema([("x", pa.int8())])):
        pass
    with pytest.raises(UnreadableRecording, match="another program"):
        read_head(path)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"version": 99}, "newer"),
        ({"format": "other"}, "another program"),
        ({"columns": 3}, "head"),
        ({"x": 1}, "head"),
    ],
)
def test_a_head_that_cannot_be_read(change: dict[str, object], words: str) -> None:
    with pytest.raises(UnreadableRecording, match=words):
        Head.decode(json.dumps({**json.loads(HEAD.encode()), **change}).encode())


@given(
    arrays(np.float64, st.integers(1, 30), elements=st.floats(-1e9, 1e9)),
    st.text(max_size=40),
    st.none() | st.integers(0, 3),
)
@settings(max_examples=40, deadline=None)
def test_marks_come_back_in_the_order_of_time(times: np.ndarray, text: str, axis: int | None) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "r.marks"
        for time_s in times:
            marks.add(path, Mark(float(time_s), "note", text, axis))
        found = marks.read(path)
        assert [mark.time_s for mark in found] == sorted(times)
        assert {(mark.text, mark.axis) for mark in found} == {(text, axis)}
        whole = path.read_bytes()
        path.write_bytes(whole[:-3])
        assert len(marks.read(path)) == len(times) - 1
    assert marks.read(path) == []
