"""Keeps Python's byte code in the user's cache where it cannot be kept beside the sources.

An installation that nobody may write to, made by who leaves no byte code, as uv does, would have Python compile some
2,000 modules at each start, which is seconds of a core. Where a start finds none, two cores make it.
"""

from __future__ import annotations

import os
import subprocess
import sys
import threading
from collections.abc import Iterable
from contextlib import suppress
from importlib.util import cache_from_source, find_spec
from pathlib import Path

import platformdirs

PREFIX = "PYTHONPYCACHEPREFIX"
IMPORTED_LAST = ("sqlalchemy", *("api", "studies", "emulators", "profiles", "procedures", "calc", "store", "devices"))
"""A library and rooms, those first which a start comes to last: two processes that begin at both ends meet once."""


def keep_byte_code(source: Path = Path(__file__), cache: Path | None = None) -> Path | None:
    """Have Python keep it in `cache`, and in the processes that this one starts; where it does, else None.

    Nothing is changed where `source`, which has been imported, left byte code beside itself, nor where Python was told
    what to do with it, nor where the cache cannot be written either.
    """
    if sys.dont_write_bytecode or sys.pycache_prefix is not None or Path(cache_from_source(str(source))).exists():
        return None
    folder = (cache or Path(platformdirs.user_cache_dir("stepscope"))) / "byte-code"
    with suppress(OSError):
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        if os.access(folder, os.W_OK):
            sys.pycache_prefix = os.environ[PREFIX] = str(folder)
            return folder
    return None


def compile_ahead(folders: Iterable[str | Path] | None = None) -> threading.Thread | None:
    """Have a second process make the byte code of `folders`, while this one imports what comes before them.

    Nothing where it is there already, as after the first start, or where Python keeps none. The thread that is returned
    ends with that process.
    """
    first = Path(cache_from_source(str(Path(__file__).with_name("main.py"))))
    if sys.dont_write_bytecode or (folders is None and first.exists()) or os.cpu_count() == 1:
        return None
    kept = () if sys.pycache_prefix is None else ("-X", f"pycache_prefix={sys.pycache_prefix}")
    of_optimisation = ("-O",) * sys.flags.optimize
    command = (sys.executable, "-I", "-S", *of_optimisation, *kept, "-m", "compileall", "-qq")
    with suppress(OSError):  # this process makes it all by itself
        process = subprocess.Popen(
            [*command, *(str(folder) for folder in folders or _imported_last())],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        waiting = threading.Thread(target=process.wait, name="byte code", daemon=True)
        waiting.start()
        return waiting
    return None


def _imported_last() -> Iterable[Path]:
    library, *rooms = IMPORTED_LAST
    found = find_spec(library)
    yield from (Path(folder) for folder in (found.submodule_search_locations if found else None) or ())
    yield from (Path(__file__).with_name(room) for room in rooms)
