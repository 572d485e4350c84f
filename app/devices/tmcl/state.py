"""A module as it was last seen: which one it is, what its parameters hold, and what its numbers count in."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from types import MappingProxyType

from ...calc.positions.extended import Counter
from ...calc.units.mechanics import Mechanics
from ...errors import BenchError
from ...registers.model import Register, Space
from ...registers.tmcl.modules import MODULES
from ..core.limit_rules.quantities import COORDINATES
from ..core.lookup import Lookup
from ..core.results import DeviceState
from ..core.session import Session
from ..core.tmcl_calls import Lacking
from .program_events import ProgramEvents
from .roles import RegisterRoles
from .units import SCALINGS


class ModuleState:
    """What is known of one module. Nothing here asks it anything: every answer that a caller gets is told to `saw`."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self.module = MODULES[session.model]
        """What this one is."""
        self.scaling = SCALINGS[self.module.counting]
        self.wrap = Counter(self.module.position_bits)
        """The position counter, which wraps."""
        self.roles = RegisterRoles(self.module)
        self.table = session.family.table
        self.find = Lookup(self.table, session.family.axes)
        self.firmware = ""
        """As the module tells it, e.g. "1.44"; empty before it was asked."""
        self.lacking = Lacking(self.roles.absent, self.roles.instead)
        """Rows that this module does not have; what its firmware has answered is forgotten when the link fails."""
        self.program_started = False
        """Whether a program was started from here and not stopped since: it may start the motor again."""
        self.program = ProgramEvents(session)
        self.saw_hooks: list[Callable[[Register, int], None]] = []
        """Parts that act on a value, each time that one was seen."""
        self._known: dict[int, int] = {}
        self.known: Mapping[int, int] = MappingProxyType(self._known)
        """Axis parameters as last seen, by number; forgotten when the link fails."""

    # --- what its parameters hold ---------------------------------------------------------------

    def last(self, register: Register) -> int | None:
        """An axis parameter as last seen; None where it was not seen yet, or is forgotten."""
        return self._known.get(register.address)

    def axis_row(self, number: int) -> Register | None:
        """The row of an axis parameter; None where there is none of that number."""
        return self.table.at(number, Space.AXIS)

    def saw(self, register: Register, value: int) -> None:
        """The module was seen to hold `value`."""
        limiter = self._session.limiter
        if limiter is not None and register.space in (Space.AXIS, Space.COORDINATE):
            base = 0 if register.space is Space.AXIS else COORDINATES
            limiter.saw(base + register.address, value)
        if register.space is Space.AXIS:
            self._known[register.address] = value
            if register in self.roles.counting:
                self._tell_dividers()
            if register is self.roles.microsteps:
                self._session.axes[0].microsteps_per_full_step = self.microsteps
        for hook in self.saw_hooks:
            hook(register, value)

    def _tell_dividers(self) -> None:
        """Have the axis say what its speeds count by, where that is dividers."""
        if self.module.counting == "dividers":
            self._session.axes[0].pulse_div, self._session.axes[0].ramp_div = self.counted_by

    def forget(self, numbers: Iterable[int]) -> None:
        """Axis parameters of which nobody knows any more what they are."""
        for number in numbers:
            self._known.pop(number, None)

    def on_state(self, state: DeviceState, problem: BenchError | None) -> None:
        """`Session.state_hooks`: where the link failed, it may be another module when that comes back, or the same
        after a power-on."""
        del problem
        if state == "failed":
            self.lacking.clear()
            self._known.clear()

    @property
    def questions(self) -> int:
        """How many questions one reading of the axis takes."""
        return len(self.roles.state)

    # --- what its numbers count in --------------------------------------------------------------

    @property
    def unit_mode(self) -> int | None:
        """AP 255; None where not seen yet, and of a module that has none."""
        return self.last(self.roles.unit_mode)

    @property
    def counted_by(self) -> tuple[int | None, ...]:
        """The parameters that speeds and accelerations count by; None where not seen yet."""
        return tuple(self.last(row) for row in self.roles.counting)

    @property
    def speed_unit_pps(self) -> float:
        """What a speed of 1 is as the module is set [pps]."""
        return self.scaling.speed_unit_pps(self._session.clock_hz, self.counted_by)

    @property
    def acceleration_unit_pps2(self) -> float:
        """What an acceleration of 1 is as the module is set [pps^2]."""
        return self.scaling.acceleration_unit_pps2(self._session.clock_hz, self.counted_by)

    @property
    def microsteps(self) -> int:
        """Microsteps per full step, of AP 140; as it comes from the factory while not seen."""
        return 1 << min(8, max(0, self._known.get(self.roles.microsteps.address, 8)))

    def mechanics(self, axis: int) -> Mechanics:
        """Conversions of an axis as the module is set: full steps are the module's own (AP 202) where it knows them.

        Gear and travel come from the connection's settings of the axis, as for any other device.
        """
        settings = self._session.axes[axis].settings
        full_steps = self.last(self.roles.full_steps) or settings.full_steps_per_rev
        return Mechanics(full_steps, self.microsteps, settings.gear_ratio, travel_mm_per_rev=settings.travel_mm_per_rev)
