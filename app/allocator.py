"""Has large buffers given back to the system when they are freed, instead of left in the heap for the next one.

What is freed in the middle of a heap stays with the process for as long as anything behind it lives. glibc learns from
each large buffer that is freed to take the next one of its size, up to 32 MB, from the heap; NumPy asks for huge pages
for such a buffer, and whatever small comes to lie there later takes 2 MB at a touch. In half an hour of the full
bench a heap that had been marked so grew by 22 MB, 14 of them huge pages.
"""

from __future__ import annotations

import os

LARGE_BYTES = 1 << 20
M_MMAP_THRESHOLD = -3
"""Of glibc's malloc.h."""


def give_back_large_buffers() -> bool:
    """Give every buffer of 1 MiB or more pages of its own, and no huge ones. To be called before NumPy is imported.

    Returns whether this C library can: glibc alone does.
    """
    import ctypes  # here, so that commands which ask a server start without it

    os.environ.setdefault("NUMPY_MADVISE_HUGEPAGE", "0")
    try:
        return bool(ctypes.CDLL(None).mallopt(M_MMAP_THRESHOLD, LARGE_BYTES))
    except (AttributeError, OSError, TypeError):  # it has no such call; Windows has no library without a name
        return False
