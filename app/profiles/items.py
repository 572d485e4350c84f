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

from ..registers.catalog import MODELS, Model
from ..registers.model import Access, Field, Register, Space
from .families import rules_of
from .rules import ProfileRules

TableName = Literal["microstep", "driver_chain", "mslut", "user_variables"]

SUPPRESS_REPLY = 255
"""Global parameter of bank 0 after which no write could be checked any more."""
NEVER = ("interface", "pipeline")
"""Groups that are no configuration: by which address and speed a module is reached, and targets that wait."""
OTHERS_SPACES = (Space.OUTPUT, Space.PULL_UP)
"""Outputs switch what hangs on them, which no profile of a motor knows."""

SETTABLE = (Access.RW, Access.W, Access.UNKNOWN)
"""What may be set; where no source tells, a driver says whether it was seen (`ConfigurationRules.settable`)."""

FIRST = (
    *("unit_mode", "microstep_resolution", "GLOBAL_SCALER", "lp_ref_conf_rm", "lp_REF_CONF_RAMP_MODE"),
    # What v_max and a_max count in: with the dividers of power-on they would be a multiple of what is meant.
    *("pulse_div_ramp_div_usrs", "PULSE_DIV_RAMP_DIV"),
    # By which ramp: on that of power-on, none, the velocity would jump.
    "RAMPMODE",
)
LAST = ("IF_CONFIGURATION_4210", "CHOPCONF", "velocity_vstart", "START_CONF")
"""Registers that come first or last of their group."""


Key = tuple[Space, int, int]
"""Space, address, and the axis of a module's axis parameter; 0 of all others, whose address tells."""


def key_of(row: Register) -> Key:
    """What tells a register or parameter from others of its model."""
    return row.space, row.address, (row.axis or 0) if row.space is Space.AXIS else 0


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
    def key(self) -> Key:
        """What tells it from others of its model."""
        return key_of(self.row)

    @property
    def place(self) -> str:
        """For people: `V_MAX of axis 0`."""
        return place_of(self.row.name, self.row.axis)


def place_of(name: str, axis: int | None) -> str:
    """A register's name, and the axis where it has one."""
    return name if axis is None else f"{name} of axis {axis}"


def items_of(model: str) -> tuple[Item, ...]:
    """All configuration of a model, in the order in which it is safe to write. Raises KeyError."""
    return _items(MODELS[model])


def items_by_key(model: str) -> Mapping[Key, Item]:
    """The same by key."""
    return _by_key(MODELS[model])


@cache
def _items(model: Model) -> tuple[Item, ...]:
    rules = rules_of(model.name)
    found = [item for row in model.table if (item := _item(rules, row)) is not None]
    return tuple(sorted(found, key=lambda item: item.rank))


@cache
def _by_key(model: Model) -> Mapping[Key, Item]:
    return {item.key: item for item in _items(model)}


def _item(rules: ProfileRules, row: Register) -> Item | None:
    if not _is_configuration(rules, row):
        return None
    if not row.fields or all(part.when for part in row.fields):
        return Item(row, (1 << row.width) - 1, (), _table(row), _rank(rules, row))
    writable = [
        part
        for part in row.fields
        if part.access in (Access.RW, Access.W, Access.UNKNOWN) and part.name not in rules.state_fields
    ]
    fields: list[Field] = []
    taken = 0
    for part in sorted(writable, key=lambda part: bool(part.when)):  # a second meaning only of bits that have no first
        if not taken & part.mask:
            fields.append(part)
            taken |= part.mask
    if not fields:
        return None
    ordered = tuple(part for part in row.fields if part in fields)
    return Item(row, taken, ordered, _table(row), _rank(rules, row))


def _is_configuration(rules: ProfileRules, row: Register) -> bool:
    if row.access not in SETTABLE or row.when or row.name in rules.state:
        return False
    if rules.is_state is not None and rules.is_state(row):
        return False
    if row.access is Access.W and row.reset is None:  # writing it does something instead of setting something
        return False
    if row.space is Space.GLOBAL_0 and row.address == SUPPRESS_REPLY:
        return False
    return row.group not in NEVER and row.space not in OTHERS_SPACES


def _table(row: Register) -> TableName | None:
    if row.group == "microstep table RAM":
        return "microstep"
    if row.group == "driver chain RAM":
        return "driver_chain"
    if row.space is Space.GLOBAL_2:
        return "user_variables"
    if row.group == "microsteps" and row.name.startswith(("MSLUT", "START_SIN")):
        return "mslut"
    return None


def _rank(rules: ProfileRules, row: Register) -> tuple[int, int, int, int]:
    order = rules.order
    group = order.index(row.group) if row.group in order else len(order)
    within = FIRST.index(row.name) - len(FIRST) if row.name in FIRST else int(row.name in LAST)
    return group, -1 if row.axis is None else row.axis, within, row.address
