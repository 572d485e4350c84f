"""`stepscope` in a working tree: the folder app/, by the name that it is installed under.

A wheel calls the folder `stepscope` itself; an editable installation cannot rename, so it finds this module instead.
Each module is imported once, whichever name asks for it.
"""

from __future__ import annotations

import importlib.util
import sys
from collections.abc import Sequence
from importlib.abc import InspectLoader, MetaPathFinder
from importlib.machinery import ModuleSpec
from types import CodeType, ModuleType
from typing import TYPE_CHECKING, cast

import app

if TYPE_CHECKING:
    from app import *  # noqa: F403


class _SameModules(MetaPathFinder, InspectLoader):
    """Finds `stepscope.x` as `app.x`."""

    def __init__(self) -> None:
        self._same: dict[str, ModuleSpec] = {}

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        del path, target
        if not fullname.startswith(f"{NAME}."):
            return None
        same = importlib.util.find_spec(app.__name__ + fullname.removeprefix(NAME))
        if same is None:
            return None
        self._same[fullname] = same
        return ModuleSpec(fullname, self, origin=same.origin)

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        return importlib.import_module(self._same[spec.name].name)

    def exec_module(self, module: ModuleType) -> None:
        assert module.__spec__ is not None
        module.__spec__ = self._same[module.__spec__.name]  # which the import has replaced by ours

    def get_code(self, fullname: str) -> CodeType | None:
        """For `python -m stepscope.cli`."""
        same = self._same[fullname]
        return cast("InspectLoader", same.loader).get_code(same.name)

    def get_source(self, fullname: str) -> str | None:
        same = self._same[fullname]
        return cast("InspectLoader", same.loader).get_source(same.name)


NAME = __name__
sys.meta_path.insert(0, _SameModules())
sys.modules[NAME] = app
