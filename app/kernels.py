"""Compiles the inner loops of emulators and calculators with Numba, and keeps their machine code on disk.

It is kept beside the sources where they may be written, else in the user's cache directory (or in NUMBA_CACHE_DIR),
else nowhere: then each process compiles what it needs. What is kept is good as long as its sources hold the same text,
for times of files change where they are copied, and in layers of images.
"""

from __future__ import annotations

import hashlib
import platform
import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final, TypeVar, cast

import numba
from llvmlite import binding as llvm

F = TypeVar("F", bound=Callable[..., object])

OPTIONS: Final = {"nogil": True, "error_model": "numpy", "_nrt": False, "no_cfunc_wrapper": True}
"""Off the GIL, no checks for division by zero, and nothing to count references of."""
_STAMP: Final = "_source_stamp"
"""Where Numba keeps what a function was made of: no option of its tells it of more files than the function's."""

_sources: set[Path] = set()
_folders: set[Path] = set()


@dataclass(slots=True)
class Progress:
    """How far compiling has come: jobs done of all, and the names of those under way."""

    total: int
    done: int = 0
    doing: list[str] = field(default_factory=list)


class Kernels:
    """Compiles functions that stand in the files `sources`, or take constants or callees from them.

    options : of Numba's njit

    A name that begins with an underscore is called by compiled code only: it has no way in from Python, which saves a
    seventh of the time to compile. Called from Python all the same, it would end the process.
    """

    def __init__(self, *sources: str | Path, options: dict[str, Any] | None = None) -> None:
        files = sorted(Path(source) for source in sources)
        _sources.update(files)
        self._stamp = _digest(files)
        self._options = OPTIONS if options is None else options

    def compiled(self, function: F) -> F:
        """Numba's njit, with the type of the plain function."""
        return cast("F", self._kept(numba.njit(**_how(function), **self._options)(function)))

    def inlined(self, function: Any) -> Any:
        """The same for what a tick calls, which its caller takes in."""
        return self._kept(numba.njit(forceinline=True, **_how(function), **self._options)(function))

    def _kept(self, dispatcher: Any) -> Any:
        if not hasattr(dispatcher, "enable_caching"):  # the plain function, under NUMBA_DISABLE_JIT
            return dispatcher
        try:
            dispatcher.enable_caching()
        except RuntimeError:  # nowhere may anything be written
            return dispatcher
        cache = dispatcher._cache  # noqa: SLF001  # Numba has no other way to say what a function was made of
        setattr(cache._cache_file, _STAMP, self._stamp)  # noqa: SLF001
        _folders.add(Path(cache.cache_path))
        return dispatcher


def _how(function: Any) -> dict[str, Any]:
    """Options by the name: without a way in from Python where it begins with an underscore."""
    return {"no_cpython_wrapper": function.__name__.startswith("_")}


def _digest(files: list[Path]) -> str:
    text = hashlib.sha256()
    for file in files:
        text.update(file.read_bytes())
    return text.hexdigest()


def kept_in() -> Path | None:
    """A folder in which machine code outlives the process; None where nothing may be written."""
    return min(_folders, default=None)


def all_compiled() -> bool:
    """Whether somebody compiled, on this machine and of these sources, all that was imported until now."""
    mark = _mark()
    return mark is not None and mark.exists()


def tell_compiled() -> None:
    """Remember that all is compiled: the next start of these sources finds it done."""
    mark = _mark()
    if mark is not None:
        mark.touch()


def _mark() -> Path | None:
    """A file beside the machine code that says of what it is; None where nothing is kept."""
    folder = kept_in()
    if folder is None:
        return None
    machine = (numba.__version__, sys.version, platform.machine(), llvm.get_host_cpu_name())
    made_of = hashlib.sha256(repr((machine, _digest(sorted(_sources)))).encode()).hexdigest()[:16]
    return folder / f"stepscope-{made_of}.compiled"
