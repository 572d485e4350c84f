"""Which modules are emulated, and what makes one of the family's firmware that one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from ...registers.tmcl.description import TmclModule
from ...registers.tmcl.modules import MODULES
from .parameters import Parameters
from .sixpoint import SixPointParameters
from .trapezoid import TrapezoidParameters


@dataclass(frozen=True, slots=True)
class Played:
    """A module as it is played."""

    model: str
    module: TmclModule
    parameters: type[Parameters]
    full_scale_a: float
    """Peak coil current at parameter 6 = 255 [A]."""


PLAYED: Mapping[str, Played] = MappingProxyType(
    {
        played.model: played
        for played in (
            # 3 A RMS (FM-PD42-1241 1.2)
            Played("pd42-1241", MODULES["pd42-1241"], SixPointParameters, 4.2),
            # 2.8 A RMS (FM-TMCM-1161, title page)
            Played("tmcm-1161", MODULES["tmcm-1161"], TrapezoidParameters, 3.96),
        )
    }
)
