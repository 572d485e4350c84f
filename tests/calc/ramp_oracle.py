"""The ramp generator tick by tick, in plain Python: slow, and short enough to be read against the law."""

from __future__ import annotations

from collections.abc import Iterator
from math import isqrt
from typing import NamedTuple

from app.calc.ramps.ticked import RampParameters, RampStart


class Instant(NamedTuple):
    """The generator after every tick of `clock`."""

    clock: int
    position: int
    velocity_256: int
    accumulator: int
    at_rest: bool


def ticks(parameters: RampParameters, distance: int, start: RampStart) -> Iterator[Instant]:
    """Every clock at which a ramp or pulse tick falls, unbounded; `at_rest` once stopped at the target."""
    ramp_period, pulse_period = 32 * 2**parameters.ramp_div, 32 * 2**parameters.pulse_div
    next_ramp = start.clocks_to_ramp_tick or ramp_period
    next_pulse = start.clocks_to_pulse_tick or pulse_period
    velocity = int(start.velocity * 256)
    if parameters.ramp_mode == "hold" and parameters.v_actual is not None:
        velocity = 256 * parameters.v_actual
    accumulator, x = start.accumulator, 0
    positioning = parameters.ramp_mode in ("ramp", "soft")
    at_rest = False

    def slow_enough() -> bool:
        return positioning and x == distance and abs(velocity) // 256 <= parameters.v_min

    if slow_enough():
        velocity, at_rest = 0, True
    while True:
        clock = min(next_ramp, next_pulse)
        if clock == next_ramp and not at_rest:
            next_ramp += ramp_period
            if slow_enough():
                velocity, at_rest = 0, True
            else:
                goal = wanted_256(parameters, distance - x, velocity)
                if velocity < goal:
                    velocity = min(goal, velocity + parameters.a_max)
                else:
                    velocity = max(goal, velocity - parameters.a_max)
        elif clock == next_ramp:
            next_ramp += ramp_period
        if clock == next_pulse:
            next_pulse += pulse_period
            accumulator += abs(velocity) // 256
            if accumulator >= 2048:
                accumulator -= 2048
                x += 1 if velocity > 0 else -1
                if slow_enough():
                    velocity, at_rest = 0, True
        yield Instant(clock, x, velocity, accumulator, at_rest)


def wanted_256(parameters: RampParameters, to_go: int, velocity: int) -> int:
    """Signed target velocity in 1/256 units."""
    if parameters.ramp_mode == "hold":
        return velocity
    if parameters.ramp_mode == "velocity":
        assert parameters.v_target is not None
        return 256 * max(-parameters.v_max, min(parameters.v_max, parameters.v_target))
    if to_go == 0:
        return 0
    d = min(abs(to_go), 2**19 - 1)
    p_mul, p_div = 128 + parameters.pmul, 2 ** (3 + parameters.pdiv)
    speed = isqrt(2048 * p_mul * d // p_div) if parameters.ramp_mode == "ramp" else p_mul * d // p_div
    speed = min(parameters.v_max, max(parameters.v_min, speed))
    return 256 * speed if to_go > 0 else -256 * speed
