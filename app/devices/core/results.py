"""What drivers answer. Plain records, whose names are those of the REST contract."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from ...calc.microsteps.mslut import MslutRegisters
from ...errors import BenchError

StopMode = Literal["ramp", "immediate"]
StopReason = Literal[
    "target_reached",
    "stop_command",
    "left_switch",
    "right_switch",
    "stall",
    "deviation",
    "driver_error",
    "lost_link",
    "unknown",
]
DeviceState = Literal["connected", "connecting", "disconnected", "failed"]


@dataclass(slots=True)
class RegisterReading:
    """One register as the chip holds it; of a field asked for by its own name, `value` is the field's."""

    name: str
    address: int
    axis: int | None
    raw: int
    """The register's meaningful bits."""
    value: int
    fields: dict[str, int]
    unit: str
    space: str = "register"
    """In which set of numbers `address` counts, as `registers.model.Space`."""
    kept: bool = False
    """It cannot be read: this is what the driver has in mind of it."""


@dataclass(slots=True)
class RegisterWritten(RegisterReading):
    """The read-back of a write."""

    written: int = 0
    """The word that was sent."""
    verified: bool | None = True
    """None where the chip may change the register by itself, so that a difference proves nothing."""
    note: str = ""


@dataclass(slots=True)
class BatchResult:
    """How far several writes came: `failed` is what ended them, `not_tried` how many were left."""

    done: list[RegisterWritten]
    failed: BenchError | None
    not_tried: int


@dataclass(slots=True)
class WriteItem:
    """One write of a batch: the whole value, or some fields."""

    name: str
    axis: int | None = None
    value: int | None = None
    fields: dict[str, int | str] | None = None


@dataclass(slots=True)
class Switches:
    """True is active; None where the wiring has no such switch. `home` is the reference switch."""

    left: bool | None
    right: bool | None
    home: bool | None


@dataclass(slots=True)
class AxisState:
    """One axis, read now. Positions in microsteps; None where the family, or the mode, has no such thing."""

    position: int
    target_position: int | None
    velocity_pps: float
    target_velocity_pps: float | None
    acceleration_pps2: float | None
    position_reached: bool
    moving: bool
    mode: str
    """RAMP_MODE, SOFT_MODE, VELOCITY_MODE or HOLD_MODE; of a TMCL module position, velocity, hold, step/dir or
    reference search."""
    switches: Switches
    flags: dict[str, bool]
    time_s: float
    """Device time of the reading of the position."""
    encoder_position: int | None = None
    deviation: float | None = None
    """Encoder less position, both of one moment."""
    external_encoder_position: int | None = None
    external_deviation: float | None = None
    encoder_velocity_pps: float | None = None
    load_angle_deg: float | None = None
    """How far the field leads the rotor, electrical."""


@dataclass(slots=True)
class AxisMove:
    """One axis's part of a move of several that start together."""

    axis: int
    target: float
    relative: bool = False
    unit: str = "microsteps"
    over_the_end: bool = False
    """The target is what the position counter shall show, in microsteps, and the way to it the shorter one round: where
    it leads over the counter's end it is not refused."""


@dataclass(slots=True)
class MoveStarted:
    """A move under way, device time."""

    axis: int
    from_position: int
    target_position: int
    started_at_s: float
    predicted_duration_s: float | None
    warnings: list[str] = field(default_factory=list)


@dataclass(slots=True)
class Rotating:
    """A rotation under way."""

    axis: int
    velocity_chip: int
    velocity_pps: float
    warnings: list[str] = field(default_factory=list)


@dataclass(slots=True)
class StopOutcome:
    """What came of a stop of one axis, and how long it took from the call on."""

    device: str
    axis: int
    ok: bool
    took_ms: float
    problem: BenchError | None = None


@dataclass(slots=True)
class RawExchange:
    """A raw datagram and its answer: `decoded` has address, register, axis, rw, data, value, fields, status, flags."""

    reply: bytes
    decoded: dict[str, object]


@dataclass(frozen=True, slots=True)
class MotionEnd:
    """A motor came to rest, or was lost sight of: when, where [microsteps] and why."""

    axis: int
    reason: StopReason
    time_s: float
    """Device time; the middle between the last look that saw it turn and the first that saw it rest."""
    unix_s: float
    position: int | None
    """None where it could not be read."""
    detail: str
    """For people: what was seen."""


@dataclass(frozen=True, slots=True)
class ChipEvents:
    """What a chip's event register told at one look that it had not told before."""

    axis: int
    seq: int
    """Counts on by one."""
    time_s: float
    """Device time of the look [s]."""
    unix_s: float
    names: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class ProgramEvent:
    """A device's program began, halted or ended: a mark on the time axis of the scope and of recordings."""

    axis: int
    time_s: float
    """Device time at which it was commanded or seen [s]."""
    address: int | None
    """Of the command that is done next; None where nobody has read it."""
    text: str
    """For people: `program halted at 4, a breakpoint`."""


@dataclass(frozen=True, slots=True)
class EventPage:
    """A stretch of the timeline, oldest first."""

    events: tuple[ChipEvents, ...]
    next: int
    """What to ask from next."""
    lost: int
    """Entries that were asked for and are not kept any more."""


@dataclass(frozen=True, slots=True)
class TmclExchange:
    """One TMCL command in direct mode and its answer. A status of an error is an answer like any other."""

    request: bytes
    reply: bytes | None
    """None where the module answers nothing to this command."""
    status: int | None
    status_text: str
    value: int | None
    text: str
    """The whole exchange, readable: `GAP 1, 0 -> -5000`."""
    took_ms: float


@dataclass(frozen=True, slots=True)
class ProgramState:
    """What the interpreter of a device's program does, as far as the device tells it."""

    status: Literal["stopped", "running", "stepping", "reset"]
    downloading: bool
    counter: int
    """Address of the command that is done next, or waits."""
    accumulator: int
    x: int
    error: int | None
    """Status of the latest command that was refused; None where the device does not tell."""
    variables: dict[int, int]


@dataclass(frozen=True, slots=True)
class ProgramDownload:
    """A program that was stored and read back."""

    address: int
    """Of its first command."""
    commands: int
    sent_again: int
    """How many commands were sent again, for their answers were lost or garbled."""


@dataclass(slots=True)
class ChainContents:
    """The driver chain as the chip holds it: 32 RAM words (two 6-bit cells each), and LSMD."""

    ram_words: list[int]
    lsmd: int


@dataclass(frozen=True, slots=True)
class HeldMslut:
    """A table of one-bit differences as the chip holds it, and what it shows of it at this moment.

    The registers can be written only: they are those last written through this connection, or else those of power-on
    (`written` False). What can be read is where the wave stands and both currents there: MSCNT and CURRENTA, CURRENTB
    of one turn of the link, while the motor may move.
    """

    registers: MslutRegisters
    written: bool
    position: int
    current_a: int
    current_b: int
