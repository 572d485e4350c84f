"""What a device can, as small protocols: a driver's parts fulfil them, and everybody above asks for one of them.

Every device has those of the first half. Those of the second half some have: `Device.part` finds one, and `Device.need`
says what to do where there is none. A part has the capabilities that it inherits, and takes over what stands here as
their default; a method of the same name makes none.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import ClassVar, Protocol

from ...calc.microsteps.mslut import MslutRegisters
from ...calc.tmcl.assembler import Assembly
from ...calc.tmcl.instructions import Command, InstructionSet
from ...errors import BenchError, WrongState
from ...links.queue import Priority
from ...registers.model import Register
from .counter import CounterReading
from .pace import PacedLeg, PaceLimits
from .prediction import Prediction
from .results import (
    AxisMove,
    AxisState,
    BatchResult,
    ChainContents,
    EventPage,
    HeldMslut,
    MotionEnd,
    MoveStarted,
    ProgramDownload,
    ProgramState,
    RawExchange,
    RegisterReading,
    RegisterWritten,
    Rotating,
    StopMode,
    StopOutcome,
    TmclExchange,
    WriteItem,
)
from .sample_plan import Channel, SamplePlan, Taken
from .signs import EncoderSeen, Remedy, Signs

# --- what every device has ----------------------------------------------------------------------


class Identity(Protocol):
    """Which chip answers, and what the driver has to know of it."""

    async def probe(self) -> str:
        """Ask something harmless; returns what was found, for people. Raises LinkError, or WrongState (other chip)."""
        ...

    async def refresh(self) -> None:
        """Read again what the driver remembers of the chip (dividers): another master may have changed it."""
        ...

    def only_reads(self, frame: bytes) -> bool:
        """Whether a frame of this link reads, and neither writes nor moves anything."""
        ...

    @property
    def shortcomings(self) -> tuple[str, ...]:
        """What this very device has not that others of its model have, for people."""
        return ()

    def ways_out(self, why: WrongState) -> tuple[Remedy, ...]:
        """What ends that the driver keeps still because of `why`."""
        del why
        return ()

    async def let_go(self) -> None:
        """End whatever the driver does on its own; the port is closed next."""


class Registers(Protocol):
    """Registers or parameters by name, read past any cache and read back after each write."""

    async def read(self, name: str, axis: int | None = None) -> RegisterReading:
        """Read one register, or a field by its own name, from the chip, past any cache."""
        ...

    def clears_when_read(self, name: str, axis: int | None = None) -> bool:
        """Whether reading that register, or field, sets it back. Raises UnknownThing, UsageError."""
        ...

    async def read_all(self, axis: int | None = None, groups: Collection[str] = ()) -> list[RegisterReading]:
        """Every readable register; with `axis` only of that axis (no global ones), with `groups` only of those."""
        ...

    def kept(self, axis: int | None = None, groups: Collection[str] = ()) -> list[RegisterReading]:
        """Registers that cannot be read, where the driver knows what they hold: nothing is asked of the chip."""
        del axis, groups
        return []

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
        ...

    async def write_many(self, items: Sequence[WriteItem]) -> BatchResult:
        """Several writes in order; the first that fails ends it. None is sent where one would break a soft limit."""
        await self.check_writes(items)
        done: list[RegisterWritten] = []
        for index, item in enumerate(items):
            try:
                done.append(await self.write(item.name, item.axis, item.value, item.fields))
            except BenchError as error:
                return BatchResult(done, error, len(items) - index - 1)
        return BatchResult(done, None, 0)

    async def check_writes(self, items: Sequence[WriteItem]) -> None:
        """Raises SoftLimit where one of these writes, made in this order, would go beyond a soft limit. Sends no write.

        For whoever writes many things and wants to know before the first: batches, profiles. Raises UnknownThing,
        OutOfRange, LinkError too.
        """
        ...


class RawFrames(Protocol):
    """Single frames as they go over the wire."""

    async def exchange(self, frame: bytes) -> RawExchange:
        """One raw frame. Raises OutOfRange for a wrong length."""
        ...

    @property
    def status_alone(self) -> bool:
        """Whether one byte may be sent alone, whose answer is the chip's status (eight clocks, DS-TMC4361 5.2)."""
        return False


class Motion(Protocol):
    """Sends axes somewhere, and stops them."""

    async def move_together(self, moves: Sequence[AxisMove]) -> list[MoveStarted]:
        """Prepare all, then start all in successive datagrams (DS-TMC428 9.10)."""
        ...

    async def move(self, axis: int, target: float, relative: bool = False, unit: str = "microsteps") -> MoveStarted:
        """Go to `target` by the axis's ramp. Raises WrongState where the setting cannot move the motor."""
        return (await self.move_together([AxisMove(axis, target, relative, unit)]))[0]

    async def retarget(self, axis: int, count_target: int) -> MoveStarted:
        """Go on to where the counter shows `count_target`, the shorter way round, also over the counter's end.

        What `move` raises. The axis may stand or be under way, by an earlier target or at a velocity.
        """
        return (await self.move_together([AxisMove(axis, count_target, over_the_end=True)]))[0]

    async def rotate(self, axis: int, velocity: float, unit: str = "pps") -> Rotating:
        """Turn on and on. Never clipped: raises OutOfRange with the limit in the same unit."""
        ...

    async def stop_axes(self, axes: Sequence[int], mode: StopMode) -> list[StopOutcome]:
        """Stop ahead of everything that waits for this link. Failures are in the outcomes, not raised."""
        ...

    def speed_limit_pps(self, axis: int) -> float:
        """What the ramp generator can at most do at this clock, however its registers are set [pps]."""
        ...

    def prediction(self, axis: int) -> Prediction | None:
        """The ramp expected for the present motion; None where there was none, or something changed it."""
        ...


class AxisMonitor(Protocol):
    """Tells how an axis is now, and why it came to rest."""

    async def axis_state(self, axis: int, priority: Priority = Priority.COMMAND) -> AxisState:
        """Position, velocity, switches and flags now."""
        ...

    def signs(self, axis: int, state: AxisState) -> Signs:
        """What is known of the axis beside `state`, as it was read just now. Asks nothing of the chip."""
        ...

    def motion_ends(self, axis: int) -> tuple[MotionEnd, ...]:
        """Why the motor came to rest, the latest last; empty where the family does not watch."""
        ...


class PositionCounter(Protocol):
    """The position counter, which wraps, and what is compared with it or latches it."""

    async def poll(self, axis: int) -> CounterReading:
        """Read the position counter, and then whether the chip was reset. Raises BenchError."""
        ...

    def counter_bits(self, axis: int) -> int | None:
        """Bits of the position counter of `axis`, which wraps; None where it wraps elsewhere as the chip is set."""
        ...

    async def runs_for_s(self) -> float | None:
        """How long ago the chip was switched on or reset, device time [s]; None where it cannot tell."""
        return None

    def latch_register(self, axis: int) -> str | None:
        """The register that keeps the counter's number at an edge of a switch; None where there is none."""
        del axis
        return None

    def compare_register(self, axis: int) -> str | None:
        """The register that the counter is compared with; None where there is none."""
        del axis
        return None


class Telemetry(Protocol):
    """Channels, and what to ask for them."""

    def channels(self) -> tuple[Channel, ...]:
        """Every telemetry channel of this device."""
        ...

    def sample_plan(self, channels: Sequence[str]) -> SamplePlan:
        """What to ask for these channels, and how to read the answers. Raises UnknownThing."""
        ...

    async def take_samples(self, plan: SamplePlan, rows: int = 1) -> Taken:
        """Samples over the link. Raises LinkError, and SampleDropped where the link is too busy."""
        ...

    @property
    def rate_max_hz(self) -> float:
        """Samples a second that this link is good for, of one channel."""
        ...

    def sample_rate_max_hz(self, plan: SamplePlan) -> float:
        """Samples a second that this link is good for when `plan` makes them."""
        ...

    def rows_at_once(self, plan: SamplePlan, rate_hz: float) -> int:
        """How many samples to take in one go at `rate_hz`: more than one where the link would be idle in between."""
        ...

    @property
    def shares_rows(self) -> bool:
        """Whether each sample costs readers something, so that history and readers have to share them."""
        ...

    @property
    def calls_per_s_possible(self) -> float | None:
        """Questions a second that the wire can carry; None where it sets no limit."""
        ...

    @property
    def calls_per_s(self) -> float:
        """Questions a second that everybody on this wire asks."""
        ...


class ConfigurationRules(Protocol):
    """Knows what its registers mean as a configuration, and keeps a motor still while one is written."""

    @property
    def firmware(self) -> str:
        """As the device itself tells it, e.g. "1.44"; empty where it tells none, or was not asked yet."""
        return ""

    def unit_of(self, register: Register, /) -> str:
        """What the numbers of `register` count in, as the device is set now."""
        return register.unit

    def range_of(self, register: Register, /) -> tuple[int, int]:
        """The least and the greatest number that `register` takes, as the device is set now."""
        return register.minimum, register.maximum

    def settable(self, register: Register, /) -> bool:
        """Whether a write of `register` is known to set it: so says its table, or it was seen."""
        return register.access.writable

    def as_set(self, register: Register, word: int, /) -> int:
        """`word`, read from `register`, as its user has set it and as one would have to write it again."""
        del register
        return word

    def as_written(self, register: Register, word: int, /) -> int:
        """`word`, read from `register` at any time, as one would have to write it to read it again."""
        del register
        return word

    def unread(self, register: Register, /) -> int | None:
        """What a register that cannot be read holds; None where nobody knows."""
        del register
        return None

    def commanded_bits(self, register: Register, word: int, /) -> int:
        """Bits of `word` that say what the motor was last told to do, though at other times they are configuration."""
        del register, word
        return 0

    async def require_idle(self) -> None:
        """Raises WrongState while something runs, a motor apart, that writing a configuration must not disturb;
        BenchError."""

    async def hold_still(self, axis: int, state: AxisState, /) -> list[str]:
        """Take every reason to move from `axis`, which rests as `state` says; what was done to that end, for people.
        Raises BenchError."""
        ...


# --- what some have -----------------------------------------------------------------------------


class EncoderSetting(Protocol):
    """Knows what sets an encoder right whose resolution is set wrong."""

    ENCODER_REGISTERS: ClassVar[frozenset[str]]
    """Registers a write to which gives an encoder, or the position, other numbers for the same place or way."""

    def encoder_remedies(self, axis: int, state: AxisState, seen: EncoderSeen, /) -> tuple[Remedy, ...]:
        """Writes after which an encoder whose resolution is set wrong tells the way that the motor goes, and starts
        from where `state` says the axis rests; empty where none are known. Asks nothing of the chip."""
        ...

    def require_encoder(self, axis: int, /) -> None:
        """Raises WrongState where no encoder shows the way of `axis`; UnknownThing for the axis."""
        ...

    def has_encoder(self, axis: int, /) -> bool:
        """Whether `axis` has an encoder, or an input for one, set up or not. Raises UnknownThing for the axis."""
        ...


class UnsetEncoder(Protocol):
    """Has an input for an encoder that shows nothing until somebody has set what a count of it is."""

    def provisional_encoder(self, axis: int, counts: int, /) -> Mapping[str, int | Mapping[str, int]]:
        """Registers of `axis` by name, or fields of them, by which an encoder shows its way as if it had `counts` a
        turn. Asks nothing of the chip. Raises WrongState where none can count as the axis is set; UnknownThing."""
        ...


class EncoderIndex(Protocol):
    """Latches where its encoder was as the index channel was met."""

    def index_setting(self, axis: int, /) -> Mapping[str, int | Mapping[str, int]]:
        """Registers of `axis` by name, or fields of them, by which each meeting of the index latches the place of the
        encoder and clears nothing. Asks nothing of the chip. Raises UnknownThing."""
        ...

    async def index_met(self, axis: int, /) -> int | None:
        """Where the encoder was as its index was met since the last call [microsteps]; None where it was not. Takes
        notice of the flag that tells so. Raises BenchError."""
        ...


class PositionFromEncoder(Protocol):
    """Can take its position from an encoder."""

    async def position_from_encoder(self, axis: int, /) -> int:
        """Call the place where the motor stands what its encoder shows; the difference. Raises WrongState."""
        ...


class PositionSetting(Protocol):
    """Can call the place where the motor stands by another number."""

    async def set_position(self, axis: int, position: int, /) -> int:
        """Call the place where the motor stands `position` [microsteps]; the difference. Raises WrongState while it
        moves, OutOfRange."""
        ...


class StallStop(Protocol):
    """Can have a stall that its driver measures stop the motor."""

    async def full_step(self, axis: int, /) -> int:
        """Microsteps of a full step."""
        ...

    def cruise_pps(self, axis: int, /) -> float | None:
        """The speed limit of moves as the user has set it [pps]; None where nobody knows it."""
        ...

    async def stall_threshold(self, axis: int, /) -> int:
        """StallGuard's threshold as it is set: the higher, the less sensitive."""
        ...

    async def stall_writes(
        self, axis: int, velocity_pps: float, threshold: int, current_percent: float | None, /, *, stops: bool
    ) -> Sequence[WriteItem]:
        """What to write so that a stall `stops` the motor from `velocity_pps` on, or is only measured.

        current_percent : run current, of full scale; None: as it is set. The same names whatever is asked for.
        """
        ...

    def set_before(self, item: WriteItem, /) -> WriteItem | None:
        """What has to be written to have again what `item`, of `stall_writes`, writes over, where no reading of that
        register tells; None where one does."""
        return None

    async def set_aside(self, axis: int, /) -> str:
        """What `stall_writes` will switch off that is on now, in words; empty for nothing."""
        return ""

    async def load(self, axis: int, /) -> int:
        """The load value now: 0 is a stall."""
        ...

    async def call_here(self, axis: int, position: int, /) -> None:
        """Call the place where the motor stands `position` [microsteps]."""
        ...


class VelocityJumps(Protocol):
    """Can move with a velocity that jumps."""

    async def move_in_steps(
        self, axis: int, target: int, *, relative: bool = False, velocity_pps: float | None = None
    ) -> MoveStarted:
        """Go without a ramp, at `velocity_pps` (None: as it is set) [pps]. Raises what `Motion.move` raises."""
        ...

    async def stand_ready(self, axis: int) -> None:
        """Positioning again with the user's ramps, the target where the axis stands. Raises WrongState while it
        moves."""
        ...


class VelocitySteps(Protocol):
    """A stream of velocities to one axis. A stop of the axis ends it: each call then raises WrongState."""

    position: int
    """Where the axis stood [microsteps]."""
    unit_pps: float
    """One count of velocity [microsteps/s]."""

    async def set(self, counts: int) -> None:
        """Have this velocity from now on: one frame."""
        ...

    async def close(self) -> int:
        """Stand still; where [microsteps]. Raises WriteRefused where the chip did not take the 0."""
        ...


class VelocityStream(Protocol):
    """Takes velocities one after another, without its own ramp."""

    async def stream_unit_pps(self, axis: int, /) -> tuple[float, int]:
        """One count of velocity as the axis is set [microsteps/s], and where it is [microsteps]."""
        ...

    async def open_stream(self, axis: int, /) -> VelocitySteps:
        """Take the axis out of its ramps. Raises WrongState while it moves."""
        ...


class LatchedFlags(Protocol):
    """Keeps flags until they are acknowledged."""

    async def clear_flags(self, axis: int, /) -> None: ...


class StartWire(Protocol):
    """Has a pin at which a new target waits for a start that one chip gives to all that are wired to it."""

    async def arm_start(self, axis: int, /, *, leads: bool) -> None:
        """Have the next target wait for the start: of this chip's own if it `leads`, else of the pin.

        Raises WrongState while the axis moves, and where the pin cannot be had; BenchError.
        """
        ...

    async def give_start(self, axis: int, /) -> None:
        """Start all that wait, this axis too: one write, never sent twice. Raises WrongState where a stop of the axis
        came between, BenchError."""
        ...

    async def has_started(self, axis: int, /) -> bool:
        """Whether the target that waited counts now: the axis goes there, or is there. Reads only."""
        ...

    async def disarm_start(self, axis: int, /, *, started: bool) -> None:
        """As it was before `arm_start`. Not `started`, the target that waits becomes where the axis stands."""
        ...


class LinePace(Protocol):
    """Can make a move on a trapezoid of a speed and acceleration of its own, so that several axes arrive together."""

    async def pace_limits(self, axis: int, /) -> PaceLimits:
        """How its ramp is set now. Raises CannotMove where nobody knows that, WrongState while it moves, LinkError."""
        ...

    def pace_begin(self, axis: int, /) -> None:
        """From now on its ramp is borrowed: what `pace_limits` saw last is what `pace_back` brings."""
        ...

    def paced(self, axis: int, way: int, velocity_pps: float, acceleration_pps2: float, /) -> PacedLeg:
        """A move by `way` [microsteps], not 0, with these; after `pace_limits`. Asks nothing of the chip.

        Raises UsageError for what its registers cannot hold.
        """
        ...

    async def pace_back(self, axis: int, /) -> None:
        """Bring the ramp back as it was at `pace_begin`, in a way that moves nothing: where a stop has left the axis
        without speed, the next move brings it back. Raises WrongState while it moves, WriteRefused, LinkError."""
        ...


class EventLog(Protocol):
    """Has an event register, whose edges are kept as a timeline."""

    def events(self, axis: int, after: int = 0, limit: int = 1000, /) -> EventPage:
        """The oldest `limit` entries behind number `after`. Raises UnknownThing for the axis."""
        ...


class TmclCommands(Protocol):
    """Speaks TMCL."""

    async def tmcl(self, command: int | str, type_: int | str = 0, motor: int = 0, value: int = 0, /) -> TmclExchange:
        """One command as it is, by numbers or by names. Raises LinkError; a bad status is an answer."""
        ...


class ParameterStore(Protocol):
    """Has an EEPROM that keeps parameters."""

    async def store(self, name: str, axis: int | None = None) -> RegisterReading:
        """Copy a parameter to EEPROM. Raises UnknownThing, and WrongState where that one cannot be stored."""
        ...

    async def restore(self, name: str, axis: int | None = None) -> RegisterReading:
        """Copy a parameter back from EEPROM."""
        ...


class MicrostepRam(Protocol):
    """Has a table of 64 values of a quarter of a wave in its RAM."""

    async def read_microstep_table(self) -> list[int]:
        """The 64 values."""
        ...

    async def write_microstep_table(self, values: Sequence[int]) -> list[int]:
        """Write 64 values of 0..63 and return the read-back. Raises UsageError, WriteRefused."""
        ...


class MslutTable(Protocol):
    """Has a table of one-bit differences (MSLUT)."""

    async def read_mslut(self, axis: int = 0) -> HeldMslut:
        """The registers of an axis's table."""
        ...

    async def write_mslut(self, registers: MslutRegisters, axis: int | None = None) -> HeldMslut:
        """Write MSLUT, MSLUTSEL and MSLUTSTART, of all axes or of one; what else shares a register (DAC_OFFSET) stays.
        Raises BadReply where the link shows that a word may have arrived otherwise."""
        ...


class DriverChainRam(Protocol):
    """Drives a chain of SPI drivers by datagrams that it composes."""

    async def read_driver_chain(self) -> ChainContents:
        """The chain's RAM and LSMD."""
        ...

    async def write_driver_chain(self, ram_words: Sequence[int], lsmd: int) -> ChainContents:
        """Write up to 32 RAM words and LSMD and return the read-back. Raises UsageError, WriteRefused."""
        ...


class ProgramMemory(Protocol):
    """Has a memory for a program, and executes it by itself."""

    @property
    def instructions(self) -> InstructionSet:
        """The commands that its programs are made of."""
        ...

    def assemble(self, text: str, files: Mapping[str, str], name: str = "program") -> Assembly:
        """The commands of a program; it may include `files` and those that every program may have."""
        ...

    async def download(self, commands: Sequence[Command], address: int = 0) -> ProgramDownload:
        """Store commands from `address` on, and read them back. A program that runs is stopped.

        Raises SoftLimit and WrongState before anything is sent, WriteRefused where another command is read back,
        LinkError.
        """
        ...

    async def read_program(self, address: int, count: int) -> list[Command]:
        """What the memory holds from `address` on. Raises WrongState where it is protected, LinkError."""
        ...

    async def run_program(self, address: int | None = None) -> None:
        """Begin at `address`, or go on where it stopped."""
        ...

    async def stop_program(self) -> None:
        """Stop the program. The motor goes on as it was told last."""
        ...

    async def step_program(self) -> None:
        """Do one command."""
        ...

    async def reset_program(self) -> None:
        """Stop it, and go to its start."""
        ...

    async def program_state(self, variables: Sequence[int] = (), priority: Priority = Priority.COMMAND) -> ProgramState:
        """What it does now, with these of its variables. Raises LinkError, and SampleDropped for a sample."""
        ...

    def state_questions(self, variables: int) -> int:
        """How many questions `program_state` asks for so many variables."""
        ...

    def includes(self) -> Mapping[str, str]:
        """The files that every program may include, by name."""
        ...

    def stepping(self, what: str) -> ProgramSteps:
        """Tell everybody once that a run by single steps begins, `what` in words; its steps are not told one by one."""
        ...


class ProgramSteps(Protocol):
    """Does a program one command at a time. A stop of the axis ends it: each call then raises WrongState."""

    async def step(self, moves: bool) -> int:
        """Do the command at the counter, which may move the motor if `moves`; where the counter is then.

        Sent once: where the answer is lost, whether it was done is not known. Raises LinkError.
        """
        ...

    async def counter(self) -> int:
        """Where the counter is; reads only. Raises LinkError."""
        ...


NO_ENCODER = ("has no encoder to record", "use a controller with an encoder input")
MISSING: dict[type, tuple[str, str]] = {
    EncoderSetting: NO_ENCODER,
    EncoderIndex: ("tells nothing of an index of its encoder", "search its reference by a switch"),
    PositionFromEncoder: ("cannot take its position from an encoder", "search its reference"),
    PositionSetting: ("cannot have its position set", "search its reference"),
    StallStop: ("measures no stall that could stop its motor", "search its reference by a switch"),
    VelocityJumps: ("moves on ramps only", "let it go on its ramp"),
    VelocityStream: ("takes no velocities one by one", "let it go on its ramp, or rotate"),
    LatchedFlags: ("keeps no flags", "its condition tells what is so now"),
    LinePace: ("has no ramp that can be paced here", "start it together with the others"),
    StartWire: ("has no pin for starts", "its moves start by their commands"),
    EventLog: ("has no event register", "its flags are in the axis's state"),
    TmclCommands: ("speaks no TMCL", "send it a datagram: POST .../exchange"),
    ProgramMemory: ("has no memory for programs", "let a script command it: stepscope has a client"),
    ParameterStore: ("has no EEPROM", "keep its profile: GET .../profile"),
    MicrostepRam: ("has no microstep table", "its step/direction driver makes microsteps"),
    MslutTable: ("has no table of differences (MSLUT)", ""),
    DriverChainRam: ("drives no chain of SPI drivers", "it has a step/direction output"),
}
"""What is said of a device without it, and what to do instead."""
