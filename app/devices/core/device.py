"""One connected thing: who it is, whether it answers, and what everybody above may ask of it.

`Device` is the contract. What the families share among themselves is in `ramp_chip`, what is the
same for every 32-bit register chip in `register_chip`.
"""

from __future__ import annotations

import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Mapping, Sequence
from contextvars import ContextVar
from dataclasses import dataclass, field
from typing import ClassVar, cast

from ...calc.microsteps.mslut import MslutRegisters
from ...clock import Clock
from ...errors import BenchError, DownloadMode, LinkError, OtherModel, UnknownThing, UsageError, WrongState
from ...links.port import FramePort, SamplingPort
from ...links.queue import FrameHold, LinkQueue, Priority
from ...links.registry import Link
from ...registers.catalog import MODELS, Model
from ..limits.limiter import Limiter
from .changes import RegisterChanged
from .config import AxisSettings, DeviceConfig
from .counter import CounterLook, CounterWritten, PositionSeen
from .holding_back import OnlyReading
from .prediction import Prediction
from .results import (
    AxisMove,
    AxisState,
    BatchResult,
    ChainContents,
    ChipEvents,
    DeviceState,
    HeldMslut,
    MotionEnd,
    MoveStarted,
    RawExchange,
    RegisterReading,
    RegisterWritten,
    Rotating,
    StopMode,
    StopOutcome,
    WriteItem,
)
from .sample_plan import Channel, SamplePlan, Taken
from .signs import EncoderSeen, Remedy, Signs

RATE_MAX_EMULATED_HZ = 1000.0
RATE_MAX_WIRE_HZ = 500.0
"""What a socket and a task a sample carry without taking the link from commands; measured, not promised."""


@dataclass(frozen=True, slots=True)
class StateChanged:
    """The connection's state is another one now."""

    state: DeviceState
    problem: BenchError | None


@dataclass(frozen=True, slots=True)
class MotionStarted:
    """An axis was sent somewhere: what a trigger waits for."""

    axis: int
    started_at_s: float


@dataclass(frozen=True, slots=True)
class MotionCommanded:
    """Something went to the chip that may move or stop an axis. `by` is what `motion_owner` held then.

    asked : by what it can be done again, empty where that is not known: `target` [microsteps] of a move; `velocity` in
        chip units of a rotation; `mode` of a stop; `position` [microsteps] that a place is called from now on
    """

    axis: int
    what: str
    by: object
    asked: Mapping[str, int | str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class LimitReached:
    """An axis was stopped before it would have left its range: which end of it, and where it was then [microsteps]."""

    axis: int
    name: str
    limit: int
    position: int


DeviceEvent = (
    StateChanged
    | LimitReached
    | MotionStarted
    | MotionCommanded
    | MotionEnd
    | ChipEvents
    | PositionSeen
    | CounterWritten
    | RegisterChanged
)

motion_owner: ContextVar[object] = ContextVar("motion_owner", default=None)
"""Who commands in this task: how a procedure tells its own commands from everybody else's."""


@dataclass(slots=True)
class Axis:
    """One axis: its settings, and what is known of its chip setting without asking (None: nothing yet)."""

    index: int
    settings: AxisSettings
    pulse_div: int | None = None
    ramp_div: int | None = None
    microsteps_per_full_step: int | None = None

    @property
    def name(self) -> str:
        return self.settings.name


class Device(ABC):
    """A chip or module behind a link. All positions in microsteps, all times in device time [s]."""

    def __init__(self, device_id: str, config: DeviceConfig, port: FramePort, clock: Clock) -> None:
        self.id = device_id
        self.config = config
        self.port = port
        self.clock = clock
        """The server's, for what a driver does on its own."""
        self.background = clock
        """The same for what may wait while somebody stops motors: looks, not what keeps a motor in its limits."""
        self.queue = LinkQueue(port, on_result=self._link_result)
        self.axes = tuple(Axis(index, settings) for index, settings in enumerate(config.axes))
        self.limiter: Limiter | None = None
        """Keeps the soft limits of the axes; None where there are none (`limits.apply`)."""
        self.stops = [0] * len(self.axes)
        """How often each axis was stopped: a command that finds it changed was overtaken."""
        self.motion_commands = [0] * len(self.axes)
        """How many commands each axis got from this session that may move or stop it."""
        self._state: DeviceState = "disconnected"
        self._problem: BenchError | None = None
        self.driver_of: Callable[[Device, str], Device] | None = None
        """Makes the driver of another model for the same port (`families`), to stop what answers there."""
        self._stranger: WrongState | None = None
        """Why what answers is not the chip or module of this connection; None where it is, or nobody knows."""
        self.notes: tuple[str, ...] = ()
        """What a user has to know of this device at present: see `found_moving`."""
        self._listeners: list[Callable[[DeviceEvent], None]] = []

    # --- who it is ------------------------------------------------------------------------------

    @property
    def name(self) -> str:
        return self.config.name

    @property
    def model(self) -> str:
        return self.config.model

    @property
    def family(self) -> Model:
        """The catalog's entry of this model."""
        return MODELS[self.config.model]

    @property
    def link(self) -> Link:
        return self.config.link

    @property
    def clock_hz(self) -> float:
        return self.config.clock_hz

    @property
    def emulated(self) -> bool:
        return self.config.link.get("kind") == "emulator"

    @property
    def sampling_port(self) -> SamplingPort | None:
        """The port, where its far end samples itself on its own time."""
        return cast("SamplingPort", self.port) if hasattr(self.port, "start_sampling") else None

    @property
    def chip_timed(self) -> bool:
        """Whether samples bear the device's own time."""
        return self.sampling_port is not None

    @property
    def rate_max_hz(self) -> float:
        """Samples a second that this link is good for, of one channel."""
        return RATE_MAX_EMULATED_HZ if self.chip_timed else RATE_MAX_WIRE_HZ

    def sample_rate_max_hz(self, plan: SamplePlan) -> float:
        """Samples a second that this link is good for when `plan` makes them."""
        del plan
        return self.rate_max_hz

    def rows_at_once(self, plan: SamplePlan, rate_hz: float) -> int:
        """How many samples to take in one go at `rate_hz`: more than one where the link would be idle in between."""
        del plan, rate_hz
        return 1

    async def take_samples(self, plan: SamplePlan, rows: int = 1) -> Taken:
        """Samples over the link. Raises LinkError, and SampleDropped where the link is too busy."""
        del rows
        time_s, replies = await self.queue.sample(plan.frames)
        first_s, last_s = self.queue.sample_span_s
        return Taken([time_s], [replies], last_s - first_s)

    @property
    def calls_per_s_possible(self) -> float | None:
        """Questions a second that the wire can carry; None where it sets no limit."""
        return None

    @property
    def calls_per_s(self) -> float:
        """Questions a second that everybody on this wire asks."""
        return self.queue.calls_per_s

    @property
    def shares_rows(self) -> bool:
        """Whether each sample costs readers something, so that history and readers have to share them."""
        return False

    def device_time_s(self) -> float:
        """Now, device time [s]."""
        return self.port.device_time_s()

    @property
    def time_scale(self) -> float:
        """How fast device time runs against the server's: what an emulator's time scale turns."""
        return float(getattr(self.port, "time_scale", 1.0))

    def axis(self, index: int) -> Axis:
        """Raises UnknownThing for an axis that the chip does not have."""
        if not 0 <= index < len(self.axes):
            raise UnknownThing("axis", str(index), [str(axis.index) for axis in self.axes])
        return self.axes[index]

    def reconfigure(self, device_id: str, config: DeviceConfig) -> None:
        """For the manager: another name, clock or other axes on the same link."""
        self.id, self.config = device_id, config
        for axis, settings in zip(self.axes, config.axes, strict=True):
            axis.settings = settings

    @property
    def shortcomings(self) -> tuple[str, ...]:
        """What this very device has not that others of its model have, for people."""
        return ()

    # --- soft limits ----------------------------------------------------------------------------

    def limit_warnings(self, axis: int) -> list[str]:
        """What the chip is set to beyond the soft limits of `axis`, and what to write; empty where all is well."""
        index = self.axis(axis).index
        return [] if self.limiter is None else self.limiter.findings(index)

    async def check_writes(self, items: Sequence[WriteItem]) -> None:
        """Raises SoftLimit where one of these writes, made in this order, would go beyond a soft limit. Sends no write.

        For whoever writes many things and wants to know before the first: batches, profiles.
        """
        if self.limiter is not None:
            self.limiter.check_writes(await self.words_of(items, self.limiter.matters))

    @abstractmethod
    async def words_of(self, items: Sequence[WriteItem], matters: Callable[[int], bool]) -> list[tuple[int, int]]:
        """(address, word) that these writes would send, of addresses that matter; what they change is read where it is
        not known. Raises UnknownThing, OutOfRange, LinkError."""

    # --- whether it answers ---------------------------------------------------------------------

    @property
    def state(self) -> DeviceState:
        return self._state

    @property
    def problem(self) -> BenchError | None:
        """Why it is not connected; None while it is."""
        return self._problem

    def listen(self, listener: Callable[[DeviceEvent], None]) -> Callable[[], None]:
        """Hear of state changes and starts; returns the function that ends it. A listener must not raise."""
        self._listeners.append(listener)

        def end() -> None:
            if listener in self._listeners:
                self._listeners.remove(listener)

        return end

    def set_state(self, state: DeviceState, problem: BenchError | None = None) -> None:
        """For the manager."""
        if state == "failed" and self.limiter is not None:
            self.limiter.forget()
        self.queue.closed = state == "disconnected"
        if (state, problem) != (self._state, self._problem):
            self._state, self._problem = state, problem
            self._tell(StateChanged(state, problem))

    def _tell(self, event: DeviceEvent) -> None:
        for listener in tuple(self._listeners):
            listener(event)

    def commanded(self, axis: int, what: str, **asked: int | str) -> None:
        """For drivers: something that may move or stop `axis` is on its way to the chip; `asked` as in the event."""
        self.motion_commands[axis] += 1
        self._tell(MotionCommanded(axis, what, motion_owner.get(), asked))
        if self.writes_counter(what):
            self._tell(CounterWritten(axis, what))

    def stopped_by_limit(self, reached: LimitReached) -> None:
        """For the watch over the range of positions."""
        self._tell(reached)

    def saw_position(self, axis: int, count: int, asked_at_s: float, encoder_count: int | None = None) -> None:
        """For drivers: the position counter of `axis` was read, and with it the encoder's (see `PositionSeen`)."""
        if self.limiter is not None:
            self.limiter.at(axis, count)
        self._tell(PositionSeen(axis, count, asked_at_s, encoder_count))

    @property
    def held_back(self) -> WrongState | None:
        """Why the driver keeps still although the link may work; None while it does not."""
        return self._stranger

    def ways_out(self, why: WrongState) -> tuple[Remedy, ...]:
        """What ends that the driver keeps still because of `why`."""
        if not isinstance(why, OtherModel):
            return ()
        return tuple(Remedy(f"change the model to {name.upper()}", "PATCH", "", {"model": name}) for name in why.found)

    async def identify(self) -> None:
        """`probe`, and be warned: as long as something else answers than expected, nothing goes out but readings and
        stops. Raises what `probe` raises."""
        try:
            await self.probe()
        except DownloadMode:
            raise
        except WrongState as error:
            self._stranger = error
            self.queue.holds = (*self._holds(), OnlyReading(error, self.only_reads))
            raise
        self._stranger = None
        self.queue.holds = self._holds()

    def _holds(self) -> tuple[FrameHold, ...]:
        """What this family always holds back."""
        return ()

    @abstractmethod
    def only_reads(self, frame: bytes) -> bool:
        """Whether a frame of this link reads, and neither writes nor moves anything."""

    def _link_result(self, error: LinkError | None) -> None:
        if self._state == "disconnected":
            return
        if error is None and (why := self.held_back) is not None:
            self.set_state("failed", why)
        elif error is None:
            self.set_state("connected")
        else:
            self.set_state("failed", error)

    def require_connected(self) -> None:
        """Raises WrongState after a disconnect. A failed link is tried: it may be back."""
        if self._state == "disconnected":
            raise WrongState(f"{self.name} is not connected", "connect it first")

    async def let_go(self) -> None:  # noqa: B027 (most drivers do nothing on their own)
        """For the manager, before it closes the port: end whatever the driver does on its own."""

    def stop_guard(self, axes: Sequence[int]) -> Callable[[], None]:
        """For turns of commands: raises WrongState as soon as one of `axes` was stopped after this call.

        Raises it at once where another chip or module answers: else the first thing missing in its registers would be
        told, and not who it is.
        """
        if axes and self._stranger is not None:
            raise self._stranger
        stops_then = [self.stops[axis] for axis in axes]

        def check() -> None:
            for axis, stops in zip(axes, stops_then, strict=True):
                if self.stops[axis] != stops:
                    raise WrongState(f"a stop of axis {axis} overtook this command", "send it again if it is wanted")

        return check

    # --- what it can ----------------------------------------------------------------------------

    @abstractmethod
    async def probe(self) -> str:
        """Ask something harmless; returns what was found, for people. Raises LinkError, or WrongState (other chip)."""

    @abstractmethod
    async def refresh(self) -> None:
        """Read again what the driver remembers of the chip (dividers): somebody else may have changed it."""

    @abstractmethod
    async def read(self, name: str, axis: int | None = None) -> RegisterReading:
        """Read one register, or a field by its own name, from the chip, past any cache."""

    @abstractmethod
    def clears_when_read(self, name: str, axis: int | None = None) -> bool:
        """Whether reading that register, or field, sets it back. Raises UnknownThing, UsageError."""

    @abstractmethod
    async def read_all(self, axis: int | None = None, groups: Collection[str] = ()) -> list[RegisterReading]:
        """Every readable register; with `axis` only of that axis (no global ones), with `groups` only of those."""

    def kept(self, axis: int | None = None, groups: Collection[str] = ()) -> list[RegisterReading]:
        """Registers that cannot be read, where the driver knows what they hold: nothing is asked of the chip."""
        return []

    @abstractmethod
    async def write(
        self,
        name: str,
        axis: int | None = None,
        value: int | None = None,
        fields: dict[str, int | str] | None = None,
    ) -> RegisterWritten:
        """Write the whole value, or some fields, and read back.

        Raises UnknownThing, OutOfRange, WrongState (read-only), WriteRefused (the chip did not take it).
        """

    @abstractmethod
    async def write_many(self, items: Sequence[WriteItem]) -> BatchResult:
        """Several writes in order; the first that fails ends it."""

    @abstractmethod
    async def exchange(self, frame: bytes) -> RawExchange:
        """One raw datagram. Raises OutOfRange for a wrong length."""

    @abstractmethod
    async def axis_state(self, axis: int, priority: Priority = Priority.COMMAND) -> AxisState:
        """Position, velocity, switches and flags now."""

    @abstractmethod
    async def move_together(self, moves: Sequence[AxisMove]) -> list[MoveStarted]:
        """Prepare all, then start all in successive datagrams (DS-TMC428 9.10)."""

    async def move(self, axis: int, target: float, relative: bool = False, unit: str = "microsteps") -> MoveStarted:
        """Go to `target`, in RAMP_MODE or SOFT_MODE. Raises WrongState where the setting cannot move the motor."""
        return (await self.move_together([AxisMove(axis, target, relative, unit)]))[0]

    @abstractmethod
    async def rotate(self, axis: int, velocity: float, unit: str = "pps") -> Rotating:
        """Turn on and on, in VELOCITY_MODE. Never clipped: raises OutOfRange with the limit in the same unit."""

    async def stop_axes(self, axes: Sequence[int], mode: StopMode = "ramp") -> list[StopOutcome]:
        """Stop ahead of everything that waits for this link. Failures are in the outcomes, not raised.

        Where another model answers, that one is stopped, with all its axes: nobody knows which of them is meant.
        """
        why = self._stranger
        if isinstance(why, OtherModel) and not why.same_stop:
            for axis in axes:
                self.stops[axis] += 1
                self.commanded(axis, "stop", mode=mode)
            return await self._stop_stranger(why, axes, mode)
        return await self._stop_axes(axes, mode)

    @abstractmethod
    async def _stop_axes(self, axes: Sequence[int], mode: StopMode) -> list[StopOutcome]:
        """`stop_axes` of the chip or module that this connection names."""

    async def _stop_stranger(self, why: OtherModel, axes: Sequence[int], mode: StopMode) -> list[StopOutcome]:
        """Stop what answers by the driver of its own model; `why` for each axis where there is none."""
        began = time.perf_counter()
        problem: BenchError | None = why
        if why.found and self.driver_of is not None:
            try:
                driver = self.driver_of(self, why.found[0])
            except UsageError as error:
                problem = error
            else:
                driver.queue = self.queue.beside()
                try:
                    stopped = await driver.stop_axes([axis.index for axis in driver.axes], mode)
                finally:
                    await driver.let_go()
                problem = next((outcome.problem for outcome in stopped if outcome.problem is not None), None)
        took_ms = (time.perf_counter() - began) * 1e3
        return [StopOutcome(self.id, axis, problem is None, took_ms, problem) for axis in axes]

    async def stop(self, axis: int, mode: StopMode = "ramp") -> StopOutcome:
        """Stop one axis. Raises what went wrong."""
        self.require_connected()
        outcome = (await self.stop_axes([self.axis(axis).index], mode))[0]
        if outcome.problem is not None:
            raise outcome.problem
        return outcome

    @abstractmethod
    def signs(self, axis: int, state: AxisState) -> Signs:
        """What is known of the axis beside `state`, as it was read just now. Asks nothing of the chip."""

    # --- encoders -------------------------------------------------------------------------------

    ENCODER_REGISTERS: ClassVar[frozenset[str]] = frozenset()
    """Registers a write to which gives an encoder, or the position, other numbers for the same place or way."""

    def encoder_remedies(self, axis: int, state: AxisState, seen: EncoderSeen) -> tuple[Remedy, ...]:
        """Writes after which an encoder whose resolution is set wrong tells the way that the motor goes, and starts
        from where `state` says the axis rests; empty where none are known. Asks nothing of the chip."""
        del state, seen
        self.axis(axis)
        return ()

    def microsteps_of(self, axis: int) -> tuple[int, int] | None:
        """Microsteps of a full step and of a turn; None where nobody knows how the chip is set."""
        known = self.axis(axis)
        full_step = known.microsteps_per_full_step
        return None if not full_step else (full_step, full_step * known.settings.full_steps_per_rev)

    # --- the position counter -------------------------------------------------------------------

    COUNTER_WRITES: ClassVar[frozenset[str]] = frozenset({"set_position", "XACTUAL"})
    """Commands, as `commanded` names them, after which the position counter shows another number for the same place."""

    def writes_counter(self, what: str) -> bool:
        """Whether a command, as `commanded` names it, is one of those."""
        return what in self.COUNTER_WRITES

    def counter_bits(self, axis: int) -> int | None:
        """Bits of the position counter of `axis`, which wraps; None where it wraps elsewhere as the chip is set."""
        self.axis(axis)
        return 32

    def speed_limit_pps(self, axis: int) -> float:
        """What the ramp generator can at most do at this clock, however its registers are set [pps]."""
        self.axis(axis)
        return self.clock_hz / 2

    async def look(self, axis: int) -> CounterLook:
        """Read the position counter, and then whether the chip was reset. Raises BenchError.

        By default the whole state of the axis, and nothing is known of resets.
        """
        asked_at_s = self.device_time_s()
        return CounterLook((await self.axis_state(axis)).position, asked_at_s, None)

    async def runs_for_s(self) -> float | None:
        """How long ago the chip was switched on or reset, device time [s]; None where it cannot tell."""
        return None

    async def retarget(self, axis: int, count_target: int) -> MoveStarted:
        """Go on to where the counter shows `count_target`, the shorter way round, also over the counter's end.

        What `move` raises. The axis may stand or be under way, by an earlier target or at a velocity.
        """
        return (await self.move_together([AxisMove(axis, count_target, over_the_end=True)]))[0]

    def latch_register(self, axis: int) -> str | None:
        """The register that keeps the counter's number at an edge of a switch; None where there is none."""
        self.axis(axis)
        return None

    def compare_register(self, axis: int) -> str | None:
        """The register that the counter is compared with; None where there is none."""
        self.axis(axis)
        return None

    @abstractmethod
    def prediction(self, axis: int) -> Prediction | None:
        """The ramp expected for the present motion; None where there was none, or something changed it."""

    def motion_ends(self, axis: int) -> tuple[MotionEnd, ...]:
        """Why the motor came to rest, the latest last; empty where the family does not watch."""
        self.axis(axis)
        return ()

    @abstractmethod
    def channels(self) -> tuple[Channel, ...]:
        """Every telemetry channel of this device."""

    @abstractmethod
    def sample_plan(self, channels: Sequence[str]) -> SamplePlan:
        """What to ask for these channels, and how to read the answers. Raises UnknownThing."""

    async def read_microstep_table(self) -> list[int]:
        """The 64 values. Raises WrongState where the chip has no table."""
        raise WrongState(f"a {self.family.title} has no microstep table", "its step/direction driver makes microsteps")

    async def write_microstep_table(self, values: Sequence[int]) -> list[int]:
        """Write 64 values of 0..63 and return the read-back. Raises WrongState, UsageError, WriteRefused."""
        raise WrongState(f"a {self.family.title} has no microstep table", "its step/direction driver makes microsteps")

    async def read_mslut(self, axis: int = 0) -> HeldMslut:
        """The registers of an axis's table of one-bit differences (MSLUT). Raises WrongState where there is none."""
        raise WrongState(f"a {self.family.title} has no table of differences (MSLUT)", "")

    async def write_mslut(self, registers: MslutRegisters, axis: int | None = None) -> HeldMslut:
        """Write MSLUT, MSLUTSEL and MSLUTSTART, of all axes or of one; what else shares a register (DAC_OFFSET) stays.

        Raises WrongState.
        """
        raise WrongState(f"a {self.family.title} has no table of differences (MSLUT)", "")

    async def read_driver_chain(self) -> ChainContents:
        """The chain's RAM and LSMD. Raises WrongState where the chip drives no chain."""
        raise WrongState(f"a {self.family.title} drives no chain of SPI drivers", "it has a step/direction output")

    async def write_driver_chain(self, ram_words: Sequence[int], lsmd: int) -> ChainContents:
        """Write up to 32 RAM words and LSMD and return the read-back. Raises WrongState, UsageError, WriteRefused."""
        raise WrongState(f"a {self.family.title} drives no chain of SPI drivers", "it has a step/direction output")
