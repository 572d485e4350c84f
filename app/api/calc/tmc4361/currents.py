"""Between the shapes of current scales and PWM outputs and the calculators behind them, app/calc/tmc4361/."""

from __future__ import annotations

import numpy as np

from ....calc.microsteps.mslut import POWER_ON, decode
from ....calc.tmc4361.current_scale import CurrentSettings, course, findings
from ....calc.tmc4361.pwm import PLACES, PwmSettings
from ....errors import UsageError
from ....number_text import plain
from ...devices.views import calculating
from ..schemas import Phase
from .current_schemas import DriveCurrent, DriveCurrentResult, PwmDuty, PwmDutyResult, ScaleStretch
from .sramp import planned

LONGEST_REST = 3.0
"""So many times the motion is shown of the rest after it, at most; a second of it in any case."""
COARSE = 64
"""Fewer duties than this are told as a finding."""


def drive_current(body: DriveCurrent) -> DriveCurrentResult:
    if body.ramp.model != "s_ramp":
        raise UsageError(f'the ramp of current scales is an "s_ramp", not {body.ramp.model!r}')
    with calculating():
        settings = CurrentSettings(**body.scales.model_dump(), clock_hz=body.clock_hz)
        plan, seen_s = planned(body.ramp)
        rest_s = min(1.1 * settings.settles_s, max(LONGEST_REST * seen_s, 1.0))
        found = course(settings, plan, seen_s + (0.0 if plan.end_velocity_pps else max(rest_s, 0.1 * seen_s)))
        time_s = np.linspace(0.0, found.duration_s, body.ramp.samples)
        scale = found.at(time_s)
        share = (scale + 1.0) / 256.0
        moving = time_s <= seen_s
    return DriveCurrentResult(
        motion_s=seen_s,
        duration_s=found.duration_s,
        time_s=time_s.tolist(),
        velocity_pps=plan.at(time_s).velocity_pps.tolist(),
        scale=scale.tolist(),
        current_rms_a=None if body.full_scale_rms_a is None else (body.full_scale_rms_a * share).tolist(),
        mean_square=float(np.mean(share[moving] ** 2)),
        rest_square=float(share[-1] ** 2),
        scale_at_first=found.scale_at_first,
        stretches=[
            ScaleStretch(
                start_s=stretch.start_s,
                end_s=stretch.end_s,
                situation=stretch.situation,
                scale_from=stretch.scale_from,
                scale_to=stretch.scale_to,
                wanted=stretch.wanted,
            )
            for stretch in found.stretches
        ],
        phases=[Phase.model_validate(phase) for phase in plan.phases],
        findings=findings(settings, plan, found),
    )


def pwm_duty(body: PwmDuty) -> PwmDutyResult:
    with calculating():
        settings = PwmSettings(
            body.period_clocks, body.amplitude, body.full_at_pps, body.offset, body.scales, body.clock_hz
        )
        top = 1.25 * max(body.full_at_pps if body.scales else 0, body.speed_pps, 1.0)
        speeds = np.linspace(0.0, top, body.samples)
        there = float(settings.amplitude_at(np.array(body.speed_pps)))
        wave = decode(POWER_ON).period().astype(np.float64)
        duty_a, duty_b = settings.duty(wave, there)
    said: list[str] = []
    if body.period_clocks < COARSE:
        said.append(f"a period of {body.period_clocks} clocks has {body.period_clocks + 1} duties: microsteps get lost")
    if settings.frequency_hz < 20e3:
        said.append(f"{plain(round(settings.frequency_hz))} Hz can be heard, and lets the current ripple")
    if body.scales and body.full_at_pps == 0:
        said.append("PWM_VMAX is 0: the amplitude is full as soon as the motor turns")
    if not body.scales:
        said.append("without pwm_scale_en the amplitude is full at every speed, at rest too")
    return PwmDutyResult(
        frequency_hz=settings.frequency_hz,
        steps=body.period_clocks + 1,
        speed_pps=speeds.tolist(),
        amplitude=settings.amplitude_at(speeds).tolist(),
        place=list(range(PLACES)),
        duty_a=duty_a.tolist(),
        duty_b=duty_b.tolist(),
        amplitude_there=there,
        findings=said,
    )
