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
from . import layout as c
from .layout import Cells, Floats, bit, clip, wrap10, wrap32

EMF_EN, CLR_XACT, VLIMIT_EN, VELOCITY_MODE_EN = 25, 26, 27, 28
"""Bits of ENC_IN_CONF."""
BACKLOG = 768
"""Microsteps that XACTUAL may be ahead in closed-loop velocity mode."""


@compiled
def error_of(fb: Floats, x_actual: int) -> int:
    """XACTUAL - ENC_POS [microsteps], the short way around a circular range."""
    error = x_actual - math.floor(fb[c.ENC_POS])
    period = fb[c.PERIOD]
    if period > 0.0:
        return error - math.floor(math.floor(error / period + 0.5) * period + 0.5)
    return wrap32(error)


@inlined
def _sum_limit(n: Cells) -> int:
    """PID_I_CLIP, as ISUM is counted."""
    return (n[c.I_CLIP_D_DIV] & 0x7FFF) << 16


@inlined
def _proportional_integral(n: Cells, error: int, isum: int) -> float:
    """P and I parts of PID and catch-up limiter [pps]."""
    return error * (n[c.GAIN_P] & 0xFFFFFF) / 256.0 + isum / 256.0 * (n[c.GAIN_I] & 0xFFFFFF) / 256.0


@compiled
def pid(fb: Floats, n: Cells, x_actual: int, velocity_pps: float) -> float:
    """One tick of regulation_modus 2 or 3; the velocity of the step output [pps]."""
    error = error_of(fb, x_actual)
    if abs(error) <= n[c.TOLERANCE] & 0xFFFFF:
        error = 0
    n[c.PID_E] = error
    if n[c.PID_FRESH]:
        n[c.PID_FRESH] = n[c.PID_DIFF] = n[c.PID_COUNT] = n[c.PID_ISUM] = 0
        n[c.PID_LAST] = error
    n[c.PID_ISUM] = clip(n[c.PID_ISUM] + error, _sum_limit(n))
    n[c.PID_COUNT] += 1
    if n[c.PID_COUNT] >= n[c.I_CLIP_D_DIV] >> 16 & 0xFF:
        n[c.PID_COUNT] = 0
        n[c.PID_DIFF] = n[c.PID_LAST] - error
        n[c.PID_LAST] = error
    wanted = _proportional_integral(n, error, n[c.PID_ISUM]) + float((n[c.GAIN_D] & 0xFFFFFF) * n[c.PID_DIFF])
    limit = float(n[c.DV_CLIP] & 0x7FFFFFFF)
    n[c.PID_VEL] = int(min(max(wanted, -limit), limit))  # cut towards zero
    if n[c.ENC_IN_CONF] >> 22 & 3 == c.PID_ALONE:
        return float(n[c.PID_VEL])
    return velocity_pps + n[c.PID_VEL]


@inlined
def _gamma(n: Cells) -> int:
    """Angle against the back-EMF, by V_ENC_MEAN."""
    if not bit(n[c.ENC_IN_CONF], EMF_EN):
        return 0
    mean = (n[c.MEAN_Q16] + 32768) >> 16
    over = abs(mean) - (n[c.VMIN_EMF] & 0xFFFFFF)
    if over <= 0:
        return 0
    gamma = n[c.CL_ANGLES] >> 16 & 0xFF
    span = n[c.VADD_EMF] & 0xFFFFFF
    if over < span:
        gamma = gamma * over // span
    return gamma if mean > 0 else -gamma


@inlined
def _correction(n: Cells) -> int:
    """Angle of the field over the rotor without gamma; sets SATURATED."""
    error = n[c.DEV]
    angle = error
    if abs(error) > n[c.TOLERANCE] & 0xFF:
        angle = abs(error) * (n[c.GAIN_D] & 0xFFFFFF) >> 16
        angle = angle if error > 0 else -angle
    beta = n[c.CL_ANGLES] & 0x1FF
    n[c.SATURATED] = abs(angle) >= beta
    return clip(angle, beta)


@inlined
def _limited(fb: Floats, n: Cells, turn: int, velocity_pps: float, clocks: int) -> int:
    """As much of a turn of the field as the catch-up limiter lets through."""
    n[c.CL_ISUM] = clip(n[c.CL_ISUM] + n[c.DEV], _sum_limit(n))
    allowed = min(abs(_proportional_integral(n, n[c.DEV], n[c.CL_ISUM])), float(n[c.DV_CLIP] & 0x7FFFFFFF))
    reach = fb[c.REACH] + (abs(velocity_pps) + allowed) * clocks / fb[c.CLK_FREQ]
    whole = math.floor(min(reach, 512.0))
    turned = clip(turn, whole)
    fb[c.REACH] = reach - whole if whole < 512 and turned != turn else 0.0
    return turned


@compiled
def commutate(fb: Floats, n: Cells, velocity_pps: float, clocks: int) -> None:
    """One tick of the closed loop: the coils' phase from the rotor's place and the deviation."""
    if n[c.GENERAL_CONF] >> 10 & 3 != c.ABN:
        if n[c.NOW] < n[c.CL_DUE]:
            return
        cycle = max(n[c.ENC_VMEAN] >> 16 & 0xFFFF, 1)
        n[c.CL_DUE] += ((n[c.NOW] - n[c.CL_DUE]) // cycle + 1) * cycle
        clocks = max(clocks, cycle)
    gamma = _gamma(n)
    angle = _correction(n) + gamma
    rotor = n[c.DIRECTION] * math.floor(fb[c.ENC_POS]) + n[c.CL_OFFSET]
    phase = n[c.PHASE]
    turn = wrap10(rotor + n[c.DIRECTION] * angle - phase)
    if bit(n[c.ENC_IN_CONF], VLIMIT_EN):
        ahead = wrap10(phase - rotor)
        most = (n[c.CL_ANGLES] & 0x1FF) + abs(gamma)
        turned = _limited(fb, n, turn, velocity_pps, clocks)
        turned = min(max(ahead + turned, -most), most) - ahead
        angle = n[c.DIRECTION] * (ahead + turned)
        turn = turned
    n[c.ANGLE] = angle
    n[c.PHASE] = phase + turn
