"""Large buffers have pages of their own, which the system gets back when they are freed."""

from __future__ import annotations

import platform
import subprocess
import sys

import pytest

LEARNT = """
import re
import sys
from pathlib import Path

if sys.argv[1] == "told":
    from app.allocator import give_back_large_buffers
    assert give_back_large_buffers()
import numpy as np

def in_heap(address):
    bounds = re.findall(r"^([0-9a-f]+)-([0-9a-f]+) .*\\[heap\\]$", Path("/proc/self/maps").read_text(), re.MULTILINE)
    return any(int(low, 16) <= address < int(high, 16) for low, high in bounds)

np.ones(3_000_000)  # freed at once: from it glibc learns
print(in_heap(np.ones(2_000_000).ctypes.data))
"""


@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="other C libraries have no such setting")
@pytest.mark.parametrize(("said", "in_heap"), [("told", "False"), ("as it is", "True")])
def test_a_large_buffer_is_in_no_heap(said: str, in_heap: str) -> None:
    done = subprocess.run([sys.executable, "-c", LEARNT, said], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == in_heap
