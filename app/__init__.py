"""stepscope: a web dashboard that configures and tunes stepper motion controllers.

The tree says what may know what; `docs/architecture.md` draws it and import-linter holds it.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:  # the server and the command line begin without the client
    from .client import *  # noqa: F403

__version__ = "0.1.0"


def __getattr__(name: str) -> object:
    """What the client offers: `from stepscope import Bench`."""
    if name[:1].isupper():
        client = import_module(f"{__name__}.client")
        if name in client.__all__:
            return getattr(client, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
