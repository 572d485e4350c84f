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
        return next(part.name for part in self.inputs.fields if part.name.upper().split("_")[-1] == "ENN")

    chopconf = row_named("CHOPCONF")
    ihold_irun = row_named("IHOLD_IRUN")
    vactual = row_named_if_any("VACTUAL")
    """None where the driver turns by STEP alone."""
    tstep = row_named("TSTEP")
    drv_status = row_named("DRV_STATUS")
    mscnt = row_named("MSCNT")
    mscuract = row_named("MSCURACT")

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
        return (self.gconf, self.chopconf)

    def microsteps(self, gconf: int, chopconf: int, inputs: int) -> int:
        """Microsteps a full step, by CHOPCONF.mres or the pins."""
        chosen = self.gconf.field_named("mstep_reg_select")
        if chosen is not None and not chosen.unpack(gconf):
            pins = self.inputs.unpack(inputs)
            return BY_PINS[pins["MS1"] | pins["MS2"] << 1]
        return FINEST >> min(part(self.chopconf, "mres").unpack(chopconf), 8)


def part(register: Register, name: str) -> Field:
    """A field that the register has."""
    found = register.field_named(name)
    if found is None:
        raise KeyError(f"{register.name} has no field {name}")
    return found
