"""What hangs on an axis: a carriage on a stage, and its three switches, in the kernel's arrays.

Stage positions there are whole numbers of `units` a full step: 64 for a TMC428, the driver's microsteps
for a TMC4210.
"""

from __future__ import annotations

from ...errors import OutOfRange
from ..drive.documents import Forced
from . import kernel
from .kernel import Cells
from .options import StageChange, StageOptions, SwitchChange
from .state import AxisState, StageState, Switches, SwitchState

_EDGES = {
    "left_at_fullsteps": kernel.LEFT_AT,
    "right_at_fullsteps": kernel.RIGHT_AT,
    "ref_from_fullsteps": kernel.REF_FROM,
    "ref_to_fullsteps": kernel.REF_TO,
}
_FORCES = {"left": kernel.FORCE_L, "right": kernel.FORCE_R, "reference": kernel.FORCE_REF}
WIRED = 2
"""Added to the level of a switch that a wire holds; one that is forced is 0 or 1."""
KEPT_WITHOUT_POWER = (kernel.MECH, kernel.NET, *_EDGES.values(), *_FORCES.values())
"""Columns that belong to the mechanics, not to the chip, and what has gone out over step/direction."""


def place(axis: Cells, options: StageOptions, units: int) -> None:
    """Set up the stage of one axis (a row of the kernel's array)."""
    for name, column in _EDGES.items():
        axis[column] = round(getattr(options, name) * units)
    axis[kernel.MECH] = round(options.start_fullsteps * units)
    for column in _FORCES.values():
        axis[column] = -1


def change(axis: Cells, wanted: StageChange, units: int) -> None:
    """Move switches or carriage. Raises OutOfRange where the switches would change places."""
    edges = {
        name: int(axis[column]) if getattr(wanted, name) is None else round(getattr(wanted, name) * units)
        for name, column in _EDGES.items()
    }
    if edges["left_at_fullsteps"] >= edges["right_at_fullsteps"]:
        raise OutOfRange(
            "left_at_fullsteps", edges["left_at_fullsteps"] / units, None, edges["right_at_fullsteps"] / units
        )
    if edges["ref_from_fullsteps"] > edges["ref_to_fullsteps"]:
        raise OutOfRange(
            "ref_from_fullsteps", edges["ref_from_fullsteps"] / units, None, edges["ref_to_fullsteps"] / units
        )
    for name, column in _EDGES.items():
        axis[column] = edges[name]
    if wanted.position_fullsteps is not None:
        axis[kernel.MECH] = round(wanted.position_fullsteps * units)


def force(axis: Cells, wanted: SwitchChange) -> None:
    """Force switches, or give them back to the stage."""
    for name, column in _FORCES.items():
        forced: Forced | None = getattr(wanted, name)
        if forced is not None:
            axis[column] = -1 if forced == "auto" else int(forced)


def wire(axis: Cells, high: bool | None) -> None:
    """Another chip holds the input of the left switch at a level, unless that is forced; None: no more."""
    if int(axis[kernel.FORCE_L]) not in (0, 1):
        axis[kernel.FORCE_L] = -1 if high is None else WIRED + high


def describe(index: int, axis: Cells, units: int) -> AxisState:
    """The stage of one axis as the API tells it."""
    physical = int(axis[kernel.PHYS])

    def switch(name: str, bit: int) -> SwitchState:
        forced = int(axis[_FORCES[name]])
        return SwitchState(active=bool(physical >> bit & 1), forced=bool(forced) if forced in (0, 1) else None)

    return AxisState(
        axis=index,
        position_fullsteps=int(axis[kernel.MECH]) / units,
        stage=StageState(**{name: int(axis[column]) / units for name, column in _EDGES.items()}),
        switches=Switches(left=switch("left", 0), right=switch("right", 1), reference=switch("reference", 2)),
    )
