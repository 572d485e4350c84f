"""Telemetry channels of a ramp generator chip: which frames they need and what the replies mean."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ...calc.units.tmc428 import acceleration_hz_s, pulse_rate_hz
from ...registers.model import Register
from ..core.prediction import wrapped
from ..core.register_link import RegisterLink
from ..core.register_samples import Asked, number, words_plan
from ..core.row_telemetry import Pace, RowTelemetry
from ..core.sample_plan import Decoder, FloatArray, IntArray, SamplePlan
from .interrupts import Interrupts
from .memory import RampMemory
from .prediction import POSITION_BITS, TickedBook
from .switching import Switching

PACE = Pace(rows_wire_hz=500.0, frames_emulated_hz=math.inf, frames_wire_hz=math.inf, shares_rows=False)
"""What a socket and a task a sample carry without taking the link from commands; measured, not promised."""

QUANTITIES = {
    "position": "microsteps",
    "target_position": "microsteps",
    "velocity": "pps",
    "target_velocity": "pps",
    "acceleration": "pps^2",
    "switch_left": "0/1",
    "switch_right": "0/1",
    "switch_reference": "0/1",
    "position_reached": "0/1",
    "predicted_position": "microsteps",
    "predicted_velocity": "pps",
    "residual": "microsteps",
}
"""Channel quantities and their units."""


FROM_PREDICTION = ("predicted_position", "predicted_velocity", "residual")


class RampTelemetry(RowTelemetry):
    """Telemetry of a ramp generator chip: a datagram a register, the status bits with each."""

    def __init__(
        self,
        link: RegisterLink,
        memory: RampMemory,
        switching: Switching,
        books: Sequence[TickedBook],
        interrupts: Interrupts,
    ) -> None:
        super().__init__(link.session, [QUANTITIES] * len(memory.rows), PACE)
        self._access = link.access
        self._memory = memory
        self._switching = switching
        self._books = books
        self._interrupts = interrupts

    def sample_plan(self, channels: Sequence[str]) -> SamplePlan:
        chosen = self.chosen(channels)
        asked = Asked()
        expected = {
            axis: _Expected(self._books[axis], self._memory.rows[axis].v_actual, asked)
            for axis in {channel.axis for channel in chosen if channel.quantity in FROM_PREDICTION}
        }
        decoders = tuple(self._decoder(channel.quantity, channel.axis, asked, expected) for channel in chosen)
        if not asked.registers:  # status bits and predictions alone: any register brings the status
            asked.column(self._memory.rows[chosen[0].axis].x_actual)
        return words_plan(self._access, asked, chosen, decoders, self._interrupts.saw_rows)

    def _decoder(self, quantity: str, axis: int, asked: Asked, expected: dict[int, _Expected]) -> Decoder:
        rows = self._memory.rows[axis]
        registers = {
            "position": rows.x_actual,
            "target_position": rows.x_target,
            "velocity": rows.v_actual,
            "target_velocity": rows.v_target,
            "acceleration": rows.a_actual,
            "residual": rows.x_actual,
        }
        if quantity.startswith("switch_"):
            return self._switching.decoder(quantity.removeprefix("switch_"), axis, asked)
        if quantity == "position_reached":
            return lambda _, __, status: self._switching.reached_column(status, axis)
        if quantity == "predicted_position":
            return lambda times_s, words, _: expected[axis](times_s, words)[0]
        if quantity == "predicted_velocity":
            return lambda times_s, words, _: expected[axis](times_s, words)[1]
        register = registers[quantity]
        value = number(asked.column(register), register)
        if quantity == "position":
            return lambda times_s, *block: self._seen_positions(axis, times_s, value(times_s, *block))
        if quantity == "target_position":
            return value
        if quantity == "residual":
            return lambda times_s, words, status: expected[axis].residual(times_s, words, value(times_s, words, status))
        unit = self._acceleration_unit if quantity == "acceleration" else self._velocity_unit
        return lambda *block: value(*block) * unit(axis)

    def _seen_positions(self, axis: int, times_s: FloatArray, positions: FloatArray) -> FloatArray:
        if len(positions):
            self._session.saw_position(axis, int(positions[-1]), float(times_s[-1]))
        return positions

    def _velocity_unit(self, axis: int) -> float:
        """What one chip unit of velocity is [pps]; NaN before the divider was seen."""
        pulse_div = self._session.axes[axis].pulse_div
        return float("nan") if pulse_div is None else pulse_rate_hz(1, pulse_div, self._session.clock_hz)

    def _acceleration_unit(self, axis: int) -> float:
        pulse_div, ramp_div = self._session.axes[axis].pulse_div, self._session.axes[axis].ramp_div
        if pulse_div is None or ramp_div is None:
            return float("nan")
        return acceleration_hz_s(1, pulse_div, ramp_div, self._session.clock_hz)


class _Expected:
    """What was expected of one axis at the times of a block of samples, computed once for all its channels."""

    def __init__(self, book: TickedBook, v_actual: Register, asked: Asked) -> None:
        self._book = book
        self._column = asked.column(v_actual)
        self._block: IntArray | None = None
        self._known: tuple[FloatArray, FloatArray] = (np.empty(0), np.empty(0))

    def __call__(self, times_s: FloatArray, words: IntArray) -> tuple[FloatArray, FloatArray]:
        """Position [microsteps] and velocity [pps], NaN where nothing was expected [rows]."""
        if self._block is not words:
            position, velocity = self._book.at(times_s)
            present = self._book.present()
            if present is not None:
                # NaN, where nothing is expected, compares false, and so does an expected rest.
                self._book.observe(times_s, (words[:, self._column] & 0xFFF == 0) & (np.abs(velocity) > 0))
                if present.ended_at_s is not None:
                    position, velocity = self._book.at(times_s)
            self._block, self._known = words, (position, velocity)
        return self._known

    def residual(self, times_s: FloatArray, words: IntArray, position: FloatArray) -> FloatArray:
        """Measured less expected position [microsteps, rows], from which later predictions learn."""
        expected, velocity = self(times_s, words)
        difference = wrapped(position - expected, POSITION_BITS)
        self._book.learn(times_s, difference, velocity)
        return difference
