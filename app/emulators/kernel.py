"""The chip's clockwork: one compiled function that brings all axes to an absolute clock count.

Everything is an int64 in two arrays, `axes[axis, column]` and `chip[cell]`; the Python code around it
writes registers into them and calls `refresh`. Layout and code share this file because numba's disk
cache only notices changes of the file that a function stands in.

The law (a reading: the data sheets give every constant but not how RAMP_MODE picks its velocity):
base ticks come every 32 clocks; a ramp tick every 2^ramp_div of them, a pulse tick every 2^pulse_div,
both counted from power-on. Velocity has 8 hidden fraction bits. A ramp tick moves it toward v_target by
a_max/256. A pulse tick adds the integer part of |v| to an 11-bit accumulator, whose overflow is one
step. With d = min(|x_target - x_actual|, 2^19 - 1) and p = (128 + pmul) / 2^(3 + pdiv), RAMP_MODE wants
min(v_max, floor(sqrt(2048 p d))) and SOFT_MODE min(v_max, floor(p d)), neither below v_min. At d = 0
the motor stops if |v| <= v_min, else it brakes and comes back. Where both ticks coincide the ramp goes
first, and within a tick axis 1 goes before 2 before 3.

How it jumps. Axes meet only at the driver chain (a step asks for a datagram, a datagram samples
multiplexed switches) and at switch inputs. So each axis runs ahead alone until its next step that
matters. While a datagram is under way and the next one already asked for, steps matter only at guarded
positions (target, zero, tolerance, compare value, switch edges); everything between is a product.
An axis whose ramp has settled needs no ramp ticks at all. `docs/decisions` tells what was measured.
"""

# numpy's stubs type a cell as Any; inside compiled code it is an int64 and nothing else.
# mypy: disable-error-code="no-any-return"

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

Cells = NDArray[np.int64]

NEVER = 1 << 62
"""A tick that never comes."""
FAR = (1 << 19) - 1
"""Longest distance that the ramp generator sees (001, 8.7.1)."""

# --- columns of `axes` ---------------------------------------------------------------------------
X, XT, VMIN, VMAX, VT, V8, AMAX, ACC = range(8)
"""Positions (signed 24 bits), limits, target velocity, velocity in 1/256, pulse accumulator."""
PMUL, PSH, MODE, RD, PD, DX = range(8, 14)
"""128 + pmul, 3 + pdiv, ramp mode, ramp_div, pulse_div, dx_ref_tolerance."""
DISL, DISR, SOFT, REFR, MASK, FLAGS, LP, XL = range(14, 22)
"""Stop disables, soft stop, REF_RnL, interrupt mask and flags, latch pending, x_latched."""
ATH, ISAG, ISAL, ISV0 = range(22, 26)
"""a_threshold and the three current scales."""
SEQ, INC, MECH, MINC, STEPS, DIR, SENT = range(26, 33)
"""Sequencer index, its width a step, stage position, its width a step, steps, direction, steps already sent."""
A0, A1, A2, A3 = range(33, 37)
"""Velocity change of the last four ramp ticks."""
SL, SR, PHYS, FORCE_L, FORCE_R, FORCE_REF, HELD = range(37, 44)
"""Switches as the chip sees them, as they are (1 left, 2 right, 4 reference), forced (-1 auto), not yet sampled."""
LEFT_AT, RIGHT_AT, REF_FROM, REF_TO = range(44, 48)
"""Switch edges on the stage, in stage units."""
COND, LSTOP, RSTOP, STOPPING = range(48, 52)
"""Conditions seen last (for their edges), stops in force, a switch is stopping the motor."""
GUARD, GDIR, STEADY, LAST, NEXT, DFAR, TFAR, CLASS, STOPT = range(52, 61)
"""Steps to the next guarded position and in which direction; settled; ticks done; next event; target speed afar;
current class; tick of the last stop."""
AXIS_COLUMNS = 61

# --- cells of `chip` -----------------------------------------------------------------------------
TICK, CLOCK, NAXES, KIND = range(4)
"""Ticks and clocks done, axes, 0 TMC428 or 1 TMC4210."""
REFMUX, MOT1R, WIRING, IDLE, CU, INVREF, GPIN, CROSS = range(4, 12)
"""Input sharing; the board's wiring; nSCS_S level at rest; continuous update; one motor's pin is another's switch."""
DURATION, BUSY, BUSY_UNTIL, PENDING, REQ, CW, CAPTURE, CU_NEXT, SENT_COUNT = range(12, 21)
"""Driver chain: clocks a datagram takes, under way, until when, asked again, asked now, cover waits (1) or goes (2),
capture armed (1), under way (2), done (3); next continuous update; datagrams so far."""
EN_SD, HALF, PULSE_LEN, PULSE_END, SOUT, MERGED = range(21, 27)
"""Step/dir output: on, edge a step, pulse clocks, its end, pulses sent, pulses that merged with the one before."""
COMP, COMP_ON, COMP_MASK, COMP_FLAG = range(27, 31)
"""Position compare."""
SNAP = 32
"""Snapshot of the last datagram's signals: for each motor sequencer index, width, scale, step, direction."""
SNAP_WIDTH = 5
COVERED = SNAP + 3 * SNAP_WIDTH
"""Whether the last datagram was covered."""
CAPTURED = COVERED + 1
"""Snapshot of the captured datagram, laid out like SNAP, its COVERED after it."""
CHIP_CELLS = CAPTURED + 3 * SNAP_WIDTH + 1

TMC428_KIND, TMC4210_KIND = 0, 1
LEFT_ONLY, TWO_ONE_NULL, MULTIPLEXED = range(3)

_XEQ, _WRONG, _MISS, _COMP = 1, 2, 4, 8


def compiled(function: Any) -> Any:
    """Numba's njit as this file uses it: cached on disk, off the GIL."""
    return njit(cache=True, nogil=True)(function)


@compiled
def wrap24(x: int) -> int:
    """To a signed 24-bit number."""
    return ((x + 0x800000) & 0xFFFFFF) - 0x800000


@compiled
def isqrt(y: int) -> int:
    """floor(sqrt(y)) for 0 <= y < 2^24, in integers."""
    root = 0
    bit = 1 << 22
    while bit > y:
        bit >>= 2
    while bit:
        if y >= root + bit:
            y -= root + bit
            root = (root >> 1) + bit
        else:
            root >>= 1
        bit >>= 2
    return root


@compiled
def speed_for_distance(a: Cells, d: int) -> int:
    """The ramp generator's wanted speed `d` steps from the target; see the law above."""
    d = min(d, FAR)
    if a[MODE] == 0:
        y = (2048 * a[PMUL] * d) >> a[PSH]
        speed = a[VMAX] if y >= a[VMAX] * a[VMAX] else isqrt(y)
    else:
        speed = (a[PMUL] * d) >> a[PSH]
    return min(max(speed, a[VMIN]), a[VMAX])


@compiled
def _ramp(a: Cells, x: int, v8: int, target: int) -> Any:
    """One ramp tick: (v_target register, velocity after it in 1/256)."""
    mode = a[MODE]
    if mode < 2:
        dx = wrap24(a[XT] - x)
        d = abs(dx)
        if d == 0:
            target = 0
            if abs(v8) >> 8 <= a[VMIN]:
                return target, 0
        else:
            speed = a[TFAR] if d >= a[DFAR] else speed_for_distance(a, d)
            target = speed if dx > 0 else -speed
        goal = target * 256
    elif mode == 2:
        goal = min(max(target, -a[VMAX]), a[VMAX]) * 256
    else:
        goal = v8
    if (goal < 0 and a[LSTOP]) or (goal > 0 and a[RSTOP]):
        goal = 0
    if v8 < goal:
        return target, min(v8 + a[AMAX], goal)
    return target, max(v8 - a[AMAX], goal)


@compiled
def _class_of(a: Cells, v8: int, change: int) -> int:
    """Row of Table 8-2: 0 at rest, 1 is_aleat, 2 is_agtat. A threshold above 1023 never selects is_agtat."""
    if v8 == 0:
        return 0
    return 2 if a[ATH] <= 1023 and abs(change) > a[ATH] else 1


@compiled
def _ahead(here: int, there: int, direction: int) -> int:
    """Steps from `here` until a landing on or leaving of `there` that may change a condition."""
    return max((direction * (there - here)) & 0xFFFFFF, 1)


@compiled
def _edge(here: int, there: int, stride: int) -> int:
    """Steps of `stride` until `here` lands on `there` or beyond; NEVER behind us."""
    if stride > 0:
        return (there - here + stride - 1) // stride if there > here else NEVER
    return (here - there - stride - 1) // -stride if there < here else NEVER


@compiled
def _guard(a: Cells, chip: Cells, direction: int) -> int:
    """Steps in `direction` to the next position that may mean something."""
    x = a[X]
    guard = min(_ahead(x, a[XT], direction), _ahead(x, 0, direction))
    tolerance = a[DX]
    if direction > 0:
        guard = min(guard, _ahead(x, -tolerance, 1), _ahead(x, tolerance + 1, 1))
    else:
        guard = min(guard, _ahead(x, tolerance, -1), _ahead(x, -tolerance - 1, -1))
    if chip[COMP_ON]:
        guard = min(guard, _ahead(x, chip[COMP], direction))
    stride = direction * a[MINC]
    here = a[MECH]
    if stride > 0:
        guard = min(guard, _edge(here, a[LEFT_AT] + 1, stride), _edge(here, a[RIGHT_AT], stride))
        guard = min(guard, _edge(here, a[REF_FROM], stride), _edge(here, a[REF_TO] + 1, stride))
    elif stride < 0:
        guard = min(guard, _edge(here, a[LEFT_AT], stride), _edge(here, a[RIGHT_AT] - 1, stride))
        guard = min(guard, _edge(here, a[REF_FROM] - 1, stride), _edge(here, a[REF_TO], stride))
    return guard


@compiled
def _physical(a: Cells) -> int:
    """The three switches of a stage: 1 left, 2 right, 4 reference."""
    here = a[MECH]
    left = a[FORCE_L] if a[FORCE_L] >= 0 else int(here <= a[LEFT_AT])
    right = a[FORCE_R] if a[FORCE_R] >= 0 else int(here >= a[RIGHT_AT])
    reference = a[FORCE_REF] if a[FORCE_REF] >= 0 else int(a[REF_FROM] <= here <= a[REF_TO])
    return left | right << 1 | reference << 2


@compiled
def _pin(axes: Cells, chip: Cells, pin: int, select: int) -> int:
    """Level of REF1..REF3 as the board is wired; `select` is nSCS_S, which drives the 74HC157."""
    if chip[WIRING] == TWO_ONE_NULL and pin == 2:
        return (axes[0, PHYS] >> 1) & 1
    if chip[WIRING] == MULTIPLEXED and not select:
        return (axes[pin, PHYS] >> 1) & 1
    return (axes[pin, PHYS] | axes[pin, PHYS] >> 2) & 1


@compiled
def _seen(axes: Cells, chip: Cells, i: int) -> Any:
    """What the chip takes its pins for (001, Table 9-3; 000, 1.5.4): (left, right) of motor `i`."""
    if chip[KIND] == TMC4210_KIND:
        left = (axes[0, PHYS] | axes[0, PHYS] >> 2) & 1
        right = (axes[0, PHYS] >> 1) & 1
        return left ^ chip[INVREF], (right ^ chip[INVREF]) * chip[MOT1R]
    if chip[REFMUX]:
        return _pin(axes, chip, i, chip[IDLE]), _pin(axes, chip, i, 1 - chip[IDLE])
    idle = chip[IDLE]
    if chip[MOT1R]:
        if i == 0:
            return _pin(axes, chip, 0, idle), _pin(axes, chip, 2, idle)
        return _pin(axes, chip, 1, idle) * (i == 1), 0
    return _pin(axes, chip, i, idle), 0


@compiled
def _stop(a: Cells, tick: int) -> None:
    """The motor stands still at once."""
    if a[V8] != 0:
        a[V8] = 0
        a[STOPT] = tick
        a[CLASS] = 0
    a[STEADY] = 0


@compiled
def _evaluate(axes: Cells, chip: Cells, i: int, tick: int) -> None:
    """Conditions of axis `i` at its present position and switches: flags, stops, next guarded position."""
    a = axes[i]
    x = a[X]
    reference = a[SR] if a[REFR] else a[SL]
    outside = abs(x) > a[DX]
    now = 0
    if x == a[XT]:
        now |= _XEQ
    if reference and outside:
        now |= _WRONG
    if x == 0 and not reference:
        now |= _MISS
    if chip[COMP_ON] and i == 0 and x == chip[COMP]:
        now |= _COMP
    risen = now & ~a[COND]
    a[COND] = now
    a[FLAGS] |= risen & 7 & a[MASK]
    if risen & _COMP and chip[COMP_MASK]:
        chip[COMP_FLAG] = 1
    # With no tolerance programmed there is no range to exclude, not even position zero itself.
    armed = 0 if a[DX] > 0 and not outside else 1
    a[LSTOP] = a[SL] & (1 - a[DISL]) & armed
    a[RSTOP] = a[SR] & (1 - a[DISR]) & armed
    v8 = a[V8]
    if (v8 < 0 and a[LSTOP]) or (v8 > 0 and a[RSTOP]):
        if not a[STOPPING]:
            a[FLAGS] |= 8 & a[MASK]
        a[STOPPING] = 1
        a[STEADY] = 0
        if not a[SOFT]:
            _stop(a, tick)
            a[STOPPING] = 0
    else:
        a[STOPPING] = 0
    if a[MODE] < 2 and now & _XEQ and abs(a[V8]) >> 8 <= a[VMIN]:
        _stop(a, tick)
    direction = a[GDIR]
    if a[V8] != 0:
        direction = 1 if a[V8] > 0 else -1
    a[GDIR] = direction
    a[GUARD] = _guard(a, chip, direction)


@compiled
def _see(axes: Cells, chip: Cells, i: int, tick: int, done: int) -> None:
    """Take the pins over into the switch bits of axis `i`: edges set flags and may latch the position.

    It happens in `tick`; the axis itself is to be brought to the end of tick `done` first.
    """
    a = axes[i]
    left, right = _seen(axes, chip, i)
    a[HELD] = 0
    if left == a[SL] and right == a[SR]:
        return
    _sync(a, chip, done)
    if left != a[SL]:
        a[FLAGS] |= (64 if left else 16) & a[MASK]
    if right != a[SR]:
        a[FLAGS] |= (128 if right else 32) & a[MASK]
    changed = right != a[SR] if a[REFR] else left != a[SL]
    a[SL] = left
    a[SR] = right
    if changed and a[LP] and abs(a[V8]) >> 8:
        a[XL] = a[X]
        a[LP] = 0
    a[STEADY] = 0  # a released switch lets the ramp tick try again
    _evaluate(axes, chip, i, tick)


@compiled
def _switches_moved(axes: Cells, chip: Cells, tick: int, i: int) -> None:
    """Some physical switch changed: direct inputs follow now, multiplexed ones with the next datagram.

    Axes after `i` have not had their turn in `tick` yet.
    """
    for j in range(chip[NAXES]):
        if chip[KIND] == TMC4210_KIND or not chip[REFMUX]:
            _see(axes, chip, j, tick, tick if j <= i else tick - 1)
        else:
            left, right = _seen(axes, chip, j)
            axes[j, HELD] = left != axes[j, SL] or right != axes[j, SR]


@compiled
def _quiet_steps(a: Cells, chip: Cells, steps: int) -> None:
    """Steps between guarded positions: they move, and that is all."""
    direction = 1 if a[V8] > 0 else -1
    a[X] = wrap24(a[X] + direction * steps)
    a[SEQ] = (a[SEQ] + direction * steps * a[INC]) & 0xFF
    a[MECH] += direction * steps * a[MINC]
    a[STEPS] += steps
    a[DIR] = direction
    a[GUARD] -= steps
    if chip[EN_SD]:
        chip[SOUT] += steps


@compiled
def _settled_ramp_ticks(a: Cells, count: int) -> None:
    """Ramp ticks that changed nothing still shift the smoothing of a_actual."""
    for _ in range(min(count, 4)):
        a[A3] = a[A2]
        a[A2] = a[A1]
        a[A1] = a[A0]
        a[A0] = 0


@compiled
def _sync(a: Cells, chip: Cells, tick: int) -> None:
    """Bring an axis that has nothing but quiet steps before it to the end of `tick`."""
    if a[LAST] >= tick:
        return
    v = abs(a[V8]) >> 8
    if v:
        total = a[ACC] + ((tick >> a[PD]) - (a[LAST] >> a[PD])) * v
        a[ACC] = total & 2047
        if total >> 11:
            _quiet_steps(a, chip, total >> 11)
            if chip[EN_SD]:
                step_tick = ((tick >> a[PD]) - a[ACC] // v) << a[PD]
                chip[PULSE_END] = 32 * step_tick + chip[PULSE_LEN]
    if a[STEADY]:
        _settled_ramp_ticks(a, (tick >> a[RD]) - (a[LAST] >> a[RD]))
    a[LAST] = tick


@compiled
def _ramp_commit(a: Cells, target: int, v8: int, tick: int) -> None:
    change = v8 - a[V8]
    if abs(change) > a[AMAX]:
        change = 0  # the abrupt stop at the target is not an acceleration
    a[A3] = a[A2]
    a[A2] = a[A1]
    a[A1] = a[A0]
    a[A0] = change
    if v8 == 0 and a[V8] != 0:
        a[STOPT] = tick
    settled = v8 == a[V8] and target == a[VT]
    if settled and a[MODE] < 2 and v8 != 0:
        dx = wrap24(a[XT] - a[X])
        settled = abs(dx) >= a[DFAR] and v8 == target * 256 and (dx > 0) == (v8 > 0)
    a[VT] = target
    a[V8] = v8
    a[CLASS] = _class_of(a, v8, change)
    a[STEADY] = settled


@compiled
def _bulk(a: Cells, chip: Cells) -> bool:
    """May steps between guarded positions be taken together?"""
    if chip[KIND] == TMC428_KIND:
        return chip[BUSY] != 0 and chip[PENDING] != 0
    if chip[HALF] or not chip[EN_SD]:
        return True
    next_pulse = 32 * (((a[LAST] >> a[PD]) + 1) << a[PD])
    return 32 << a[PD] >= chip[PULSE_LEN] and chip[PULSE_END] <= next_pulse


@compiled
def _plan(axes: Cells, chip: Cells, i: int, end: int) -> None:
    """Run axis `i` ahead as far as nobody else can notice; NEXT is then the tick of its next event."""
    a = axes[i]
    rd = a[RD]
    pd = a[PD]
    locked = chip[CROSS] != 0 or a[HELD] != 0
    bulk = _bulk(a, chip) and not locked
    limit = end
    if bulk and chip[KIND] == TMC428_KIND:
        limit = min(end, (chip[BUSY_UNTIL] + 31) // 32 - 1)
    while True:
        v8 = a[V8]
        v = abs(v8) >> 8
        last = a[LAST]
        if v8 != 0 and a[GDIR] != (1 if v8 > 0 else -1):
            a[GDIR] = -a[GDIR]
            a[GUARD] = _guard(a, chip, a[GDIR])
        steps = a[GUARD] if bulk else 1
        if a[STEADY]:
            a[NEXT] = NEVER
            if v == 0:
                return
            quiet = steps
            if a[MODE] < 2:  # one step inside DFAR the wanted speed begins to fall
                quiet = min(quiet, abs(wrap24(a[XT] - a[X])) - a[DFAR] + 1)
            if a[ACC] + ((limit >> pd) - (last >> pd)) * v < 2048 * quiet:
                return
            pulses = (2048 * quiet - a[ACC] + v - 1) // v
            tick = ((last >> pd) + pulses) << pd
            if quiet == steps:
                a[NEXT] = tick
                return
            _sync(a, chip, tick)
            a[STEADY] = 0
            continue
        ramp = ((last >> rd) + 1) << rd
        total = a[ACC] + (((ramp - 1) >> pd) - (last >> pd)) * v
        if total >= 2048 * steps:
            a[NEXT] = ((last >> pd) + (2048 * steps - a[ACC] + v - 1) // v) << pd
            return
        a[NEXT] = ramp
        if ramp > limit or locked:
            return
        _sync(a, chip, ramp - 1)
        target, new = _ramp(a, a[X], v8, a[VT])
        change = new - v8
        if _class_of(a, new, change) != a[CLASS] or (v8 > 0) != (new > 0):
            return
        if ramp & ((1 << pd) - 1) == 0 and a[ACC] + (abs(new) >> 8) >= 2048 and not (bulk and a[GUARD] > 1):
            return
        _ramp_commit(a, target, new, ramp)
        _sync_pulse(a, chip, ramp)


@compiled
def _sync_pulse(a: Cells, chip: Cells, tick: int) -> None:
    """The pulse half of `tick`, whose step if any is a quiet one."""
    if tick & ((1 << a[PD]) - 1) == 0:
        a[ACC] += abs(a[V8]) >> 8
        if a[ACC] >= 2048:
            a[ACC] -= 2048
            _quiet_steps(a, chip, 1)
            if chip[EN_SD]:
                chip[PULSE_END] = 32 * tick + chip[PULSE_LEN]
    a[LAST] = tick


@compiled
def _execute(axes: Cells, chip: Cells, i: int, tick: int) -> None:
    """Tick `tick` of axis `i` with all that it may entail."""
    a = axes[i]
    _sync(a, chip, tick - 1)
    if tick & ((1 << a[RD]) - 1) == 0:
        if a[STEADY]:
            _settled_ramp_ticks(a, 1)
        else:
            target, v8 = _ramp(a, a[X], a[V8], a[VT])
            _ramp_commit(a, target, v8, tick)
    a[LAST] = tick
    if tick & ((1 << a[PD]) - 1):
        return
    a[ACC] += abs(a[V8]) >> 8
    if a[ACC] >= 2048:
        a[ACC] -= 2048
        _step(axes, chip, i, tick)


@compiled
def _step(axes: Cells, chip: Cells, i: int, tick: int) -> None:
    """One step of axis `i` in the direction of its velocity."""
    a = axes[i]
    direction = 1 if a[V8] > 0 else -1
    a[X] = wrap24(a[X] + direction)
    a[SEQ] = (a[SEQ] + direction * a[INC]) & 0xFF
    a[STEPS] += 1
    a[DIR] = direction
    chip[REQ] = 1
    moved = True
    if chip[EN_SD]:
        # A pulse that begins before the last one ended is no new edge: the driver misses the step.
        moved = chip[HALF] != 0 or 32 * tick >= chip[PULSE_END]
        chip[SOUT if moved else MERGED] += 1
        chip[PULSE_END] = 32 * tick + chip[PULSE_LEN]
    if moved:
        a[MECH] += direction * a[MINC]
    a[GUARD] -= 1
    if a[MODE] < 2 and a[STEADY] and abs(wrap24(a[XT] - a[X])) < a[DFAR]:
        a[STEADY] = 0
    if a[GUARD] <= 0 or direction != a[GDIR] or not moved:
        physical = _physical(a)
        if physical != a[PHYS]:
            a[PHYS] = physical
            _switches_moved(axes, chip, tick, i)
        _evaluate(axes, chip, i, tick)


@compiled
def _next_update(axes: Cells, chip: Cells, after: int) -> int:
    """First tick behind `after` at which some motor asks for a continuous update (001, 9.7).

    Every 1024 ramp ticks of each motor, so that the frequencies add up as in the sheet's formula. The
    three are offset by odd numbers of ramp ticks, else equal dividers would fall together and not add.
    """
    if not chip[CU]:
        return NEVER
    first = NEVER
    for i in range(chip[NAXES]):
        period = 1024 << axes[i, RD]
        offset = (0, 341, 683)[i] << axes[i, RD]
        first = min(first, (after - offset) // period * period + period + offset)
    return first


@compiled
def _start_datagram(axes: Cells, chip: Cells, clock: int, tick: int) -> None:
    """A datagram leaves for the driver chain: signals are buffered, multiplexed switches sampled."""
    for i in range(chip[NAXES]):
        a = axes[i]
        _sync(a, chip, tick)
        at = SNAP + i * SNAP_WIDTH
        scale = a[ISAL]
        if a[CLASS] == 2:
            scale = a[ISAG]
        elif a[CLASS] == 0 and tick - a[STOPT] >= 255 << a[RD]:
            scale = a[ISV0]
        chip[at] = a[SEQ]
        chip[at + 1] = a[INC]
        chip[at + 2] = scale
        chip[at + 3] = a[STEPS] != a[SENT]
        chip[at + 4] = a[DIR] < 0
        a[SENT] = a[STEPS]
    chip[COVERED] = chip[CW] == 1
    if chip[CW] == 1:
        chip[CW] = 2
    if chip[CAPTURE] == 1:
        chip[CAPTURE] = 2
        for cell in range(3 * SNAP_WIDTH + 1):
            chip[CAPTURED + cell] = chip[SNAP + cell]
    chip[BUSY] = 1
    chip[PENDING] = 0
    chip[BUSY_UNTIL] = clock + chip[DURATION]
    chip[SENT_COUNT] += 1
    if chip[REFMUX]:
        for i in range(chip[NAXES]):
            _see(axes, chip, i, tick, tick)


@compiled
def _end_datagram(axes: Cells, chip: Cells) -> None:
    """The datagram is out; one that was asked for meanwhile follows at once."""
    clock = chip[BUSY_UNTIL]
    tick = (clock + 31) // 32 - 1
    chip[BUSY] = 0
    if chip[CW] == 2:
        chip[CW] = 0
    if chip[CAPTURE] == 2:
        chip[CAPTURE] = 3
    if chip[PENDING]:
        _start_datagram(axes, chip, clock, tick)


@compiled
def _request(axes: Cells, chip: Cells, clock: int, tick: int) -> None:
    """Something wants a datagram sent."""
    chip[REQ] = 0
    if chip[KIND] == TMC4210_KIND:
        return
    if chip[BUSY]:
        chip[PENDING] = 1
    else:
        _start_datagram(axes, chip, clock, tick)


@compiled
def status(axes: Cells, chip: Cells) -> int:
    """Status byte of the next reply (001, Table 6-4; 000, 5.2.2.2)."""
    bits = 0
    interrupt = chip[COMP_FLAG] & chip[COMP_MASK]
    for i in range(chip[NAXES]):
        a = axes[i]
        if a[X] == a[XT]:
            bits |= 1 << 2 * i
        if a[SR] if a[REFR] and chip[KIND] == TMC428_KIND else a[SL]:
            bits |= 2 << 2 * i
        interrupt |= a[FLAGS]
    if chip[KIND] == TMC4210_KIND:
        right = (axes[0, PHYS] >> 1 & 1) ^ chip[INVREF]
        bits |= chip[GPIN] << 3 | right * (1 - chip[MOT1R]) << 5
    elif chip[CW] or chip[CAPTURE] in (1, 2):
        bits |= 0x40
    return bits | (0x80 if interrupt else 0)


@compiled
def advance(axes: Cells, chip: Cells, clock: int) -> int:
    """Bring the chip to `clock` clocks since power-on (never back) and return the status byte."""
    axis_count = chip[NAXES]
    end = clock >> 5
    for i in range(axis_count):
        _plan(axes, chip, i, end)
    while True:
        tick = chip[CU_NEXT]
        for i in range(axis_count):
            tick = min(tick, axes[i, NEXT])
        if chip[BUSY] and chip[BUSY_UNTIL] <= clock and chip[BUSY_UNTIL] <= 32 * min(tick, NEVER >> 6):
            _end_datagram(axes, chip)
            for i in range(axis_count):
                _plan(axes, chip, i, end)
            continue
        if tick > end:
            break
        before = chip[BUSY] + 2 * chip[PENDING]
        for i in range(axis_count):
            if chip[CROSS]:  # an axis before this one may have moved its switches in this very tick
                _plan(axes, chip, i, end)
            if axes[i, NEXT] == tick:
                _execute(axes, chip, i, tick)
                axes[i, NEXT] = -1
        if chip[CU_NEXT] == tick:
            chip[REQ] = 1
            chip[CU_NEXT] = _next_update(axes, chip, tick)
        if chip[REQ]:
            _request(axes, chip, 32 * tick, tick)
        again = before != chip[BUSY] + 2 * chip[PENDING]
        for i in range(axis_count):
            if again or axes[i, NEXT] == -1 or axes[i, HELD] or chip[CROSS]:
                _plan(axes, chip, i, end)
    for i in range(axis_count):
        _sync(axes[i], chip, end)
    chip[TICK] = end
    chip[CLOCK] = clock
    return status(axes, chip)


@compiled
def refresh(axes: Cells, chip: Cells) -> int:
    """Take over what Python wrote into the arrays since the last `advance`; return the status byte."""
    tick = chip[TICK]
    chip[CROSS] = chip[KIND] == TMC428_KIND and (
        chip[WIRING] == TWO_ONE_NULL or (chip[MOT1R] != 0 and chip[REFMUX] == 0)
    )
    for i in range(chip[NAXES]):
        a = axes[i]
        a[DFAR] = FAR
        if a[MODE] == 0:
            a[DFAR] = min(FAR, -((-a[VMAX] * a[VMAX] << a[PSH]) // (2048 * a[PMUL])))
        elif a[MODE] == 1:
            a[DFAR] = min(FAR, -((-a[VMAX] << a[PSH]) // a[PMUL]))
        a[TFAR] = speed_for_distance(a, a[DFAR])
        a[STEADY] = 0
        a[LAST] = tick
        a[CLASS] = _class_of(a, a[V8], a[A0])
        a[PHYS] = _physical(a)
    _switches_moved(axes, chip, tick, chip[NAXES])
    for i in range(chip[NAXES]):
        _evaluate(axes, chip, i, tick)
    chip[CU_NEXT] = _next_update(axes, chip, tick)
    if chip[REQ]:
        _request(axes, chip, chip[CLOCK], tick)
    return status(axes, chip)
