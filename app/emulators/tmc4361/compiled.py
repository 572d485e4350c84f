"""How this package compiles: as the other kernels, but over several files.

Numba keys the disk cache of a function on the file that the function stands in. Here constants and callees stand in
other files, and stale machine code of a chip would be a nasty thing to look for. So the stamp of a cached function is
that of every file with compiled code or its layout, the motor's included.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from numba import njit

OPTIONS: dict[str, Any] = {"cache": True, "nogil": True, "error_model": "numpy", "_nrt": False}
"""As in the TMC428's kernel: on disk, off the GIL, no checks for division by zero, nothing to count references of."""


STAMP_FIELD = "_source_stamp"
"""Where Numba keeps what a cached function was made of: no option of its tells it of more files than the function's."""


def _stamp() -> tuple[tuple[str, float, int], ...]:
    here = Path(__file__).parent
    package = sorted((*here.glob("*.py"), *here.glob("feedback/*.py")))
    files = [file for file in package if "tmc4361.compiled" in file.read_text()]
    files += [here / "layout.py", here / "feedback/layout.py", here.parent / "drive/kernel.py"]
    stats = [(str(file.relative_to(here.parent)), file.stat()) for file in files]
    return tuple((name, stat.st_mtime, stat.st_size) for name, stat in stats)


_STAMP = _stamp()


def _keyed(dispatcher: Any) -> Any:
    cache_file = getattr(getattr(dispatcher, "_cache", None), "_cache_file", None)
    if cache_file is not None:  # no cache where nothing can be written, or under NUMBA_DISABLE_JIT
        setattr(cache_file, STAMP_FIELD, _STAMP)
    return dispatcher


def compiled(function: Any) -> Any:
    """Numba's njit as this package uses it."""
    return _keyed(njit(**OPTIONS)(function))


def inlined(function: Any) -> Any:
    """The same for what a tick calls."""
    return _keyed(njit(forceinline=True, **OPTIONS)(function))
