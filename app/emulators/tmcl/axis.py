"""The axis as TMCL sees it: motion, axis parameters, and what the firmware does about events (FM-PD42-1241 3.6, 4)."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from functools import partial

from ...calc.positions.extended import Counter
from ...registers.model import Access
from ...registers.tmcl.commands import DriverErrors, ExtendedErrors
from ..drive import Drive, Event, EventKind
from . import units
from .application import wrapped
from .models import Played
from .parameters import (
    ACCELERATION,
    DOUBLE_EDGE,
    RAMP_MODE,
    SEARCH_MODE,
    SEARCH_SPEED,
    SPEED,
    STEP_DIR,
    SWITCH_SPEED,
    TARGET_SPEED,
    Configuration,
)
from .refused import invalid_value, wrong_type
from .search import PHASE_TEXTS, RIGHT, WATCHED, Phase, Search

Reader = Callable[[], int]

POSITIONING, FORWARDS, BACKWARDS = 0, 1, 2
"""Values of RAMPMODE."""
_EVENT_STOP_SG = 1 << 6
_FASTEST = 0xFFFF
_ALWAYS_WATCHED = EventKind.STALL_STOP | EventKind.DEVIATION_INTERNAL | EventKind.DEVIATION_EXTERNAL
LAST_TARGET, ACTUAL_POSITION = 0, 1
"""Values of parameter 127."""
RELATIVE_TO = 127
IN_POSITION, IN_VELOCITY = 0, 2
"""Values of parameter 138."""
_TURN = 1024


class Axis:
    """One axis. Commands come as method calls, GAP through `readers`, news of the drive through `happened`."""

    def __init__(
        self,
        played: Played,
        drive: Drive,
        configuration: Configuration,
        kept: Mapping[int, int],
        unknown: Collection[int] = (),
    ) -> None:
        """`kept` are parameters that the EEPROM holds; `unknown` are those that this firmware does not have."""
        self.drive = drive
        self.parameters = played.parameters(
            played.module, drive, lambda: None if self.search is None else self.search.stops, configuration
        )
        self._kept = kept
        self._counter = Counter(played.module.position_bits)
        self._also_watched = EventKind(0)
        self.search: Search | None = None
        self.errors = 0
        """Axis parameter 207."""
        self.arrived: Callable[[int], None] = lambda clocks: None
        """Called when an MVP for which an event was wanted has arrived, with the chip's time then [clocks]."""
        self.readers: list[Reader | None] = self._readers()
        """GAP by parameter number; None where there is none."""
        self._unknown = frozenset(unknown)
        for number in self._unknown:
            self.readers[number] = None
        self.power_on()

    def power_on(self) -> None:
        """All parameters at their defaults, nothing moves."""
        self.search = None
        self.errors = 0
        self.end_switch_distance = self.last_reference = 0
        self.event_wanted = self.event_every = self.event_due = False
        self.parameters.positioning = False
        rows = self.parameters.rows
        self.parameters.power_on(
            {
                number: value
                for number, value in self._kept.items()
                if number in rows and rows[number].stored and rows[number].minimum <= value <= rows[number].maximum
            }
        )
        self._rest()
        self._watch()

    # --- motion commands -------------------------------------------------------------------------

    def rotate(self, velocity: int) -> None:
        """ROR, ROL, MST and parameter 2: `velocity` in the user's unit, positive counts up.

        Raises Refused (status 4) beyond the range of parameter 2. In step/direction mode nothing happens
        (FM-PD42-1241 6.4).
        """
        self.parameters.check(TARGET_SPEED, velocity)
        if not self._begin():
            return
        self.parameters.keep(TARGET_SPEED, velocity)
        self._turn(self.parameters.in_chip_units(TARGET_SPEED))

    def move(self, target: int) -> None:
        """MVP and parameter 0. Raises Refused (status 4) where `target` is beyond the counter."""
        if self._counter.shows(target) != target:
            raise invalid_value()
        if not self._begin():
            return
        self._go(target, self.parameters.in_chip_units(SPEED))
        self.event_due = self.event_wanted
        self.event_wanted = self.event_wanted and self.event_every
        self._watch()
        if self.event_due and self.position == target and self.standing:
            self._arrive()

    def relative_base(self) -> int:
        """What MVP REL counts from: parameter 127, and without that the position."""
        if self.parameters.values.get(RELATIVE_TO, ACTUAL_POSITION) == ACTUAL_POSITION:
            return self.position
        return self.target

    def request_event(self, every: bool, on: bool) -> None:
        """Command 138: tell when the next MVP, or every one from now on, has arrived."""
        self.event_wanted, self.event_every = on, every

    def start_search(self) -> None:
        """RFS START."""
        if not self._begin():
            return
        self.search = Search(self, self.parameters.values[SEARCH_MODE])
        self.parameters.apply_switches()
        self._watch()
        self._advance_search()

    def stop_search(self) -> None:
        """RFS STOP: the motor slows down."""
        if self.search is not None:
            self._end_search()
            self._rest()

    def feed_pulses(self, pulses: int, rate_hz: float) -> None:
        """Pulses on the step input; without step/direction mode nobody listens.

        The input counts at once and without ramp, so here it is a move without one; with parameter 161 both edges of
        a pulse count. On which counter the module shows them is open; it is parameter 1.
        """
        if not self.parameters.values[STEP_DIR]:
            return
        self._forgive()
        edges = 2 if self.parameters.values[DOUBLE_EDGE] else 1
        pulses, rate_hz = edges * pulses, edges * rate_hz
        rate = max(units.velocity_to_chip(round(rate_hz)), 1)
        write = self.drive.write
        for register in ("A1", "AMAX", "DMAX", "D1"):
            write(register, _FASTEST)
        write("V1", 0)
        write("VSTART", min(rate, (1 << 18) - 1))
        write("VSTOP", min(rate, (1 << 18) - 1))
        base = self.drive.read("XTARGET") if self.parameters.positioning else self.position
        self._go(wrapped(base + pulses), rate)

    # --- parameters ------------------------------------------------------------------------------

    def set(self, number: int, value: int) -> None:
        """SAP, AAP. Raises Refused: status 3 for a parameter that cannot be written, 4 for the value."""
        if number in self._unknown:
            raise wrong_type()
        self.parameters.check(number, value)
        if number == 0:
            self.move(value)
        elif number == 1:
            self._place(value)
        elif number == 2:
            self.rotate(value)
        elif number == 209:
            self.drive.internal.position = value
        elif number == RAMP_MODE:
            self._switch_mode(value)
        elif number == 210 and self.parameters.NULL_SWITCH:
            self.drive.internal.clear_on_null = bool(value)
        elif number == 216:
            self.drive.external.position = value
        else:
            if number == STEP_DIR:
                self._switch_step_dir(bool(value))
            self.parameters.write(number, value)

    def storable(self, number: int) -> int:
        """What STAP keeps of a parameter. Raises Refused (status 3) for one that cannot be kept."""
        row = self.parameters.rows.get(number)
        reader = self.readers[number]
        if row is None or reader is None or row.stored != "on request":
            raise wrong_type()
        return reader()

    @property
    def position(self) -> int:
        """As the module's counter shows it, which may have fewer bits than the drive's."""
        return self._counter.shows(self.drive.read("XACTUAL"))

    @property
    def position_bits(self) -> int:
        """Of that counter."""
        return self._counter.bits

    @property
    def target(self) -> int:
        """The same of the latest target."""
        return self._counter.shows(self.drive.read("XTARGET"))

    @property
    def standing(self) -> bool:
        return self.drive.read("VACTUAL") == 0

    @property
    def phase_text(self) -> str:
        """What the reference search does; empty while none runs."""
        return PHASE_TEXTS[self.search.phase if self.search else Phase.NONE]

    # --- what a search does (`Searched`) ---------------------------------------------------------

    def turn(self, direction: int, fast: bool) -> None:
        self._turn(direction * self.parameters.in_chip_units(SEARCH_SPEED if fast else SWITCH_SPEED))

    def halt(self) -> None:
        self._turn(0)

    def go(self, position: int) -> None:
        self._go(position, self.parameters.in_chip_units(SWITCH_SPEED))

    def stop_switch(self, side: int) -> bool:
        return bool(self.drive.read("RAMP_STAT") >> (1 if side == RIGHT else 0) & 1)

    def home_switch(self) -> bool:
        return self.drive.switches.home

    # --- news of the drive -----------------------------------------------------------------------

    def happened(self, event: Event) -> None:
        """What the firmware does about an event: stop, tell, or go on with the search."""
        kinds = event.kinds
        if kinds & EventKind.STALL_STOP:
            self._fail(ExtendedErrors.STALL)
        if kinds & (EventKind.DEVIATION_INTERNAL | EventKind.DEVIATION_EXTERNAL):
            self._fail(ExtendedErrors.DEVIATION)
        if kinds & EventKind.POSITION_REACHED and self.event_due:
            self._arrive()
        if self.search is not None:
            self._advance_search()

    def also_watch(self, kinds: EventKind) -> None:
        """Have the drive stop at these events as well."""
        if kinds != self._also_watched:
            self._also_watched = kinds
            self._watch()

    def stop(self) -> None:
        """Slow down to a stop, whatever the axis does: MST, or a heartbeat that failed to come."""
        if self._begin():
            self._rest()

    # --- within ----------------------------------------------------------------------------------

    def _begin(self) -> bool:
        """Before any motion command: the errors of the last motion are forgotten. False in step/direction mode."""
        if self.parameters.values[STEP_DIR]:
            return False
        self._end_search()
        self._forgive()
        self.event_due = False
        self._watch()
        return True

    def _forgive(self) -> None:
        self.errors = 0
        self.drive.write("RAMP_STAT", _EVENT_STOP_SG)
        self.drive.internal.exceeded = False
        self.drive.external.exceeded = False

    def _turn(self, velocity: int) -> None:
        """Velocity mode [ramp units]."""
        self.parameters.positioning = False
        self.drive.write("VMAX", abs(velocity))
        self.drive.write("RAMPMODE", FORWARDS if velocity >= 0 else BACKWARDS)

    def _go(self, target: int, velocity: int) -> None:
        """Positioning mode, at most `velocity` [ramp units]."""
        self.parameters.positioning = True
        here = self.drive.read("XACTUAL")
        self.drive.write("XTARGET", wrapped(here + self._counter.way(target, here)))
        self.drive.write("VMAX", velocity)
        self.drive.write("RAMPMODE", POSITIONING)

    def _rest(self) -> None:
        self.parameters.keep(TARGET_SPEED, 0)
        self._turn(0)

    def _place(self, position: int) -> None:
        """Say where the motor is. The target goes along, or the motor would run there at once."""
        self.drive.write("XTARGET", position)
        self.drive.write("XACTUAL", position)

    def _fail(self, why: ExtendedErrors) -> None:
        """The drive has stopped the motor: it stays so until the next motion command."""
        self._end_search()
        self.event_due = False
        self.errors |= why
        self._rest()
        self._watch()

    def _arrive(self) -> None:
        self.event_due = False
        self._watch()
        self.arrived(self.drive.clocks)

    def _advance_search(self) -> None:
        search = self.search
        if search is None:
            return
        search.advance()
        if not search.done:
            return
        self._end_search()
        self.last_reference = search.reference
        if search.distance is not None:
            self.end_switch_distance = search.distance
        self._place(self.position - search.reference)
        self.drive.internal.position = self.drive.external.position = self.position
        self._rest()

    def _end_search(self) -> None:
        if self.search is not None:
            self.search = None
            self.parameters.apply_switches()
            self._watch()

    def _watch(self) -> None:
        """Be woken only for what is waited for: an event ends a stretch of compiled time."""
        watch = _ALWAYS_WATCHED | self._also_watched
        if self.event_due:
            watch |= EventKind.POSITION_REACHED
        if self.search is not None:
            watch |= WATCHED
        self.drive.watch = watch

    def _switch_mode(self, mode: int) -> None:
        """Parameter 138 by hand: towards the latest target, or at the latest target speed."""
        if mode == IN_VELOCITY:
            self.rotate(self.parameters.shown[TARGET_SPEED])
        else:  # the soft mode's exponential approach is not made
            self.move(self.target)

    def _switch_step_dir(self, on: bool) -> None:
        """Into step/direction mode the motor stops; out of it the ramp is the parameters' again."""
        if on:
            self.stop()
        elif self.parameters.values[STEP_DIR]:
            self.parameters.apply_ramp()
            self._rest()

    # --- GAP -------------------------------------------------------------------------------------

    def _readers(self) -> list[Reader | None]:
        drive, parameters, read = self.drive, self.parameters, self.drive.read
        table: list[Reader | None] = [None] * 256
        live: dict[int, Reader] = {
            0: lambda: self.target,
            1: lambda: self.position,
            2: partial(self._shown, TARGET_SPEED),
            3: lambda: parameters.speed_shown(read("VACTUAL")),
            8: lambda: int(read("XACTUAL") == read("XTARGET")),  # RAMP_STAT has it too, and costs three times as much
            9: lambda: int(drive.switches.home),
            10: lambda: read("RAMP_STAT") >> 1 & 1,
            11: lambda: read("RAMP_STAT") & 1,
            29: self._measured_speed,
            135: self._acceleration,
            RAMP_MODE: lambda: IN_POSITION if parameters.positioning else IN_VELOCITY,
            180: lambda: read("DRV_STATUS") >> 16 & 0x1F,
            189: lambda: read("PWM_SCALE") & 0xFF,
            190: lambda: read("DRV_STATUS") >> 14 & 1,
            196: lambda: self.end_switch_distance,
            197: lambda: self.last_reference,
            206: lambda: read("DRV_STATUS") & 0x3FF,
            207: self._read_errors,
            208: self._driver_errors,
            209: lambda: self._counter.shows(drive.internal.position),
            210: lambda: int(drive.internal.clear_on_null),
            215: lambda: drive.internal.absolute * _TURN // drive.options.encoders.internal_counts,
            216: lambda: self._counter.shows(drive.external.position),
        }
        if not parameters.NULL_SWITCH:
            del live[210]
        for number, row in parameters.rows.items():
            if number in live:
                table[number] = live[number]
            elif row.access is Access.R:
                raise KeyError(f"nobody tells axis parameter {number}")
            elif parameters.counts(number):
                table[number] = partial(self._shown, number)
            else:
                table[number] = partial(parameters.values.__getitem__, number)
        return table

    def _shown(self, number: int) -> int:
        return self.parameters.shown[number]

    def _measured_speed(self) -> int:
        return self.parameters.speed_shown(
            units.measured_velocity(self.drive.read("TSTEP"), self.parameters.microsteps)
        )

    def _acceleration(self) -> int:
        """What it accelerates or brakes by now: nothing at rest and at the speed that it is to have."""
        speed = abs(self.drive.read("VACTUAL"))
        return 0 if speed in (0, self.drive.read("VMAX")) else self.parameters.shown[ACCELERATION]

    def _read_errors(self) -> int:
        errors, self.errors = self.errors, 0
        return errors

    def _driver_errors(self) -> int:
        """DRV_STATUS 31..24. It has no bit for undervoltage: bridges that are off show as open coils."""
        flags = self.drive.read("DRV_STATUS") >> 24 & 0xFF
        if self.drive.undervoltage:
            flags |= DriverErrors.OPEN_LOAD_A | DriverErrors.OPEN_LOAD_B
        return flags
