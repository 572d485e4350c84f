"""Telemetry channels of a TMCL module: which questions they need and what the answers mean.

A question costs 18 bytes on the wire, so a row asks only what its channels need, and each thing once.
The one exception are deviations: the position is asked right before and right after the encoder, and
the mean of the two is where the axis was at the moment of the encoder's reading.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from ...links.tmcl import FRAME_BYTES
from ...registers.model import Register
from ..core.motion_watch import MotionReading
from ..core.prediction import wrapped
from ..core.row_telemetry import RowTelemetry
from ..core.sample_plan import FloatArray, SamplePlan, Taken
from ..core.session import Session
from ..core.tmcl_frames import reading
from ..core.tmcl_link import TmclLink
from ..core.tmcl_samples import PACE, TmclDecoder, TmclPlan, TmclSampler
from .ongoing import OngoingMotion
from .roles import RegisterRoles
from .state import ModuleState

FROM_PREDICTION = {"predicted_position": "microsteps", "predicted_velocity": "pps", "residual": "microsteps"}
FIRST = (
    "position",
    "target_position",
    "velocity",
    "target_velocity",
    "encoder_position",
    "deviation",
    "external_encoder_position",
    "external_deviation",
)
"""What is listed first."""
SPEEDS = ("velocity", "target_velocity", "measured_speed")


class Quantities:
    """What can be sampled of one module: parameters that it has, and what is made of them."""

    def __init__(self, roles: RegisterRoles) -> None:
        direct = {
            "position": (roles.actual_position, "microsteps"),
            "target_position": (roles.target_position, "microsteps"),
            "velocity": (roles.actual_speed, "pps"),
            "target_velocity": (roles.target_speed, "pps"),
            "encoder_position": (roles.encoder, "microsteps"),
            "external_encoder_position": (roles.external_encoder, "microsteps"),
            "load_value": (roles.load, ""),
            "actual_current_scale": (roles.current_scale, "1/32"),
            "measured_speed": (roles.measured_speed, "pps"),
            "switch_left": (roles.left_switch, "0/1"),
            "switch_right": (roles.right_switch, "0/1"),
            "switch_home": (roles.home_switch, "0/1"),
            "position_reached": (roles.position_reached, "0/1"),
            "driver_flags": (roles.driver_flags, "bits"),
            "absolute_encoder": (roles.absolute_encoder, "1/1024 turn"),
            "pwm_scale": (roles.pwm_scale, ""),
        }
        deviations = {"deviation": roles.encoder, "external_deviation": roles.external_encoder}
        self.direct = {name: row for name, (row, _) in direct.items() if row not in roles.absent}
        """Channels that are one parameter."""
        self.deviations = {name: row for name, row in deviations.items() if row not in roles.absent}
        """Channels that compare an encoder with the position."""
        units = {name: unit for name, (_, unit) in direct.items()} | dict.fromkeys(deviations, "microsteps")
        known = {*self.direct, *self.deviations}
        self.units = {name: units[name] for name in (*FIRST, *direct) if name in known} | FROM_PREDICTION
        """Every channel quantity and its unit."""


class _Questions:
    """The questions of one row: each once, but positions again after an encoder."""

    def __init__(self, position: Register) -> None:
        self._position = position
        self.asked: list[Register] = []

    def column(self, register: Register) -> int:
        """Which question asks for `register`."""
        if register not in self.asked:
            self.asked.append(register)
        return self.asked.index(register)

    def bracketed(self, encoder: Register) -> tuple[int, int, int]:
        """Where the position before, the encoder, and the position after are asked, one right after the other."""
        if not self.asked or self.asked[-1] is not self._position:
            self.asked.append(self._position)
        self.asked += [encoder, self._position]
        end = len(self.asked) - 1
        return end - 2, end - 1, end


class ModuleTelemetry(RowTelemetry):
    """Samples of the module's axis."""

    def __init__(self, session: Session, state: ModuleState, link: TmclLink, ongoing: OngoingMotion) -> None:
        self._quantities = Quantities(state.roles)
        super().__init__(session, [self._quantities.units], PACE)
        self._state = state
        self._link = link
        self._ongoing = ongoing
        self._sampler = TmclSampler(session)

    def rows_at_once(self, plan: SamplePlan, rate_hz: float) -> int:
        return self._sampler.rows_at_once(plan, rate_hz)

    async def take_samples(self, plan: SamplePlan, rows: int = 1) -> Taken:
        return await self._sampler.take_samples(plan, rows)

    def sample_plan(self, channels: Sequence[str]) -> SamplePlan:
        chosen = self.chosen(channels)
        wanted = [channel.quantity for channel in chosen]
        questions = _Questions(self._state.roles.actual_position)
        brackets = {
            quantity: questions.bracketed(encoder)
            for quantity, encoder in self._quantities.deviations.items()
            if quantity in wanted
        }
        if any(quantity in FROM_PREDICTION for quantity in wanted):
            # It tells where something stopped the motor that no command told of.
            questions.column(self._state.roles.actual_speed)
        decoders = tuple(self._decoder(quantity, questions, brackets) for quantity in wanted)
        frames = tuple(reading(self._link.address, register).encode() for register in questions.asked)
        return TmclPlan(frames, chosen, FRAME_BYTES, decoders, self._watcher(questions.asked))

    def _decoder(self, quantity: str, questions: _Questions, brackets: dict[str, tuple[int, int, int]]) -> TmclDecoder:
        if quantity in brackets:
            before, encoder, after = brackets[quantity]
            return lambda _, values: self._apart(values[:, encoder], values[:, before], values[:, after])
        if quantity in FROM_PREDICTION:
            return self._expected(quantity, questions)
        column = questions.column(self._quantities.direct[quantity])
        if quantity in SPEEDS:
            return lambda _, values: values[:, column] * self._speed_unit()
        return lambda _, values: values[:, column]

    def _apart(self, encoder: FloatArray, before: FloatArray, after: FloatArray) -> FloatArray:
        """How far the encoder is from the mean of two positions; both counters wrap."""
        bits = self._state.module.position_bits
        return wrapped(encoder - before, bits) - wrapped(after - before, bits) / 2

    def _speed_unit(self) -> float:
        """What a speed of 1 is [pps]; NaN while nobody knows what the module counts in."""
        return float("nan") if None in self._state.counted_by else self._state.speed_unit_pps

    def _expected(self, quantity: str, questions: _Questions) -> TmclDecoder:
        book, bits = self._ongoing.book, self._state.module.position_bits
        if quantity == "predicted_position":
            return lambda times_s, _: wrapped(book.at(times_s)[0], bits)
        if quantity == "predicted_velocity":
            return lambda times_s, _: book.at(times_s)[1]
        column = questions.column(self._state.roles.actual_position)
        return lambda times_s, values: wrapped(values[:, column] - book.at(times_s)[0], bits)

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
        if self._state.roles.actual_position not in asked:
            return None
        position = asked.index(self._state.roles.actual_position)
        encoder = asked.index(self._state.roles.encoder) if self._state.roles.encoder in asked else None

        def seen(times_s: FloatArray, values: FloatArray) -> None:
            count, with_it = values[-1, position], np.nan if encoder is None else values[-1, encoder]
            if np.isfinite(count):
                asked_at_s = float(times_s[-1]) - self._sampler.row_spread_s()
                self._session.saw_position(0, int(count), asked_at_s, int(with_it) if np.isfinite(with_it) else None)

        return seen

    def _end_watcher(self, asked: Sequence[Register]) -> Callable[[FloatArray, FloatArray], None] | None:
        if self._state.roles.actual_speed not in asked:
            return None
        speed = asked.index(self._state.roles.actual_speed)
        others = [self._state.roles.actual_position, self._state.roles.position_reached]
        whole = all(row in asked for row in others)
        position, reached = (asked.index(row) if whole else 0 for row in others)

        def seen(times_s: FloatArray, values: FloatArray) -> None:
            if self._ongoing.book.present() is not None:
                _, expected = self._ongoing.book.at(times_s)
                # NaN, where nothing is expected or known, compares false, and so does an expected rest.
                self._ongoing.book.observe(times_s, (values[:, speed] == 0) & (np.abs(expected) > 0))
            if whole:
                self._watch_rows(times_s, values[:, position], values[:, speed], values[:, reached])

        return seen

    def _watch_rows(self, times_s: FloatArray, position: FloatArray, speed: FloatArray, reached: FloatArray) -> None:
        """Polls out of telemetry: all of them while a motion is under way, else only those that see one."""
        known = np.isfinite(position) & np.isfinite(speed) & np.isfinite(reached)
        spread_s = self._sampler.row_spread_s()
        for row in np.flatnonzero(known & (speed != 0) if self._ongoing.watch.under_way is None else known):
            self._ongoing.watch.update(
                MotionReading(float(times_s[row]), int(position[row]), float(speed[row]), bool(reached[row])), spread_s
            )
