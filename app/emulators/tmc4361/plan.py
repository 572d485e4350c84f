"""The ramp generator's plan: what RAMPMODE makes of the registers, as pieces of constant jerk from now to rest.

The data sheet gives shapes, limits and that positioning ends exactly on XTARGET, not the law by which the chip does
it. Here a plan is worked out in doubles whenever registers, target or a stop ask for it, from the velocity and the
acceleration that there are, and the kernel looks up its place in the plan every 64 clocks: that is the bow update
of DS-TMC4361 8.2. So the end is exact by construction, however the registers are changed on the way.

The way to a target is: a velocity change to some peak, that velocity for a while, a stop. The peak is VMAX or, where
the way is too short, what bisection finds. A velocity change lets a begun acceleration go to zero along its bow first
where it leads the wrong way, so |VACTUAL| can exceed a VMAX that was lowered (DS-TMC4361 8.2.2). Through zero the
slope runs on: VSTART, VSTOP, ASTART and DFINAL are for true starts and ends (8.2.1).

In the frame of a direction speed is u, acceleration a > 0 speeds up: BOW1 raises it to AMAX, BOW2 takes it to 0, BOW3
to -DMAX, BOW4 back to 0.
"""

# numpy's stubs type a cell as Any; inside compiled code it is an int64 or a float64 and nothing else.
# mypy: disable-error-code="no-any-return"

from __future__ import annotations

import math

from . import layout as c
from .compiled import compiled
from .layout import Cells, Floats

HOLD, TRAPEZOID, S_SHAPE = range(3)
_HALVINGS = 64
"""Bisection steps: doubles have 53 bits, the rest settles the last one."""
_NEAR = 1e-6
"""Ends that differ by less [pulses] are the same end: no correction is worth so little."""


@compiled
def _go(s: Cells, f: Floats, duration: float, jerk: float) -> None:
    """Append a piece and go to its end."""
    if duration <= 0.0 or s[c.PIECES] >= c.MOST_PIECES:
        return
    at = c.PLAN + c.PIECE_CELLS * s[c.PIECES]
    t, p, v, a = f[c.END_T], f[c.END_P], f[c.END_V], f[c.END_A]
    f[at + c.P_T], f[at + c.P_P], f[at + c.P_V], f[at + c.P_A], f[at + c.P_J] = t, p, v, a, jerk
    s[c.PIECES] += 1
    f[c.END_T] = t + duration
    f[c.END_P] = p + duration * (v + duration * (a / 2.0 + duration * jerk / 6.0))
    f[c.END_V] = v + duration * (a + duration * jerk / 2.0)
    f[c.END_A] = a + duration * jerk


@compiled
def _begin(s: Cells, f: Floats) -> None:
    """Throw the plan away; the next piece starts at `P0`, `V0`, `A0`."""
    s[c.PIECES] = s[c.PIECE] = 0
    f[c.END_T] = 0.0
    f[c.END_P], f[c.END_V], f[c.END_A] = f[c.P0], f[c.V0], f[c.A0]


@compiled
def _square_root(x: float) -> float:
    return math.sqrt(x) if x > 0.0 else 0.0


# --- S-shape: one direction --------------------------------------------------------------------------------------


@compiled
def _bows(s: Cells, f: Floats, d: float, change: float, limit: float, rise: float, fall: float, last: float) -> None:
    """Change the velocity by `change` >= 0 in direction `d` and end with acceleration `last` >= 0 in it.

    The acceleration, not negative in that direction, goes by `rise` up to at most `limit`, stays, and goes by `fall`.
    Where `change` is less than its present value needs to get to `last`, that is what happens.
    """
    a = max(d * f[c.END_A], 0.0)
    peak2 = (change + a * a / (2.0 * rise) + last * last / (2.0 * fall)) / (0.5 / rise + 0.5 / fall)
    peak = max(_square_root(peak2), last)
    if peak > limit:
        peak = max(limit, last)
    if peak < a:  # the limit has been lowered, or there is no way to go: down first
        _go(s, f, (a - peak) / fall, -d * fall)
        used = (a * a - peak * peak) / (2.0 * fall)
    else:
        _go(s, f, (peak - a) / rise, d * rise)
        used = (peak * peak - a * a) / (2.0 * rise)
    left = change - used - (peak * peak - last * last) / (2.0 * fall)
    if peak > 0.0 and left > 1e-12 * change:
        f[c.END_A] = d * peak
        _go(s, f, left / peak, 0.0)
    _go(s, f, (peak - last) / fall, -d * fall)
    f[c.END_A] = d * last


@compiled
def _change_s(s: Cells, f: Floats, goal: float) -> None:
    """Change to velocity `goal` (signed) and acceleration 0, through zero where it has to be."""
    for _ in range(4):  # each passing through zero takes a turn, and more than two are not possible
        v, a = f[c.END_V], f[c.END_A]
        d = 1.0 if v > 0.0 or (v == 0.0 and (a > 0.0 or (a == 0.0 and goal > 0.0))) else -1.0
        u, a, w = d * v, d * a, d * goal
        if a > 0.0:
            natural = u + a * a / (2.0 * f[c.BOW2])
            if w >= natural * (1.0 - 1e-12):
                _bows(s, f, d, max(w - u, 0.0), f[c.AMAX], f[c.BOW1], f[c.BOW2], 0.0)
                break
            _go(s, f, a / f[c.BOW2], -d * f[c.BOW2])
            f[c.END_A] = 0.0
            u = d * f[c.END_V]
            a = 0.0
        natural = u - a * a / (2.0 * f[c.BOW4])
        if _leads_through_zero(f, u, a) or (w < 0.0 and u > 0.0):
            _to_zero(s, f, d, u, a, max(-w, 0.0))
            f[c.END_V] = 0.0
            continue
        if w < natural:
            _bows(s, f, -d, u - w, f[c.DMAX], f[c.BOW3], f[c.BOW4], 0.0)
            break
        if a < 0.0:
            _go(s, f, -a / f[c.BOW4], d * f[c.BOW4])
            f[c.END_A] = 0.0
            u = d * f[c.END_V]
        _bows(s, f, d, max(w - u, 0.0), f[c.AMAX], f[c.BOW1], f[c.BOW2], 0.0)
        break
    f[c.END_V] = goal
    f[c.END_A] = 0.0


@compiled
def _leads_through_zero(f: Floats, u: float, a: float) -> bool:
    """Whether a deceleration, ended by BOW4 at once, still takes the velocity below 0."""
    return a < 0.0 and u - a * a / (2.0 * f[c.BOW4]) < -1e-9 * max(u, 1.0)


@compiled
def _to_zero(s: Cells, f: Floats, d: float, u: float, a: float, beyond: float) -> None:
    """Slow down from `u` > 0 to 0 on the way to `beyond` in the other direction, a <= 0.

    The acceleration at zero is what both sides can have: it is a deceleration before and speeds up afterwards.
    """
    at_zero2 = min(min(f[c.AMAX], f[c.DMAX]) ** 2, 2.0 * f[c.BOW2] * beyond, a * a + 2.0 * f[c.BOW3] * u)
    at_zero = _square_root(max(at_zero2, a * a - 2.0 * f[c.BOW4] * u))
    _bows(s, f, -d, u, f[c.DMAX], f[c.BOW3], f[c.BOW4], at_zero)


@compiled
def _stop_s(s: Cells, f: Floats, vstop: float, last: float, ends: bool) -> None:
    """Slow down to `vstop` > 0 (no B4, then dead stop), or to 0 with deceleration `last` at the end.

    `ends` false: `last` is given up in favour of a smooth end. Velocity and acceleration are 0 after it.
    """
    v = f[c.END_V]
    d = 1.0 if v > 0.0 else -1.0
    u, a = d * v, d * f[c.END_A]
    if u > vstop:
        if a > 0.0:
            _go(s, f, a / f[c.BOW2], -d * f[c.BOW2])
            f[c.END_A] = 0.0
            u, a = d * f[c.END_V], 0.0
        way = u - vstop
        if vstop == 0.0 and _leads_through_zero(f, u, a):
            _change_s(s, f, 0.0)
            return
        least = _square_root(a * a - 2.0 * f[c.BOW4] * way)
        most = min(_square_root(a * a + 2.0 * f[c.BOW3] * way), max(f[c.DMAX], -a))
        final = min(max(last, least), most) if ends else least
        _bows(s, f, -d, way, f[c.DMAX], f[c.BOW3], f[c.BOW4], final)
    f[c.END_V] = f[c.END_A] = 0.0


# --- trapezoid ---------------------------------------------------------------------------------------------------


@compiled
def _line(s: Cells, f: Floats, d: float, end: float, acceleration: float) -> None:
    """Straight to speed `end` in direction `d`."""
    change = abs(end - d * f[c.END_V])
    if acceleration > 0.0 and change > 0.0:
        f[c.END_A] = acceleration * d * (1.0 if end > d * f[c.END_V] else -1.0)
        _go(s, f, change / acceleration, 0.0)
    f[c.END_V] = d * end
    f[c.END_A] = 0.0


@compiled
def _change_lines(s: Cells, f: Floats, goal: float) -> None:
    """Change to velocity `goal` (signed) by the trapezoid's slopes: ASTART, AMAX, DMAX, DFINAL around VBREAK."""
    knee = f[c.VBREAK]
    for _ in range(2):
        v = f[c.END_V]
        d = 1.0 if v > 0.0 or (v == 0.0 and goal > 0.0) else -1.0
        u, w = d * v, d * goal
        if w >= u:
            if u < knee and w > u:
                _line(s, f, d, min(w, knee), f[c.ASTART])
                u = d * f[c.END_V]
            if w > u:
                _line(s, f, d, w, f[c.AMAX])
            break
        below = max(w, 0.0)
        if u > knee:
            _line(s, f, d, max(below, knee), f[c.DMAX])
        if d * f[c.END_V] > below:
            _line(s, f, d, below, f[c.DFINAL] if knee > 0.0 else f[c.DMAX])
        if w >= 0.0:
            break
    f[c.END_V] = goal
    f[c.END_A] = 0.0


# --- both --------------------------------------------------------------------------------------------------------


@compiled
def change(s: Cells, f: Floats, shape: int, goal: float) -> None:
    """Change to velocity `goal` with acceleration 0 at the end."""
    if shape == S_SHAPE:
        _change_s(s, f, goal)
    else:
        _change_lines(s, f, goal)


@compiled
def start(s: Cells, f: Floats, shape: int, goal: float, first: float) -> None:
    """From rest: VSTART, and in an S-shape the acceleration that the ramp begins with, `first`.

    What does not fit `goal` is taken back: ASTART becomes altered (DS-TMC4361 8.2.2), a speed above it is not begun
    with.
    """
    d = 1.0 if goal > 0.0 else -1.0
    u = min(f[c.VSTART], abs(goal))
    f[c.END_V] = d * u
    f[c.END_A] = 0.0
    if shape == S_SHAPE:
        f[c.END_A] = d * min(first, f[c.AMAX], _square_root(2.0 * f[c.BOW2] * (abs(goal) - u)))


@compiled
def stop(s: Cells, f: Floats, shape: int, vstop: float, last: float, ends: bool) -> None:
    """Slow down to standstill: from `vstop` on at once."""
    if shape == S_SHAPE:
        _stop_s(s, f, vstop, last, ends)
        return
    u = abs(f[c.END_V])
    if u > vstop:
        _change_lines(s, f, vstop if f[c.END_V] > 0.0 else -vstop)
    f[c.END_V] = f[c.END_A] = 0.0


@compiled
def _attempt(s: Cells, f: Floats, shape: int, peak: float, from_rest: bool, first: float, wait: float) -> float:
    """Build the way over velocity `peak` (signed), `wait` [s] of it; where it ends [pulses]."""
    _begin(s, f)
    if from_rest:
        start(s, f, shape, peak, first)
    change(s, f, shape, peak)
    _go(s, f, wait, 0.0)
    stop(s, f, shape, f[c.VSTOP], f[c.DMAX] if f[c.VSTOP] > 0.0 else 0.0, f[c.VSTOP] > 0.0)
    return f[c.END_P]


@compiled
def _direct(s: Cells, f: Floats, last: float, ends: bool) -> float:
    """Stop now, S-shaped, with deceleration `last` at the end; where that is [pulses]."""
    _begin(s, f)
    _stop_s(s, f, f[c.VSTOP], last, ends)
    return f[c.END_P]


@compiled
def to_position(s: Cells, f: Floats, shape: int, goal: float, from_rest: bool, first: float, corrects: bool) -> float:
    """Plan the way from `P0`, `V0`, `A0` to rest at `goal` [pulses]; returns where it really leads.

    That is `goal`, but for what the data sheet tells of overshooting: a VSTART too high for a short way, and a
    trapezoid that brakes very slowly. `corrects`: it is the correction of such a case, which makes neither mistake.
    """
    if shape == HOLD:
        _begin(s, f)
        f[c.END_A] = 0.0
        way = goal - f[c.P0]
        f[c.END_V] = f[c.VMAX] if way > 0.0 else -f[c.VMAX]
        _go(s, f, abs(way) / f[c.VMAX], 0.0)
        f[c.END_V] = f[c.END_A] = 0.0
        f[c.PLAN_END] = f[c.END_T]
        return goal
    e = 1.0 if goal > f[c.P0] else -1.0
    low, high = 0.0, f[c.VMAX]
    if from_rest:
        low = min(f[c.VSTART], high)
    else:
        d = 1.0 if f[c.V0] > 0.0 else -1.0
        u, a = d * f[c.V0], d * f[c.A0]
        _begin(s, f)
        stop(s, f, shape, f[c.VSTOP], f[c.DMAX] if f[c.VSTOP] > 0.0 else 0.0, f[c.VSTOP] > 0.0)
        ahead = d * (goal - f[c.END_P])
        if abs(ahead) < _NEAR:
            f[c.PLAN_END] = f[c.END_T]
            return goal
        if ahead > 0.0 and shape == S_SHAPE and _leads_through_zero(f, u, a):
            e = d
            if u > f[c.VSTOP] > 0.0 and e * (_direct(s, f, 0.0, True) - goal) > 0.0:
                return _between(s, f, goal, e)
            _begin(s, f)
            change(s, f, shape, 0.0)
            if 0.0 < e * _cut(s, f, goal, e) <= f[c.VSTOP] * (1.0 + 1e-9):
                return goal
            ahead = -1.0
        elif ahead > 0.0:
            natural = u
            if shape == S_SHAPE:
                natural += a * a / (2.0 * f[c.BOW2]) if a > 0.0 else -a * a / (2.0 * f[c.BOW4])
            e, low = d, max(min(natural, high), 0.0)
            # Two slopes with a smooth turn between them are longer than one, so below the velocity to which the
            # acceleration tends the way over a peak has no one root: first look above it, that is faster, too.
            if e * (_attempt(s, f, shape, e * low, False, 0.0, 0.0) - goal) > _NEAR:
                high, low = low, min(f[c.VSTOP], low)
                if e * (_attempt(s, f, shape, e * low, False, 0.0, 0.0) - goal) > 0.0:  # VSTOP ends it, if it can
                    if u > f[c.VSTOP] and (natural >= f[c.VSTOP] or e * (_direct(s, f, 0.0, True) - goal) > 0.0):
                        return _between(s, f, goal, e)
                    _attempt(s, f, shape, e * low, False, 0.0, 0.0)
                    if e * _cut(s, f, goal, e) <= f[c.VSTOP] * (1.0 + 1e-9):
                        return goal
                    ahead, high = -1.0, f[c.VMAX]
        if ahead < 0.0:  # to zero, and from there to wherever the target is
            low = 0.0
            _begin(s, f)
            change(s, f, shape, 0.0)
            if abs(goal - f[c.END_P]) < _NEAR:
                f[c.PLAN_END] = f[c.END_T]
                return goal
            e = 1.0 if goal > f[c.END_P] else -1.0
    wait = 0.0
    reached = _attempt(s, f, shape, e * high, from_rest, first, 0.0)
    if e * (goal - reached) >= 0.0:
        low = high
    elif from_rest and e * (_attempt(s, f, shape, e * low, True, first, 0.0) - goal) > _NEAR:
        f[c.PLAN_END] = f[c.END_T]  # VSTART leads past the target (DS-TMC4361 8.2.2): there, and back later
        return f[c.END_P]
    else:
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            if e * (_attempt(s, f, shape, e * middle, from_rest, first, 0.0) - goal) > 0.0:
                high = middle
            else:
                low = middle
        reached = _attempt(s, f, shape, e * low, from_rest, first, 0.0)
    if low > 0.0:
        # the rest of the way at the peak; after a halving it is a rounding error
        wait = max(e * (goal - reached), 0.0) / low
        if shape == TRAPEZOID and not corrects and f[c.VSTOP] == 0.0 and f[c.DMAX] * c.SLOW_SLOPE_S <= low:
            goal += e  # a target overrun (DS-TMC4361 8.2.2), by a step here, and a ramp back later
            wait += 1.0 / low
        _attempt(s, f, shape, e * low, from_rest, first, wait)
    f[c.PLAN_END] = f[c.END_T]
    return goal


@compiled
def _cut(s: Cells, f: Floats, goal: float, e: float) -> float:
    """End the plan where it passes `goal` in direction `e`; the velocity there, infinite if it does not."""
    for piece in range(s[c.PIECES]):
        at = c.PLAN + c.PIECE_CELLS * piece
        last = piece + 1 == s[c.PIECES]
        end = f[c.END_P] if last else f[at + c.PIECE_CELLS + c.P_P]
        if e * (end - goal) < 0.0:
            continue
        p, v, a, j = f[at + c.P_P], f[at + c.P_V], f[at + c.P_A], f[at + c.P_J]
        low, high = 0.0, (f[c.END_T] if last else f[at + c.PIECE_CELLS + c.P_T]) - f[at + c.P_T]
        for _ in range(_HALVINGS):
            t = 0.5 * (low + high)
            if e * (p + t * (v + t * (a / 2.0 + t * j / 6.0)) - goal) < 0.0:
                low = t
            else:
                high = t
        s[c.PIECES] = piece + 1
        f[c.PLAN_END] = f[c.END_T] = f[at + c.P_T] + high
        f[c.END_P] = p + high * (v + high * (a / 2.0 + high * j / 6.0))
        return v + high * (a + high * j / 2.0)
    return e * math.inf


@compiled
def _between(s: Cells, f: Floats, goal: float, e: float) -> float:
    """Stops that end at VSTOP with less deceleration than they could: a little later than the nearest."""
    low, high = 0.0, f[c.DMAX]
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if e * (_direct(s, f, middle, True) - goal) > 0.0:
            low = middle
        else:
            high = middle
    _direct(s, f, high, True)
    f[c.PLAN_END] = f[c.END_T]
    return goal


@compiled
def to_velocity(s: Cells, f: Floats, shape: int, from_rest: bool, first: float) -> None:
    """Plan the way to VMAX (signed) and go on with it for ever."""
    goal = f[c.VMAX]
    _begin(s, f)
    if shape == HOLD:
        f[c.END_V], f[c.END_A] = goal, 0.0
    elif goal == 0.0:
        last = f[c.DFINAL] if f[c.VSTOP] == 0.0 else f[c.DMAX]
        stop(s, f, shape, f[c.VSTOP], last, shape == S_SHAPE)
    else:
        if from_rest:
            start(s, f, shape, goal, first)
        change(s, f, shape, goal)
    f[c.PLAN_END] = f[c.END_T] if goal == 0.0 else math.inf
    if goal != 0.0:
        _go(s, f, 1.0, 0.0)


@compiled
def to_standstill(s: Cells, f: Floats, shape: int) -> None:
    """Plan the way to standstill by the slopes of RAMPMODE, without VSTOP."""
    _begin(s, f)
    change(s, f, shape, 0.0)
    f[c.PLAN_END] = f[c.END_T]


@compiled
def straight_down(s: Cells, f: Floats, deceleration: float) -> None:
    """Plan a linear slope to standstill; 0 is a hard stop. DSTOP's, VSTOP not considered (DS-TMC4361 9.1), or
    DFREEZE's."""
    _begin(s, f)
    f[c.END_A] = 0.0
    d = 1.0 if f[c.V0] > 0.0 else -1.0
    _line(s, f, d, 0.0, deceleration)
    f[c.END_V] = f[c.END_A] = 0.0
    f[c.PLAN_END] = f[c.END_T]


__all__ = ["HOLD", "S_SHAPE", "TRAPEZOID", "straight_down", "to_position", "to_standstill", "to_velocity"]
