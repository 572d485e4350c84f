"""Every TMCL module that stepscope knows, by model name."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from .description import TmclModule
from .pd42 import PD42_1241
from .tmcm1161 import TMCM1161

MODULES: Mapping[str, TmclModule] = MappingProxyType({"pd42-1241": PD42_1241, "tmcm-1161": TMCM1161})
