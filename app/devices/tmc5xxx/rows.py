"""Rows of the register tables that the driver itself needs, by what they are: the same for all five chips.

The second axis has rows of its own, at other addresses; global rows are the same for both.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property

from ...registers.model import Field, Register, RegisterTable
from ...registers.tmc5xxx.table import AXES, TABLES

POSITION, FORWARD, BACKWARD, HOLD = range(4)
"""RAMPMODE."""
MODE_NAMES = ("position", "velocity", "velocity", "hold")


def part(register: Register, *names: str) -> Field:
    """A field of a row, by the first of its names that the row has. Raises KeyError."""
    for name in names:
        found = register.field_named(name)
        if found is not None:
            return found
    raise KeyError(f"{register.name} has no field {' or '.join(names)}")


def _row(table: RegisterTable, axis: int | None, *names: str) -> Register | None:
    """The first of these rows that the chip has."""
    for name in names:
        found = table.find(name, axis)
        if found is not None and found[1] is None:
            return found[0]
    return None


@dataclass(frozen=True)
class AxisRows:
    """The rows of one axis."""

    table: RegisterTable
    axis: int

    def _get(self, name: str) -> Register:
        return self.table.get(name, self.axis)

    def find(self, name: str) -> Register | None:
        """A row that only some of the chips have."""
        return _row(self.table, self.axis, name)

    @cached_property
    def rampmode(self) -> Register:
        return self._get("RAMPMODE")

    @cached_property
    def xactual(self) -> Register:
        return self._get("XACTUAL")

    @cached_property
    def vactual(self) -> Register:
        return self._get("VACTUAL")

    @cached_property
    def xtarget(self) -> Register:
        return self._get("XTARGET")

    @cached_property
    def vmax(self) -> Register:
        return self._get("VMAX")

    @cached_property
    def amax(self) -> Register:
        return self._get("AMAX")

    @cached_property
    def ramp(self) -> dict[str, Register]:
        """The ramp's parameters by name; none of them can be read."""
        return {name: self._get(name) for name in RAMP}

    @cached_property
    def sw_mode(self) -> Register:
        return self._get("SW_MODE")

    @cached_property
    def ramp_stat(self) -> Register:
        return self._get("RAMP_STAT")

    @cached_property
    def ihold_irun(self) -> Register:
        return self._get("IHOLD_IRUN")

    @cached_property
    def chopconf(self) -> Register:
        return self._get("CHOPCONF")

    @cached_property
    def drv_status(self) -> Register:
        return self._get("DRV_STATUS")

    @cached_property
    def mscnt(self) -> Register:
        return self._get("MSCNT")

    @cached_property
    def mscuract(self) -> Register:
        return self._get("MSCURACT")

    @cached_property
    def tstep(self) -> Register | None:
        """Chips of two axes have none."""
        return self.find("TSTEP")

    @cached_property
    def x_enc(self) -> Register | None:
        """None where the chip has no encoder input."""
        return self.find("X_ENC")

    @cached_property
    def enc_const(self) -> Register | None:
        return self.find("ENC_CONST")

    @cached_property
    def encoder_mode(self) -> Register | None:
        """Not asked for by the driver itself: kept in mind where somebody reads or writes it."""
        return self.find("ENCMODE")

    @cached_property
    def mslut(self) -> tuple[Register, ...]:
        """MSLUT[0..7], MSLUTSEL and MSLUTSTART; of a TMC5072 the same for both axes."""
        return tuple(self._get(name) for name in (*(f"MSLUT[{index}]" for index in range(8)), "MSLUTSEL", "MSLUTSTART"))

    @cached_property
    def remembered(self) -> tuple[Register, ...]:
        """What can be read and is kept in mind."""
        return (self.rampmode, self.sw_mode, self.chopconf)

    @cached_property
    def moving(self) -> frozenset[int]:
        """Addresses a write to which may move or stop the motor, or change how it moves."""
        rows = (*self.ramp.values(), self.rampmode, self.xactual, self.xtarget, self.sw_mode)
        return frozenset(row.address for row in rows)


RAMP = ("VSTART", "A1", "V1", "AMAX", "VMAX", "DMAX", "D1", "VSTOP", "TZEROWAIT")


@dataclass(frozen=True)
class ChipRows:
    """The rows of a chip that belong to all of it, and those of its axes."""

    table: RegisterTable
    axes: tuple[AxisRows, ...]

    @cached_property
    def gconf(self) -> Register:
        return self.table.get("GCONF")

    @cached_property
    def gstat(self) -> Register:
        return self.table.get("GSTAT")

    @cached_property
    def disable_pin(self) -> str:
        """The bit of `inputs` that is 1 while the pin DRV_ENN switches the bridges off, as this chip calls it."""
        return next(part.name for part in self.inputs.fields if part.name.upper().startswith("DRV_ENN"))

    @cached_property
    def inputs(self) -> Register:
        """IOIN, or INPUT: pins and VERSION."""
        found = _row(self.table, None, "IOIN", "INPUT")
        if found is None:
            raise KeyError(f"{self.table.chip} has neither IOIN nor INPUT")
        return found

    @cached_property
    def remembered(self) -> tuple[Register, ...]:
        return (self.gconf, *(row for axis in self.axes for row in axis.remembered))

    @property
    def clears_on_read(self) -> bool:
        """Whether reading GSTAT and RAMP_STAT clears their flags; else writing 1 does."""
        return self.gstat.read_clears

    @property
    def two_axes(self) -> bool:
        return len(self.axes) > 1


@cache
def rows_of(model: str) -> ChipRows:
    """The rows of a model. Raises KeyError."""
    table = TABLES[model]
    return ChipRows(table, tuple(AxisRows(table, axis) for axis in range(AXES[model])))
