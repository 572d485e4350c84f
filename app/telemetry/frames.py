"""The binary telemetry frame, both ways.

Little-endian: b"SSC1", u32 sequence, u32 rows, u32 columns, u64 rows dropped so far for this reader
(24 bytes, so that what follows is aligned for float64), then the time [s] of each row, then column
after column. tests/telemetry/golden.bin holds one for both sides, this one and the page's.

Header and body are apart, because readers with the same subscription share the body.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

MAGIC = b"SSC1"
HEADER = struct.Struct("<4sIIIQ")


@dataclass(frozen=True, slots=True)
class Frame:
    """A decoded frame: `time_s` [rows], `columns` [columns, rows], NaN where a value is missing."""

    sequence: int
    dropped: int
    time_s: FloatArray
    columns: FloatArray


def encode_header(sequence: int, dropped: int, rows: int, columns: int) -> bytes:
    """24 bytes. The sequence wraps at 2^32."""
    return HEADER.pack(MAGIC, sequence & 0xFFFF_FFFF, rows, columns, dropped)


def encode_body(time_s: FloatArray, samples: FloatArray) -> bytes:
    """`samples` is [rows, columns], as the sampler has it; on the wire it goes column after column."""
    return time_s.astype("<f8").tobytes() + samples.T.astype("<f8", order="C").tobytes()


def decode(frame: bytes) -> Frame:
    """A frame to arrays that view it. Raises ValueError for anything that is no whole frame."""
    if len(frame) < HEADER.size:
        raise ValueError(f"a telemetry frame has at least {HEADER.size} bytes, not {len(frame)}")
    magic, sequence, rows, columns, dropped = HEADER.unpack_from(frame)
    if magic != MAGIC:
        raise ValueError(f"a telemetry frame begins with {MAGIC!r}, not {magic!r}")
    wanted = HEADER.size + 8 * rows * (1 + columns)
    if len(frame) != wanted:
        raise ValueError(f"a frame of {rows} rows and {columns} columns has {wanted} bytes, not {len(frame)}")
    numbers = np.frombuffer(frame, dtype="<f8", offset=HEADER.size)
    return Frame(sequence, dropped, numbers[:rows], numbers[rows:].reshape(columns, rows))
