"""Telemetry channels of a ramp generator chip: which frames they need and what the replies mean."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ...calc.units.tmc428 import acceleration_hz_s, pulse_rate_hz
from ...errors import UnknownThing, UsageError
from ...links.access32 import READ_FRAMES
from ...registers.model import Register
from ..core.prediction import wrapped
from ..core.sample_plan import Channel, DatagramPlan, Decoder, FloatArray, SamplePlan
from .counter import RampCounter
from .prediction import POSITION_BITS, TickedBook

IntArray = NDArray[np.int64]

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


class Frames:
    """The frames of one sample: each register once, the status bits with any of them."""

    def __init__(self) -> None:
        self.addresses: list[int] = []

    def column(self, register: Register) -> int:
        """Which word of a sample holds `register`."""
        if register.address not in self.addresses:
            self.addresses.append(register.address)
        return self.addresses.index(register.address)


class RampSamples(RampCounter):
    """`RampChip` with telemetry."""

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
        frames = Frames()
        expected = {
            axis: _Expected(self._books[axis], self.rows[axis].v_actual, frames)
            for axis in {channel.axis for channel in chosen if channel.quantity in FROM_PREDICTION}
        }
        decoders = tuple(self._decoder(channel.quantity, channel.axis, frames, expected) for channel in chosen)
        if not frames.addresses:  # status bits and predictions alone: any register brings the status
            frames.column(self.rows[chosen[0].axis].x_actual)
        return DatagramPlan(tuple(READ_FRAMES[address] for address in frames.addresses), chosen, decoders)

    def _decoder(self, quantity: str, axis: int, frames: Frames, expected: dict[int, _Expected]) -> Decoder:
        rows = self.rows[axis]
        registers = {
            "position": rows.x_actual,
            "target_position": rows.x_target,
            "velocity": rows.v_actual,
            "target_velocity": rows.v_target,
            "acceleration": rows.a_actual,
            "residual": rows.x_actual,
        }
        if quantity.startswith("switch_"):
            return self._switch_decoder(quantity.removeprefix("switch_"), axis, frames)
        if quantity == "position_reached":
            return lambda _, __, status: self._reached_column(status, axis)
        if quantity == "predicted_position":
            return lambda times_s, words, _: expected[axis](times_s, words)[0]
        if quantity == "predicted_velocity":
            return lambda times_s, words, _: expected[axis](times_s, words)[1]
        register = registers[quantity]
        column = frames.column(register)
        number = _number(register)
        if quantity == "position":
            return lambda times_s, words, _: self._seen_positions(axis, times_s, number(words[:, column]))
        if quantity == "target_position":
            return lambda _, words, __: number(words[:, column])
        if quantity == "residual":
            return lambda times_s, words, _: expected[axis].residual(times_s, words, number(words[:, column]))
        if quantity == "acceleration":
            return lambda _, words, __: number(words[:, column]) * self._acceleration_unit(axis)
        return lambda _, words, __: number(words[:, column]) * self._velocity_unit(axis)

    def _seen_positions(self, axis: int, times_s: FloatArray, positions: FloatArray) -> FloatArray:
        if len(positions):
            self.saw_position(axis, int(positions[-1]), float(times_s[-1]))
        return positions

    def _velocity_unit(self, axis: int) -> float:
        """What one chip unit of velocity is [pps]; NaN before the divider was seen."""
        pulse_div = self.axes[axis].pulse_div
        return float("nan") if pulse_div is None else pulse_rate_hz(1, pulse_div, self.clock_hz)

    def _acceleration_unit(self, axis: int) -> float:
        pulse_div, ramp_div = self.axes[axis].pulse_div, self.axes[axis].ramp_div
        if pulse_div is None or ramp_div is None:
            return float("nan")
        return acceleration_hz_s(1, pulse_div, ramp_div, self.clock_hz)

    def _reached_column(self, status: IntArray, axis: int) -> FloatArray:
        raise NotImplementedError

    def _switch_decoder(self, side: str, axis: int, frames: Frames) -> Decoder:
        raise NotImplementedError


class _Expected:
    """What was expected of one axis at the times of a block of samples, computed once for all its channels."""

    def __init__(self, book: TickedBook, v_actual: Register, frames: Frames) -> None:
        self._book = book
        self._column = frames.column(v_actual)
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


def _number(register: Register) -> _Number:
    return _Number(register.width, signed=register.signed)


class _Number:
    """Register words to values, a column at a time."""

    def __init__(self, width: int, *, signed: bool) -> None:
        self._mask = (1 << width) - 1
        self._sign = 1 << (width - 1) if signed else 0

    def __call__(self, words: IntArray) -> FloatArray:
        return (((words & self._mask) ^ self._sign) - self._sign).astype(np.float64)
