"""Registers that the driver itself needs, by their roles: the same for all chips.

The second axis has rows of its own, at other addresses; global rows are the same for both.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property

from ...registers.model import Field, Register, RegisterTable
from ...registers.tmc5xxx.table import AXES, TABLES
from ..core.row_named import row_named, row_named_if_any

POSITION, FORWARD, BACKWARD, HOLD = range(4)
"""RAMPMODE."""
MODE_NAMES = ("position", "velocity", "velocity", "hold")
LOWEST, HIGHEST = -(1 << 31), (1 << 31) - 1
"""Of the position counter [microsteps]."""
TABLE_MICROSTEPS = 256


def signed(count: int) -> int:
    """What a 32-bit counter shows: of a distance, the shorter way round."""
    return (count + (1 << 31)) % (1 << 32) - (1 << 31)


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
class AxisRoles:
    """The rows of one axis."""

    table: RegisterTable
    axis: int

    def get(self, name: str) -> Register:
        """A row that all of the chips have. Raises KeyError."""
        return self.table.get(name, self.axis)

    def find(self, name: str) -> Register | None:
        """A row that only some of the chips have."""
        return _row(self.table, self.axis, name)

    rampmode = row_named("RAMPMODE")
    xactual = row_named("XACTUAL")
    vactual = row_named("VACTUAL")
    xtarget = row_named("XTARGET")
    vmax = row_named("VMAX")
    amax = row_named("AMAX")

    @cached_property
    def ramp(self) -> dict[str, Register]:
        """The ramp's parameters by name; most chips cannot read them."""
        further = {name: row for name in FURTHER if (row := self.find(name)) is not None}
        return {name: self.get(name) for name in RAMP} | further

    sw_mode = row_named("SW_MODE")
    ramp_stat = row_named("RAMP_STAT")
    ihold_irun = row_named("IHOLD_IRUN")
    chopconf = row_named("CHOPCONF")

    @cached_property
    def current_range(self) -> tuple[Register, Field] | None:
        """Where the range of the current is set, of a chip that has one."""
        row = self.find("DRV_CONF")
        field = None if row is None else row.field_named("CURRENT_RANGE")
        return None if row is None or field is None else (row, field)

    drv_status = row_named("DRV_STATUS")
    mscnt = row_named("MSCNT")
    mscuract = row_named("MSCURACT")
    tstep = row_named_if_any("TSTEP")
    """Chips of two axes have none."""
    x_enc = row_named_if_any("X_ENC")
    """None where the chip has no encoder input."""
    enc_const = row_named_if_any("ENC_CONST")
    encoder_mode = row_named_if_any("ENCMODE")
    """Not asked for by the driver itself: kept in mind where a caller reads or writes it."""

    @cached_property
    def mslut(self) -> tuple[Register, ...]:
        """MSLUT[0..7], MSLUTSEL and MSLUTSTART; of a TMC5072 the same for both axes."""
        return tuple(self.get(name) for name in (*(f"MSLUT[{index}]" for index in range(8)), "MSLUTSEL", "MSLUTSTART"))

    @cached_property
    def remembered(self) -> tuple[Register, ...]:
        """What can be read and is kept in mind."""
        return (self.rampmode, self.sw_mode, self.chopconf)

    @cached_property
    def settings(self) -> tuple[Register, ...]:
        """What is kept in mind as it was written, as far as this chip can read it: most can nothing of it."""
        named = (self.find(name) for name in ("GLOBAL_SCALER", "DRV_CONF", "ENC_CONST"))
        rows = (*self.ramp.values(), self.ihold_irun, *(row for row in named if row is not None), *self.mslut)
        return tuple(row for row in rows if row.access.readable)

    def microsteps(self, chopconf: int | None) -> int:
        """Microsteps per full step, of CHOPCONF.mres; a TMC5031 has no such field, and always 256. So it is taken
        where nobody knows the word."""
        mres = self.chopconf.field_named("mres")
        if mres is None or chopconf is None:
            return TABLE_MICROSTEPS
        return TABLE_MICROSTEPS >> min(mres.unpack(chopconf), 8)

    @cached_property
    def moving(self) -> frozenset[int]:
        """Addresses a write to which may move or stop the motor, or change how it moves."""
        rows = (*self.ramp.values(), self.rampmode, self.xactual, self.xtarget, self.sw_mode)
        return frozenset(row.address for row in rows)


RAMP = ("VSTART", "A1", "V1", "AMAX", "VMAX", "DMAX", "D1", "VSTOP", "TZEROWAIT")
FURTHER = ("TVMAX", "V2", "A2", "D2")
"""Of the chips with ramps of eight points."""


@dataclass(frozen=True)
class ChipRoles:
    """The rows of a chip that belong to all of it, and those of its axes."""

    table: RegisterTable
    axes: tuple[AxisRoles, ...]

    def get(self, name: str) -> Register:
        """A row of the whole chip. Raises KeyError."""
        return self.table.get(name)

    gconf = row_named("GCONF")
    gstat = row_named("GSTAT")

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

    @cached_property
    def settings(self) -> tuple[Register, ...]:
        return tuple(row for axis in self.axes for row in axis.settings)

    def moved_by(self, register: Register) -> AxisRoles | None:
        """The axis that a write to `register` may move."""
        for rows in self.axes:
            if register.axis == rows.axis and register.access.writable and register.address in rows.moving:
                return rows
        return None

    @property
    def clears_on_read(self) -> bool:
        """Whether reading GSTAT and RAMP_STAT clears their flags; else writing 1 does."""
        return self.gstat.read_clears

    @property
    def two_axes(self) -> bool:
        return len(self.axes) > 1


@cache
def roles_of(model: str) -> ChipRoles:
    """The rows of a model. Raises KeyError."""
    table = TABLES[model]
    return ChipRoles(table, tuple(AxisRoles(table, axis) for axis in range(AXES[model])))
