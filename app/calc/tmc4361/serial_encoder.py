"""A serial (absolute) encoder at a TMC4361: the bits of its answer, how long it takes, how fast the shaft may turn.

Facts: NOTES-TMC4361-ENCODER 1 and 3; TMC4361A (headers). An answer has turns, angle and status bits, the highest first;
status bits come in front, or last with left_aligned_data. `Frame` is also that of the chip's own serial output.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Kind = Literal["ssi", "spi"]
SSI_PAUSE_S = 21e-6
"""Rest of the clock between two SSI requests: less, and an encoder may answer with the old value (NOTES-TMC4361-ENCODER
3)."""
SSI_REPEAT_S = 19e-6
"""Rest before the same value is asked for again: more, and the encoder has a new one (NOTES-TMC4361-ENCODER 3)."""
CLOCK_HIGHEST_HZ = 2e6
"""What SSI encoders take at most, as a rule; long wires take less."""


@dataclass(frozen=True)
class Frame:
    """The bits of one answer.

    single_bits : of the angle, 1..32; multi_bits : of the turns, 0 for none; status_bits : 0..3
    gray : turns and angle together are Gray coded; status_last : status bits behind them, else in front

    Raises ValueError outside these ranges.
    """

    single_bits: int
    multi_bits: int = 0
    status_bits: int = 0
    gray: bool = False
    status_last: bool = False

    def __post_init__(self) -> None:
        for name, value, low, high in (
            ("single_bits", self.single_bits, 1, 32),
            ("multi_bits", self.multi_bits, 0, 32),
            ("status_bits", self.status_bits, 0, 3),
        ):
            if not low <= value <= high:
                raise ValueError(f"{name} is {low} to {high}, got {value}")

    @property
    def length(self) -> int:
        """Clocks of one answer."""
        return self.single_bits + self.multi_bits + self.status_bits

    @property
    def names(self) -> tuple[str, ...]:
        """What each bit is, the first sent first: T (turns), A (angle), S (status) and its place from 0."""
        status = tuple(f"S{bit}" for bit in reversed(range(self.status_bits)))
        data = (
            *(f"T{bit}" for bit in reversed(range(self.multi_bits))),
            *(f"A{bit}" for bit in reversed(range(self.single_bits))),
        )
        return (*data, *status) if self.status_last else (*status, *data)

    def bits(self, turns: int, angle: int, status: int = 0) -> tuple[int, ...]:
        """The answer for a place, the first bit sent first; numbers that are too wide lose their upper bits."""
        value = (turns & (1 << self.multi_bits) - 1) << self.single_bits | angle & (1 << self.single_bits) - 1
        if self.gray:
            value ^= value >> 1
        wide = self.single_bits + self.multi_bits
        data = [value >> bit & 1 for bit in reversed(range(wide))]
        told = [status >> bit & 1 for bit in reversed(range(self.status_bits))]
        return tuple(data + told if self.status_last else told + data)

    def place(self, bits: tuple[int, ...]) -> tuple[int, int, int]:
        """Turns (not signed), angle and status of an answer. Raises ValueError for another number of bits."""
        if len(bits) != self.length:
            raise ValueError(f"an answer has {self.length} bits, got {len(bits)}")
        cut = len(bits) - self.status_bits if self.status_last else self.status_bits
        data, told = (bits[:cut], bits[cut:]) if self.status_last else (bits[cut:], bits[:cut])
        value = _number(data)
        if self.gray:
            value = from_gray(value)
        return value >> self.single_bits, value & (1 << self.single_bits) - 1, _number(told)


def _number(bits: tuple[int, ...]) -> int:
    value = 0
    for bit in bits:
        value = value << 1 | bit
    return value


def from_gray(value: int) -> int:
    """The number of a Gray code, up to 64 bits."""
    shift = 1
    while shift < 64:
        value ^= value >> shift
        shift <<= 1
    return value


@dataclass(frozen=True)
class Requests:
    """How the chip asks: its registers, in clocks.

    high, low : SER_CLK_IN_HIGH_LOW; delay : SSI_IN_CLK_DELAY; repeat_wait : SSI_IN_WTIME; period : SER_PTIME
    twice : ssi_multi_cycle_data, each value is asked for twice and compared
    variation : SER_ENC_VARIATION, 0 where it does not limit

    Raises ValueError where a time cannot be.
    """

    kind: Kind
    clock_hz: float
    high: int
    low: int
    delay: int = 0
    repeat_wait: int = 0
    period: int = 0
    twice: bool = False
    variation: int = 0

    def __post_init__(self) -> None:
        if self.high < 1 or self.low < 1:
            raise ValueError("SER_CLK_IN_HIGH and SER_CLK_IN_LOW are 1 clock at least")


@dataclass(frozen=True)
class Timing:
    """What the settings come to.

    bit_hz : the encoder's clock [Hz]; answer_s : all clocks of one answer, both answers and the wait between where it
        is asked for twice [s]
    period_s : from one request to the next [s]; pause_s : rest of the clock between two requests [s]
    angle_deg : what one count is [deg]; turns : how many turns are told apart
    speed_rpm : fastest the shaft may turn: by half a turn between two answers where turns are not sent, and by the
        variation limit; None where nothing limits it
    warnings : what does not work, or not as it seems
    """

    bit_hz: float
    answer_s: float
    period_s: float
    pause_s: float
    angle_deg: float
    turns: int
    speed_rpm: float | None
    warnings: tuple[str, ...]


def timing(frame: Frame, requests: Requests, counts_per_turn: int = 0) -> Timing:
    """How long an answer takes, and what follows. `counts_per_turn` is ENC_IN_RES, 0 where it is not set."""
    clock = requests.clock_hz
    bit = requests.high + requests.low
    ssi = requests.kind == "ssi"
    once = frame.length * bit + (requests.delay if ssi else 0)
    answer = 2 * once + requests.repeat_wait if ssi and requests.twice else once
    least_pause = SSI_PAUSE_S * clock if ssi else 0.0
    period = max(float(requests.period), answer + least_pause)
    limits = []
    if not frame.multi_bits:
        limits.append(0.5 / (period / clock) * 60)
    if requests.variation and counts_per_turn:
        share = requests.variation / 2048 * counts_per_turn / (1 << frame.single_bits)
        limits.append(share / (period / clock) * 60)
    return Timing(
        bit_hz=clock / bit,
        answer_s=answer / clock,
        period_s=period / clock,
        pause_s=(period - answer) / clock,
        angle_deg=360 / (1 << frame.single_bits),
        turns=1 << frame.multi_bits,
        speed_rpm=min(limits) if limits else None,
        warnings=tuple(_warnings(frame, requests, counts_per_turn, answer, period)),
    )


def _warnings(frame: Frame, requests: Requests, counts: int, answer: float, period: float) -> list[str]:
    clock = requests.clock_hz
    bit_hz = clock / (requests.high + requests.low)
    found = []
    if counts and counts != 1 << frame.single_bits:
        found.append(
            f"ENC_IN_RES is {counts}, but {frame.single_bits} bits of angle are {1 << frame.single_bits} counts a turn"
        )
    if not counts:
        found.append("ENC_IN_RES is 0: no count moves ENC_POS")
    if requests.period < answer:
        found.append(
            f"SER_PTIME is shorter than an answer: requests follow every {period / clock * 1e6:.4g} us at best"
        )
    if requests.kind == "ssi":
        if bit_hz > CLOCK_HIGHEST_HZ:
            found.append(f"SSI encoders take clocks up to about 2 MHz, this one is {bit_hz / 1e6:.3g} MHz")
        if requests.twice and requests.repeat_wait > SSI_REPEAT_S * clock:
            found.append("SSI_IN_WTIME is longer than 19 us: the encoder may have a new value when it is asked again")
        if requests.delay >= requests.high + requests.low:
            found.append("SSI_IN_CLK_DELAY is longer than a bit")
    elif requests.twice or frame.gray:
        found.append("ssi_multi_cycle_data and ssi_gray_code_en are for SSI encoders")
    return found
