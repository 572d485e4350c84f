"""Parameters of the PD42-1241 (TMCM-1241), firmware V1.44: axis and global parameters, ports, coordinates.

Source "FM-PD42-1241" is its TMCL manual, whose parameter tables are lost in the copy at hand. Numbers and
names come from PyTrinamic's TMCM1241.py; ranges and most meanings from the manual of the sister
module TMCM-1290 ("1290"), or where that has nothing from the registers of the TMC5160 ("5160").
Ranges in pps and pps^2 are those of unit mode 1; `internal_range` is what unit mode 0 allows.
"""

from __future__ import annotations

from ..model import RegisterTable
from .description import TmclModule
from .pd42_axis import AXIS_PARAMETERS
from .pd42_globals import COORDINATE_ROWS, GLOBAL_PARAMETERS, PORTS

AXES = 1
CLOCK_HZ = 16e6
"""The driver chip's clock [Hz]. No source states it; every range of the sister's manual fits it exactly."""
MODULE = 1241

PD42 = RegisterTable("PD42-1241", (*AXIS_PARAMETERS, *GLOBAL_PARAMETERS, *PORTS, *COORDINATE_ROWS))
PD42_1241 = TmclModule(MODULE, "1.44", PD42, CLOCK_HZ)
