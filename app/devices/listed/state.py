"""A module as it was last seen: the standard parameters of its axes, and what its firmware lacks."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from ...calc.units.mechanics import Mechanics
from ...errors import BenchError
from ...registers.listed.modules import role_of
from ...registers.model import Register, Space
from ..core.lookup import Lookup
from ..core.results import DeviceState
from ..core.session import Session
from ..core.tmcl_calls import Lacking

COUNTER_BITS = 32
"""Of the position counter: what a TMCL value holds."""
AXIS_SHIFT = 12
"""Limits know parameters by one number: that of the parameter, and above it the axis."""


def limit_address(axis: int, number: int) -> int:
    """What limits call an axis parameter."""
    return axis << AXIS_SHIFT | number


@dataclass(frozen=True, slots=True)
class AxisRoles:
    """The parameters of one axis that TMCL's standard meaning makes something of."""

    target_position: Register
    position: Register
    target_speed: Register
    speed: Register
    max_speed: Register
    max_acceleration: Register
    position_reached: Register | None = None

    @property
    def polled(self) -> tuple[Register, ...]:
        """What tells how an axis is: position first, then speed, target, target speed and arrival."""
        always = (self.position, self.speed, self.target_position, self.target_speed)
        return always if self.position_reached is None else (*always, self.position_reached)

    @property
    def moving(self) -> tuple[Register, ...]:
        """What a write to may set the axis in motion."""
        return self.target_position, self.target_speed, self.position


class ListedState:
    """What is known of one module. Nothing here asks it anything: every answer that a caller gets is told to `saw`."""

    unit_mode = None
    """The package does not tell what speeds count in."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self.table = session.family.table
        self.find = Lookup(self.table, session.family.axes)
        self.axes = tuple(self._axis_roles(axis) for axis in range(session.family.axes))
        self.lacking = Lacking()
        self.firmware = ""
        """As the module tells it, e.g. "1.44"; empty before it was asked."""
        self.calls_itself = ""
        """What it says that it is, where that is not what its title says."""
        self.saw_hooks: list[Callable[[Register, int], None]] = []
        self._known: dict[tuple[int, int], int] = {}
        self._taken: set[tuple[Space, int | None, int]] = set()

    def _axis_roles(self, axis: int) -> AxisRoles:
        return AxisRoles(**{role: row for row in self.table if row.axis == axis and (role := role_of(row)) is not None})

    @property
    def questions(self) -> int:
        """How many questions one reading of an axis takes."""
        return len(self.axes[0].polled)

    def last(self, register: Register) -> int | None:
        """An axis parameter as last seen; None where it was not seen yet, or is forgotten."""
        return self._known.get((register.axis or 0, register.address))

    def known(self, address: int) -> int | None:
        """The same by what limits call it."""
        return self._known.get((address >> AXIS_SHIFT, address & (1 << AXIS_SHIFT) - 1))

    def moves(self, register: Register) -> bool:
        """Whether a write to `register` may set an axis in motion, as far as standard names tell."""
        return register.axis is not None and register in self.axes[register.axis].moving

    def saw(self, register: Register, value: int) -> None:
        """The module was seen to hold `value`."""
        if register.space is Space.AXIS:
            axis = register.axis or 0
            self._known[axis, register.address] = value
            if self._session.limiter is not None:
                self._session.limiter.saw(limit_address(axis, register.address), value)
        for hook in self.saw_hooks:
            hook(register, value)

    def took(self, register: Register) -> None:
        """A write of it was read back."""
        self._taken.add((register.space, register.axis, register.address))

    def has_taken(self, register: Register) -> bool:
        """Whether this module, with this firmware, was seen to take a write of it."""
        return (register.space, register.axis, register.address) in self._taken

    def answered(self, firmware: str) -> None:
        """It told its firmware: of another one nothing has been seen yet."""
        if firmware != self.firmware:
            self._taken.clear()
        self.firmware = firmware

    def forget(self, axis: int, number: int) -> None:
        """Nobody knows any more what an axis parameter holds."""
        self._known.pop((axis, number), None)

    def on_state(self, state: DeviceState, problem: BenchError | None) -> None:
        """`Session.state_hooks`: where the link failed, it may be another module when that comes back."""
        del problem
        if state == "failed":
            self.lacking.clear()
            self._known.clear()

    def mechanics(self, axis: int) -> Mechanics:
        """Conversions of an axis: what a count is the module does not tell, so it is taken for a microstep of 256."""
        settings = self._session.axes[axis].settings
        return Mechanics(
            settings.full_steps_per_rev, 256, settings.gear_ratio, travel_mm_per_rev=settings.travel_mm_per_rev
        )
