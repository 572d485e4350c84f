"""Which registers and parameters are configuration, and in which order they are safe to write.

Configuration is what makes another chip of its kind behave like this one. Where the motor is, what it was last told to
do, flags, what happens once as it is written, and what cannot be undone are not; neither is what only the individual
has (the trim of its oscillator) or what would cut the connection that it is written through.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import Literal

from ..registers.catalog import MODELS
from ..registers.model import Access, Field, Register, Space

TableName = Literal["microstep", "driver_chain", "mslut", "user_variables"]

STATE: Mapping[str, frozenset[str]] = {
    "tmc428": frozenset({"x_target", "x_actual", "v_target", "v_actual", "cover_datagram"}),
    "tmc4210": frozenset({"X_TARGET", "X_ACTUAL", "V_TARGET", "V_ACTUAL", "USTEP_COUNT_4210"}),
    "tmc4361": frozenset(
        {"XACTUAL", "XTARGET", "ENC_POS", "RESET_CLK_GATING", "X_HOME", "ADDR_TO_ENC", "DATA_TO_ENC"}
        | {"COVER_LOW", "COVER_HIGH", *(f"X_PIPE{index}" for index in range(8))}
    ),
    # RAMPMODE is the last command: every move and every stop writes it. NODECONF and SLAVECONF are by which address a
    # UART reaches the chip.
    "tmc5xxx": frozenset(
        {"XACTUAL", "XTARGET", "X_ENC", "RAMPMODE", "OTP_PROG", "FACTORY_CONF", "TEST_SEL", "NODECONF", "SLAVECONF"}
        | {"OUTPUT"}
    ),
    "pd42-1241": frozenset(
        {"target_position", "actual_position", "target_speed", "encoder_position", "encoder_clear_on_null"}
        # Lifting the protection erases the program; the tick and the dice are never what they were.
        | {"external_encoder_position", "tmcl_code_protection", "tmcl_tick_timer", "random_number"}
    ),
}
"""By family: registers that can be written, but are state, happen once, or belong to the individual."""
STATE_FIELDS: Mapping[str, frozenset[str]] = {
    # Regulation is switched by the closed loop's own procedure, which calibrates first.
    "tmc4361": frozenset({"OPERATION_MODE", "start_home_tracking", "clr_latch_once_on_n", "cl_calibration_en"})
    | {"regulation_modus"},
    # A lock cannot be taken back but by a reset.
    "tmc5xxx": frozenset({"clr_once", "lock_gconf", "test_mode"}),
}
"""By family: fields of which the same is true."""
SUPPRESS_REPLY = 255
"""Global parameter of bank 0 after which no write could be checked any more."""
NEVER = ("interface", "pipeline")
"""Groups that are no configuration: by which address and speed a module is reached, and targets that wait."""
OTHERS_SPACES = (Space.OUTPUT, Space.PULL_UP)
"""Outputs switch what hangs on them, which no profile of a motor knows."""

RANKS: Mapping[str, str] = {
    # RAM first: while it is noise, a datagram to the driver chain may never end (DS-TMC428 chapter 11). The mode
    # before the dividers: a new pulse_div in another than RAMP_MODE may force a microstep (DS-TMC428 8.14).
    "tmc428": "driver chain RAM, microstep table RAM, global, driver chain, current, motion, switches",
    "tmc4210": "step/dir, global, motion, switches, position compare",
    # In which units accelerations count (GENERAL_CONF) and the clock before the ramp; what starts by a signal last.
    "tmc4361": "general, clock, current, driver, spi output, pwm, step/dir, microsteps, ramp, filters, reference, "
    "serial encoder, encoder, pid, closed loop, shadow, events, start",
    # Currents before the chopper that lets them flow (CHOPCONF.toff).
    "tmc5xxx": "current, microsteps, general, ramp, thresholds, stealthchop, driver, encoder, switches",
    # In which units speeds count first of all.
    "pd42-1241": "motor, current, chopper, stealthchop, coolstep, stallguard, ramp, motion, encoder, switches, "
    "reference search, interrupts, application, coordinates, variables, step/dir",
}
"""By family: groups of registers in the order in which they are written; those that are not named follow."""
FIRST = (
    *("unit_mode", "microstep_resolution", "GLOBAL_SCALER", "lp_ref_conf_rm", "lp_REF_CONF_RAMP_MODE"),
    # What v_max and a_max count in: with the dividers of power-on they would be a multiple of what is meant.
    *("pulse_div_ramp_div_usrs", "PULSE_DIV_RAMP_DIV"),
    # By which ramp: on that of power-on, none, the velocity would jump.
    "RAMPMODE",
)
LAST = ("IF_CONFIGURATION_4210", "CHOPCONF", "velocity_vstart", "START_CONF")
"""Registers that come first or last of their group."""


@dataclass(frozen=True, slots=True)
class Item:
    """A register or parameter that belongs to a profile."""

    row: Register
    mask: int
    """Bits of its word that are configuration; the others stay as the device has them."""
    fields: tuple[Field, ...]
    """Fields that are configuration; none of a register without fields."""
    table: TableName | None
    """The table that it is a part of in a document."""
    rank: tuple[int, int, int, int]
    """Where it comes in the order of writing."""

    @property
    def key(self) -> tuple[Space, int]:
        """What tells it from others of its model."""
        return self.row.space, self.row.address

    @property
    def place(self) -> str:
        """For people: `V_MAX of axis 0`."""
        return place_of(self.row.name, self.row.axis)


def place_of(name: str, axis: int | None) -> str:
    """A register's name, and the axis where it has one."""
    return name if axis is None else f"{name} of axis {axis}"


def family_of(model: str) -> str:
    """The key of the tables above. Raises KeyError for an unknown model."""
    return "tmc5xxx" if MODELS[model].name.startswith("tmc5") else model


@cache
def items_of(model: str) -> tuple[Item, ...]:
    """All configuration of a model, in the order in which it is safe to write. Raises KeyError."""
    family = family_of(model)
    found = [item for row in MODELS[model].table if (item := _item(family, row)) is not None]
    return tuple(sorted(found, key=lambda item: item.rank))


@cache
def items_by_key(model: str) -> Mapping[tuple[Space, int], Item]:
    """The same by space and address."""
    return {item.key: item for item in items_of(model)}


def _item(family: str, row: Register) -> Item | None:
    if not _is_configuration(family, row):
        return None
    state = STATE_FIELDS.get(family, frozenset())
    if not row.fields or all(part.when for part in row.fields):
        return Item(row, (1 << row.width) - 1, (), _table(family, row), _rank(family, row))
    writable = [part for part in row.fields if part.access in (Access.RW, Access.W) and part.name not in state]
    fields: list[Field] = []
    taken = 0
    for part in sorted(writable, key=lambda part: bool(part.when)):  # a second meaning only of bits that have no first
        if not taken & part.mask:
            fields.append(part)
            taken |= part.mask
    if not fields:
        return None
    ordered = tuple(part for part in row.fields if part in fields)
    return Item(row, taken, ordered, _table(family, row), _rank(family, row))


def _is_configuration(family: str, row: Register) -> bool:
    if row.access not in (Access.RW, Access.W) or row.when or row.name in STATE[family]:
        return False
    if row.access is Access.W and row.reset is None:  # writing it does something instead of setting something
        return False
    if row.space is Space.GLOBAL_0 and row.address == SUPPRESS_REPLY:
        return False
    return row.group not in NEVER and row.space not in OTHERS_SPACES


def _table(family: str, row: Register) -> TableName | None:
    if row.group == "microstep table RAM":
        return "microstep"
    if row.group == "driver chain RAM":
        return "driver_chain"
    if row.space is Space.GLOBAL_2:
        return "user_variables"
    if row.group == "microsteps" and row.name.startswith(("MSLUT", "START_SIN")):
        return "mslut"
    return None


def _rank(family: str, row: Register) -> tuple[int, int, int, int]:
    order = RANKS[family].split(", ")
    group = order.index(row.group) if row.group in order else len(order)
    within = FIRST.index(row.name) - len(FIRST) if row.name in FIRST else int(row.name in LAST)
    return group, -1 if row.axis is None else row.axis, within, row.address
