"""Moves on a ramp of a speed and acceleration of their own: dividers, v_max, a_max and the pair that come nearest.

v_max and a_max have 11 bits, so the dividers are those that leave them most of these; what that still is off, and that
pmul and pdiv brake a little early (DS-TMC428 8.11), the exact ramp tells (`calc.ramps.ticked`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from ...calc.ramps.curve import RampCurve
from ...calc.ramps.pmul_pdiv import RegisterSuggestion, inverse
from ...calc.ramps.ticked import RampParameters as ExactParameters
from ...calc.ramps.ticked import exact_ramp, ramp_ending
from ...calc.units.tmc428 import acceleration_hz_s, pulse_rate_hz
from ...errors import OutOfRange, UsageError, WrongState
from ..core.capabilities import LinePace, Registers
from ..core.pace import PacedLeg, PaceLimits
from ..core.prediction import FloatArray
from ..core.register_link import RegisterLink
from ..core.results import WriteItem
from .axis_roles import POSITIONING_MODES, RAMP_MODE, SOFT_MODE, AxisRoles
from .memory import RampMemory
from .ramp_parameters import DISTANCE_MAX, P_MUL_FIRST, RampParameters

RATES_AS = "tmc4210"
"""Whose registers are found from microsteps alone: usrs stays as it is."""
CLOSE_ERRORS = 0.0003, 0.001
"""Rounding of speed and acceleration that is close enough to choose by anything else [-]."""
REDUCTIONS = 0.01, 0.02, 0.05, 0.1
"""Parts of p to take off, the first that does not overshoot on that very way [-]."""
SAMPLES = 2001
SAID_ERROR, SAID_EARLY, SAID_START = 0.001, 0.015, 0.02
"""Errors of the rates, how much less than a_max it brakes, and v_min of v_max that are worth a word [-]."""


@dataclass(frozen=True, slots=True)
class _Moment:
    position: FloatArray
    velocity_pps: FloatArray
    acceleration_pps2: FloatArray


class TickedPlan:
    """The exact ramp as a `Plan`: between its samples on straight lines."""

    end_velocity_pps = 0.0

    def __init__(self, parameters: ExactParameters, way: int) -> None:
        self._parameters = parameters
        self._way = way
        self._curve = exact_ramp(parameters, way, SAMPLES)

    @property
    def duration_s(self) -> float:
        return self._curve.duration_s

    def at(self, time_s: FloatArray, /) -> _Moment:
        known = self._curve
        columns = (known.position, known.velocity_pps, known.acceleration_pps2)
        return _Moment(*(np.interp(time_s, known.time_s, column) for column in columns))

    def curve(self, samples: int = SAMPLES, /) -> RampCurve:
        return exact_ramp(self._parameters, self._way, samples)


@dataclass(eq=False)
class Pace(LinePace):
    """Of the axes of one chip."""

    link: RegisterLink
    memory: RampMemory
    registers: Registers
    _held: dict[int, dict[int, int]] = field(default_factory=dict)
    _before: dict[int, dict[int, int]] = field(default_factory=dict)
    """The words of the user's ramps by address, while others are in their places."""

    async def pace_limits(self, axis: int, /) -> PaceLimits:
        session = self.link.session
        rows = self.memory.rows[session.axis(axis).index]
        async with self.link.command(axis) as turn:
            io = self.link.io(turn)
            ramp = await self.memory.read_ramp(io, axis)
            target, position = await io.value(rows.x_target), await io.value(rows.x_actual)
            if await io.value(rows.v_actual):
                raise WrongState(f"axis {axis} of {session.name} moves", "stop it first")
        if ramp.mode in POSITIONING_MODES and target != position:
            raise WrongState(f"axis {axis} of {session.name} is held on its way to {target}", "stop it first")
        ramp.require_motion(axis)
        self._held[axis] = {row.address: self.memory.word(row) for row in RampParameters.rows(rows)}
        speed = pulse_rate_hz(ramp.v_max, ramp.pulse_div, session.clock_hz)
        return PaceLimits(
            position, speed, acceleration_hz_s(ramp.a_max, ramp.pulse_div, ramp.ramp_div, session.clock_hz)
        )

    def pace_begin(self, axis: int, /) -> None:
        self._before.setdefault(axis, self._held[axis])

    def paced(self, axis: int, way: int, velocity_pps: float, acceleration_pps2: float, /) -> PacedLeg:
        rows, clock_hz = self.memory.rows[axis], self.link.session.clock_hz
        if abs(way) > DISTANCE_MAX:
            raise OutOfRange("way", way, -DISTANCE_MAX, DISTANCE_MAX, "microsteps; go in two moves")
        held = RampParameters.of(rows, self._held[axis])
        v_min_pps = pulse_rate_hz(held.v_min, held.pulse_div, clock_hz)
        for reduction in REDUCTIONS:
            near = _near(axis, velocity_pps, acceleration_pps2, clock_hz, reduction)
            exact = _exact(near, v_min_pps, clock_hz)
            if ramp_ending(exact, way).overshoot_steps == 0:
                break
        return PacedLeg(
            self._items(axis, rows, exact),
            near.achieved_velocity_pps,
            near.achieved_acceleration_pps2,
            TickedPlan(exact, way),
            _shortcomings(near, exact),
        )

    def _items(self, axis: int, rows: AxisRoles, exact: ExactParameters) -> tuple[WriteItem, ...]:
        held = self._held[axis]
        dividers = rows.ramp_div.pack(exact.ramp_div, over=held[rows.dividers.address])
        pair = rows.pdiv.pack(exact.pdiv, over=held[rows.proportionality.address])
        p_mul = (exact.pmul | P_MUL_FIRST) & (1 << rows.pmul.width) - 1  # a TMC4210 counts its leading one
        words = {
            rows.dividers.address: rows.pulse_div.pack(exact.pulse_div, over=dividers),
            rows.v_min.address: exact.v_min,
            rows.v_max.address: exact.v_max,
            rows.a_max.address: exact.a_max,
            rows.proportionality.address: rows.pmul.pack(p_mul, over=pair),
        }
        reference = held[rows.reference.address]
        if rows.mode.unpack(reference) == SOFT_MODE:
            words[rows.reference.address] = rows.with_mode(reference, RAMP_MODE)
        return _writes(axis, rows, words)

    async def pace_back(self, axis: int, /) -> None:
        if axis not in self._before:
            return
        session, rows = self.link.session, self.memory.rows[axis]
        async with self.link.turn() as turn:
            io = self.link.io(turn)
            if await io.value(rows.v_actual):
                raise WrongState(f"axis {axis} of {session.name} moves", "stop it, and write its ramp again")
            reference = await io.read(rows.reference)
            there = await io.value(rows.x_target) == await io.value(rows.x_actual)
        words = dict(self._before.pop(axis))
        before = words.pop(rows.reference.address)
        if there and rows.mode.unpack(reference) == RAMP_MODE and rows.mode.unpack(before) == SOFT_MODE:
            words[rows.reference.address] = rows.with_mode(reference, SOFT_MODE)
        done = await self.registers.write_many(_writes(axis, rows, words))
        if done.failed is not None:
            raise done.failed


def _near(axis: int, velocity_pps: float, acceleration_pps2: float, clock_hz: float, part: float) -> RegisterSuggestion:
    """The registers for that. Raises UsageError, naming the limit, where there are none."""
    try:
        return inverse(
            RATES_AS,
            velocity_pps,
            acceleration_pps2,
            clock_hz=clock_hz,
            reduction=part,
            good_errors=CLOSE_ERRORS,
        )
    except ValueError as error:
        raise UsageError(f"axis {axis} cannot keep to this line: {error}") from error


def _exact(near: RegisterSuggestion, v_min_pps: float, clock_hz: float) -> ExactParameters:
    """The ramp of these registers; v_min as fast as it was, and 1 at least, for with 0 no move ends."""
    v_min = round(v_min_pps / pulse_rate_hz(1, near.pulse_div, clock_hz))
    return ExactParameters(
        v_min=max(1, min(v_min, near.v_max)),
        v_max=near.v_max,
        a_max=near.a_max,
        ramp_div=near.ramp_div,
        pulse_div=near.pulse_div,
        pmul=near.pmul,
        pdiv=near.pdiv,
        clock_hz=clock_hz,
    )


def _shortcomings(near: RegisterSuggestion, exact: ExactParameters) -> tuple[str, ...]:
    said = [
        f"{name} {word} is {error:+.2%} off the {rate} wanted"
        for name, word, error, rate in (
            ("v_max", near.v_max, near.velocity_error, "speed"),
            ("a_max", near.a_max, near.acceleration_error, "acceleration"),
        )
        if abs(error) > SAID_ERROR
    ]
    ideal = near.a_max / (128 * 2.0 ** (near.ramp_div - near.pulse_div))
    early = 1 - near.p_mul / 2.0 ** (3 + near.pdiv) / ideal
    if early > SAID_EARLY:
        said.append(f"pmul {near.p_mul} and pdiv {near.pdiv} brake {early:.1%} more gently than a_max speeds up")
    if exact.v_min > SAID_START * exact.v_max:
        start = pulse_rate_hz(exact.v_min, exact.pulse_div, exact.clock_hz)
        said.append(f"it starts and stops at v_min {exact.v_min}, {start:.4g} pps")
    return tuple(said)


def _writes(axis: int, rows: AxisRoles, words: Mapping[int, int]) -> tuple[WriteItem, ...]:
    """Words by address as writes, the dividers first."""
    order = (rows.dividers, rows.v_min, rows.v_max, rows.a_max, rows.proportionality, rows.reference)
    return tuple(
        WriteItem(row.name, axis, words[row.address] & row.write_mask) for row in order if row.address in words
    )
