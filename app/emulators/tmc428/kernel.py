"""The chip's simulation kernel: one compiled function that brings all axes to an absolute clock count.

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
matters. While a datagram is under way, steps matter only at guarded positions (target, zero, tolerance,
compare value, switch edges): everything between is a product, and that there were steps is enough to
send the next datagram. An axis whose ramp has settled needs no ramp ticks at all, and where one motor
keeps the chain busy for sure, whole trains of datagrams are passed over. `tests/emulators` holds all of
it to a plain model that does none of this.
"""

# numpy's stubs type a cell as Any; inside compiled code it is an int64 and nothing else.
# mypy: disable-error-code="no-any-return"

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...kernels import Kernels

Cells = NDArray[np.int64]

NEVER = 1 << 62
"""A tick that never comes."""
FAR = (1 << 19) - 1
"""Longest distance that the ramp generator sees (DS-TMC428 8.7.1)."""

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
SOUT, MERGED, PULSE_END = range(61, 64)
"""Step/dir output: pulses sent, pulses that merged with the one before, end of the last one [clock]."""
NET = 64
"""Of those pulses: steps forwards less those backwards."""
AXIS_COLUMNS = 65

# --- cells of `chip` -----------------------------------------------------------------------------
TICK, CLOCK, NAXES, KIND = range(4)
"""Ticks and clocks done, axes, 0 TMC428 and TMC429 or 1 TMC4210."""
REFMUX, MOT1R, WIRING, IDLE, CU, INVREF, GPIN, CROSS = range(4, 12)
"""Input sharing; the board's wiring; nSCS_S level at rest; continuous update; one motor's pin is another's switch."""
DURATION, BUSY, BUSY_UNTIL, PENDING, REQ, CW, CAPTURE, CU_NEXT, SENT_COUNT = range(12, 21)
"""Driver chain: clocks a datagram takes, under way, until when, asked again, asked now, cover waits (1) or goes (2),
capture armed (1), under way (2), done (3); next continuous update; datagrams so far."""
EN_SD, HALF, PULSE_LEN, EN_REFR = range(21, 25)
"""Step/dir outputs: on, edge a step, pulse clocks; right switches at pins of their own."""
COMP, COMP_ON, COMP_MASK, COMP_FLAG = range(25, 29)
"""Position compare; COMP_ON is the motor's number from 1, 0 for none."""
SNAP = 32
"""Snapshot of the last datagram's signals: for each motor sequencer index, width, scale, step, direction."""
SNAP_WIDTH = 5
COVERED = SNAP + 3 * SNAP_WIDTH
"""Whether the last datagram was covered."""
CAPTURED = COVERED + 1
"""Snapshot of the captured datagram, laid out like SNAP, its COVERED after it."""
LOG_ON, LOGGED = range(CAPTURED + 3 * SNAP_WIDTH + 1, CAPTURED + 3 * SNAP_WIDTH + 3)
"""Whether every datagram is logged, for drivers that do what it says, and how many are."""
CHIP_CELLS = LOGGED + 1
LOG_WIDTH = 3 * SNAP_WIDTH + 3
"""Of a logged datagram: the clock at which it ends, its signals as in SNAP, covered, captured. The log is behind the
cells, where there is one."""
LOG_LENGTH = 512
LOG_CELLS = LOG_LENGTH * LOG_WIDTH

TMC428_KIND, TMC4210_KIND = 0, 1
LEFT_ONLY, TWO_ONE_NULL, MULTIPLEXED = range(3)

_XEQ, _WRONG, _MISS, _COMP = 1, 2, 4, 8


_KERNELS = Kernels(__file__, plain=True)
# Not all is inlined: that would double the time to compile. Nothing here allocates, so reference counts are left
# alone: with them every row view costs two atomic operations, and all runs at a fifth of the speed.
compiled, inlined = _KERNELS.compiled, _KERNELS.inlined


@inlined
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


@inlined
def _ramp(a: Cells, x: int, v8: int, target: int) -> Any:
    """One ramp tick: (v_target register, velocity after it in 1/256, acceleration applied)."""
    mode = a[MODE]
    if mode < 2:
        dx = wrap24(a[XT] - x)
        d = abs(dx)
        if d == 0:
            target = 0
            if abs(v8) >> 8 <= a[VMIN]:
                return target, 0, 0  # stopping dead at the target is no acceleration
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
    new = min(v8 + a[AMAX], goal) if v8 < goal else max(v8 - a[AMAX], goal)
    return target, new, new - v8


@inlined
def _class_of(a: Cells, v8: int, change: int) -> int:
    """Row of Table 8-2: 0 at rest, 1 is_aleat, 2 is_agtat. A threshold above 1023 never selects is_agtat."""
    if v8 == 0:
        return 0
    return 2 if a[ATH] <= 1023 and abs(change) > a[ATH] else 1


@inlined
def _ahead(here: int, there: int, direction: int) -> int:
    """Steps from `here` until a landing on or leaving of `there` that may change a condition."""
    return max((direction * (there - here)) & 0xFFFFFF, 1)


@inlined
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
    left = a[FORCE_L] & 1 if a[FORCE_L] >= 0 else int(here <= a[LEFT_AT])  # 2 and 3 are a wire's
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
    """What the chip takes its pins for (DS-TMC428 Table 9-3; DS-TMC4210 1.5.4): (left, right) of motor `i`."""
    if chip[KIND] == TMC4210_KIND:
        left = (axes[0, PHYS] | axes[0, PHYS] >> 2) & 1
        right = (axes[0, PHYS] >> 1) & 1
        return left ^ chip[INVREF], (right ^ chip[INVREF]) * chip[MOT1R]
    invert = chip[INVREF]
    if chip[EN_REFR]:
        left = (axes[i, PHYS] | axes[i, PHYS] >> 2) & 1
        return left ^ invert, (axes[i, PHYS] >> 1) & 1 ^ invert
    if chip[REFMUX]:
        return _pin(axes, chip, i, chip[IDLE]) ^ invert, _pin(axes, chip, i, 1 - chip[IDLE]) ^ invert
    idle = chip[IDLE]
    if chip[MOT1R]:
        if i == 0:
            return _pin(axes, chip, 0, idle) ^ invert, _pin(axes, chip, 2, idle) ^ invert
        return (_pin(axes, chip, 1, idle) ^ invert) * (i == 1), 0
    return _pin(axes, chip, i, idle) ^ invert, 0


@compiled
def _stop(a: Cells, tick: int) -> None:
    """The motor stands still at once."""
    if a[V8] != 0:
        a[V8] = 0
        a[STOPT] = tick
        a[CLASS] = 0
    a[STOPPING] = 0
    a[STEADY] = 0


@compiled
def _evaluate(axes: Cells, chip: Cells, i: int, tick: int, landed: bool) -> None:
    """Conditions of axis `i` at its present position and switches: flags, stops, next guarded position.

    `landed`: a step has just brought it here, so a slow motor stops dead at its target. One that finds
    itself there because a register was written waits for its ramp tick.
    """
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
    if chip[COMP_ON] == i + 1 and x == chip[COMP]:
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
    else:
        a[STOPPING] = 0
    if landed and a[MODE] < 2 and now & _XEQ and abs(a[V8]) >> 8 <= a[VMIN]:
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
    _evaluate(axes, chip, i, tick, False)


@compiled
def _switches_moved(axes: Cells, chip: Cells, tick: int, i: int) -> None:
    """Some physical switch changed: direct inputs follow now, multiplexed ones with the next datagram.

    Axes after `i` have not had their turn in `tick` yet.
    """
    for j in range(chip[NAXES]):
        if chip[KIND] == TMC4210_KIND or not chip[REFMUX] or chip[EN_REFR]:
            _see(axes, chip, j, tick, tick if j <= i else tick - 1)
        else:
            left, right = _seen(axes, chip, j)
            axes[j, HELD] = left != axes[j, SL] or right != axes[j, SR]


@inlined
def _quiet_steps(a: Cells, chip: Cells, steps: int, direction: int) -> None:
    """Steps between guarded positions: they move, and that is all."""
    a[X] = wrap24(a[X] + direction * steps)
    a[SEQ] = (a[SEQ] + direction * steps * a[INC]) & 0xFF
    a[MECH] += direction * steps * a[MINC]
    a[STEPS] += steps
    a[DIR] = direction
    a[GUARD] -= steps
    if chip[EN_SD]:
        a[SOUT] += steps
        a[NET] += direction * steps


@inlined
def _settled_ramp_ticks(a: Cells, count: int) -> None:
    """Ramp ticks that changed nothing still shift the smoothing of a_actual."""
    for _ in range(min(count, 4)):
        a[A3] = a[A2]
        a[A2] = a[A1]
        a[A1] = a[A0]
        a[A0] = 0


@inlined
def _sync(a: Cells, chip: Cells, tick: int) -> None:
    """Bring an axis that has nothing but quiet steps before it to the end of `tick`."""
    if a[LAST] >= tick:
        return
    v = abs(a[V8]) >> 8
    if v:
        total = a[ACC] + ((tick >> a[PD]) - (a[LAST] >> a[PD])) * v
        a[ACC] = total & 2047
        if total >> 11:
            _quiet_steps(a, chip, total >> 11, 1 if a[V8] > 0 else -1)
            if chip[EN_SD]:
                step_tick = ((tick >> a[PD]) - a[ACC] // v) << a[PD]
                a[PULSE_END] = 32 * step_tick + chip[PULSE_LEN]
    if a[STEADY]:
        _settled_ramp_ticks(a, (tick >> a[RD]) - (a[LAST] >> a[RD]))
    a[LAST] = tick


@inlined
def _settled(a: Cells, x: int, v8: int, target: int) -> bool:
    """Will ramp ticks change nothing more, until a register, a switch or a falling distance does?"""
    if a[MODE] > 1 or v8 == 0:
        return True
    dx = wrap24(a[XT] - x)
    return abs(dx) >= a[DFAR] and v8 == target * 256 and (dx > 0) == (v8 > 0)


@inlined
def _bulk(a: Cells, chip: Cells) -> bool:
    """May steps between guarded positions be taken together?"""
    if chip[KIND] == TMC428_KIND and not chip[EN_SD]:
        return chip[BUSY] != 0
    if chip[HALF] or not chip[EN_SD]:
        return True
    next_pulse = 32 * (((a[LAST] >> a[PD]) + 1) << a[PD])
    return 32 << a[PD] >= chip[PULSE_LEN] and a[PULSE_END] <= next_pulse


@inlined
def _face(a: Cells, chip: Cells) -> None:
    """The guard looks where the motor goes."""
    if a[V8] != 0 and a[GDIR] != (1 if a[V8] > 0 else -1):
        a[GDIR] = -a[GDIR]
        a[GUARD] = _guard(a, chip, a[GDIR])


@inlined
def _before(clock: int) -> int:
    """The last tick that lies before `clock`."""
    return (clock + 31) // 32 - 1


@compiled
def _plan(axes: Cells, chip: Cells, i: int, end: int) -> None:
    """Run axis `i` ahead as far as nobody else can notice; NEXT is then the tick of its next event."""
    a = axes[i]
    locked = chip[CROSS] != 0 or a[HELD] != 0
    bulk = _bulk(a, chip) and not locked
    limit = min(end, _before(chip[BUSY_UNTIL])) if chip[BUSY] and bulk else end
    _run(a, chip, limit, bulk, locked, True)


@compiled
def _run(a: Cells, chip: Cells, limit: int, bulk: bool, locked: bool, pause: bool) -> None:
    """The inner loop: ramp ticks up to `limit` with the pulses between them.

    It ends before the tick of a step that matters (any step, or with `bulk` only one onto a guarded
    position), before a ramp tick at all if `locked`, and with `pause` before one that changes the current
    scale. A settled axis is left where it is: `_sync` brings it on. Works on locals: three times as fast.
    """
    _face(a, chip)
    rd, pd = a[RD], a[PD]
    v8, x, acc, last, vt, steady, cls = a[V8], a[X], a[ACC], a[LAST], a[VT], a[STEADY], a[CLASS]
    a0, a1, a2, a3 = a[A0], a[A1], a[A2], a[A3]
    guard = a[GUARD]
    direction = 1 if v8 > 0 else -1
    done = 0
    last_step = -1
    while True:
        upcoming = NEVER
        v = abs(v8) >> 8
        steps = guard - done if bulk else 1
        if steady:
            if v == 0:
                break
            quiet = steps
            if a[MODE] < 2:  # one step inside DFAR the wanted speed begins to fall
                quiet = min(quiet, abs(wrap24(a[XT] - x)) - a[DFAR] + 1)
            if acc + ((limit >> pd) - (last >> pd)) * v < 2048 * quiet:
                break
            pulses = (2048 * quiet - acc + v - 1) // v
            tick = ((last >> pd) + pulses) << pd
            if quiet == steps:
                upcoming = tick
                break
            acc = (acc + pulses * v) & 2047
            done += quiet
            x += direction * quiet
            last_step = tick
            for _ in range(min((tick >> rd) - (last >> rd), 4)):
                a0, a1, a2, a3 = 0, a0, a1, a2
            last = tick
            steady = 0
            continue
        ramp = ((last >> rd) + 1) << rd
        total = acc + (((ramp - 1) >> pd) - (last >> pd)) * v
        if total >= 2048 * steps:
            upcoming = ((last >> pd) + (2048 * steps - acc + v - 1) // v) << pd
            break
        upcoming = ramp
        if ramp > limit or locked:
            break
        acc = total & 2047
        last = ramp - 1
        if total >> 11:
            done += total >> 11
            x += direction * (total >> 11)
            if chip[EN_SD]:
                last_step = ((last >> pd) - acc // v) << pd
        target, new, change = _ramp(a, x, v8, vt)
        new_cls = _class_of(a, new, change)
        if (pause and new_cls != cls) or (v8 > 0) != (new > 0):
            break
        if ramp & ((1 << pd) - 1) == 0:
            pulse = acc + (abs(new) >> 8)
            if pulse >= 2048:
                if not bulk or guard - done <= 1:
                    break
                done += 1
                x += direction
                last_step = ramp
            acc = pulse & 2047
        a0, a1, a2, a3 = change, a0, a1, a2
        if new == v8 and target == vt:
            steady = _settled(a, x, new, target)
        v8, vt, cls, last = new, target, new_cls, ramp
    a[V8], a[ACC], a[LAST], a[VT], a[STEADY], a[CLASS] = v8, acc, last, vt, steady, cls
    a[A0], a[A1], a[A2], a[A3] = a0, a1, a2, a3
    a[NEXT] = upcoming
    if v8 == 0:
        a[STOPPING] = 0
    if done:
        _quiet_steps(a, chip, done, direction)
        if chip[EN_SD]:
            a[PULSE_END] = 32 * last_step + chip[PULSE_LEN]


@compiled
def _leap(axes: Cells, chip: Cells, clock: int) -> bool:
    """Pass over datagrams of a train in which one follows the other for sure. False: nothing passed over.

    For when the datagram under way is about to end and another is asked for. While one motor steps at
    least once in every datagram's time, datagrams follow without a gap; as long as besides nothing
    happens, all but the last may be skipped. That one is sent, for its signals can be seen.
    """
    duration = chip[DURATION]
    if chip[CROSS] or chip[CW] or chip[CAPTURE] in (1, 2) or duration >= NEVER or chip[LOG_ON]:
        return False
    horizon = clock >> 5
    assured = 0
    for i in range(chip[NAXES]):
        a = axes[i]
        if a[HELD]:
            return False
        _face(a, chip)
        v8, last, rd, pd = a[V8], a[LAST], a[RD], a[PD]
        v = abs(v8) >> 8
        window = duration // (32 << pd)
        needed = (2047 + window) // window if window else NEVER
        if a[STEADY]:
            if v:
                quiet = a[GUARD]
                if a[MODE] < 2:
                    quiet = min(quiet, abs(wrap24(a[XT] - a[X])) - a[DFAR] + 1)
                horizon = min(horizon, (((last >> pd) + (2048 * quiet - a[ACC] + v - 1) // v) << pd) - 1)
                if v >= needed:
                    assured = NEVER
            continue
        if v8 == 0 or (a[MODE] < 2 and a[X] == a[XT]):
            return False
        change = max(a[AMAX], 1)
        horizon = min(horizon, last + ((a[GUARD] - 1) << pd), ((last >> rd) + (abs(v8) - 1) // change) << rd)
        if v >= needed:
            assured = max(assured, ((last >> rd) + (abs(v8) - needed * 256) // change) << rd)
    first = chip[BUSY_UNTIL]
    follow = (32 * min(horizon, assured) - first) // duration  # starts at first + 0..follow durations
    if follow < 2:
        return False
    tick = _before(first + (follow - 1) * duration)
    for i in range(chip[NAXES]):
        _run(axes[i], chip, tick, True, False, False)
        _sync(axes[i], chip, tick)
        axes[i, SENT] = axes[i, STEPS]  # the last datagram's step bits tell what moved since the one before
    chip[SENT_COUNT] += follow
    tick = _before(first + follow * duration)
    for i in range(chip[NAXES]):
        _run(axes[i], chip, tick, True, False, False)
        _sync(axes[i], chip, tick)
    chip[CU_NEXT] = _next_update(axes, chip, tick)
    _start_datagram(axes, chip, first + follow * duration, tick)
    return True


@compiled
def _execute(axes: Cells, chip: Cells, i: int, tick: int) -> None:
    """Tick `tick` of axis `i` with all that it may entail."""
    a = axes[i]
    _sync(a, chip, tick - 1)
    if tick & ((1 << a[RD]) - 1) == 0:
        if a[STEADY]:
            _settled_ramp_ticks(a, 1)
        else:
            target, v8, change = _ramp(a, a[X], a[V8], a[VT])
            a[A0], a[A1], a[A2], a[A3] = change, a[A0], a[A1], a[A2]
            if v8 == 0:
                a[STOPPING] = 0
                if a[V8] != 0:
                    a[STOPT] = tick
            a[STEADY] = v8 == a[V8] and target == a[VT] and _settled(a, a[X], v8, target)
            a[VT] = target
            a[V8] = v8
            a[CLASS] = _class_of(a, v8, change)
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
        moved = chip[HALF] != 0 or 32 * tick >= a[PULSE_END]
        a[SOUT if moved else MERGED] += 1
        if moved:
            a[NET] += direction
        a[PULSE_END] = 32 * tick + chip[PULSE_LEN]
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
        _evaluate(axes, chip, i, tick, True)


@compiled
def _next_update(axes: Cells, chip: Cells, after: int) -> int:
    """First tick behind `after` at which some motor asks for a continuous update (DS-TMC428 9.7).

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
    if chip[LOG_ON] and chip[DURATION] < NEVER and chip[LOGGED] < LOG_LENGTH:
        at = CHIP_CELLS + chip[LOGGED] * LOG_WIDTH
        chip[at] = clock + chip[DURATION]
        for cell in range(3 * SNAP_WIDTH + 1):
            chip[at + 1 + cell] = chip[SNAP + cell]
        chip[at + LOG_WIDTH - 1] = chip[CAPTURE] == 1
        chip[LOGGED] += 1
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
def _end_datagram(axes: Cells, chip: Cells, clock: int) -> None:
    """The datagram is out; if another was asked for meanwhile, it follows at once."""
    now = chip[BUSY_UNTIL]
    tick = _before(now)
    if chip[CW] == 2:
        chip[CW] = 0
    if chip[CAPTURE] == 2:
        chip[CAPTURE] = 3
    wanted = chip[PENDING] and not chip[EN_SD]
    for i in range(chip[NAXES]):
        _sync(axes[i], chip, tick)
        if axes[i, STEPS] != axes[i, SENT] and not chip[EN_SD]:
            wanted = 1
    chip[BUSY] = 0
    if wanted and not _leap(axes, chip, clock):
        _start_datagram(axes, chip, now, tick)


@compiled
def _request(axes: Cells, chip: Cells, clock: int, tick: int) -> None:
    """Something wants a datagram sent."""
    chip[REQ] = 0
    if chip[KIND] == TMC4210_KIND or chip[EN_SD]:
        return
    if chip[BUSY]:
        chip[PENDING] = 1
    else:
        _start_datagram(axes, chip, clock, tick)


@compiled
def status(axes: Cells, chip: Cells) -> int:
    """Status byte of the next reply (DS-TMC428 Table 6-4; DS-TMC4210 5.2.2.2)."""
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
            _end_datagram(axes, chip, clock)
            for i in range(axis_count):
                _plan(axes, chip, i, end)
            continue
        if tick > end:
            break
        before = chip[BUSY]
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
        again = before != chip[BUSY]
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
        _evaluate(axes, chip, i, tick, False)
    chip[CU_NEXT] = _next_update(axes, chip, tick)
    if chip[REQ]:
        _request(axes, chip, chip[CLOCK], tick)
    return status(axes, chip)
