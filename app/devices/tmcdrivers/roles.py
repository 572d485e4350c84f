"""Registers that the driver itself needs, by their roles."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from ...registers.catalog import Model
from ...registers.model import Field, Register
from ..core.row_named import row_named, row_named_if_any

FINEST = 256
"""Microsteps a full step of the microstep table, and of TSTEP."""
STANDS = (1 << 20) - 1
"""TSTEP at standstill."""
BY_PINS = (8, 32, 64, 16)
"""Microsteps a full step by MS1 (1) and MS2 (2) (DS-TMC2209 3.2)."""


@dataclass(frozen=True)
class DriverRoles:
    """The rows of one driver."""

    model: Model

    def find(self, name: str) -> Register | None:
        """A row that only some of the drivers have."""
        found = self.model.table.find(name, 0)
        return found[0] if found is not None and found[1] is None else None

    def get(self, name: str) -> Register:
        """A row that all of the drivers have. Raises KeyError."""
        return self.model.table.get(name, 0)

    gconf = row_named("GCONF")
    gstat = row_named("GSTAT")
    inputs = row_named("IOIN")
    """Pins and VERSION."""

    @cached_property
    def disable_pin(self) -> str:
        """The bit of `inputs` that is 1 while a pin switches the bridges off."""
        return _pin(self.inputs, "ENN")

    @cached_property
    def direction_pin(self) -> Field:
        """The bit of `inputs` that is 1 while the motor is stepped the other way."""
        return part(self.inputs, _pin(self.inputs, "DIR"))

    chopconf = row_named("CHOPCONF")
    ihold_irun = row_named("IHOLD_IRUN")
    vactual = row_named_if_any("VACTUAL")
    """None where the driver turns by STEP alone."""
    tstep = row_named("TSTEP")
    scaler = row_named_if_any("GLOBAL_SCALER")
    """None where vsense takes its place."""

    @cached_property
    def current_range(self) -> tuple[Register, Field] | None:
        """The register and field of the range of full scale, of those that have several."""
        row = self.find("DRV_CONF")
        field = None if row is None else row.field_named("CURRENT_RANGE")
        return None if row is None or field is None else (row, field)

    drv_status = row_named("DRV_STATUS")
    mscnt = row_named("MSCNT")
    mscuract = row_named("MSCURACT")

    @cached_property
    def mslut(self) -> tuple[Register, ...]:
        """The microstep table in the order of its addresses; none where the chip has a fixed one."""
        names = (*(f"MSLUT[{n}]" for n in range(8)), "MSLUTSEL", "MSLUTSTART")
        return tuple(row for name in names if (row := self.find(name)) is not None)

    @cached_property
    def sine(self) -> tuple[str, str]:
        """The fields of `mscuract` that have the sine and the cosine of the microstep table."""
        low, high = sorted(self.mscuract.fields, key=lambda each: each.lsb)
        return low.name, high.name

    @cached_property
    def stalled(self) -> Field | None:
        """The bit that tells of a stall; None of a driver that shows it at a pin alone."""
        return self.drv_status.field_named("StallGuard")

    @cached_property
    def load(self) -> tuple[Register, Field | None]:
        """StallGuard's value: a register of its own, or a field."""
        own = self.find("SG_RESULT")
        if own is not None:
            return own, None
        return self.drv_status, self.drv_status.field_named("SG_RESULT")

    @cached_property
    def remembered(self) -> tuple[Register, ...]:
        """What can be read and decides what other numbers mean."""
        more = (self.ihold_irun, self.scaler, None if self.current_range is None else self.current_range[0])
        return (self.gconf, self.chopconf, *(row for row in more if row is not None and row.access.readable))

    def microsteps(self, gconf: int, chopconf: int, inputs: int) -> int:
        """Microsteps a full step, by CHOPCONF.mres or the pins."""
        chosen = self.gconf.field_named("mstep_reg_select")
        if chosen is not None and not chosen.unpack(gconf):
            pins = self.inputs.unpack(inputs)
            return BY_PINS[pins["MS1"] | pins["MS2"] << 1]
        return FINEST >> min(part(self.chopconf, "mres").unpack(chopconf), 8)


def _pin(inputs: Register, name: str) -> str:
    """The bit of a pin, whatever else the pin is."""
    return next(each.name for each in inputs.fields if name in each.name.upper().split("_"))


def part(register: Register, name: str) -> Field:
    """A field that the register has."""
    found = register.field_named(name)
    if found is None:
        raise KeyError(f"{register.name} has no field {name}")
    return found
