from __future__ import annotations

import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from app.telemetry.frames import HEADER, FloatArray, decode, encode_body, encode_header
from tests.telemetry import make_golden


def test_the_golden_frame_is_what_we_write_and_read() -> None:
    golden = (make_golden.HERE / "golden.bin").read_bytes()
    said = json.loads((make_golden.HERE / "golden.json").read_text())
    assert make_golden.frame() == golden
    assert make_golden.description() == said
    frame = decode(golden)
    assert (frame.sequence, frame.dropped) == (said["sequence"], said["dropped"])
    assert frame.time_s.tolist() == said["time_s"]
    columns = [[np.nan if value is None else value for value in column] for column in said["columns"]]
    np.testing.assert_array_equal(frame.columns, columns)


def test_the_header_leaves_the_numbers_aligned() -> None:
    assert HEADER.size == 24
    assert HEADER.size % 8 == 0


@given(
    samples=arrays.arrays(
        np.dtype("float64"), st.tuples(st.integers(0, 40), st.integers(1, 12)), elements=st.floats(allow_nan=True)
    ),
    sequence=st.integers(0, 2**40),
    dropped=st.integers(0, 2**64 - 1),
)
def test_a_frame_survives_the_wire(samples: FloatArray, sequence: int, dropped: int) -> None:
    time_s = np.linspace(0.0, 1.0, len(samples), dtype=np.float64)
    frame = decode(encode_header(sequence, dropped, *samples.shape) + encode_body(time_s, samples))
    assert (frame.sequence, frame.dropped) == (sequence % 2**32, dropped)
    np.testing.assert_array_equal(frame.time_s, time_s)
    np.testing.assert_array_equal(frame.columns.T, samples)


@pytest.mark.parametrize("spoilt", [b"", b"SSC1", b"SSC2" + bytes(20), encode_header(0, 0, 1, 1) + bytes(15)])
def test_half_a_frame_is_refused(spoilt: bytes) -> None:
    with pytest.raises(ValueError, match="frame"):
        decode(spoilt)
