"""Writes golden.bin and golden.json: one telemetry frame, as both sides of the socket have to read it.

Run `python -m tests.telemetry.make_golden` only when the format is meant to change; the page tests the same files.
"""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np

from app.telemetry.frames import encode_body, encode_header

HERE = Path(__file__).parent
TIME_S = [0.0, 0.001, 0.002, 1e6 + 1 / 3]
COLUMNS = [
    [-(2.0**23), 0.0, 1.0, 2.0**23 - 1],
    [math.nan, 0.1, -0.1, math.nan],
    [0.0, 1.0, 0.0, 1.0],
]
SEQUENCE, DROPPED = 4_294_967_295, 2**40 + 7


def frame() -> bytes:
    samples = np.array(COLUMNS).T
    return encode_header(SEQUENCE, DROPPED, len(TIME_S), len(COLUMNS)) + encode_body(np.array(TIME_S), samples)


def description() -> dict[str, object]:
    return {
        "sequence": SEQUENCE,
        "dropped": DROPPED,
        "time_s": TIME_S,
        "columns": [[None if math.isnan(value) else value for value in column] for column in COLUMNS],
    }


if __name__ == "__main__":
    (HERE / "golden.bin").write_bytes(frame())
    (HERE / "golden.json").write_text(json.dumps(description(), indent=1) + "\n")
