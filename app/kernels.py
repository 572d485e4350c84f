"""Compiles the inner loops of emulators and calculators with Numba, and keeps their machine code on disk.

It is kept beside the sources where they may be written, else in the user's cache directory (or in NUMBA_CACHE_DIR),
else nowhere: then each process compiles what it needs, but for a server, which has a temporary folder. What is kept is
good as long as its sources hold the same text, for times of files change where they are copied, and in layers of
images.

Numba, 0.5 s of work to import, comes with the first kernel that is called: who has no emulator starts without.

Compiling takes seconds. While a server compiles in the background, kernels of a group with `plain=True` run as what
they are written in until their machine code is there: slower, and equal in every bit (`plain_meanwhile`).
"""

from __future__ import annotations

import hashlib
import os
import platform
import sys
import threading
from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from functools import lru_cache
from importlib import import_module
from pathlib import Path
from types import FunctionType, ModuleType, SimpleNamespace
from typing import Any, Final, TypeVar, cast

import numpy as np

F = TypeVar("F", bound=Callable[..., object])

OPTIONS: Final = {"nogil": True, "error_model": "numpy", "_nrt": False, "no_cfunc_wrapper": True}
"""Off the GIL, no checks for division by zero, and nothing to count references of."""
_STAMP: Final = "_source_stamp"
"""Where Numba keeps what a function was made of: no option of its tells it of more files than the function's."""

_sources: set[Path] = set()
_kernels: list[Kernel] = []
_making = threading.RLock()
"""Held while a kernel is made: two threads would make two of it, and compile both."""
_meanwhile = threading.Event()
_this_thread = threading.local()


@dataclass(slots=True)
class Progress:
    """How far compiling has come: jobs done of all, and the names of those under way.

    looked : whether it is known what there is to do
    """

    total: int
    done: int = 0
    doing: list[str] = field(default_factory=list)
    looked: bool = False


class Kernels:
    """Compiles functions that stand in the files `sources`, or take constants or callees from them.

    options : of Numba's njit
    plain : whether plain Python serves until they are compiled. They take arrays and numbers, and never count on what
        64 bits cut off
    views : whether they look at parts of their arrays as at arrays of their own: plain Python gets the arrays then, and
        takes three times as long as on lists

    A name that begins with an underscore is called by compiled code only: it has no way in from Python, which saves a
    seventh of the time to compile. Called from Python all the same, it would end the process.
    """

    def __init__(
        self, *sources: str | Path, options: dict[str, Any] | None = None, plain: bool = False, views: bool = False
    ) -> None:
        files = sorted(Path(source) for source in sources)
        _sources.update(files)
        self._files = files
        self._options = OPTIONS if options is None else options
        self._plain, self._views = plain, views

    def compiled(self, function: F) -> F:
        """Numba's njit at the first call, with the type of the plain function."""
        return cast(
            "F",
            Kernel(
                cast("FunctionType", function),
                self._files,
                {**_how(function), **self._options},
                self._plain,
                self._views,
            ),
        )

    def inlined(self, function: Any) -> Any:
        """The same for what a tick calls, which its caller takes in."""
        return Kernel(
            function, self._files, {"forceinline": True, **_how(function), **self._options}, self._plain, self._views
        )


class Kernel:
    """A function that Numba gets when it is first called, or when another kernel that calls it is compiled.

    Whatever else is asked of it, its Numba dispatcher answers.
    """

    def __init__(
        self,
        function: FunctionType,
        files: list[Path],
        options: dict[str, Any],
        plain: bool = False,
        views: bool = False,
    ) -> None:
        self.py_func, self._files, self._options, self._plain, self._views = function, files, options, plain, views
        self.__doc__, self.__name__, self.__module__ = function.__doc__, function.__name__, function.__module__
        self._made: Any = None
        self._ready: Any = None
        """What Numba made, once it has answered."""
        _kernels.append(self)

    def __call__(self, *arguments: Any) -> Any:
        return (self._ready or self._first)(*arguments)

    def _first(self, *arguments: Any) -> Any:
        """What is called until there is machine code."""
        if self._plain and _meanwhile.is_set() and not getattr(_this_thread, "compiles", False):
            with suppress(ArithmeticError, ValueError):  # where compiled code goes on with inf or nan
                return (_run_on_arrays if self._views else _run_plain)(self.py_func, arguments)
        answer = self.dispatcher(*arguments)
        self._ready = self._made
        return answer

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):  # of nobody who means Numba's
            raise AttributeError(name)
        return getattr(self.dispatcher, name)

    @property
    def _numba_type_(self) -> Any:
        """Numba asks for it where a kernel that it compiles names this one."""
        return self.dispatcher._numba_type_

    @property
    def dispatcher(self) -> Any:
        """What Numba makes of the function, which is the plain function under NUMBA_DISABLE_JIT."""
        if self._made is None:
            with _making:
                if self._made is None:
                    import numba

                    self._made = self._kept(numba.njit(**self._options)(self.py_func))
        return self._made

    def _kept(self, dispatcher: Any) -> Any:
        if not hasattr(dispatcher, "enable_caching"):  # the plain function, under NUMBA_DISABLE_JIT
            return dispatcher
        stamp = _digest(tuple(self._files))
        beside = _kept_beside(self.py_func, stamp)
        if beside is not None:
            dispatcher._cache = beside  # noqa: SLF001  # Numba has no other way to say where, and of what it was made
            return dispatcher
        try:
            dispatcher.enable_caching()
        except RuntimeError:  # nowhere may anything be written
            return dispatcher
        setattr(dispatcher._cache._cache_file, _STAMP, stamp)  # noqa: SLF001
        return dispatcher

    def make_anew(self) -> None:
        """Forget a dispatcher that has not compiled anything yet."""
        if self._ready is None:
            self._made = None

    @property
    def folder(self) -> Path | None:
        """Where its machine code is kept; None where nothing may be written."""
        path = getattr(getattr(self.dispatcher, "_cache", None), "cache_path", None)
        return None if path is None else Path(path)


def _how(function: Any) -> dict[str, Any]:
    """Options by the name: without a way in from Python where it begins with an underscore."""
    return {"no_cpython_wrapper": function.__name__.startswith("_")}


def _kept_beside(function: FunctionType, stamp: str) -> Any:
    """The cache beside the sources, where it has machine code for this processor and may not be written; else None.

    So it is in an image, and in what a system's administrator has installed: Numba would pass over it, and look for a
    place to write.
    """
    file = Path(function.__code__.co_filename)
    folder = file.parent / "__pycache__"
    index = f"{file.stem}.{function.__qualname__}-{function.__code__.co_firstlineno}.*.nbi"
    if os.access(folder, os.W_OK) or not any(folder.glob(index)):
        return None
    caching: Any = import_module("numba.core.caching")
    registry: Any = import_module("numba.core.registry")

    class Beside(caching.InTreeCacheLocator):  # type: ignore[misc]  # Numba has no types
        from_function = classmethod(lambda cls, function, file: cls(function, file))

    class Results(caching.CompileResultCacheImpl):  # type: ignore[misc]
        _locator_classes: Final = [Beside]

    class Cache(caching.FunctionCache):  # type: ignore[misc]
        _impl_class = Results

        def save_overload(self, sig: object, data: object) -> None:
            """What is missing is compiled by each process."""

    kept = Cache(function)._cache_file  # noqa: SLF001
    setattr(kept, _STAMP, stamp)
    here = registry.cpu_target.target_context.codegen().magic_tuple()
    if not any(processor == here for _, processor, _ in kept._load_index()):  # noqa: SLF001
        return None
    cache = Cache(function)
    cache._cache_file = kept  # noqa: SLF001
    return cache


@lru_cache
def _digest(files: tuple[Path, ...]) -> str:
    text = hashlib.sha256()
    for file in files:
        text.update(file.read_bytes())
    return text.hexdigest()


# --- plain Python until then ---------------------------------------------------------------------


def plain_meanwhile(on: bool) -> None:
    """Whether kernels that may run as plain Python do so until they are compiled; else whoever calls one waits."""
    if on:
        _meanwhile.set()
    else:
        _meanwhile.clear()


def serves_plain() -> bool:
    """Whether plain Python serves what is not compiled yet."""
    return _meanwhile.is_set()


@contextmanager
def compiles_here() -> Iterator[None]:
    """What this thread calls is compiled, or taken from disk, whatever others do meanwhile."""
    _this_thread.compiles = True
    try:
        yield
    finally:
        _this_thread.compiles = False


class _Rows(list[Any]):
    """A matrix as a list of lists, whose cells and rows are named as an array's."""

    def __getitem__(self, at: Any) -> Any:
        return list.__getitem__(self, at[0])[at[1]] if type(at) is tuple else list.__getitem__(self, at)

    def __setitem__(self, at: Any, cell: Any) -> None:
        list.__getitem__(self, at[0])[at[1]] = cell


def _run_plain(function: FunctionType, arguments: tuple[Any, ...]) -> Any:
    """Run it on lists, whose cells cost a third of an array's, and write what they hold then back into the arrays."""
    arrays = [(at, one) for at, one in enumerate(arguments) if isinstance(one, np.ndarray)]
    given = list(arguments)
    for at, array in arrays:
        given[at] = array.tolist() if array.ndim == 1 else _Rows(array.tolist())
    answer = _plain_names(function)[function.__name__](*given)
    for at, array in arrays:
        if array.flags.writeable:
            array[:] = given[at]
    return answer


def _run_on_arrays(function: FunctionType, arguments: tuple[Any, ...]) -> Any:
    """Run it on the arrays themselves, which are as before where it fails: machine code begins from there."""
    before = [(one, one.copy()) for one in arguments if isinstance(one, np.ndarray) and one.flags.writeable]
    try:
        with np.errstate(all="ignore"):  # compiled code tells of no overflow either
            return _plain_names(function)[function.__name__](*arguments)
    except (ArithmeticError, ValueError):
        for array, cells in before:
            array[...] = cells
        raise


_plain_modules: dict[str, dict[str, Any]] = {}


def _plain_names(function: FunctionType) -> dict[str, Any]:
    """What the names of its module mean to a plain function: other plain functions where they are kernels, of its own
    module, of others, or in others that it names.
    """
    return _plain_module(function.__module__, function.__globals__)


def _plain_module(module: str, its: dict[str, Any]) -> dict[str, Any]:
    names = _plain_modules.get(module)
    if names is None:
        names = _plain_modules[module] = dict(its)
        for name, meant in its.items():
            if isinstance(meant, Kernel):
                plain: FunctionType = meant.py_func
                inner = names if plain.__globals__ is its else _plain_names(plain)
                names[name] = FunctionType(plain.__code__, inner, name, plain.__defaults__)
            elif isinstance(meant, ModuleType) and any(isinstance(one, Kernel) for one in vars(meant).values()):
                names[name] = SimpleNamespace(**_plain_module(meant.__name__, vars(meant)))
    return names


# --- what is compiled ----------------------------------------------------------------------------


def kept_in() -> Path | None:
    """A folder in which machine code outlives the process; None where there is none, nor may be written."""
    # Numba decides by the folder that a function's file is in: one function tells of all of them.
    return min(_kernels, key=lambda kernel: kernel.py_func.__code__.co_filename).folder if _kernels else None


def can_keep() -> bool:
    """Whether machine code that is not there yet can be kept."""
    folders = (kernel.folder for kernel in _kernels)
    return any(folder is not None and os.access(folder, os.W_OK) for folder in folders)


def keep_in(folder: Path) -> None:
    """Keep machine code there from now on, in this process and those that it starts."""
    import numba

    os.environ["NUMBA_CACHE_DIR"] = str(folder)
    numba.config.CACHE_DIR = str(folder)  # type: ignore[attr-defined]  # it has read the variable already
    for kernel in _kernels:
        kernel.make_anew()


def all_compiled(parts: Collection[str] = ()) -> bool:
    """Whether all was compiled, on this machine and of these sources, that was imported until now, or all `parts`."""
    whole = _mark()
    if whole is None:
        return False
    return whole.exists() or (bool(parts) and all(_part(whole, name).exists() for name in parts))


def tell_compiled(part: str = "") -> None:
    """Remember that all is compiled, or a part of that name: the next start of these sources finds it done."""
    whole = _mark()
    if whole is not None:
        with suppress(OSError):  # beside the rest, which may only be read
            (_part(whole, part) if part else whole).touch()


def _part(whole: Path, name: str) -> Path:
    return whole.with_stem(f"{whole.stem}-{name}")


def _mark() -> Path | None:
    """A file beside the machine code that says of what it is; None where nothing is kept."""
    folder = kept_in()
    if folder is None:
        return None
    import numba
    from llvmlite import binding as llvm

    machine = (numba.__version__, sys.version, platform.machine(), numba.config.CPU_NAME or llvm.get_host_cpu_name())  # type: ignore[attr-defined]
    made_of = hashlib.sha256(repr((machine, _digest(tuple(sorted(_sources))))).encode()).hexdigest()[:16]
    return folder / f"stepscope-{made_of}.compiled"
