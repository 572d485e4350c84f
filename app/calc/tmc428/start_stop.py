"""v_min as a start-stop speed: from how fast a motor may be stopped dead, or started, without losing a step.

In RAMP_MODE and SOFT_MODE the motor stops dead at its target where it is not faster than v_min (DS-TMC428 8.3), and the
ramp generator asks for no less. A rotor that is torn along or stopped at once swings about the field. It stays with it
while its kinetic energy is below what it takes over the next maximum of the torque's potential: a slip by four full
steps lies behind that. No damping and no chopper enter, so a motor can do a little more; its load is taken to be
against the motion, which is right for starting and leaves a margin for stopping.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from ..motor_torque import StepperMotor
from ..ramps.ticked import RampParameters, ramp_ending
from ..units.tmc428 import MAX_VELOCITY, pulse_rate_hz

SAFE = 0.5
"""Share of the limit that is suggested: resonances and a drooping supply are not in it."""


def start_stop_pps(motor: StepperMotor) -> float:
    """The speed from which the motor may just be stopped dead, and to which it may be started [microsteps/s].

    0 where friction and load are more than the motor can hold. A field that turns at w around a rotor at rest is a
    rotor with w in a field at rest: so both are the same.
    """
    peak = motor.torque_constant * motor.current_a
    against = motor.friction_nm + motor.load_nm
    if against >= peak:
        return 0.0
    teeth = motor.full_steps_per_rev / 4
    lag = math.asin(against / peak)
    barrier_j = peak / teeth * (2 * math.cos(lag) - against / peak * (math.pi - 2 * lag))
    return math.sqrt(2 * barrier_j / motor.inertia_kgm2) / motor.microstep_rad


@dataclass(frozen=True)
class StartStop:
    """What v_min comes to.

    limit_pps : `start_stop_pps`; limit_chip : the highest v_min at or below it; suggested_chip : half of it
    v_min_pps : of the v_min that is set; share : of the limit; keeps_steps : whether it is within
    duration_s : of the move with v_min as it is, 1, and as suggested [s]; None where it never ends, or is not asked
    warnings : what is to be known
    """

    limit_pps: float
    limit_chip: int
    suggested_chip: int
    v_min_pps: float
    share: float | None
    keeps_steps: bool
    duration_s: float | None
    duration_least_s: float | None
    duration_suggested_s: float | None
    warnings: tuple[str, ...]


def start_stop(motor: StepperMotor, parameters: RampParameters, distance: int) -> StartStop:
    """v_min of `parameters` against what the motor can. Raises ValueError outside the ranges of `ramp_ending`."""
    unit = pulse_rate_hz(1, parameters.pulse_div, parameters.clock_hz)
    limit = start_stop_pps(motor)
    highest = min(int(limit / unit), MAX_VELOCITY)
    suggested = min(max(1, int(SAFE * limit / unit)), parameters.v_max or 1)
    v_min_pps = parameters.v_min * unit
    keeps = v_min_pps <= limit

    def lasts(v_min: int) -> float | None:
        if parameters.ramp_mode not in ("ramp", "soft"):
            return None
        return ramp_ending(replace(parameters, v_min=v_min), distance).duration_s

    found = []
    if limit == 0:
        found.append("friction and load are more than the motor can hold: it loses steps at any speed")
    elif not keeps:
        found.append(
            f"stopped dead from v_min the rotor may slip by four full steps, or a multiple: at most {highest} here"
        )
    elif v_min_pps > SAFE * limit:
        found.append("little is left for resonances: half of the limit is safe")
    if parameters.v_min == 0:
        found.append("v_min 0 may leave the motor short of its target: 1 or more reaches each (DS-TMC428 8.3)")
    if parameters.v_min > parameters.v_max:
        found.append("v_min is above v_max, which limits it")
    return StartStop(
        limit_pps=limit,
        limit_chip=highest,
        suggested_chip=suggested,
        v_min_pps=v_min_pps,
        share=v_min_pps / limit if limit else None,
        keeps_steps=keeps,
        duration_s=lasts(parameters.v_min),
        duration_least_s=lasts(1),
        duration_suggested_s=lasts(suggested),
        warnings=tuple(found),
    )
