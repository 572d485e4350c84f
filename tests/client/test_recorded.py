"""Rows of a recording as a script gets them."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from app.client.errors import ClientError
from app.client.stream import samples_of

READS = """
import os, sys
from pathlib import Path
from stepscope.client.stream import samples_of

def threads():
    return len(os.listdir("/proc/self/task"))

content, before = Path(sys.argv[1]).read_bytes(), threads()
assert samples_of(content, 10.0).time_s.tolist()[:2] == [0.0, 0.1]
print(threads() - before)
"""


@pytest.fixture
def recorded(tmp_path: Path) -> Path:
    """A file of several pieces, as long recordings are."""
    path = tmp_path / "recording.parquet"
    rows = 500
    schema = pa.schema([pa.field("time_s", pa.float64()), pa.field("position.0", pa.float64())])
    with pq.ParquetWriter(path, schema, compression="zstd") as writer:
        for piece in range(20):
            times_s = np.arange(piece * rows, (piece + 1) * rows) / 10
            writer.write_table(pa.table([times_s, times_s], schema=schema))
    return path


def test_a_script_that_ends_after_reading_ends_well(recorded: Path) -> None:
    """Arrow's threads abort a process that ends while they still hold its bytes: so there are none."""
    if not Path("/proc/self/task").is_dir():
        pytest.skip("threads are counted by Linux's /proc")
    for _ in range(3):
        ran = subprocess.run(
            [sys.executable, "-c", READS, str(recorded)], capture_output=True, text=True, check=False, timeout=60
        )
        assert (ran.returncode, ran.stdout, ran.stderr) == (0, "0\n", "")


@pytest.mark.parametrize("content", [b"", b"PAR1", b"no recording" * 10])
def test_what_is_no_recording_is_told(content: bytes) -> None:
    with pytest.raises(ClientError, match="no recording"):
        samples_of(content, 10.0)
