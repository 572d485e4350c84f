"""PID, closed loop and calibration: what ENC_POS does to the step output and to the coils' phase.

Facts: tmc4361-encoder-closed-loop, sections 3, 5, 6 and 8. What they leave open is read like this:

- ENC_POS_DEV is ENC_POS - XACTUAL (its sign is in no source); regulation works on E = XACTUAL - ENC_POS;
- "inside the tolerance" is |E| <= tolerance for PID_TOLERANCE and CL_TOLERANCE;
- v_PID is cut to whole pps; D's difference is the last E minus this one, as written, and holds until its next sample;
- CL_OFFSET is the coils' phase minus ENC_POS, as -512..511: what an absolute encoder needs to commutate after power-on.
  Calibration stores it in every tick while cl_calibration_en is set and regulation_modus is 0;
- the catch-up limiter (cl_vlimit_en) lets the field turn at most VACTUAL + v_lim fast, as long as it stays within
  CL_BETA + gamma of the rotor. Without VACTUAL the vendor's example gains could not follow the vendor's velocities;
- cl_clr_xact acts when ENC_POS_DEV_TOL is exceeded, in every regulation_modus;
- gamma's sign is that of V_ENC_MEAN; CL_MAX is met when the gain's angle reaches CL_BETA;
- with a serial encoder the closed loop works every CL_CYCLE clocks, with an ABN encoder in every tick.
"""

# mypy: disable-error-code="no-any-return"

from __future__ import annotations

import math

from ..compiled import compiled, inlined
from .layout import (
    ABN,
    ANGLE,
    CL_ANGLES,
    CL_DUE,
    CL_ISUM,
    CL_OFFSET,
    CLK_FREQ,
    DEV,
    DIRECTION,
    DV_CLIP,
    ENC_IN_CONF,
    ENC_POS,
    ENC_VMEAN,
    GAIN_D,
    GAIN_I,
    GAIN_P,
    GENERAL_CONF,
    I_CLIP_D_DIV,
    MEAN_Q16,
    NOW,
    PERIOD,
    PHASE,
    PID_ALONE,
    PID_COUNT,
    PID_DIFF,
    PID_E,
    PID_FRESH,
    PID_ISUM,
    PID_LAST,
    PID_VEL,
    REACH,
    SATURATED,
    TOLERANCE,
    VADD_EMF,
    VMIN_EMF,
    Cells,
    Floats,
    bit,
    clip,
    wrap10,
    wrap32,
)

EMF_EN, CLR_XACT, VLIMIT_EN, VELOCITY_MODE_EN = 25, 26, 27, 28
"""Bits of ENC_IN_CONF."""
BACKLOG = 768
"""Microsteps that XACTUAL may be ahead in closed-loop velocity mode."""


@compiled
def error_of(fb: Floats, x_actual: int) -> int:
    """XACTUAL - ENC_POS [microsteps], the short way around a circular range."""
    error = x_actual - math.floor(fb[ENC_POS])
    period = fb[PERIOD]
    if period > 0.0:
        return error - math.floor(math.floor(error / period + 0.5) * period + 0.5)
    return wrap32(error)


@inlined
def _sum_limit(n: Cells) -> int:
    """PID_I_CLIP, as ISUM is counted."""
    return (n[I_CLIP_D_DIV] & 0x7FFF) << 16


@inlined
def _proportional_integral(n: Cells, error: int, isum: int) -> float:
    """P and I parts of PID and catch-up limiter [pps]."""
    return error * (n[GAIN_P] & 0xFFFFFF) / 256.0 + isum / 256.0 * (n[GAIN_I] & 0xFFFFFF) / 256.0


@compiled
def pid(fb: Floats, n: Cells, x_actual: int, velocity_pps: float) -> float:
    """One tick of regulation_modus 2 or 3; the velocity of the step output [pps]."""
    error = error_of(fb, x_actual)
    if abs(error) <= n[TOLERANCE] & 0xFFFFF:
        error = 0
    n[PID_E] = error
    if n[PID_FRESH]:
        n[PID_FRESH] = n[PID_DIFF] = n[PID_COUNT] = n[PID_ISUM] = 0
        n[PID_LAST] = error
    n[PID_ISUM] = clip(n[PID_ISUM] + error, _sum_limit(n))
    n[PID_COUNT] += 1
    if n[PID_COUNT] >= n[I_CLIP_D_DIV] >> 16 & 0xFF:
        n[PID_COUNT] = 0
        n[PID_DIFF] = n[PID_LAST] - error
        n[PID_LAST] = error
    wanted = _proportional_integral(n, error, n[PID_ISUM]) + float((n[GAIN_D] & 0xFFFFFF) * n[PID_DIFF])
    limit = float(n[DV_CLIP] & 0x7FFFFFFF)
    n[PID_VEL] = int(min(max(wanted, -limit), limit))  # cut towards zero
    if n[ENC_IN_CONF] >> 22 & 3 == PID_ALONE:
        return float(n[PID_VEL])
    return velocity_pps + n[PID_VEL]


@inlined
def _gamma(n: Cells) -> int:
    """Angle against the back-EMF, by V_ENC_MEAN."""
    if not bit(n[ENC_IN_CONF], EMF_EN):
        return 0
    mean = (n[MEAN_Q16] + 32768) >> 16
    over = abs(mean) - (n[VMIN_EMF] & 0xFFFFFF)
    if over <= 0:
        return 0
    gamma = n[CL_ANGLES] >> 16 & 0xFF
    span = n[VADD_EMF] & 0xFFFFFF
    if over < span:
        gamma = gamma * over // span
    return gamma if mean > 0 else -gamma


@inlined
def _correction(n: Cells) -> int:
    """Angle of the field over the rotor without gamma; sets SATURATED."""
    error = n[DEV]
    angle = error
    if abs(error) > n[TOLERANCE] & 0xFF:
        angle = abs(error) * (n[GAIN_D] & 0xFFFFFF) >> 16
        angle = angle if error > 0 else -angle
    beta = n[CL_ANGLES] & 0x1FF
    n[SATURATED] = abs(angle) >= beta
    return clip(angle, beta)


@inlined
def _limited(fb: Floats, n: Cells, turn: int, velocity_pps: float, clocks: int) -> int:
    """As much of a turn of the field as the catch-up limiter lets through."""
    n[CL_ISUM] = clip(n[CL_ISUM] + n[DEV], _sum_limit(n))
    allowed = min(abs(_proportional_integral(n, n[DEV], n[CL_ISUM])), float(n[DV_CLIP] & 0x7FFFFFFF))
    reach = fb[REACH] + (abs(velocity_pps) + allowed) * clocks / fb[CLK_FREQ]
    whole = math.floor(min(reach, 512.0))
    turned = clip(turn, whole)
    fb[REACH] = reach - whole if whole < 512 and turned != turn else 0.0
    return turned


@compiled
def commutate(fb: Floats, n: Cells, velocity_pps: float, clocks: int) -> None:
    """One tick of the closed loop: the coils' phase from the rotor's place and the deviation."""
    if n[GENERAL_CONF] >> 10 & 3 != ABN:
        if n[NOW] < n[CL_DUE]:
            return
        cycle = max(n[ENC_VMEAN] >> 16 & 0xFFFF, 1)
        n[CL_DUE] += ((n[NOW] - n[CL_DUE]) // cycle + 1) * cycle
        clocks = max(clocks, cycle)
    gamma = _gamma(n)
    angle = _correction(n) + gamma
    rotor = n[DIRECTION] * math.floor(fb[ENC_POS]) + n[CL_OFFSET]
    phase = n[PHASE]
    turn = wrap10(rotor + n[DIRECTION] * angle - phase)
    if bit(n[ENC_IN_CONF], VLIMIT_EN):
        ahead = wrap10(phase - rotor)
        most = (n[CL_ANGLES] & 0x1FF) + abs(gamma)
        turned = _limited(fb, n, turn, velocity_pps, clocks)
        turned = min(max(ahead + turned, -most), most) - ahead
        angle = n[DIRECTION] * (ahead + turned)
        turn = turned
    n[ANGLE] = angle
    n[PHASE] = phase + turn
