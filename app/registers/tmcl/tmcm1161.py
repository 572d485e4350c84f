"""Parameters of the TMCM-1161, firmware V1.46: axis and global parameters, ports, coordinates.

One axis, a TMC429 as motion controller and a TMC262 as motor driver, an encoder on the motor's shaft, TMCL over USB,
RS485 and RS232. Numbers and names come from PyTrinamic's TMCM1161.py; ranges from PyStepRocker's table of the modules
with these two chips ("STEPROCKER"); speeds and accelerations count as the TMC429's registers do; of the module's own
manual ("FM-TMCM-1161") two pages were available. What nobody tells is like the PD42-1241's.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import partial

from ..model import Register, RegisterTable, Space
from .build import Parameters
from .description import TmclModule
from .pd42_globals import COORDINATE_ROWS, GLOBAL_PARAMETERS, PORTS
from .tmcm1161_axis import AXIS_PARAMETERS, INT24

SOURCE = "PyTrinamic TMCM1161"
_BANK0 = frozenset({65, 66, 68, 75, 76, 77, 81, 84, 85, 87, 128, 129, 130, 132, 133, 255})
"""What both modules have; this one has no CAN."""
_kept = partial(Parameters, source=SOURCE, space=Space.GLOBAL_0, stored="auto")


def _shared(rows: Iterable[Register]) -> Iterator[Register]:
    """Rows that mean here what they mean there."""
    for row in rows:
        if row.space is Space.PULL_UP or (row.space is Space.GLOBAL_0 and row.address not in _BANK0):
            continue
        limits = INT24 if row.space is Space.COORDINATE else row.range
        yield replace(row, source=SOURCE, range=limits)


TABLE = RegisterTable(
    "TMCM-1161",
    (
        *AXIS_PARAMETERS,
        *_shared(GLOBAL_PARAMETERS),
        _kept("switches").switch(79, "limit_switch_polarity", "1 inverts both stop inputs", reset=0),
        _kept("motor").switch(90, "reverse_shaft_direction", "1 turns the motor the other way round", reset=0),
        *_shared(PORTS),
        *_shared(COORDINATE_ROWS),
    ),
)
TMCM1161 = TmclModule(1161, "1.46", TABLE, 16e6, counting="dividers", position_bits=24, stores_axis=True)
