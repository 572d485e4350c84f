"""How an S-ramp is worked out, compiled: rows of constant jerk from any state to a velocity, or onto a target.

Velocity and acceleration only. While acceleration keeps its sign, a^2 / 2 over velocity is a line whose slope is the
jerk: the fastest slope is the highest roof under the lines that the bows allow from its start and to its end, and under
AMAX^2 / 2 or DMAX^2 / 2. Where a slope runs through velocity 0 the braking bows and limit change to the accelerating
ones, and the roof has a wall there. No roof needs a search.

Onto a target. The motor follows the slope to VMAX until it has to brake. Where it ends, if it brakes at a moment of
that slope, moves steadily forward with that moment, so the right moment is found between two ends, whatever the
state at the start was. It is also what the chip does: it brakes when it must. The search halves where
interpolation does not help, and ends at the last bit.
"""

from __future__ import annotations

import math
from typing import Final, cast

import numpy as np
from numpy.typing import NDArray

from ...kernels import Kernels

FloatArray = NDArray[np.float64]

# What `p` holds, in order.
VMAX, AMAX, DMAX, BOW1, BOW2, BOW3, BOW4, VSTART, VSTOP, ASTART, DFINAL, USE_ASTART = range(12)
PARAMETERS: Final = 12

# Columns of a row: which phase, how long, velocity and acceleration at its start, jerk, velocity and acceleration at
# its end, its length, and where it is: at its start, or at its end if it is counted back from the target.
PHASE, TIME, V0, A0, JERK, V1, A1, LENGTH, PLACE = range(9)
COLUMNS: Final = 9
MOST_ROWS: Final = 32
"""Two rows that let go of an acceleration, two slopes of six, one row at VMAX and what is tried for braking."""
PEAKS: Final = MOST_ROWS - 1
"""This row has, in its first columns, the highest velocity, and accelerations when accelerating and when braking."""

PHASES: Final = ("B1", "B12", "B2", "B23", "B3", "B34", "B4")
B1, B12, B2, B23, B3, B34, B4 = (float(phase) for phase in range(7))
# Numba compiles a function anew for each whole number that is passed as such. These are no literals to it, and phases
# are floats: half the time to compile.
FIRST: Final = cast("int", np.int64(0))
AT_START: Final = cast("int", np.int64(-1))

ALIKE: Final = 1e-12
"""Relative: velocities and places that differ by less come of rounding. To correct them would take visible time,
because the time of a slope goes with the root of its height, and that of a way with its cube root."""
NOISE: Final = 1e-15
NEAR: Final = 2e-15
"""Relative: a moment of braking with which the motion ends so near to the target cannot be bettered."""
MOST_HALVINGS: Final = 200

compiled = Kernels(__file__, plain=True).compiled


@compiled
def _add(rows: FloatArray, n: int, s: float, phase: float, t: float, v0: float, a0: float, v1: float, a1: float) -> int:
    """Write a row that lasts; `s` mirrors it."""
    if not t > 0:
        return n
    jerk = 0.0
    if phase not in (B12, B23, B34):
        jerk = (a1 - a0) / t
    rows[n, PHASE], rows[n, TIME], rows[n, JERK] = phase, t, s * jerk
    rows[n, V0], rows[n, A0], rows[n, V1], rows[n, A1] = s * v0, s * a0, s * v1, s * a1
    rows[n, LENGTH] = s * t * (v0 + t * (a0 / 2 + t * jerk / 6))
    return n + 1


@compiled
def _region(
    p: FloatArray,
    rows: FloatArray,
    n: int,
    s: float,
    v0: float,
    v1: float,
    dv: float,
    a0: float,
    a1: float,
) -> int:
    """Up from v0 by dv to v1 on one side of velocity 0, from acceleration a0 to at most a1, both not negative.

    The caller knows that a0 can come down to a1 within the way.
    """
    if v0 < 0:
        up, cap, down, first = p[BOW3], p[DMAX], p[BOW4], B3
    else:
        up, cap, down, first = p[BOW1], p[AMAX], p[BOW2], B1
    if a0 > cap:  # after AMAX or DMAX was lowered
        least = math.sqrt(max(a0 * a0 - 2 * down * dv, 0.0))
        if least >= cap:
            return _add(rows, n, s, first + 2, (a0 - least) / down, v0, a0, v1, least)
        at_cap = v0 + (a0 - cap) * (a0 + cap) / (2 * down)
        n = _add(rows, n, s, first + 2, (a0 - cap) / down, v0, a0, at_cap, cap)
        dv -= at_cap - v0
        v0, a0 = at_cap, cap
    a1 = min(a1, cap, math.sqrt(a0 * a0 + 2 * up * dv))
    peak = math.sqrt((2 * up * down * dv + down * a0 * a0 + up * a1 * a1) / (up + down))
    flat = peak > cap
    peak = max(min(peak, cap), a0, a1)
    if peak - a0 <= NOISE * peak:
        peak = a0
    if peak - a1 <= NOISE * peak:
        a1 = peak
    rise, fall = (peak - a0) * (peak + a0) / (2 * up), (peak - a1) * (peak + a1) / (2 * down)
    n = _add(rows, n, s, first, (peak - a0) / up, v0, a0, v0 + rise, peak)
    if flat and dv - rise - fall > NOISE * (abs(v0) + abs(v1)):
        n = _add(rows, n, s, first + 1, (dv - rise - fall) / peak, v0 + rise, peak, v1 - fall, peak)
    return _add(rows, n, s, first + 2, (peak - a1) / down, v1 - fall, peak, v1, a1)


@compiled
def _slope(p: FloatArray, rows: FloatArray, n: int, s: float, v0: float, a0: float, v1: float) -> int:
    """Up from v0 with a0 >= 0 to v1 with acceleration 0; a0 can come down to 0 within the way."""
    if v0 >= 0 or v1 <= 0:
        return _region(p, rows, n, s, v0, v1, v1 - v0, a0, 0.0)
    # squared accelerations at velocity 0: what can be reached, what is allowed, what cannot be avoided
    if a0 <= p[DMAX]:
        reached = min(p[DMAX] ** 2, a0 * a0 - 2 * p[BOW3] * v0)
    else:
        reached = max(p[DMAX] ** 2, a0 * a0 + 2 * p[BOW4] * v0)
    allowed = min(p[AMAX] ** 2, 2 * p[BOW2] * v1)
    at_zero = math.sqrt(max(min(reached, allowed), a0 * a0 + 2 * p[BOW4] * v0))
    n = _region(p, rows, n, s, v0, 0.0, -v0, a0, at_zero)
    return _region(p, rows, n, s, 0.0, v1, v1, at_zero, 0.0)


@compiled
def coasting(p: FloatArray, v: float, a: float) -> float:
    """The velocity at which the acceleration would be 0, were it let go now."""
    s = 1.0 if a > 0 else -1.0
    v, a = s * v, s * a
    if v < 0:
        v += a * a / (2 * p[BOW4])
        return float(s * (v if v <= 0 else v * p[BOW4] / p[BOW2]))
    return float(s * (v + a * a / (2 * p[BOW2])))


@compiled
def _let_go(p: FloatArray, rows: FloatArray, n: int, v: float, a: float) -> int:
    """Acceleration to 0 at once, which ends at `coasting`."""
    s = 1.0 if a > 0 else -1.0
    end = s * coasting(p, v, a)
    v, a = s * v, s * a
    if v < 0:
        if end <= 0:
            return _add(rows, n, s, B4, a / p[BOW4], v, a, end, 0.0)
        at_zero = math.sqrt(2 * p[BOW2] * end)
        n = _add(rows, n, s, B4, (a - at_zero) / p[BOW4], v, a, 0.0, at_zero)
        v, a = 0.0, at_zero
    return _add(rows, n, s, B2, a / p[BOW2], v, a, end, 0.0)


@compiled
def follow(p: FloatArray, rows: FloatArray, n: int, v: float, a: float, target: float) -> int:
    """Rows from state (v, a) to velocity `target` with acceleration 0, written from row `n` on; the row after them."""
    end = coasting(p, v, a)
    if abs(target - end) <= ALIKE * (abs(v) + abs(end) + abs(target)):
        return _let_go(p, rows, n, v, a)
    s = 1.0 if target > end else -1.0
    if s * a < 0:
        n = _let_go(p, rows, n, v, a)
        v, a = end, 0.0
    return _slope(p, rows, n, s, s * v, s * a, s * target)


@compiled
def stop(p: FloatArray, rows: FloatArray, n: int, v: float, a: float, vstop: float, dfinal: float) -> int:
    """Rows from state (v, a) to rest, or to the moment at which `vstop` may end the motion.

    What lets go of its acceleration below `vstop` ends there, with acceleration 0.
    """
    s = 1.0 if v > 0 or (v == 0 and a > 0) else -1.0
    v, a = s * v, s * a
    last = math.inf if vstop > 0 else dfinal
    if a >= 0:
        n = _let_go(p, rows, n, s * v, s * a)
        above = v - vstop + a * a / (2 * p[BOW2])  # so it keeps its digits where both are near VSTOP
        if above <= 0:
            return n
        return _region(p, rows, n, -s, -coasting(p, v, a), -vstop, above, 0.0, last)
    if v <= vstop:
        return n
    if vstop > 0 or a * a <= dfinal * dfinal + 2 * p[BOW4] * v * (1 + ALIKE):
        return _region(p, rows, n, -s, -v, -vstop, v - vstop, -a, last)
    # too hard to be let go before velocity 0: through it and back
    beyond = coasting(p, v, a)
    n = _let_go(p, rows, n, s * v, s * a)
    return _region(p, rows, n, s, beyond, 0.0, -beyond, 0.0, dfinal)


@compiled
def _brake(p: FloatArray, rows: FloatArray, n: int, v: float, a: float) -> int:
    """`stop` of a move forward: what still runs backward does not end with VSTOP, but turns."""
    if v > 0 or (v == 0 and a > 0):
        return stop(p, rows, n, v, a, p[VSTOP], 0.0)
    end = coasting(p, v, a)
    if end > 0 and a * a > -2 * p[BOW4] * v * (1 + ALIKE):
        n = _let_go(p, rows, n, v, a)
        return stop(p, rows, n, end, 0.0, p[VSTOP], 0.0)
    return stop(p, rows, n, v, a, 0.0, 0.0)


@compiled
def _length(rows: FloatArray, begin: int, end: int) -> float:
    total = 0.0
    for row in range(begin, end):
        total += rows[row, LENGTH]
    return total


@compiled
def _stopping(p: FloatArray, rows: FloatArray, n: int, v: float, a: float) -> float:
    """Way from state (v, a) until `_brake` ends; uses the rows from `n` on."""
    return _length(rows, n, _brake(p, rows, n, v, a))


@compiled
def _within(rows: FloatArray, row: int, t: float) -> tuple[float, float, float]:
    """Way, velocity and acceleration at `t` after the start of a row, or where `t` is below 0 before its end."""
    j = rows[row, JERK]
    if t < 0:
        v, a, way = rows[row, V1], rows[row, A1], rows[row, LENGTH]
    else:
        v, a, way = rows[row, V0], rows[row, A0], 0.0
    return way + t * (v + t * (a / 2 + t * j / 6)), v + t * (a + t * j / 2), a + t * j


@compiled
def _ends_at(p: FloatArray, rows: FloatArray, n: int, row: int, t: float, v_start: float) -> float:
    """Where the motion ends if it brakes at `t` of `row`, from the row's start; of row -1: if it starts with a = t."""
    if row < 0:
        return _stopping(p, rows, n, v_start, t)
    way, v, a = _within(rows, row, t)
    return way + _stopping(p, rows, n, v, a)


@compiled
def _guess(p: FloatArray, rows: FloatArray, row: int, wanted: float, reach: float) -> float:
    """The moment of `row` at which braking begins, in closed form where there is one; else any number.

    Exact without VSTOP, where AMAX and DMAX both hold for a while, or, from rest, neither does. `reach` is where the
    motion ends if it brakes at the end of the row.
    """
    v0, a = rows[row, V0], rows[row, A0]
    if a == 0:
        return float(rows[row, TIME] * (wanted / reach) ** (1 / 3))  # all times grow alike
    # a quadratic equation for the highest velocity, which is `gain` above that at the moment
    t2, t3, t4, dmax = a / p[BOW2], p[DMAX] / p[BOW3], p[DMAX] / p[BOW4], p[DMAX]
    gain = a * t2 / 2
    square, linear = (1 / a + 1 / dmax) / 2, (t2 + t3) / 2
    short = wanted + ((v0 - gain) * (v0 + gain) / a + dmax * (t3 - t4) * (t3 + t4) / 12) / 2 + a * t2 * t2 / 6
    top = 2 * short / (linear + math.sqrt(linear * linear + 4 * square * max(short, 0.0)))
    return float((top - gain - v0) / a)


@compiled
def _moment(p: FloatArray, rows: FloatArray, n: int, row: int, limit: float, v_start: float, wanted: float) -> float:
    """The t of 0..limit at which `_ends_at` passes `wanted`, which is between its ends (Chandrupatla's method).

    Of a row it is counted from the nearer end, from the later one below 0: a bow a million times steeper than
    another puts all that matters into the last of its digits.
    """
    low, high = 0.0, limit
    f_low = _ends_at(p, rows, n, row, low, v_start) - wanted
    if f_low >= 0:
        return low
    if row < 0:
        f_high = _ends_at(p, rows, n, row, high, v_start) - wanted
        if f_high <= 0:
            return high
    else:
        high = limit / 2
        f_high = _ends_at(p, rows, n, row, high, v_start) - wanted
        if f_high < 0:
            low, f_low = -high, f_high
            high = -5e-324  # the end of the row: not 0, which is its start
            f_high = _ends_at(p, rows, n, row, high, v_start) - wanted
            if f_high <= 0:
                return high
    # x1 is the newest estimate, x2 the other side of the bracket, x3 the one before
    x1, f1, x2, f2 = high, f_high, low, f_low
    t = 0.5
    for _ in range(MOST_HALVINGS):
        x = x1 + t * (x2 - x1)
        f = _ends_at(p, rows, n, row, x, v_start) - wanted
        if (f > 0) == (f1 > 0):
            x3, f3 = x1, f1
        else:
            x3, f3, x2, f2 = x2, f2, x1, f1
        x1, f1 = x, f
        if f == 0:
            return x
        width = abs(x2 - x1)
        least = 2.3e-16 * max(abs(x1), abs(x2))
        if width <= 2 * least:
            break
        xi, phi = (x1 - x2) / (x3 - x2), (f1 - f2) / (f3 - f2)
        t = 0.5
        if phi * phi < xi and (1 - phi) * (1 - phi) < 1 - xi:
            t = f1 / (f2 - f1) * f3 / (f2 - f3) + (x3 - x1) / (x2 - x1) * f1 / (f3 - f1) * f2 / (f3 - f2)
        edge = least / width
        t = min(max(t, edge), 1 - edge)
    return x1 if abs(f1) < abs(f2) else x2


@compiled
def _cut(rows: FloatArray, n: int, wanted: float) -> int:
    """End the rows where they first pass `wanted` going forward. The number of rows then, or -1."""
    x = 0.0
    for row in range(n):
        length = rows[row, LENGTH]
        if length > 0 and x <= wanted <= x + length:
            low, high = 0.0, rows[row, TIME]
            for _ in range(MOST_HALVINGS):
                middle = (low + high) / 2
                if not low < middle < high:
                    break
                if x + _within(rows, row, middle)[0] < wanted:
                    low = middle
                else:
                    high = middle
            way, v, a = _within(rows, row, high)
            rows[row, TIME], rows[row, V1], rows[row, A1], rows[row, LENGTH] = high, v, a, way
            return row + 1 if high > 0 else row
        x += length
    return -1


@compiled
def _slow_enough(p: FloatArray, rows: FloatArray, n: int) -> bool:
    return bool(n > 0 and 0 <= rows[n - 1, V1] <= p[VSTOP] * (1 + ALIKE))


@compiled
def starting_acceleration(p: FloatArray, v_start: float, target: float) -> float:
    """With which a motor starts from rest to a velocity `target` above 0: altered to fit it (DS-TMC4361 8.2.2)."""
    a = p[AMAX] if p[VSTART] > 0 and not p[USE_ASTART] else min(p[ASTART], p[AMAX])
    return float(min(a, math.sqrt(2 * p[BOW2] * max(target - v_start, 0.0))))


@compiled
def _joined(rows: FloatArray, n: int, first_anchored: int) -> tuple[int, int]:
    """One row of two that are one phase with one jerk: braking may begin within the bow with which it would begin."""
    out = 0
    anchored = n
    for row in range(n):
        same = (
            out > 0
            and rows[row, PHASE] == rows[out - 1, PHASE]
            and abs(rows[row, JERK] - rows[out - 1, JERK]) <= 1e-6 * abs(rows[row, JERK])
            and abs(rows[row, A0] - rows[out - 1, A1]) <= 1e-6 * abs(rows[row, A0])
        )
        if same:
            for column in (TIME, LENGTH):
                rows[out - 1, column] += rows[row, column]
            for column in (V1, A1):
                rows[out - 1, column] = rows[row, column]
        else:
            if out < row:
                for column in range(COLUMNS):
                    rows[out, column] = rows[row, column]
            out += 1
        if row >= first_anchored:
            anchored = min(anchored, out - 1)
    return out, anchored


@compiled
def position(p: FloatArray, rows: FloatArray, distance: float, v: float, a: float) -> tuple[int, int]:
    """Rows of a move by `distance` from state (v, a), and from which row on they are counted back from the target."""
    n, first_anchored = _moved(p, rows, distance, v, a)
    for row in range(n - 1, first_anchored - 1, -1):
        rows[row, PLACE] = distance
        distance -= rows[row, LENGTH]
    return n, first_anchored


@compiled
def _moved(p: FloatArray, rows: FloatArray, distance: float, v: float, a: float) -> tuple[int, int]:
    from_rest = v == 0 and a == 0
    if distance == 0 and (from_rest or (p[VSTOP] > 0 and abs(v) <= p[VSTOP])):
        return _finished(rows, FIRST, FIRST, 1.0)
    s = 1.0
    v_start = 0.0
    if from_rest:
        s = 1.0 if distance > 0 else -1.0
        v_start = min(p[VSTART], p[VMAX])
        v, a = v_start, starting_acceleration(p, v_start, p[VMAX])
    elif v < 0 or (v == 0 and a < 0):
        s = -1.0
        v, a = -v, -a
    wanted = s * distance

    # first the way in which the motor runs; s = -s where it then has to come back
    n = _brake(p, rows, FIRST, v, a)
    ending = _length(rows, FIRST, n)
    if from_rest and ending > wanted:  # a start too steep for so short a move
        if p[VSTOP] > 0:
            n = _cut_if_slow(p, rows, follow(p, rows, FIRST, v, a, p[VMAX]), wanted)
            if n > 0:
                return _mirrored(rows, n, n - 1, s)
        a = _moment(p, rows, FIRST, AT_START, a, v_start, wanted)
        n = _brake(p, rows, FIRST, v, a)
        ending = _length(rows, FIRST, n)
    size = abs(wanted)
    for row in range(n):
        size += abs(rows[row, LENGTH])
    if abs(ending - wanted) <= ALIKE * size:
        return _mirrored(rows, n, FIRST, s)
    if p[VSTOP] > 0:
        n = _cut_if_slow(p, rows, follow(p, rows, FIRST, v, a, p[VMAX]), wanted)
        if n > 0:
            return _mirrored(rows, n, n - 1, s)
        if ending > wanted:
            n = _cut_if_slow(p, rows, _brake(p, rows, FIRST, v, a), wanted)
            if n > 0:
                return _mirrored(rows, n, n - 1, s)
    if ending > wanted:
        s, wanted, v, a = -s, -wanted, -v, -a
        if p[VSTOP] > 0:
            n = _cut_if_slow(p, rows, follow(p, rows, FIRST, v, a, p[VMAX]), wanted)
            if n > 0:
                return _mirrored(rows, n, n - 1, s)
            n = _brake(p, rows, FIRST, v, a)
            if _length(rows, FIRST, n) > wanted:  # below VSTOP, but braking so hard that it is fast the other way
                n = _cut_if_slow(p, rows, n, wanted)
                if n > 0:
                    return _mirrored(rows, n, n - 1, s)
                s, wanted, v, a = -s, -wanted, -v, -a

    n = follow(p, rows, FIRST, v, a, p[VMAX])
    x = _length(rows, FIRST, n)
    if n > 0:
        v = rows[n - 1, V1]
    end = _brake(p, rows, n + 1, v, 0.0)  # behind a row that is kept free for B23
    reach = x + _length(rows, n + 1, end)
    if reach < wanted:
        _add(rows, n, 1.0, B23, (wanted - reach) / v, v, 0.0, v, 0.0)
        return _mirrored(rows, end, n + 1, s)
    # braking begins within the slope: in the first row whose end is too late
    last = n - 1
    x = 0.0
    for row in range(n):
        if row < last:
            reach = _stopping(p, rows, n, rows[row, V1], rows[row, A1]) + x + rows[row, LENGTH]
            if reach < wanted:
                x += rows[row, LENGTH]
                continue
        t, limit = _guess(p, rows, row, wanted - x, reach - x), rows[row, TIME]
        known = 0 < t < limit
        if known:
            t = t if 2 * t < limit else t - limit
            way, v, a = _within(rows, row, t)
            end = _brake(p, rows, row + 1, v, a)  # over the rest of the slope, which is not needed again
            known = abs(x + way + _length(rows, row + 1, end) - wanted) <= NEAR * wanted
        if not known:
            t = _moment(p, rows, row + 1, row, limit, 0.0, wanted - x)
            way, v, a = _within(rows, row, t)
        if t < 0:
            t += limit
        rows[row, TIME], rows[row, V1], rows[row, A1], rows[row, LENGTH] = t, v, a, way
        if known:
            return _mirrored(rows, end, row + 1, s)
        n = row + 1 if t > 0 else row
        break
    return _mirrored(rows, _brake(p, rows, n, v, a), n, s)


@compiled
def _cut_if_slow(p: FloatArray, rows: FloatArray, n: int, wanted: float) -> int:
    """The number of rows, where they pass the target slowly enough for VSTOP to end them there; else 0."""
    n = _cut(rows, n, wanted)
    return n if _slow_enough(p, rows, n) else 0


@compiled
def _mirrored(rows: FloatArray, n: int, first_anchored: int, s: float) -> tuple[int, int]:
    return _finished(rows, n, min(first_anchored, n - 1), s)


@compiled
def _finished(rows: FloatArray, n: int, first_anchored: int, s: float) -> tuple[int, int]:
    """Joined, mirrored with `s`, put in place, and with their peaks."""
    n, first_anchored = _joined(rows, n, first_anchored)
    if s < 0:
        for row in range(n):
            for column in (V0, A0, JERK, V1, A1, LENGTH):
                rows[row, column] = -rows[row, column]
    fastest = accelerating = braking = x = 0.0  # velocity turns only where acceleration is 0, and rows end there
    for row in range(n):
        fastest = max(fastest, abs(rows[row, V0]), abs(rows[row, V1]))
        steepest = max(abs(rows[row, A0]), abs(rows[row, A1]))
        if rows[row, PHASE] < B23:
            accelerating = max(accelerating, steepest)
        else:
            braking = max(braking, steepest)
        if row < first_anchored:
            rows[row, PLACE] = x
            x += rows[row, LENGTH]
    rows[PEAKS, 0], rows[PEAKS, 1], rows[PEAKS, 2] = fastest, accelerating, braking
    return n, first_anchored


@compiled
def velocity(p: FloatArray, rows: FloatArray, target: float, v: float, a: float) -> int:
    """Rows of a change to velocity `target` from state (v, a); VSTOP may leave the last velocity to a jump to 0."""
    if target == 0:
        if (abs(v) <= p[VSTOP] and p[VSTOP] > 0) or (v == 0 and abs(a) <= p[DFINAL]):
            return _finished(rows, FIRST, FIRST, 1.0)[0]
        n = stop(p, rows, FIRST, v, a, p[VSTOP], p[DFINAL])
        return _finished(rows, n, n, 1.0)[0]
    if v == 0 and a == 0:
        s = 1.0 if target > 0 else -1.0
        v = s * min(p[VSTART], abs(target))
        a = s * starting_acceleration(p, abs(v), abs(target))
    n = follow(p, rows, FIRST, v, a, target)
    return _finished(rows, n, n, 1.0)[0]


@compiled
def many(
    parameters: FloatArray,
    distances: FloatArray,
    velocities: FloatArray,
    accelerations: FloatArray,
    rows: FloatArray,
    durations: FloatArray,
    peaks: FloatArray,
    phases: FloatArray,
) -> None:
    """`position` for each row of `parameters`: durations, highest velocities, and time in each of the seven phases."""
    for i in range(len(distances)):
        n, _ = position(parameters[i], rows, distances[i], velocities[i], accelerations[i])
        durations[i] = 0.0
        peaks[i] = rows[PEAKS, 0]
        for phase in range(7):
            phases[i, phase] = 0.0
        for row in range(n):
            durations[i] += rows[row, TIME]
            phases[i, int(rows[row, PHASE])] += rows[row, TIME]
