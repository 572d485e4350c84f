"""Which plan there is: what RAMPMODE, target, stops and the step input make of each other; and the place in it."""

# numpy's stubs type a cell as Any; inside compiled code it is an int64 or a float64 and nothing else.
# mypy: disable-error-code="no-any-return"

from __future__ import annotations

import math

from . import layout as c
from . import plan
from .compiled import compiled, inlined
from .layout import Cells, Floats
from .units import signed

_ANCHOR_TICKS = 1 << 22
"""A plan at constant velocity begins anew after so long: its seconds stay small numbers."""
_CRAWL_PPS = 1.0
"""VMAX = 1: from here VMAX = 0 stops an S-ramp in positioning mode."""


# --- circular motion ---------------------------------------------------------------------------------------------


@inlined
def circular(r: Cells, s: Cells) -> bool:
    """Whether XACTUAL wraps at X_RANGE."""
    return r[c.REFERENCE_CONF] >> 22 & 1 != 0 and s[c.X_RANGE] > 0


@inlined
def _surplus(f: Floats, turn: int) -> int:
    """Microsteps on the seam between `turn` and the next one: what the fractions of all turns add up to there."""
    fraction = f[c.REV_SURPLUS]
    return int(math.floor((turn + 1) * fraction) - math.floor(turn * fraction))


@compiled
def count(r: Cells, s: Cells, f: Floats, steps: int) -> None:
    """XACTUAL goes on by `steps`. On the seam of circular motion the surplus of CIRCULAR_DEC is not counted."""
    if not circular(r, s):
        s[c.X] = signed(s[c.X] + steps)
        return
    half = s[c.X_RANGE]
    for _ in range(abs(steps)):
        if steps > 0:
            if s[c.X] < half - 1:
                s[c.X] += 1
            elif s[c.SURPLUS] < _surplus(f, s[c.REV_CNT]):
                s[c.SURPLUS] += 1
            else:
                s[c.X], s[c.SURPLUS] = -half, 0
                s[c.REV_CNT] += 1
        elif s[c.SURPLUS] > 0:
            s[c.SURPLUS] -= 1
        elif s[c.X] > -half:
            s[c.X] -= 1
        else:
            s[c.REV_CNT] -= 1
            s[c.X], s[c.SURPLUS] = half - 1, _surplus(f, s[c.REV_CNT])


@compiled
def distance(r: Cells, s: Cells, f: Floats) -> int:
    """Steps to XTARGET; in circular motion the shorter way."""
    target = s[c.ACT_XTARGET]
    if not circular(r, s):
        return signed(target - s[c.X])
    half = s[c.X_RANGE]
    target = (target + half) % (2 * half) - half
    straight = target - s[c.X] - s[c.SURPLUS]
    if target > s[c.X]:
        other = -(s[c.X] + half + 1 + _surplus(f, s[c.REV_CNT] - 1) + half - 1 - target)
    else:
        other = half - 1 - s[c.X] + _surplus(f, s[c.REV_CNT]) - s[c.SURPLUS] + 1 + target + half
    return straight if abs(straight) <= abs(other) else other


# --- plans -------------------------------------------------------------------------------------------------------


@inlined
def rest(r: Cells, s: Cells, f: Floats) -> None:
    """Stand still; what was left of a step is dropped."""
    if f[c.V] != 0.0 or s[c.KIND] != c.IDLING:
        s[c.ZERO_WAIT] = s[c.TICK] + (r[c.TZEROWAIT] + c.TICK_CLOCKS - 1) // c.TICK_CLOCKS
    f[c.V] = f[c.A] = f[c.P] = 0.0
    s[c.STEPPED] = 0
    s[c.KIND] = c.IDLING


@inlined
def _cannot_begin(r: Cells, s: Cells) -> bool:
    """No acceleration to begin with: the register says 0, and VSTART does not help."""
    if r[c.R_VSTART] & 0x7FFFFFFF:
        return False
    shape = s[c.ACT_RAMPMODE] & 3
    if shape == plan.HOLD:
        return False
    if r[c.R_AMAX] & 0xFFFFFF == 0 or (shape == plan.S_SHAPE and (r[c.R_BOW1] == 0 or r[c.R_BOW1 + 1] == 0)):
        return True
    return shape == plan.TRAPEZOID and r[c.R_VSTART + 2] != 0 and r[c.R_ASTART] & 0xFFFFFF == 0


@compiled
def decide(r: Cells, s: Cells, f: Floats) -> None:
    """Plan anew from where the ramp generator is now. A stop's slope is kept: it ends at standstill first."""
    kind = s[c.KIND]
    if s[c.FROZEN] or kind in (c.STOPPING, c.FREEZING):
        return
    if _external(r, s, f):
        return
    mode = s[c.ACT_RAMPMODE]
    shape = mode & 3
    if shape == 3:  # undefined: nothing changes
        return
    positioning = mode & 4 != 0
    if kind == c.TO_ZERO and shape == plan.TRAPEZOID and f[c.V] != 0.0:
        return
    if positioning and f[c.VMAX] == 0.0 and shape == plan.S_SHAPE and abs(f[c.V]) > _CRAWL_PPS:
        return  # DS-TMC4361 8.2.2: not to be done. Here it is not obeyed
    if kind == c.MOVING and s[c.PLAN_TICK] == s[c.TICK]:  # several writes in one tick: all from the same start
        f[c.P0], f[c.V0], f[c.A0] = f[c.BEFORE_P], f[c.BEFORE_V], f[c.BEFORE_A]
    else:
        f[c.P0], f[c.V0], f[c.A0] = f[c.P] - s[c.STEPPED], f[c.V], f[c.A]
    from_rest = f[c.V0] == 0.0 and f[c.A0] == 0.0
    way = distance(r, s, f) if positioning else 0
    wanted = f[c.VMAX]  # where to, by its sign
    if positioning and f[c.VMAX] != 0.0:
        wanted = way - f[c.P0]
    if from_rest:
        blocked = (wanted < 0.0 and s[c.CLOSED] & 1) or (wanted > 0.0 and s[c.CLOSED] & 2)
        if wanted == 0.0 or blocked or s[c.STALLED] or s[c.TICK] < s[c.ZERO_WAIT] or _cannot_begin(r, s):
            if f[c.V] != 0.0 or s[c.KIND] == c.MOVING:
                rest(r, s, f)
            return
    slowing = kind == c.MOVING and f[c.A] * f[c.V] < 0.0
    f[c.BEFORE_P], f[c.BEFORE_V], f[c.BEFORE_A] = f[c.P0], f[c.V0], f[c.A0]
    s[c.KIND], s[c.PLAN_TICK], s[c.STEPPED] = c.MOVING, s[c.TICK], 0
    f[c.GOAL] = 0.0
    corrects = s[c.CORRECTS] != 0
    vstart, astart = f[c.VSTART], f[c.ASTART]
    if corrects:
        f[c.VSTART] = f[c.ASTART] = 0.0
    first = f[c.ASTART]
    if f[c.VSTART] > 0.0 and not r[c.GENERAL_CONF] & 1:
        first = math.inf  # AMAX (DS-TMC4361 8.2.1)
    if (positioning and f[c.VMAX] == 0.0) or (not positioning and _closed_ahead(s, f)):
        if shape == plan.HOLD:
            plan.straight_down(s, f, 0.0)
        else:
            plan.to_standstill(s, f, shape)
        s[c.KIND] = c.TO_ZERO
    elif positioning:
        f[c.GOAL] = plan.to_position(s, f, shape, float(way), from_rest, first, corrects)
        s[c.CORRECTS] = f[c.GOAL] != float(way)
    else:
        plan.to_velocity(s, f, shape, from_rest, first)
        f[c.GOAL] = f[c.END_P]
    f[c.VSTART], f[c.ASTART] = vstart, astart
    if slowing and shape == plan.TRAPEZOID and s[c.PIECES] > 0 and f[c.PLAN + c.P_A] * f[c.V0] > 0.0:
        plan.to_standstill(s, f, shape)  # DS-TMC4361 8.2.2: a slope down is finished before the next one goes up
        s[c.KIND] = c.TO_ZERO
    if s[c.KIND] == c.TO_ZERO:
        f[c.GOAL] = f[c.END_P]
    s[c.PIECE] = 0
    if s[c.PIECES] > 0:
        f[c.P], f[c.V], f[c.A] = f[c.PLAN + c.P_P], f[c.PLAN + c.P_V], f[c.PLAN + c.P_A]


@inlined
def _closed_ahead(s: Cells, f: Floats) -> bool:
    return (f[c.VMAX] < 0.0 and s[c.CLOSED] & 1 != 0) or (f[c.VMAX] > 0.0 and s[c.CLOSED] & 2 != 0)


@compiled
def slow_down(r: Cells, s: Cells, f: Floats, deceleration: float, kind: int) -> None:
    """A stop: a linear slope to standstill, with 0 at once."""
    if deceleration <= 0.0 or f[c.V] == 0.0:
        rest(r, s, f)
        return
    f[c.P0], f[c.V0], f[c.A0] = f[c.P] - s[c.STEPPED], f[c.V], 0.0
    plan.straight_down(s, f, deceleration)
    f[c.GOAL] = f[c.END_P]
    s[c.KIND], s[c.PLAN_TICK], s[c.STEPPED], s[c.PIECE] = kind, s[c.TICK], 0, 0
    f[c.P], f[c.A] = f[c.P0], f[c.PLAN + c.P_A]


@compiled
def go_on(r: Cells, s: Cells, f: Floats) -> int:
    """One tick of the plan; the steps made in it."""
    tick = s[c.TICK] - s[c.PLAN_TICK]
    t = tick * f[c.DT]
    if t >= f[c.PLAN_END]:
        left = f[c.GOAL] - s[c.STEPPED]
        steps = int(left + math.copysign(1e-6, left))
        rest(r, s, f)
        return steps
    piece = s[c.PIECE]
    while piece + 1 < s[c.PIECES] and f[c.PLAN + c.PIECE_CELLS * (piece + 1) + c.P_T] <= t:
        piece += 1
    s[c.PIECE] = piece
    at = c.PLAN + c.PIECE_CELLS * piece
    t -= f[at + c.P_T]
    v, a, j = f[at + c.P_V], f[at + c.P_A], f[at + c.P_J]
    f[c.P] = f[at + c.P_P] + t * (v + t * (a / 2.0 + t * j / 6.0))
    f[c.V] = v + t * (a + t * j / 2.0)
    f[c.A] = a + t * j
    steps = int(f[c.P] - s[c.STEPPED])
    s[c.STEPPED] += steps
    if s[c.STEPPED] == f[c.GOAL] and f[c.PLAN_END] - tick * f[c.DT] < f[c.DT]:
        # There by rounding, with an end that comes before the next tick: TARGET_REACHED is told at rest, so that what
        # it starts begins there (TZEROWAIT, VSTART, ASTART).
        rest(r, s, f)
        return steps
    if tick >= _ANCHOR_TICKS and piece + 1 == s[c.PIECES] and f[c.PLAN_END] == math.inf:
        f[c.PLAN + c.P_T], f[c.PLAN + c.P_P] = 0.0, f[c.P] - s[c.STEPPED]
        f[c.PLAN + c.P_V], f[c.PLAN + c.P_A], f[c.PLAN + c.P_J] = f[c.V], 0.0, 0.0
        f[c.P] -= s[c.STEPPED]
        s[c.PIECES], s[c.PIECE], s[c.STEPPED], s[c.PLAN_TICK] = 1, 0, 0, s[c.TICK]
    return steps


# --- step input --------------------------------------------------------------------------------------------------


@compiled
def _external(r: Cells, s: Cells, f: Floats) -> bool:
    """Whether STPIN has control of the steps (sdin_mode, without sd_indirect_control).

    Leaving it, the ramp begins with VSTART in the direction of the last steps if automatic_direct_sdin_switch_off is
    set and they still came, else from standstill; a choice, the sources only name VSTART and ASTART.
    """
    general = r[c.GENERAL_CONF]
    if general >> 6 & 3 and not general >> 9 & 1:
        if s[c.KIND] != c.EXTERNAL:
            rest(r, s, f)
            s[c.KIND] = c.EXTERNAL
        return True
    if s[c.KIND] == c.EXTERNAL:
        going = f[c.V]
        rest(r, s, f)
        if general >> 26 & 1 and going != 0.0:
            f[c.V] = math.copysign(f[c.VSTART], going)
            if s[c.ACT_RAMPMODE] & 3 == plan.S_SHAPE:
                f[c.A] = math.copysign(f[c.ASTART], -1.0 if r[c.R_ASTART] >> 31 & 1 else 1.0)
    return False


@compiled
def external_steps(r: Cells, s: Cells, f: Floats) -> int:
    """One tick of the step input; the internal steps that it makes."""
    general = r[c.GENERAL_CONF]
    if s[c.EXT_LEFT] == 0:
        if s[c.KIND] == c.EXTERNAL:
            f[c.V] = 0.0
        return 0
    direction = 1 if s[c.EXT_LEFT] > 0 else -1
    f[c.EXT_PHASE] += f[c.EXT_RATE]
    pulses = min(int(f[c.EXT_PHASE]), abs(s[c.EXT_LEFT]))
    f[c.EXT_PHASE] -= pulses
    s[c.EXT_LEFT] -= direction * pulses
    if s[c.EXT_LEFT] == 0:
        f[c.EXT_PHASE] = 0.0
    mode = general >> 6 & 3
    if mode == 0:
        return 0
    if mode == 3:  # both edges of a pulse count
        pulses *= 2
    f[c.GEAR_SUM] += direction * pulses * f[c.GEAR]
    steps = math.floor(f[c.GEAR_SUM])
    f[c.GEAR_SUM] -= steps
    if general >> 9 & 1:
        s[c.ACT_XTARGET] = signed(s[c.ACT_XTARGET] + steps)
        return steps
    f[c.V] = direction * f[c.EXT_RATE] / f[c.DT] * f[c.GEAR] * (2.0 if mode == 3 else 1.0)
    f[c.A] = 0.0
    return steps
