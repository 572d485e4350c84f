"""Telemetry channels of a TMCL module: which questions they need and what the answers mean.

A question costs 18 bytes on the wire, so a row asks only what its channels need, and each thing once.
The one exception are deviations: the position is asked right before and right after the encoder, and
the mean of the two is where the axis was at the moment of the encoder's reading.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ...errors import BadReply, LinkTimeout, UnknownThing, UsageError
from ...links.port import Batch
from ...links.queue import Priority
from ...links.tmcl import FRAME_BYTES
from ...registers.model import Register
from ...registers.tmcl.commands import Status
from ..core.motion_watch import Look
from ..core.planned_motion import POSITION_BITS
from ..core.prediction import wrapped
from ..core.sample_plan import Channel, FloatArray, SamplePlan, Taken
from . import rows
from .counter import Counting
from .frames import reading

ROW_RATE_MAX_HZ = 1000.0
CALLS_EMULATED_HZ = 10_000.0
"""Questions a second asked of an emulated module in this process: it answers 180,000, so they cost 6 % of a core."""
CALLS_WIRE_HZ = 10_000.0
"""The same for a wire that sets no limit of its own (USB, a socket)."""
SATURATED = 0.8
"""From this share of a wire on, rows are taken several at once: the way to the wire's thread and back costs a row of
one question a tenth of its time."""
AT_ONCE_S = 0.033
"""How long the rows taken at once last [s]: less than a beat of the screen later than they could be."""

DIRECT: dict[str, tuple[Register, str]] = {
    "position": (rows.ACTUAL_POSITION, "microsteps"),
    "target_position": (rows.TARGET_POSITION, "microsteps"),
    "velocity": (rows.ACTUAL_SPEED, "pps"),
    "target_velocity": (rows.TARGET_SPEED, "pps"),
    "encoder_position": (rows.ENCODER, "microsteps"),
    "external_encoder_position": (rows.EXTERNAL_ENCODER, "microsteps"),
    "load_value": (rows.LOAD, ""),
    "actual_current_scale": (rows.CURRENT_SCALE, "1/32"),
    "measured_speed": (rows.MEASURED_SPEED, "pps"),
    "switch_left": (rows.LEFT_SWITCH, "0/1"),
    "switch_right": (rows.RIGHT_SWITCH, "0/1"),
    "switch_home": (rows.HOME_SWITCH, "0/1"),
    "position_reached": (rows.POSITION_REACHED, "0/1"),
    "driver_flags": (rows.DRIVER_FLAGS, "bits"),
    "absolute_encoder": (rows.ABSOLUTE_ENCODER, "1/1024 turn"),
    "pwm_scale": (rows.PWM_SCALE, ""),
}
"""Channels that are one parameter, with their units."""
DEVIATIONS = {"deviation": rows.ENCODER, "external_deviation": rows.EXTERNAL_ENCODER}
FROM_PREDICTION = {"predicted_position": "microsteps", "predicted_velocity": "pps", "residual": "microsteps"}
SPEEDS = ("velocity", "target_velocity", "measured_speed")
QUANTITIES = {
    "position": "microsteps",
    "target_position": "microsteps",
    "velocity": "pps",
    "target_velocity": "pps",
    "encoder_position": "microsteps",
    "deviation": "microsteps",
    "external_encoder_position": "microsteps",
    "external_deviation": "microsteps",
    **{name: unit for name, (_, unit) in DIRECT.items()},
    **FROM_PREDICTION,
}
"""Every channel quantity and its unit."""

TmclDecoder = Callable[[FloatArray, FloatArray], FloatArray]
"""(time_s[rows], values[rows, questions], NaN where an answer was wrong) to one column [rows]."""


@dataclass(frozen=True, slots=True)
class TmclPlan(SamplePlan):
    """Answers of nine bytes."""

    columns: tuple[TmclDecoder, ...]
    seen: Callable[[FloatArray, FloatArray], None] | None = None
    """Hears the times and values of each block, e.g. to learn that a motion has ended."""

    reply_bytes: ClassVar[int] = FRAME_BYTES

    def decode(self, times_s: FloatArray, replies: bytes) -> FloatArray:
        count = len(times_s)
        self._require_rows(count, replies)
        values = values_of(self.frames, replies, count)
        if self.seen is not None and count:
            self.seen(times_s, values)
        columns = np.empty((count, len(self.columns)))
        for index, decode in enumerate(self.columns):
            columns[:, index] = decode(times_s, values)
        return columns


def values_of(frames: Sequence[bytes], replies: bytes, count: int) -> FloatArray:
    """The values of `count` rows of answers to `frames` [rows, frames].

    NaN where an answer is not sound: its checksum, its module, its command, or a status that is not 100.
    """
    answers = np.frombuffer(replies, dtype=np.uint8).reshape(count, len(frames), FRAME_BYTES)
    asked = np.frombuffer(b"".join(frames), dtype=np.uint8).reshape(len(frames), FRAME_BYTES)
    # uint8 sums wrap at 256 by themselves, which is what the checksum does.
    sound = answers[:, :, :8].sum(axis=2, dtype=np.uint8) == answers[:, :, 8]
    sound &= answers[:, :, 1] == asked[:, 0]
    sound &= answers[:, :, 2] == Status.OK
    sound &= answers[:, :, 3] == asked[:, 1]
    values = np.ascontiguousarray(answers[:, :, 4:8]).view(">i4")[:, :, 0].astype(np.float64)
    values[~sound] = np.nan
    return values


class _Questions:
    """The questions of one row: each once, but positions again after an encoder."""

    def __init__(self) -> None:
        self.asked: list[Register] = []

    def column(self, register: Register) -> int:
        """Which question asks for `register`."""
        if register not in self.asked:
            self.asked.append(register)
        return self.asked.index(register)

    def bracketed(self, encoder: Register) -> tuple[int, int, int]:
        """Where the position before, the encoder, and the position after are asked, one right after the other."""
        if not self.asked or self.asked[-1] is not rows.ACTUAL_POSITION:
            self.asked.append(rows.ACTUAL_POSITION)
        self.asked += [encoder, rows.ACTUAL_POSITION]
        end = len(self.asked) - 1
        return end - 2, end - 1, end


class Samples(Counting):
    """A TMCL module with telemetry."""

    _row_spread_latest_s = 0.0

    @property
    def rate_max_hz(self) -> float:
        return self._row_rate(1)

    def sample_rate_max_hz(self, plan: SamplePlan) -> float:
        return self._row_rate(len(plan.frames))

    def _row_rate(self, questions: int) -> float:
        """Rows a second of so many questions each."""
        possible = CALLS_EMULATED_HZ if self.chip_timed else self.calls_per_s_possible or CALLS_WIRE_HZ
        return min(ROW_RATE_MAX_HZ, possible / questions)

    def rows_at_once(self, plan: SamplePlan, rate_hz: float) -> int:
        possible, questions = self.calls_per_s_possible, len(plan.frames)
        if possible is None or rate_hz * questions < SATURATED * possible:
            return 1
        return max(1, int(AT_ONCE_S * possible / questions))

    async def take_samples(self, plan: SamplePlan, rows: int = 1) -> Taken:
        try:
            return await self._take(plan, rows)
        except (BadReply, LinkTimeout):
            # The link is in step again, and a row only reads: one flipped bit must not make a hole of a quarter second.
            return await self._take(plan, 1)

    async def _take(self, plan: SamplePlan, rows: int) -> Taken:
        """Several rows in one go; each bears the middle of the time between its first and its last answer."""
        count = len(plan.frames)
        frames = plan.frames * rows if rows > 1 else plan.frames
        async with self.queue.turn(Priority.SAMPLE) as turn:
            answers = await turn.exchange_many(frames)
            first_s, last_s = self.queue.sample_span_s = turn.span_s
        batch = getattr(self.port, "batch", None)
        if isinstance(batch, Batch) and len(batch.answered_s) == len(frames):
            answered_s = batch.started_s + np.array(batch.answered_s)
        else:  # something more urgent came between: the answers are taken to lie evenly
            answered_s = np.linspace(first_s, max(first_s, last_s), len(frames))
        begin_s, end_s = answered_s[::count], answered_s[count - 1 :: count]
        replies = [b"".join(answers[row * count : (row + 1) * count]) for row in range(rows)]
        self._row_spread_latest_s = float((end_s - begin_s).max())
        return Taken(((begin_s + end_s) / 2).tolist(), replies, float((end_s - begin_s).mean()))

    @property
    def shares_rows(self) -> bool:
        return not self.chip_timed

    def channels(self) -> tuple[Channel, ...]:
        return tuple(
            Channel(f"{quantity}.{axis.index}", quantity, axis.index, unit)
            for axis in self.axes
            for quantity, unit in QUANTITIES.items()
        )

    def sample_plan(self, channels: Sequence[str]) -> SamplePlan:
        if not channels:
            raise UsageError("a sample of no channel")
        known = {channel.name: channel for channel in self.channels()}
        unknown = next((name for name in channels if name not in known), None)
        if unknown is not None:
            raise UnknownThing("channel", unknown, list(known))
        chosen = tuple(known[name] for name in channels)
        wanted = [channel.quantity for channel in chosen]
        questions = _Questions()
        brackets = {
            quantity: questions.bracketed(encoder) for quantity, encoder in DEVIATIONS.items() if quantity in wanted
        }
        if any(quantity in FROM_PREDICTION for quantity in wanted):
            questions.column(rows.ACTUAL_SPEED)  # it tells where something stopped the motor that no command told of
        decoders = tuple(self._decoder(quantity, questions, brackets) for quantity in wanted)
        frames = tuple(reading(self.address, register).encode() for register in questions.asked)
        return TmclPlan(frames, chosen, decoders, self._watcher(questions.asked))

    def _decoder(self, quantity: str, questions: _Questions, brackets: dict[str, tuple[int, int, int]]) -> TmclDecoder:
        if quantity in brackets:
            before, encoder, after = brackets[quantity]
            return lambda _, values: values[:, encoder] - (values[:, before] + values[:, after]) / 2
        if quantity in FROM_PREDICTION:
            return self._expected(quantity, questions)
        column = questions.column(DIRECT[quantity][0])
        if quantity in SPEEDS:
            return lambda _, values: values[:, column] * self._speed_unit()
        return lambda _, values: values[:, column]

    def _speed_unit(self) -> float:
        """What a speed of 1 is [pps]; NaN while nobody knows what the module counts in."""
        return float("nan") if self.unit_mode is None else self.speed_unit_pps

    def _expected(self, quantity: str, questions: _Questions) -> TmclDecoder:
        if quantity == "predicted_position":
            return lambda times_s, _: self._book.at(times_s)[0]
        if quantity == "predicted_velocity":
            return lambda times_s, _: self._book.at(times_s)[1]
        column = questions.column(rows.ACTUAL_POSITION)
        return lambda times_s, values: wrapped(values[:, column] - self._book.at(times_s)[0], POSITION_BITS)

    def _watcher(self, asked: Sequence[Register]) -> Callable[[FloatArray, FloatArray], None] | None:
        """What these questions tell of where the axis is, of a motion's end and of predictions; None where nothing."""
        where = self._position_watcher(asked)
        ends = self._end_watcher(asked)
        if where is None or ends is None:
            return where or ends

        def seen(times_s: FloatArray, values: FloatArray) -> None:
            where(times_s, values)
            ends(times_s, values)

        return seen

    def _position_watcher(self, asked: Sequence[Register]) -> Callable[[FloatArray, FloatArray], None] | None:
        if rows.ACTUAL_POSITION not in asked:
            return None
        position = asked.index(rows.ACTUAL_POSITION)
        encoder = asked.index(rows.ENCODER) if rows.ENCODER in asked else None

        def seen(times_s: FloatArray, values: FloatArray) -> None:
            count, with_it = values[-1, position], np.nan if encoder is None else values[-1, encoder]
            if np.isfinite(count):
                asked_at_s = float(times_s[-1]) - self._row_spread_s()
                self.saw_position(0, int(count), asked_at_s, int(with_it) if np.isfinite(with_it) else None)

        return seen

    def _end_watcher(self, asked: Sequence[Register]) -> Callable[[FloatArray, FloatArray], None] | None:
        if rows.ACTUAL_SPEED not in asked:
            return None
        speed = asked.index(rows.ACTUAL_SPEED)
        others = [rows.ACTUAL_POSITION, rows.POSITION_REACHED]
        whole = all(row in asked for row in others)
        position, reached = (asked.index(row) if whole else 0 for row in others)

        def seen(times_s: FloatArray, values: FloatArray) -> None:
            if self._book.present() is not None:
                _, expected = self._book.at(times_s)
                # NaN, where nothing is expected or known, compares false, and so does an expected rest.
                self._book.observe(times_s, (values[:, speed] == 0) & (np.abs(expected) > 0))
            if whole:
                self._watch_rows(times_s, values[:, position], values[:, speed], values[:, reached])

        return seen

    def _watch_rows(self, times_s: FloatArray, position: FloatArray, speed: FloatArray, reached: FloatArray) -> None:
        """Looks out of telemetry: all of them while a motion is under way, else only those that see one."""
        known = np.isfinite(position) & np.isfinite(speed) & np.isfinite(reached)
        spread_s = self._row_spread_s()
        for row in np.flatnonzero(known & (speed != 0) if self._watch.under_way is None else known):
            self._watch.look(
                Look(float(times_s[row]), int(position[row]), float(speed[row]), bool(reached[row])), spread_s
            )

    def _row_spread_s(self) -> float:
        """From the first to the last question of a row [s]: none where the far end samples itself."""
        return 0.0 if self.chip_timed else self._row_spread_latest_s
