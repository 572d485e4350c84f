"""The exact ramp of TMC428 and TMC4210: every step of a move as the chip's integers make it.

`exact_ramp` is the prediction that the scope draws over a measured move; the law is in `ticked_kernel`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..units.tmc428 import acceleration_hz_s, pulse_rate_hz
from . import ticked_kernel as kernel
from .curve import Phase, RampCurve, check_samples
from .trapezoid import trapezoid_ramp

__all__ = [
    "Phase",
    "RampCurve",
    "RampEnding",
    "RampParameters",
    "RampStart",
    "exact_ramp",
    "ramp_ending",
    "trapezoid_ramp",
]

IntArray = NDArray[np.int64]

MODES = ("ramp", "soft", "velocity", "hold")
# |x_target - x_actual| has to be less for the chip to find the right direction (DS-TMC428 8.1)
DISTANCE_LIMIT = 1 << 23
# The kernel counts clocks in 64 bits and multiplies them; a year at 16 MHz is far below this.
MAX_CLOCKS = 1 << 50

PHASE_NAMES = {
    kernel.ACCELERATION: "acceleration",
    kernel.CONSTANT: "constant velocity",
    kernel.DECELERATION: "deceleration",
    kernel.APPROACH: "final approach",
    kernel.SETTLING: "settling",
    kernel.REVERSAL: "reversal",
}


@dataclass(frozen=True)
class RampParameters:
    """The motion registers of one axis, by the chip's names.

    v_min, v_max, a_max : 0..2047
    ramp_div, pulse_div : 0..13
    pmul : 0..127 (the TMC4210 counts the same bits 128..255); pdiv : 0..13
    ramp_mode : "ramp", "soft", "velocity" or "hold"
    clock_hz : above 0 [Hz]
    v_target : -2047..2047, velocity mode only: where the velocity goes
    v_actual : -2047..2047, hold mode only: the velocity written, which applies at once; None keeps that of the start

    Raises ValueError outside these ranges.
    """

    v_min: int
    v_max: int
    a_max: int
    ramp_div: int
    pulse_div: int
    pmul: int = 0
    pdiv: int = 0
    ramp_mode: str = "ramp"
    clock_hz: float = 16e6
    v_target: int | None = None
    v_actual: int | None = None

    def __post_init__(self) -> None:
        for name, value, low, high in (
            ("v_min", self.v_min, 0, 2047),
            ("v_max", self.v_max, 0, 2047),
            ("a_max", self.a_max, 0, 2047),
            ("ramp_div", self.ramp_div, 0, 13),
            ("pulse_div", self.pulse_div, 0, 13),
            ("pmul", self.pmul, 0, 127),
            ("pdiv", self.pdiv, 0, 13),
            ("v_target", self.v_target or 0, -2047, 2047),
            ("v_actual", self.v_actual or 0, -2047, 2047),
        ):
            _check_whole(name, value, low, high)
        if self.ramp_mode not in MODES:
            raise ValueError(f"ramp_mode is one of {', '.join(MODES)}, got {self.ramp_mode!r}")
        if not 0 < self.clock_hz <= 1e9:
            raise ValueError(f"clock_hz is above 0 to 1e9 Hz, got {self.clock_hz}")

    @property
    def ramp_period_clocks(self) -> int:
        return 32 << self.ramp_div

    @property
    def pulse_period_clocks(self) -> int:
        return 32 << self.pulse_div


@dataclass(frozen=True)
class RampStart:
    """Where the ramp generator stands at t = 0.

    velocity : -2047..2047 in steps of 1/256, the chip's hidden fraction included [chip units]
    accumulator : 0..2047, the pulse generator's remainder
    clocks_to_ramp_tick, clocks_to_pulse_tick : clocks until the next tick of either divider, 1 to its period;
        None is a whole period

    Raises ValueError outside these ranges; the last two are checked against the parameters in `exact_ramp`.
    """

    velocity: float = 0.0
    accumulator: int = 0
    clocks_to_ramp_tick: int | None = None
    clocks_to_pulse_tick: int | None = None

    def __post_init__(self) -> None:
        if not -2047 <= self.velocity <= 2047 or self.velocity * 256 != int(self.velocity * 256):
            raise ValueError(f"start velocity is -2047 to 2047 in steps of 1/256, got {self.velocity}")
        _check_whole("start accumulator", self.accumulator, 0, 2047)


def exact_ramp(
    parameters: RampParameters,
    distance: int,
    samples: int = 1000,
    start: RampStart | None = None,
    duration_s: float | None = None,
) -> RampCurve:
    """Position, velocity and acceleration of a move, bit for bit as the chip's ramp generator makes them.

    Parameters
    ----------
    parameters : the axis' registers
    distance : x_target - x_actual at t = 0, more than -2^23 and less than 2^23 [microsteps]
    samples : how many, evenly spaced from t = 0 to the end, each at a whole clock
    start : state of the ramp generator at t = 0; None is at rest
    duration_s : where to end [s], up to 2^50 clocks. None: ramp and soft end at rest at the target; velocity and
        hold end when the velocity has reached its target and |distance| microsteps are behind.

    `velocity_pps` is the rate of the pulses, of the whole part of the velocity, as v_actual reads;
    `velocity_256` has the fraction too. `acceleration_pps2` is the mean change at the ramp ticks of the last
    sampling interval that had one; the stop at v_min is no acceleration.

    Raises ValueError outside the ranges, and where the move never ends: nothing lets the motor move (v_max or
    a_max 0), a target velocity below 1, oscillation around the target.
    """
    begin = start if start is not None else RampStart()
    _check_whole("distance", distance, 1 - DISTANCE_LIMIT, DISTANCE_LIMIT - 1)
    check_samples(samples)
    settings, state = _prepared(parameters, distance, begin)
    phases = np.zeros((kernel.MAX_PHASES, 4), dtype=np.int64)
    limit = _clocks(duration_s, parameters.clock_hz)
    if parameters.ramp_mode in ("velocity", "hold"):
        end_clock = limit if limit is not None else _open_end(parameters, settings, state, distance)
    else:
        if limit is None:
            _check_can_end(parameters, distance, begin)
        end_clock = _positioning_end(parameters, settings, state.copy(), phases.copy(), limit)
    clocks = np.rint(np.linspace(0, end_clock, samples)).astype(np.int64)
    rows = np.zeros((samples, 4), dtype=np.int64)
    first_velocity = int(state[kernel.VELOCITY_256])
    kernel.sample(settings, state, phases, clocks, rows)
    if state[kernel.ENDING] == kernel.UNDECIDED:
        raise ValueError(f"too long: more than {kernel.MAX_EVENTS} changes of the ramp generator within duration_s")
    return _curve(parameters, distance, clocks, rows, phases[: state[kernel.PHASES]], state, first_velocity)


@dataclass(frozen=True)
class RampEnding:
    """How a move ends: overshoot [microsteps], time from the first arrival at the target to rest [s], and in all [s].

    Where it never settles, both times are None and `overshoot_steps` is the farthest that was seen.
    """

    overshoot_steps: int
    settling_s: float | None
    duration_s: float | None


def ramp_ending(parameters: RampParameters, distance: int, start: RampStart | None = None) -> RampEnding:
    """The end of the move that `exact_ramp` draws, without drawing it: ramp and soft mode.

    Raises ValueError outside the ranges of `exact_ramp`, for velocity and hold mode, and with v_max or a_max 0.
    """
    if parameters.ramp_mode not in ("ramp", "soft"):
        raise ValueError(f"ramp_mode is ramp or soft, got {parameters.ramp_mode!r}: only these end at a target")
    begin = start if start is not None else RampStart()
    _check_whole("distance", distance, 1 - DISTANCE_LIMIT, DISTANCE_LIMIT - 1)
    _check_can_end(parameters, distance, begin)
    settings, state = _prepared(parameters, distance, begin)
    kernel.advance(settings, state, np.zeros((kernel.MAX_PHASES, 4), dtype=np.int64), kernel.NEVER)
    beyond = int(state[kernel.BEYOND])
    if state[kernel.ENDING] != kernel.SETTLED:
        return RampEnding(beyond, None, None)
    end, arrival = int(state[kernel.END_CLOCK]), int(state[kernel.FIRST_ARRIVAL])
    return RampEnding(beyond, (end - arrival) / parameters.clock_hz, end / parameters.clock_hz)


def _check_whole(name: str, value: int, low: int, high: int) -> None:
    if not low <= value <= high or value != int(value):
        raise ValueError(f"{name} is a whole number of {low} to {high}, got {value}")


def _clocks(duration_s: float | None, clock_hz: float) -> int | None:
    if duration_s is None:
        return None
    if not 0 <= duration_s * clock_hz <= MAX_CLOCKS:
        raise ValueError(f"duration_s is 0 to {MAX_CLOCKS / clock_hz:g} s at this clock, got {duration_s}")
    return round(duration_s * clock_hz)


def _prepared(parameters: RampParameters, distance: int, start: RampStart) -> tuple[IntArray, IntArray]:
    """The kernel's settings and state at t = 0."""
    velocity = int(start.velocity * 256)
    if parameters.ramp_mode == "hold" and parameters.v_actual is not None:
        velocity = parameters.v_actual * 256  # a write clears the hidden bits (DS-TMC428 8.6)
    fixed = velocity
    if parameters.ramp_mode == "velocity":
        if parameters.v_target is None:
            raise ValueError("velocity mode needs v_target, -2047 to 2047")
        fixed = max(-parameters.v_max, min(parameters.v_max, parameters.v_target)) * 256
    settings = np.zeros(kernel.SETTINGS, dtype=np.int64)
    settings[kernel.MODE] = {"ramp": kernel.RAMP, "soft": kernel.SOFT}.get(parameters.ramp_mode, kernel.VELOCITY)
    settings[kernel.V_MIN] = parameters.v_min
    settings[kernel.V_MAX] = parameters.v_max
    settings[kernel.A_MAX] = parameters.a_max
    settings[kernel.RAMP_PERIOD] = parameters.ramp_period_clocks
    settings[kernel.PULSE_PERIOD] = parameters.pulse_period_clocks
    settings[kernel.P_MUL] = 128 + parameters.pmul
    settings[kernel.P_SHIFT] = 3 + parameters.pdiv
    settings[kernel.V_FIXED] = fixed
    state = np.zeros(kernel.STATE, dtype=np.int64)
    state[kernel.NEXT_RAMP] = _first_tick("ramp", start.clocks_to_ramp_tick, parameters.ramp_period_clocks)
    state[kernel.NEXT_PULSE] = _first_tick("pulse", start.clocks_to_pulse_tick, parameters.pulse_period_clocks)
    state[kernel.TO_GO] = distance
    state[kernel.VELOCITY_256] = velocity
    state[kernel.ACCUMULATOR] = start.accumulator
    state[kernel.FIRST_ARRIVAL] = -1
    state[kernel.DIRECTION] = 1 if distance > 0 or (distance == 0 and velocity >= 0) else -1
    if distance == 0 and parameters.ramp_mode in ("ramp", "soft"):
        state[kernel.FIRST_ARRIVAL] = 0
        if abs(velocity) >> 8 <= parameters.v_min:  # at the target, and slow enough to stop at once
            state[kernel.ENDING] = kernel.SETTLED
            state[kernel.VELOCITY_256] = 0
    return settings, state


def _first_tick(name: str, clocks: int | None, period: int) -> int:
    if clocks is None:
        return period
    _check_whole(f"start clocks_to_{name}_tick", clocks, 1, period)
    return clocks


def _check_can_end(parameters: RampParameters, distance: int, start: RampStart) -> None:
    if distance == 0 and start.velocity == 0:
        return
    if parameters.v_max == 0:
        raise ValueError("the move never ends: v_max is 0, which holds the motor at rest; use 1 to 2047")
    if parameters.a_max == 0:
        raise ValueError("the move never ends: a_max is 0, so the velocity cannot change; use 1 to 2047")


def _positioning_end(
    parameters: RampParameters, settings: IntArray, state: IntArray, phases: IntArray, limit: int | None
) -> int:
    """Clock at which the motor comes to rest at the target, or `limit` where that is given."""
    if limit is not None:
        return limit
    kernel.advance(settings, state, phases, kernel.NEVER)
    ending, beyond = int(state[kernel.ENDING]), int(state[kernel.BEYOND])
    if ending == kernel.STUCK:
        raise ValueError(
            f"the move never ends: {abs(int(state[kernel.TO_GO]))} microsteps before the target the target velocity"
            f" falls below 1; v_min is {parameters.v_min}, and 1 or more is enough"
        )
    if ending == kernel.OSCILLATES:
        raise ValueError(
            f"the move never ends: it oscillates around the target, {beyond} microsteps beyond it at most;"
            " choose a smaller p (pmul, pdiv), or a larger v_min, for this a_max"
        )
    if ending != kernel.SETTLED:
        raise ValueError(f"the move did not end within {kernel.MAX_EVENTS} events of the ramp generator")
    return int(state[kernel.END_CLOCK])


def _open_end(parameters: RampParameters, settings: IntArray, start: IntArray, distance: int) -> int:
    """Clock at which v_target is reached and |distance| microsteps are behind."""
    state = start.copy()
    change = abs(int(settings[kernel.V_FIXED]) - int(state[kernel.VELOCITY_256]))
    if change and parameters.a_max == 0:
        raise ValueError("v_target is never reached: a_max is 0, so the velocity cannot change; use 1 to 2047")
    clock = 0
    if change:
        ticks = -(-change // parameters.a_max)
        clock = int(state[kernel.NEXT_RAMP]) + (ticks - 1) * parameters.ramp_period_clocks
        kernel.advance(settings, state, np.zeros((kernel.MAX_PHASES, 4), dtype=np.int64), clock)
    whole = abs(int(settings[kernel.V_FIXED])) >> 8
    behind = abs(distance - int(state[kernel.TO_GO]))
    if behind >= abs(distance):
        return clock
    if whole == 0:
        if change:
            return clock
        raise ValueError("the motion never ends: the velocity is 0; give a duration_s")
    way = 1 if settings[kernel.V_FIXED] > 0 else -1
    # microsteps still to make in the direction of the velocity, until |distance| from the start
    missing = abs(distance) - way * (distance - int(state[kernel.TO_GO]))
    pulses = -(-(missing * 2048 - int(state[kernel.ACCUMULATOR])) // whole)
    return int(state[kernel.NEXT_PULSE]) + (pulses - 1) * parameters.pulse_period_clocks


def _curve(
    parameters: RampParameters,
    distance: int,
    clocks: IntArray,
    rows: IntArray,
    phases: IntArray,
    state: IntArray,
    first_velocity: int,
) -> RampCurve:
    time_s = clocks / parameters.clock_hz
    settled = int(state[kernel.ENDING]) == kernel.SETTLED
    first_arrival = int(state[kernel.FIRST_ARRIVAL])
    positioning = parameters.ramp_mode in ("ramp", "soft")
    settling = (int(state[kernel.END_CLOCK]) - first_arrival) / parameters.clock_hz if settled else 0.0
    velocity_256 = rows[:, 1].copy()
    named = _phases(parameters, distance, phases, rows, int(clocks[-1]), first_velocity)
    return RampCurve(
        duration_s=float(time_s[-1]),
        shape=_shape(parameters, named),
        phases=named,
        time_s=time_s,
        position=(distance - rows[:, 0]).astype(np.float64),
        velocity_pps=_rate_pps(parameters)(velocity_256),
        acceleration_pps2=_acceleration(parameters, rows),
        overshoot_steps=int(state[kernel.BEYOND]) if positioning else 0,
        settled=settled,
        settling_s=settling,
        velocity_256=velocity_256,
    )


def _rate_pps(parameters: RampParameters) -> Callable[[IntArray], NDArray[np.float64]]:
    unit = pulse_rate_hz(1, parameters.pulse_div, parameters.clock_hz)

    def rate(velocity_256: IntArray) -> NDArray[np.float64]:
        return np.asarray(np.sign(velocity_256) * (np.abs(velocity_256) >> 8) * unit)

    return rate


def _acceleration(parameters: RampParameters, rows: IntArray) -> NDArray[np.float64]:
    """Mean change a ramp tick since the sample before, or the last such mean where no tick fell between."""
    slewed, ticks = np.diff(rows[:, 2], prepend=0), np.diff(rows[:, 3], prepend=0)
    mean = np.divide(slewed, ticks, out=np.zeros(ticks.shape), where=ticks > 0)
    latest = np.maximum.accumulate(np.where(ticks > 0, np.arange(ticks.size), 0))
    unit = acceleration_hz_s(1, parameters.pulse_div, parameters.ramp_div, parameters.clock_hz)
    return np.asarray(mean[latest] * unit)


def _phases(
    parameters: RampParameters,
    distance: int,
    recorded: IntArray,
    rows: IntArray,
    end_clock: int,
    first_velocity: int,
) -> tuple[Phase, ...]:
    if not recorded.size:
        return ()
    rate = _rate_pps(parameters)
    # a phase begins where the one before has ended; the first waits for its first ramp tick from t = 0
    clocks = [0, *(int(clock) for clock in recorded[1:, 1]), end_clock]
    positions = [0, *(distance - int(to_go) for to_go in recorded[1:, 3]), distance - int(rows[-1, 0])]
    speeds = rate(np.array([first_velocity, *recorded[1:, 2], rows[-1, 1]], dtype=np.int64))
    return tuple(
        Phase(
            name=PHASE_NAMES[int(code)],
            start_s=clocks[i] / parameters.clock_hz,
            end_s=clocks[i + 1] / parameters.clock_hz,
            start_position=float(positions[i]),
            end_position=float(positions[i + 1]),
            start_velocity_pps=float(speeds[i]),
            end_velocity_pps=float(speeds[i + 1]),
        )
        for i, code in enumerate(recorded[:, 0])
    )


def _shape(parameters: RampParameters, phases: tuple[Phase, ...]) -> str:
    if parameters.ramp_mode in ("velocity", "hold"):
        return parameters.ramp_mode
    if not phases:
        return "rest"
    return "trapezoid" if any(phase.name == PHASE_NAMES[kernel.CONSTANT] for phase in phases) else "triangle"
