"""Keeps Python's byte code in the user's cache where it cannot be kept beside the sources.

An installation that nobody may write to, made by who leaves no byte code, as uv does, would have Python compile some
2,000 modules at each start, which is seconds of a core.
"""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from importlib.util import cache_from_source
from pathlib import Path

import platformdirs

PREFIX = "PYTHONPYCACHEPREFIX"


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
