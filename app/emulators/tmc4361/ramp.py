"""Which plan there is: what RAMPMODE, target, stops and the step input make of each other; and the place in it."""

# numpy's stubs type a cell as Any; inside compiled code it is an int64 or a float64 and nothing else.
# mypy: disable-error-code="no-any-return"

from __future__ import annotations

import math

from . import plan
from .compiled import compiled, inlined
from .layout import (
    A0,
    ACT_RAMPMODE,
    ACT_XTARGET,
    ASTART,
    BEFORE_A,
    BEFORE_P,
    BEFORE_V,
    CLOSED,
    CORRECTS,
    DT,
    END_P,
    EXT_LEFT,
    EXT_PHASE,
    EXT_RATE,
    EXTERNAL,
    FREEZING,
    FROZEN,
    GEAR,
    GEAR_SUM,
    GENERAL_CONF,
    GOAL,
    IDLING,
    KIND,
    MOVING,
    P0,
    P_A,
    P_J,
    P_P,
    P_T,
    P_V,
    PIECE,
    PIECE_CELLS,
    PIECES,
    PLAN,
    PLAN_END,
    PLAN_TICK,
    R_AMAX,
    R_ASTART,
    R_BOW1,
    R_VSTART,
    REFERENCE_CONF,
    REV_CNT,
    REV_SURPLUS,
    STALLED,
    STEPPED,
    STOPPING,
    SURPLUS,
    TICK,
    TICK_CLOCKS,
    TO_ZERO,
    TZEROWAIT,
    V0,
    VMAX,
    VSTART,
    X_RANGE,
    ZERO_WAIT,
    A,
    Cells,
    Floats,
    P,
    V,
    X,
)
from .units import signed

_ANCHOR_TICKS = 1 << 22
"""A plan at constant velocity begins anew after so long: its seconds stay small numbers."""
_CRAWL_PPS = 1.0
"""VMAX = 1: from here VMAX = 0 stops an S-ramp in positioning mode."""


# --- circular motion ---------------------------------------------------------------------------------------------


@inlined
def circular(r: Cells, s: Cells) -> bool:
    """Whether XACTUAL wraps at X_RANGE."""
    return r[REFERENCE_CONF] >> 22 & 1 != 0 and s[X_RANGE] > 0


@inlined
def _surplus(f: Floats, turn: int) -> int:
    """Microsteps on the seam between `turn` and the next one: what the fractions of all turns add up to there."""
    fraction = f[REV_SURPLUS]
    return int(math.floor((turn + 1) * fraction) - math.floor(turn * fraction))


@compiled
def count(r: Cells, s: Cells, f: Floats, steps: int) -> None:
    """XACTUAL goes on by `steps`. On the seam of circular motion the surplus of CIRCULAR_DEC is not counted."""
    if not circular(r, s):
        s[X] = signed(s[X] + steps)
        return
    half = s[X_RANGE]
    for _ in range(abs(steps)):
        if steps > 0:
            if s[X] < half - 1:
                s[X] += 1
            elif s[SURPLUS] < _surplus(f, s[REV_CNT]):
                s[SURPLUS] += 1
            else:
                s[X], s[SURPLUS] = -half, 0
                s[REV_CNT] += 1
        elif s[SURPLUS] > 0:
            s[SURPLUS] -= 1
        elif s[X] > -half:
            s[X] -= 1
        else:
            s[REV_CNT] -= 1
            s[X], s[SURPLUS] = half - 1, _surplus(f, s[REV_CNT])


@compiled
def distance(r: Cells, s: Cells, f: Floats) -> int:
    """Steps to XTARGET; in circular motion the shorter way."""
    target = s[ACT_XTARGET]
    if not circular(r, s):
        return signed(target - s[X])
    half = s[X_RANGE]
    target = (target + half) % (2 * half) - half
    straight = target - s[X] - s[SURPLUS]
    if target > s[X]:
        other = -(s[X] + half + 1 + _surplus(f, s[REV_CNT] - 1) + half - 1 - target)
    else:
        other = half - 1 - s[X] + _surplus(f, s[REV_CNT]) - s[SURPLUS] + 1 + target + half
    return straight if abs(straight) <= abs(other) else other


# --- plans -------------------------------------------------------------------------------------------------------


@inlined
def rest(r: Cells, s: Cells, f: Floats) -> None:
    """Stand still; what was left of a step is dropped."""
    if f[V] != 0.0 or s[KIND] != IDLING:
        s[ZERO_WAIT] = s[TICK] + (r[TZEROWAIT] + TICK_CLOCKS - 1) // TICK_CLOCKS
    f[V] = f[A] = f[P] = 0.0
    s[STEPPED] = 0
    s[KIND] = IDLING


@inlined
def _cannot_begin(r: Cells, s: Cells) -> bool:
    """No acceleration to begin with: the register says 0, and VSTART does not help."""
    if r[R_VSTART] & 0x7FFFFFFF:
        return False
    shape = s[ACT_RAMPMODE] & 3
    if shape == plan.HOLD:
        return False
    if r[R_AMAX] & 0xFFFFFF == 0 or (shape == plan.S_SHAPE and (r[R_BOW1] == 0 or r[R_BOW1 + 1] == 0)):
        return True
    return shape == plan.TRAPEZOID and r[R_VSTART + 2] != 0 and r[R_ASTART] & 0xFFFFFF == 0


@compiled
def decide(r: Cells, s: Cells, f: Floats) -> None:
    """Plan anew from where the ramp generator is now. A stop's slope is kept: it ends at standstill first."""
    kind = s[KIND]
    if s[FROZEN] or kind in (STOPPING, FREEZING):
        return
    if _external(r, s, f):
        return
    mode = s[ACT_RAMPMODE]
    shape = mode & 3
    if shape == 3:  # undefined: nothing changes
        return
    positioning = mode & 4 != 0
    if kind == TO_ZERO and shape == plan.TRAPEZOID and f[V] != 0.0:
        return
    if positioning and f[VMAX] == 0.0 and shape == plan.S_SHAPE and abs(f[V]) > _CRAWL_PPS:
        return  # DS-TMC4361 8.2.2: not to be done. Here it is not obeyed
    if kind == MOVING and s[PLAN_TICK] == s[TICK]:  # several writes in one tick: all from the same start
        f[P0], f[V0], f[A0] = f[BEFORE_P], f[BEFORE_V], f[BEFORE_A]
    else:
        f[P0], f[V0], f[A0] = f[P] - s[STEPPED], f[V], f[A]
    from_rest = f[V0] == 0.0 and f[A0] == 0.0
    way = distance(r, s, f) if positioning else 0
    wanted = f[VMAX]  # where to, by its sign
    if positioning and f[VMAX] != 0.0:
        wanted = way - f[P0]
    if from_rest:
        blocked = (wanted < 0.0 and s[CLOSED] & 1) or (wanted > 0.0 and s[CLOSED] & 2)
        if wanted == 0.0 or blocked or s[STALLED] or s[TICK] < s[ZERO_WAIT] or _cannot_begin(r, s):
            if f[V] != 0.0 or s[KIND] == MOVING:
                rest(r, s, f)
            return
    slowing = kind == MOVING and f[A] * f[V] < 0.0
    f[BEFORE_P], f[BEFORE_V], f[BEFORE_A] = f[P0], f[V0], f[A0]
    s[KIND], s[PLAN_TICK], s[STEPPED] = MOVING, s[TICK], 0
    f[GOAL] = 0.0
    corrects = s[CORRECTS] != 0
    vstart, astart = f[VSTART], f[ASTART]
    if corrects:
        f[VSTART] = f[ASTART] = 0.0
    first = f[ASTART]
    if f[VSTART] > 0.0 and not r[GENERAL_CONF] & 1:
        first = math.inf  # AMAX (DS-TMC4361 8.2.1)
    if (positioning and f[VMAX] == 0.0) or (not positioning and _closed_ahead(s, f)):
        if shape == plan.HOLD:
            plan.straight_down(s, f, 0.0)
        else:
            plan.to_standstill(s, f, shape)
        s[KIND] = TO_ZERO
    elif positioning:
        f[GOAL] = plan.to_position(s, f, shape, float(way), from_rest, first, corrects)
        s[CORRECTS] = f[GOAL] != float(way)
    else:
        plan.to_velocity(s, f, shape, from_rest, first)
        f[GOAL] = f[END_P]
    f[VSTART], f[ASTART] = vstart, astart
    if slowing and shape == plan.TRAPEZOID and s[PIECES] > 0 and f[PLAN + P_A] * f[V0] > 0.0:
        plan.to_standstill(s, f, shape)  # DS-TMC4361 8.2.2: a slope down is finished before the next one goes up
        s[KIND] = TO_ZERO
    if s[KIND] == TO_ZERO:
        f[GOAL] = f[END_P]
    s[PIECE] = 0
    if s[PIECES] > 0:
        f[P], f[V], f[A] = f[PLAN + P_P], f[PLAN + P_V], f[PLAN + P_A]


@inlined
def _closed_ahead(s: Cells, f: Floats) -> bool:
    return (f[VMAX] < 0.0 and s[CLOSED] & 1 != 0) or (f[VMAX] > 0.0 and s[CLOSED] & 2 != 0)


@compiled
def slow_down(r: Cells, s: Cells, f: Floats, deceleration: float, kind: int) -> None:
    """A stop: a linear slope to standstill, with 0 at once."""
    if deceleration <= 0.0 or f[V] == 0.0:
        rest(r, s, f)
        return
    f[P0], f[V0], f[A0] = f[P] - s[STEPPED], f[V], 0.0
    plan.straight_down(s, f, deceleration)
    f[GOAL] = f[END_P]
    s[KIND], s[PLAN_TICK], s[STEPPED], s[PIECE] = kind, s[TICK], 0, 0
    f[P], f[A] = f[P0], f[PLAN + P_A]


@compiled
def go_on(r: Cells, s: Cells, f: Floats) -> int:
    """One tick of the plan; the steps made in it."""
    tick = s[TICK] - s[PLAN_TICK]
    t = tick * f[DT]
    if t >= f[PLAN_END]:
        left = f[GOAL] - s[STEPPED]
        steps = int(left + math.copysign(1e-6, left))
        rest(r, s, f)
        return steps
    piece = s[PIECE]
    while piece + 1 < s[PIECES] and f[PLAN + PIECE_CELLS * (piece + 1) + P_T] <= t:
        piece += 1
    s[PIECE] = piece
    at = PLAN + PIECE_CELLS * piece
    t -= f[at + P_T]
    v, a, j = f[at + P_V], f[at + P_A], f[at + P_J]
    f[P] = f[at + P_P] + t * (v + t * (a / 2.0 + t * j / 6.0))
    f[V] = v + t * (a + t * j / 2.0)
    f[A] = a + t * j
    steps = int(f[P] - s[STEPPED])
    s[STEPPED] += steps
    if tick >= _ANCHOR_TICKS and piece + 1 == s[PIECES] and f[PLAN_END] == math.inf:
        f[PLAN + P_T], f[PLAN + P_P] = 0.0, f[P] - s[STEPPED]
        f[PLAN + P_V], f[PLAN + P_A], f[PLAN + P_J] = f[V], 0.0, 0.0
        f[P] -= s[STEPPED]
        s[PIECES], s[PIECE], s[STEPPED], s[PLAN_TICK] = 1, 0, 0, s[TICK]
    return steps


# --- step input --------------------------------------------------------------------------------------------------


@compiled
def _external(r: Cells, s: Cells, f: Floats) -> bool:
    """Whether STPIN has control of the steps (sdin_mode, without sd_indirect_control).

    Leaving it, the ramp begins with VSTART in the direction of the last steps if automatic_direct_sdin_switch_off is
    set and they still came, else from standstill; a choice, the sources only name VSTART and ASTART.
    """
    general = r[GENERAL_CONF]
    if general >> 6 & 3 and not general >> 9 & 1:
        if s[KIND] != EXTERNAL:
            rest(r, s, f)
            s[KIND] = EXTERNAL
        return True
    if s[KIND] == EXTERNAL:
        going = f[V]
        rest(r, s, f)
        if general >> 26 & 1 and going != 0.0:
            f[V] = math.copysign(f[VSTART], going)
            if s[ACT_RAMPMODE] & 3 == plan.S_SHAPE:
                f[A] = math.copysign(f[ASTART], -1.0 if r[R_ASTART] >> 31 & 1 else 1.0)
    return False


@compiled
def external_steps(r: Cells, s: Cells, f: Floats) -> int:
    """One tick of the step input; the internal steps that it makes."""
    general = r[GENERAL_CONF]
    if s[EXT_LEFT] == 0:
        if s[KIND] == EXTERNAL:
            f[V] = 0.0
        return 0
    direction = 1 if s[EXT_LEFT] > 0 else -1
    f[EXT_PHASE] += f[EXT_RATE]
    pulses = min(int(f[EXT_PHASE]), abs(s[EXT_LEFT]))
    f[EXT_PHASE] -= pulses
    s[EXT_LEFT] -= direction * pulses
    if s[EXT_LEFT] == 0:
        f[EXT_PHASE] = 0.0
    mode = general >> 6 & 3
    if mode == 0:
        return 0
    if mode == 3:  # both edges of a pulse count
        pulses *= 2
    f[GEAR_SUM] += direction * pulses * f[GEAR]
    steps = math.floor(f[GEAR_SUM])
    f[GEAR_SUM] -= steps
    if general >> 9 & 1:
        s[ACT_XTARGET] = signed(s[ACT_XTARGET] + steps)
        return steps
    f[V] = direction * f[EXT_RATE] / f[DT] * f[GEAR] * (2.0 if mode == 3 else 1.0)
    f[A] = 0.0
    return steps
