"""dcStep: the ramp waits for the motor instead of losing it.

DC_VEL is the speed from which it acts, and with it full steps (API). Above, the driver tells by STEP_READY when the
motor has followed; the documents that we have do not say how the ramp generator waits. Read like this: the plan of the
ramp stands still, with VACTUAL as it is, while the field is more than a full step ahead of the rotor, which is 45
degrees of lag as a full step goes out, like the dcStep of the emulated TMC5xxx with its DC_TIME in the middle.
From half of that on the rotor must not swing back: only a coil against which it turns has the back-EMF that the driver
looks for. DC_LSPTM clocks after the one before a full step goes out whether the motor has followed or not, so the
lowest rate of full steps is fCLK / DC_LSPTM. It does not act in closed loop, under PID, or with PWM.
"""

# mypy: disable-error-code="no-any-return"

from __future__ import annotations

import math

import numpy as np

from ..drive import kernel as k
from . import layout as c
from .compiled import compiled, inlined
from .feedback import layout as fl
from .layout import Cells, Floats
from .output import microstep

DCSTEP_MODE, PWM_OUT = 21, 23
"""Bits of GENERAL_CONF."""
FULL_STEP = 256


@compiled
def dcstep_acts(r: Cells, f: Floats) -> bool:
    """Whether dcStep works at this speed."""
    general, least = r[c.GENERAL_CONF], r[c.DC_VEL] & 0xFFFFFF
    if general >> DCSTEP_MODE & 3 == 0 or general >> PWM_OUT & 1 or least == 0:
        return False
    return r[fl.ENC_IN_CONF - fl.WORD] >> 22 & 3 == 0 and abs(f[c.V]) > least


@compiled
def waits(r: Cells, s: Cells, f: Floats, fb: Floats) -> bool:
    """Whether the ramp waits for the motor in this tick."""
    if s[c.KIND] != c.MOVING or not dcstep_acts(r, f):
        s[c.DC_WAIT] = s[c.DC_FREE] = 0
        return False
    n = fb[fl.INTEGERS_AT :].view(np.int64)
    way = n[fl.DIRECTION] if f[c.V] > 0.0 else -n[fl.DIRECTION]
    rotor = fb[k.TEETH] * fb[k.THETA] * (2 * FULL_STEP / math.pi)
    if s[c.DC_FREE] > 0:
        s[c.DC_WAIT] += 1
        return False
    ahead = way * (n[fl.PHASE] - rotor)
    if ahead <= FULL_STEP // 2 or (ahead <= FULL_STEP and way * fb[k.OMEGA] >= 0.0):
        s[c.DC_WAIT] = 0
        return False
    s[c.DC_WAIT] += 1
    if s[c.DC_WAIT] * c.TICK_CLOCKS >= r[c.DC_LSPTM]:
        s[c.DC_WAIT] = 0
        s[c.DC_FREE] = FULL_STEP
        return False
    return True


@inlined
def made(r: Cells, s: Cells, steps: int) -> None:
    """Steps went out, of those that go whether the motor follows or not."""
    if s[c.DC_FREE] > 0:
        s[c.DC_FREE] = max(s[c.DC_FREE] - abs(steps) * microstep(r), 0)
