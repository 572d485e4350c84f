"""Executes the program in the module, command by command in its time (FM-PD42-1241 3.3, 3.5.6, 3.6.15 to 3.6.33).

Commands that touch nothing but registers and user variables run compiled, ahead of the drive; should the drive then
stop at an event, they are taken back to that moment. So it makes no difference in how many pieces time is advanced.
Where one reads the position, or what else the drive's cells tell, they run compiled together with the drive
(`beside_drive`).

Open in all sources, and decided here:
- how long a command takes: the option `command_us`, and `EEPROM_S` more for what writes the EEPROM;
- a command that is refused changes nothing; its status stays in global parameter 131, and the program goes on with the
  next command. One that the firmware does not know stops the program, with the counter on it, and so does the end of
  the memory. Memory that holds no program reads as opcode 0, which is unknown;
- after STOP the counter stays on the STOP;
- WAIT with no ticks, or with a negative accumulator, waits for nothing; WAIT POS is met where the motor stands at its
  target; a wait that an interrupt has interrupted goes on with the time that it had;
- an interrupt that comes while it is enabled is kept until it can be served, once however often it came; enabling
  forgets what came before. Timers count from when their period is written. A step serves none, and RETI outside an
  interrupt is ignored;
- flags EAL and EPO are never set: nothing says what sets them. EDV is set where the deviation is exceeded.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from ...registers.tmcl.commands import BY_MNEMONIC, CONTROL_FIRST, PROGRAM_COMMANDS, Opcode, Status
from ..drive import Drive, Event, EventKind
from . import beside_drive
from . import interpreter_kernel as k
from .application import ALL_INTERRUPTS, RUNS, STEPS, Application
from .axis import Axis
from .global_parameters import GlobalParameters
from .ports import Ports
from .refused import Refused, invalid_value, wrong_type

TICK_MS = 10
"""A tick of WAIT (FM-PD42-1241 3.6.20)."""
EEPROM_S = 0.005
"""What writing the EEPROM takes [s]: a usual figure for such memories; no source tells it."""
TIMERS = (0, 1, 2)
POSITION_REACHED, STALL, DEVIATION, STOP_LEFT, STOP_RIGHT, INPUT_0 = 3, 15, 21, 27, 28, 39
_LEVELS = (STOP_LEFT, STOP_RIGHT, INPUT_0, INPUT_0 + 1, INPUT_0 + 2, INPUT_0 + 3)
_RISING, _FALLING = 1, 2
_TICKS, _POS, _REFSW, _LIMSW, _RFS = range(5)
_STATUS = BY_MNEMONIC["RFS"].types["STATUS"]
_FROM_ACCUMULATOR = -1
_READS = frozenset({Opcode.GAP, Opcode.GGP, Opcode.GIO, Opcode.GCO})
_NEVER_COMPILED = frozenset(
    opcode
    for opcode in Opcode
    if opcode
    not in {
        Opcode.CALC, Opcode.CALCX, Opcode.COMP, Opcode.JC, Opcode.JA, Opcode.CSUB, Opcode.RSUB, Opcode.CLE,
        Opcode.SGP, Opcode.GGP, Opcode.AGP, Opcode.CALCVV, Opcode.CALCVA, Opcode.CALCAV, Opcode.CALCVX, Opcode.CALCXV,
        Opcode.CALCV, Opcode.RST, Opcode.DJNZ, Opcode.SIV, Opcode.GIV, Opcode.AIV, Opcode.CALL,
    }
)  # fmt: skip
"""Commands that `interpreter_kernel` need not be asked for."""
_DEVIATIONS = EventKind.DEVIATION_INTERNAL | EventKind.DEVIATION_EXTERNAL
_WATCHED_BY_WAIT = {
    _POS: EventKind.POSITION_REACHED | EventKind.STOPPED,
    _REFSW: EventKind.SWITCH_HOME,
    _LIMSW: EventKind.SWITCH_LEFT | EventKind.SWITCH_RIGHT,
    _RFS: EventKind.STOPPED,
}
_WATCHED_BY_INTERRUPT = {
    POSITION_REACHED: EventKind.POSITION_REACHED,
    STOP_LEFT: EventKind.SWITCH_LEFT,
    STOP_RIGHT: EventKind.SWITCH_RIGHT,
    INPUT_0: EventKind.SWITCH_HOME,
}

Handler = Callable[[int, int, int], int]


class _Wait(NamedTuple):
    condition: int
    until: int | None
    """Clocks; None without a time limit."""


class _Context(NamedTuple):
    """What an interrupt saves (FM-PD42-1241 3.5.6.2)."""

    registers: np.ndarray[Any, np.dtype[np.int64]]
    """Program counter, accumulator, X register and flags."""
    wait: _Wait | None


class _Ahead(NamedTuple):
    """What compiled commands began from, should they have to be taken back."""

    registers: np.ndarray[Any, np.dtype[np.int64]]
    variables: np.ndarray[Any, np.dtype[np.int64]]
    due: int
    until: int


class Interpreter:
    """Whoever advances the drive asks `run_to` how far, and tells it each event."""

    def __init__(
        self,
        application: Application,
        axis: Axis,
        ports: Ports,
        parameters: GlobalParameters,
        drive: Drive,
        handlers: Sequence[Handler],
        command_s: float,
    ) -> None:
        """`handlers` are those of direct mode, by opcode; a command takes `command_s` [s]."""
        self._application, self._axis, self._ports = application, axis, ports
        self._globals, self._drive, self._handlers = parameters, drive, handlers
        clock_hz = drive.options.clock_hz
        self._cost = max(1, round(command_s * clock_hz))
        self._clocks_per_ms = round(clock_hz / 1000)
        self._eeprom_cost = round(EEPROM_S * clock_hz)
        application.changed = self._changed
        application.enabled = self._enabled
        parameters.timer_set = self._timer_set
        self._due = drive.clocks
        """When the command at the counter is due [clocks]."""
        self._to_step = False
        self._wait: _Wait | None = None
        self._ahead: _Ahead | None = None
        self._event: Event | None = None
        """What the drive stopped at while commands ran beside it."""
        self._context: _Context | None = None
        self._pending: set[int] = set()
        self._here = np.zeros(256, dtype=np.int64)
        """What `beside_drive` reads, by axis parameter."""
        for number, what in beside_drive.READ_HERE.items():
            if axis.readers[number] is not None:
                self._here[number] = what
        self.power_on()

    def power_on(self) -> None:
        """Timers begin anew; a program that starts by itself starts now."""
        self._timer_from = [self._drive.clocks] * len(TIMERS)
        self._timer_fired = [0] * len(TIMERS)
        self._levels = self._read_levels()
        self._changed(True)

    @property
    def active(self) -> bool:
        """Whether there is a command to be done, or one that waits."""
        return self._application.status == RUNS or self._to_step

    @property
    def waits(self) -> bool:
        """Whether a WAIT is not met yet."""
        return self._wait is not None

    @property
    def serves(self) -> bool:
        """Whether an interrupt is being served."""
        return self._context is not None

    # --- time ------------------------------------------------------------------------------------

    def advance(self, stop: int) -> Event | None:
        """Go on with program and drive to `stop` [clocks], or less far: until a command is due, or to an event."""
        upto = self._run_to(stop)
        event, self._event = self._event, None
        return event or self._drive.advance(upto)

    def _run_to(self, stop: int) -> int:
        """Do what is due now, and what can be done ahead; how far the drive may go, at most to `stop` [clocks]."""
        self._ahead = None
        while self.active:
            now = self._drive.clocks
            self._sample_interrupts(now)
            self._pending &= self._application.interrupts
            if now < self._due and (self._wait is not None or (self._pending and self._interruptible)):
                return min(self._due, stop)  # the command before is still at work
            if self._pending and self._interruptible:
                self._serve(now)
            if self._wait is not None:
                if not self._met(now):
                    until = self._wait.until
                    return min(self._next_timer(now, stop), stop if until is None else until)
                self._finish_wait(now)
                continue
            horizon = self._next_timer(now, stop)
            if self._due >= horizon:
                return horizon
            if not self._to_step:
                if self._run_ahead(horizon) and self._due >= horizon:
                    return horizon
                if self._run_beside(horizon):
                    if self._event is not None:
                        return stop
                    continue
            if self._due > now:
                return self._due
            self._execute(now)
        return stop

    def happened(self, event: Event) -> None:
        """An event of the drive. What was done ahead of it is done only as far as it came."""
        ahead = self._ahead
        if ahead is not None and event.clocks < ahead.until:
            self._application.registers[:] = ahead.registers
            self._application.variables[:] = ahead.variables
            self._due = ahead.due
            self._compiled(event.clocks)
        self._ahead = None
        kinds = event.kinds
        if kinds & _DEVIATIONS:
            self._application.raise_flag(k.EDV)
            self._came(DEVIATION)
        if kinds & EventKind.STALL_STOP:
            self._came(STALL)
        if kinds & EventKind.POSITION_REACHED:
            self._came(POSITION_REACHED)

    def _run_ahead(self, horizon: int) -> bool:
        """Compiled commands up to `horizon`; whether there were any."""
        application = self._application
        at = application.counter
        if at < PROGRAM_COMMANDS and int(application.code[at, 0]) in _NEVER_COMPILED:
            return False
        self._ahead = _Ahead(application.registers.copy(), application.variables.copy(), self._due, horizon)
        return self._compiled(horizon) > 0

    def _run_beside(self, horizon: int) -> bool:
        """Commands up to `horizon` together with the drive, if the next one reads it; whether anything was done."""
        application, drive = self._application, self._drive
        at = application.counter
        if at >= PROGRAM_COMMANDS:
            return False
        opcode, type_, motor, _ = application.code[at].tolist()
        if opcode != Opcode.GAP or motor or self._here[type_] == beside_drive.NOT_HERE:
            return False
        axis = self._axis
        kinds, due = beside_drive.run(
            application.registers, application.variables, application.code, self._here, *drive.cells,
            axis.position_bits, *axis.parameters.speed_scale, self._due, self._cost, horizon,
        )  # fmt: skip
        if kinds:
            self._event = drive.event(kinds)
        if due != self._due:
            self._due = due
            self._ahead = None
        return True

    def _compiled(self, until: int) -> int:
        """Compiled commands that are due before `until`; how many there were."""
        most = -(-(until - self._due) // self._cost)
        if most <= 0:
            return 0
        application = self._application
        done = int(k.run(application.registers, application.variables, application.code, most))
        self._due += done * self._cost
        return done

    # --- commands --------------------------------------------------------------------------------

    def _execute(self, now: int) -> None:
        """The command at the counter, of whatever kind, at its time."""
        application = self._application
        self._ahead = None
        at = application.counter
        if at >= PROGRAM_COMMANDS:
            self._fail(Status.INVALID_COMMAND)
            return
        opcode, type_, motor, value = application.code[at].tolist()
        writes = application.eeprom.writes
        try:
            self._do(now, at, opcode, type_, motor, value)
        except Refused as refusal:
            application.last_error = refusal.status
            application.counter = at + 1
        self._due = now + self._cost + (application.eeprom.writes - writes) * self._eeprom_cost
        if self._wait is None:
            self._to_step = False
        self._watch()

    def _do(self, now: int, at: int, opcode: int, type_: int, motor: int, value: int) -> None:
        """Raises Refused."""
        application = self._application
        if opcode not in _NEVER_COMPILED:
            status = int(k.execute(application.registers, application.variables, opcode, type_, motor, value))
            if status == k.DONE:
                return
            if status != k.ELSEWHERE:
                raise Refused(Status(status))
        if opcode == Opcode.STOP:
            application.stop()
            return
        if opcode == Opcode.WAIT:
            self._begin_wait(now, type_, motor, value)
            if self._met(now):
                self._finish_wait(now)
            return
        if opcode == Opcode.RETI:
            self._leave(at)
            return
        if opcode == Opcode.VECT:
            application.set_vector(type_, value)
        elif opcode >= CONTROL_FIRST:
            self._fail(Status.INVALID_COMMAND)
            return
        else:
            try:
                answer = self._handlers[opcode](type_, motor, value)
            except Refused as refusal:
                if refusal.status == Status.INVALID_COMMAND:
                    self._fail(refusal.status)
                    return
                raise
            if opcode in _READS or (opcode == Opcode.RFS and type_ == _STATUS):
                application.load_accumulator(answer)
        application.counter = at + 1

    def _fail(self, status: Status) -> None:
        self._application.last_error = status
        self._application.stop()

    # --- waits -----------------------------------------------------------------------------------

    def _begin_wait(self, now: int, condition: int, motor: int, ticks: int) -> None:
        if condition > _RFS:
            raise wrong_type()
        if condition != _TICKS and motor:
            raise invalid_value()
        if ticks == _FROM_ACCUMULATOR:
            ticks = self._application.accumulator
        limited = condition == _TICKS or ticks > 0
        self._wait = _Wait(condition, now + max(ticks, 0) * TICK_MS * self._clocks_per_ms if limited else None)

    def _met(self, now: int) -> bool:
        """Whether the wait is over, by what it waits for or by its time."""
        wait = self._wait
        if wait is None:
            return True
        axis, switches = self._axis, self._drive.switches
        if wait.condition == _POS:
            met = axis.standing and axis.position == axis.target
        elif wait.condition == _REFSW:
            met = switches.home
        elif wait.condition == _LIMSW:
            met = switches.left or switches.right
        elif wait.condition == _RFS:
            met = axis.search is None
        else:
            met = False
        if met:
            return True
        if wait.until is None or now < wait.until:
            return False
        if wait.condition != _TICKS:
            self._application.raise_flag(k.ETO)
        return True

    def _finish_wait(self, now: int) -> None:
        self._wait = None
        self._to_step = False
        self._application.counter += 1
        self._due = now + self._cost
        self._watch()

    # --- interrupts ------------------------------------------------------------------------------

    @property
    def _interruptible(self) -> bool:
        application = self._application
        return ALL_INTERRUPTS in application.interrupts and self._context is None and application.status == RUNS

    def _serve(self, now: int) -> None:
        """Enter the interrupt of the lowest number, which has the highest priority (FM-PD42-1241 5.4)."""
        application = self._application
        number = min(self._pending)
        self._pending.discard(number)
        self._context = _Context(application.registers[: k.FLAGS + 1].copy(), self._wait)
        self._wait = None
        self._due = max(self._due, now)
        application.counter = application.vectors[number]
        self._watch()

    def _leave(self, at: int) -> None:
        """RETI."""
        if self._context is None:
            self._application.counter = at + 1
            return
        self._application.registers[: k.FLAGS + 1] = self._context.registers
        self._wait = self._context.wait
        self._context = None

    def _came(self, number: int) -> None:
        if number in self._application.interrupts and number in self._application.vectors:
            self._pending.add(number)

    def _sample_interrupts(self, now: int) -> None:
        """Which timers have run out and which inputs have changed since the last look."""
        enabled = self._application.interrupts
        if not enabled:
            return
        for number in TIMERS:
            if number in enabled:
                rounds = self._rounds(number, now)
                if rounds > self._timer_fired[number]:
                    self._timer_fired[number] = rounds
                    self._came(number)
        if any(number in enabled for number in _LEVELS):
            levels = self._read_levels()
            for number, before, after in zip(_LEVELS, self._levels, levels, strict=True):
                edge = _RISING if after > before else _FALLING if after < before else 0
                if edge & self._globals.interrupt_setup.get(number, 0):
                    self._came(number)
            self._levels = levels

    def _read_levels(self) -> tuple[bool, ...]:
        switches = self._drive.switches
        return switches.left, switches.right, *self._ports.levels()

    def _rounds(self, number: int, now: int) -> int:
        """How often timer `number` has run out since its period was set."""
        period = self._period(number)
        return (now - self._timer_from[number]) // period if period else 0

    def _period(self, number: int) -> int:
        return (self._globals.interrupt_setup.get(number, 0) & 0xFFFF_FFFF) * self._clocks_per_ms

    def _next_timer(self, now: int, stop: int) -> int:
        """When the next timer that would interrupt runs out; `stop` if none does before."""
        if not self._interruptible:
            return stop
        for number in TIMERS:
            period = self._period(number)
            if period and number in self._application.interrupts and number in self._application.vectors:
                stop = min(stop, self._timer_from[number] + (self._rounds(number, now) + 1) * period)
        return stop

    # --- news ------------------------------------------------------------------------------------

    def _changed(self, fresh: bool) -> None:
        """A control command, or the power: a wait begins again; `fresh`: no interrupt is served any more either."""
        self._wait = None
        self._ahead = None
        self._to_step = self._application.status == STEPS
        self._due = self._drive.clocks
        if fresh:
            self._context = None
            self._pending.clear()
        if self._to_step:
            self._execute(self._due)
        self._watch()

    def _enabled(self, number: int) -> None:
        self._pending.discard(number)
        if number in TIMERS:
            self._timer_fired[number] = self._rounds(number, self._drive.clocks)
        elif number in _LEVELS:
            self._levels = self._read_levels()

    def _timer_set(self, number: int) -> None:
        if number in TIMERS:
            self._timer_from[number] = self._drive.clocks
            self._timer_fired[number] = 0

    def _watch(self) -> None:
        """Have the drive stop at what a wait or an interrupt waits for, and at nothing else."""
        kinds = EventKind(0)
        if self.active:
            if self._wait is not None:
                kinds |= _WATCHED_BY_WAIT.get(self._wait.condition, EventKind(0))
            for number, kind in _WATCHED_BY_INTERRUPT.items():
                if number in self._application.interrupts:
                    kinds |= kind
        self._axis.also_watch(kinds)
