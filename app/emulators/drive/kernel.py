"""The drive's simulation kernel: a compiled function that brings ramp generator, driver and motor to an absolute clock.

State and settings are int64 cells `s` and float64 cells `f`; the Python code around writes into them. Layout and code
share this file because numba's disk cache only notices changes of the file that a function stands in.

The tick laws are a reading: the data sheet gives every unit (velocity 1/2^24 microstep a clock, acceleration 1/2^17
velocity unit a clock), not how the ramp generator meets its target. Here everything happens in ticks of 256 clocks,
so that an acceleration of A adds A/512 velocity units a tick: velocity has 9 hidden fraction bits, and each tick adds
it to a 25-bit accumulator whose overflows are the steps. On the way to a target a tick takes the highest velocity of
those in reach (one tick of acceleration up, one of deceleration down) from which, after this tick, the way left still
suffices to brake: DMAX down to V2, D2 down to V1, D1 down to VSTOP, then dead stop (without a V2 above V1, as in most
chips, DMAX down to V1). That solves to a square root, taken in doubles (IEEE, so the same everywhere) and floored. A
tick that would run past the target while a stop from its velocity is allowed ends on the target. With TVMAX a
positioning motor that has sped up keeps its velocity for so many ticks before it brakes, and the other way round, so it
speeds up only as far as the way suffices for that too. It serves them also where a new target leaves no way for them (a
reading).

The motor is motor-physics' model: coils behind a regulator of first order that the supply clamps (with StealthChop
behind the voltage of its PWM, which nothing but the looks of its regulation corrects), back-EMF, detent,
Coulomb friction with stiction, inertia, in semi-implicit Euler. A coil current within 1 nA of its reference is set on
it. From there a motor at rest is an exact fixed point of the step, so passing over ticks in which neither reference
nor plant changes (REST), and over all ticks while the ramp generator has nothing to do either (QUIET), changes no bit.
Load and rotor are one piece, or two with a spring between them; the supply is stiff, or behind a resistance.

A rigid motor has none of that: the shaft is where the field is, in whole microsteps, and its encoder is worked out in
integers. While its ramp generator keeps its velocity, ticks differ in nothing but sums, so they are added up at once
as far as the next thing that could happen: braking, a switch, the N line, X_COMPARE, XTARGET, deviation (`_leap`).
"""

# numpy's stubs type a cell as Any; inside compiled code it is an int64 or a float64 and nothing else.
# mypy: disable-error-code="no-any-return"

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ...kernels import Kernels

Cells = NDArray[np.int64]
Floats = NDArray[np.float64]

TICK_CLOCKS = 256
"""Clocks from one tick to the next."""
VELOCITY_BITS = 9
"""Hidden fraction bits of a velocity."""
STEP_BITS = 25
"""Bits of the accumulator whose overflow is a step."""
NO_TSTEP = 0xFFFFF
"""TSTEP at standstill."""
TICKS_A_DELAY = 1024
"""2^18 clocks: the unit of TPOWERDOWN and IHOLDDELAY."""
NANO_AMPERE = 1e-9

# --- cells of `s` --------------------------------------------------------------------------------
TICK, CLOCK, WATCH, QUIET, REST = range(5)
"""Ticks and clocks done, events that end an advance, nothing happens until a write, the motor is at rest."""
MODE, X, XT, V, ACC = range(5, 10)
"""RAMPMODE, XACTUAL, XTARGET, velocity (signed, 9 fraction bits), step accumulator."""
VSTART, A1, V1, AMAX, VMAX, DMAX, D1, VSTOP, TZERO = range(10, 19)
"""Ramp parameters; velocities with 9 fraction bits, D1 and DMAX never 0, TZERO in ticks."""
ZWAIT, LATCHED, REACHED, FAST, HEADING = range(19, 24)
"""Ticks of TZEROWAIT left, RAMP_STAT's latching bits, position and velocity reached, direction of the last move."""
PHYS, FORCE, FORCED, LSEEN, RSEEN, LSTOP, RSTOP = range(24, 31)
"""Switches as they are (1 left, 2 right, 4 home), which are forced and to what, as the ramp generator sees them, and
whether they stop it."""
SW, XLATCH, ENC_LATCH, STOPPING = range(31, 35)
"""SW_MODE, latches, a switch is stopping the motor."""
FIELD, LOOK, MRES, INTPOL, SHAFT = range(35, 40)
"""Microsteps of 1/256 commanded since ever, the same with interpolation, MRES, intpol, +-1."""
STILL, STILL_LIMIT, TPOWER, IHOLDDELAY, IHOLD, IRUN, PHASE, DOWN, CS = range(40, 49)
"""Ticks without a step, how many are standstill, delays [ticks], current scales, 0 run 1 ramping down 2 hold, ticks
of the ramp down, scale in use."""
TSTEP, TPWMTHRS, TCOOLTHRS, THIGH, EN_PWM, STEALTH, FREEWHEEL = range(49, 56)
BRIDGES, DRIVER_ON = range(56, 58)
"""0 regulated, 1 open, 2 shorted; whether toff, supply and temperature let the bridges work."""
SG, SG_VALID, SG_SUM, SG_COUNT, SGT, SFILT, SG_TICKS, STALL_V = range(58, 66)
"""StallGuard2 value, whether one was measured since the motor stood, filter, settings, ticks in the window, velocity
from which a stall stops (-1: TCOOLTHRS decides)."""
COOL_CS, COOL_DOWN, SEMIN, SEUP, SEMAX, SEDN, SEIMIN = range(66, 73)
RNG, SUBSTEPS, BLOCKED, ENCODERS = range(73, 77)
"""Noise, physics steps a tick, the shaft is clamped, whether any encoder has to be looked at in each tick."""
ARRIVED, SG_FROM = range(77, 79)
"""The motor stands on the target of positioning mode; LOOK where StallGuard2's window began."""
INTERNAL, EXTERNAL = 79, 89
"""Where the cells of each encoder start."""
E_NUM, E_DEN, E_BASE_COUNTS, E_BASE, E_LIMIT, E_STOPS, E_EXCEEDED, E_NULL, E_TURN, E_PER_TURN = range(10)
"""Microsteps a count as a fraction, counter and position from which it is counted, deviation limit, what happens
beyond it, null armed, turn it is in, counts a turn."""
COOL_V, HIGH_V = range(99, 101)
"""Velocities between which CoolStep and a stop by StallGuard2 are possible [9 fraction bits]; COOL_V -1: TSTEP says."""
X_COMPARE, PASSED, PINS = range(101, 104)
"""Position to compare with and how often it was come upon; switches that are wired to pins, as in PHYS."""
N_HAS, N_ON, N_MODE, N_ONCE, N_FLAG, N_AT, N_LOW, N_HIGH = range(104, 112)
"""The external encoder's N line: wired, has to be looked at, ENCMODE, armed for one event, ENC_STATUS.n_event, counts
seen last, and counts between which nothing can happen."""
RIGID, STEADY, OFFSET, SLIP_M = range(112, 116)
"""0: physics, 1: none, 2: none and no leaps; the last tick changed nothing but sums; shaft ahead of the field and
encoder's slip [microsteps of 1/256]."""
V2, A2, D2, TVMAX, VWAIT, SLOPE, ACTUAL = range(116, 123)
"""The further segment (V2 0: none), TVMAX in ticks, ticks of it left, whether the speed rose (1) or fell (-1) last, and
its change in the last tick (AACTUAL)."""
X_REPEAT, VIRTUAL, VLEFT, VRIGHT, VSEEN = range(123, 128)
"""Distance at which X_COMPARE repeats (less than 2: never); virtual stops: 1 left, 2 right, 4 by the encoder; where,
and which hold now."""
IRUNDELAY, UP = range(128, 130)
"""Ticks for each step up to the run current, and of that gone."""
SG4, SG4_THRS, SG4_FILTER, SG4_LAST = range(130, 134)
"""StallGuard4 works in StealthChop; below twice that it is a stall; mean of four; the latest four, a byte each."""
PWM_KIND, AUTOSCALE, AUTOGRAD, PWM_OFS, PWM_GRAD, PWM_REG, PWM_LIM = range(134, 141)
"""StealthChop: which of the three there are, and PWMCONF's fields; of chips without PWM_OFS it is PWM_AMPL."""
OFS_AUTO, GRAD_AUTO, PWM_WAIT, PWM_STEPS, PWM_CS, PWM_TUNED, TUNING = range(141, 148)
"""What it has found by itself; ticks and full steps until it looks again; current scale at the latest look at rest, and
whether that changed nothing; it is still looking, so nothing is quiet."""
CHM, VHIGHFS, VHIGHCHM, T_OFF, T_BLANK, AT_HIGH = range(148, 154)
"""CHOPCONF's choppers, its slow decay and blank time [clocks], and whether any of them hangs on velocity."""
CHOPPER, FULL, SLOW_ONLY = range(154, 157)
"""How the bridges are driven outside StealthChop, full steps, and no fast decay: what holds now."""
VDCMIN, DC_TIME, DC_SG, DCSTEP, DC_TICKS, DC_HELD, DC_LOST, MORE = range(157, 165)
"""DcStep: its least velocity (0: off), longest and shortest time that current is let in [clocks], whether it works,
ticks that this full step lasts, whether the motor was waited for in it, and it does not follow; whether V2, TVMAX or
DcStep have a part in the ramp, or it is moved from outside."""
BOOST, SLOW, VARIES, FREE_AFTER = range(165, 169)
"""Of modules: current scale, plus 1, while the speed changes, and outside CoolStep's range (0: none); whether the run
current is anything but IRUN; ticks of hold current after which there is none (0: never)."""
WAVE_STEPS = 169
"""Physics steps until `SINE` and `COSINE` are worked out anew."""
OUTSIDE, COMING, DIRECT_A, DIRECT_B = range(170, 174)
"""What moves the field in place of the ramp generator (`BY_STEPS`, `BY_CURRENTS`), steps that have come since the last
tick, and coil currents that were told [1/248 of the peak]."""
GAP, WINDOW, MOVED = range(174, 177)
"""From outside: ticks since the latest step, and ticks and steps since the speed was worked out last."""
UNTRUE, UNEVEN = range(177, 179)
"""The external encoder has errors; the phases of the motor are unlike, or more than a sine."""
APART, COUPLED, SAGGED, SAG_SEEN = range(179, 183)
"""One of both: the load hangs on a spring, or the supply sags. The former; it has sagged below what the bridges need,
now and since that was cleared."""
INTEGERS = 183

# --- cells of `f` --------------------------------------------------------------------------------
THETA, OMEGA, IA, IB, TORQUE, REF_A, REF_B = range(7)
"""Shaft angle and speed, coil currents, electromagnetic torque, current references of the last step."""
IA0, IB0, EMF_A, EMF_B = range(7, 11)
"""Currents before the last step and back-EMF in it: for whoever wants the voltages."""
SUM_T, SUM_I2, MARK = range(11, 14)
"""StallGuard2's window: sums of torque and of current squared, electrical angle at its start."""
TEETH, KT, KEEP, GAIN, ALPHA, SUPPLY = range(14, 20)
"""Rotor teeth, Kt; of a coil in one step: what is kept of a current, current a volt, share of the regulator."""
TD, LOAD, DT, DT_J, DAMP, FRICTION, STICTION = range(21, 28)
"""Detent, load torque, step, step over inertia, viscous factor, friction turning and at rest (as speed a step)."""
FULL_SCALE, FS_A_V, S0, V_HALF, NOISE = range(28, 33)
"""Peak current at CS 31, full steps a second per velocity cell, StallGuard2's figures."""
LEFT_AT, RIGHT_AT, HOME_FROM, HOME_TO = range(33, 37)
"""Switches [rad of the shaft]."""
E1, P1, E2, P2, ZERO, SLIP_I, SCALE_I, SLIP_E, SCALE_E = range(37, 46)
"""Encoders: errors and their phases, magnet's zero, slips [rad], counts a radian (signed)."""
RATIO_I, BOUND_I, RATIO_E, BOUND_E = range(46, 50)
"""Microsteps a count, and how far at most [microsteps] an encoder is from what the angle alone would say."""
PWM_AUTO, PWM_SUM, PWM_FLOOR = range(50, 53)
"""StealthChop: what the regulation adds to the amplitude, the amplitude [1/256 of the supply, about], and the least
current that the regulation sees [A]."""
FALL_CHM, FALL, SINE_OFFSET, DC_MARK = range(53, 57)
"""Constant off time: share of the supply with which it can lower a current, as set and now, what is added to the
wave; electrical angle of the rotor at DcStep's last full step."""
LOW_END, HIGH_END = range(57, 59)
"""Where the stage ends hard [rad of the shaft]; it has no ends where the first is not below the second."""
ANGLE, SINE, COSINE = range(59, 62)
"""Electrical angle of the rotor in the last physics step, and its sine and cosine."""
BRAKE_SQUARE, BRAKE_REST = range(62, 64)
"""A motor that goes at u needs at most `BRAKE_SQUARE` u^2 + `BRAKE_REST` to brake down to VSTOP [1/2^25 step]."""
FLUX_A, FLUX_A3, FLUX_B, FLUX_B3, FLUX_BX = range(64, 69)
"""Of an uneven motor: torque of a coil an ampere [N m/A] at an electrical angle with sine s and cosine c. That of A is
(FLUX_A - FLUX_A3 s^2) c, that of B -(FLUX_B + FLUX_B3 s^2) s - FLUX_BX c."""
EX1, PX1, EX2, PX2, EXS, PXS, LINES = range(69, 76)
"""Errors of the external encoder and their phases [rad]: once and twice a turn, and once a line of so many."""
NOISE_V, POLES = range(76, 78)
"""StallGuard2: noise for each full step a second, and what the poles do to a value."""
PLAY, BEHIND = range(78, 80)
"""Between the shaft and its encoder: play, and how far the shaft is ahead of what the encoder sees [rad]."""
SWITCH_PLAY = 80
"""How far behind the place where it is pressed a switch is released [rad of the shaft]."""
SOURCE, SUPPLY_OHM, SUPPLY_LAG, LEAST_SUPPLY = range(81, 85)
"""The supply behind its resistance [V, ohm], what of a change comes in a tick, and what the bridges need [V]."""
LOAD_THETA, LOAD_OMEGA, LOAD_TORQUE, LOAD_DT_J, LOAD_FRICTION, LOAD_STICTION = range(85, 91)
"""A load on a spring: its angle and speed, and what the cells without LOAD are for the rotor."""
SPRING, SPRING_DAMPING, SPRING_PLAY = range(91, 94)
"""Between rotor and load: [N m/rad], [N m s], and half of the play [rad]."""
REALS = 94

# --- cells of the table --------------------------------------------------------------------------
WAVE, CHOPPED, TABLE = 0, 1024, 2048
"""Where the microstep table begins, where the same as SpreadCycle makes it, and how many cells both have."""

REGULATED, OPEN, SHORTED, VOLTAGE, CLASSIC, IN_FULL_STEPS = range(6)
"""What the bridges do. VOLTAGE: a PWM sets their mean voltage (StealthChop, or one from outside), and the references
are volts. CLASSIC: a chopper with constant off time, whose current falls only as fast as its fast decay lets it.
IN_FULL_STEPS: as REGULATED, apart so that microsteps ask nothing more."""
TUNED, AMPLITUDE, FIXED = range(3)
"""Kinds of StealthChop: PWM_OFS and PWM_GRAD that it tunes itself; PWM_AMPL and PWM_GRAD; the same, where velocity adds
nothing to a fixed amplitude."""
PWM_PEAK = 248.0 / 256.0 / 256.0
"""Share of the supply that an amplitude of 1 is at the wave's peak (DS-TMC5160 7.4: 374 = 256 sqrt(2) 256 / 248)."""
DC_EARLY, DC_LATE = math.pi / 4.0, math.pi / 7.2
"""How much less and more than 45 degrees the rotor may lag as DcStep makes the next full step: to no lag, and to 70
degrees, which leaves a third of the torque (INFERRED)."""
TUNING_TICKS, REGULATION_TICKS = TICKS_A_DELAY, 64
"""Between two looks at a standing motor: 2^18 clocks where PWM_OFS is tuned (the sheet gives two of them to it), about
a millisecond where the amplitude is regulated (INFERRED)."""
TUNING_STEPS = 8
"""Full steps for each change of PWM_GRAD_AUTO (DS-TMC5160 7.2.1, AT#2)."""
MOST_ROTATED = 0.1
"""Electrical angle [rad] up to which sine and cosine are carried on by their series, whose next terms are below 3e-17:
at 20 turns a second a motor of 50 teeth passes it in a tick."""
WAVE_LASTS = 256
"""Physics steps for which they are carried on: what rounding leaves is below 1e-13."""
BRAKE_MARGIN = 1.0 + 1e-6
"""What `allowed` rounds is far less than this share of the way, or two steps of 1/2^25."""
PWM_LOOP = 0.25
"""Gain of the regulation: as much as stays stable with a coil that follows slowly (INFERRED; sheets tell only the
greatest change)."""
BY_STEPS, BY_CURRENTS = 1, 2
CURRENT_PEAK = 248.0
"""What a driver that is told its coil currents takes for the peak of the wave (DS-TMC2660 6.4)."""
RUN, RAMPING_DOWN, HOLD = range(3)
LEAPS, NO_LEAPS = 1, 2
WITHOUT_EMF = 0.2
"""How far below 0 StallGuard2 is where the rotor does not follow, as a share of its full scale: coils without back-EMF
only take energy. Takes clamped motors to 0 up to a threshold of 12; the maker's demos stall at 6 to 9 (INFERRED)."""
LEAST_SAG = 1e-6
"""A supply that is so near to where it goes stays as it is [V]: so a motor at rest comes to rest."""
LONGEST_LEAP = 1 << 29
"""Ticks: velocities are at most 2^32, and the sum of all has to fit."""
N_WIDTH = 4
"""Counts of a turn, from its place 0, in which the N line is high."""
N_REPEATS = 8
"""Counts, two times A and B, in which everything between two pulses has happened twice."""
POSITION, FORWARD, BACKWARD, HOLD_MODE = range(4)

# RAMP_STAT's latching bits, and bits of SW_MODE
_LATCH_L, _LATCH_R, _STOP_SG, _POS_REACHED, _SECOND_MOVE = 1 << 2, 1 << 3, 1 << 6, 1 << 7, 1 << 12
_SG_STOP, _SOFT_STOP = 1 << 10, 1 << 11

# events, as in EventKind
_EV_POSITION, _EV_STOPPED, _EV_LEFT, _EV_SWITCH_STOP, _EV_STALL = 1, 2, 4, 32, 64
_EV_DEVIATION, _EV_NULL, _EV_STANDSTILL, _EV_VELOCITY = 128, 512, 2048, 4096

_KERNELS = Kernels(__file__, plain=True)
compiled, inlined = _KERNELS.compiled, _KERNELS.inlined


@inlined
def wrap32(x: int) -> int:
    """To a signed 32-bit number."""
    return ((x + 0x80000000) & 0xFFFFFFFF) - 0x80000000


# --- ramp generator ------------------------------------------------------------------------------


@inlined
def _faster(s: Cells, u: int, more: bool) -> int:
    """Speed after one tick of acceleration: A1 below V1, A2 below V2, AMAX from there; 0 leaves a segment out."""
    v1 = s[V1]
    if more and u < s[V2] and s[V2] > v1:
        return _faster_below_v2(s, u)
    if u >= v1:
        return u + s[AMAX]
    a1 = s[A1]
    if u + a1 <= v1:
        return u + a1
    return v1 + s[AMAX] * (a1 - (v1 - u)) // a1


@compiled
def _faster_below_v2(s: Cells, u: int) -> int:
    """The same where A2 has a part in it."""
    v1, v2, a1, a2 = s[V1], s[V2], s[A1], s[A2]
    if u < v1:
        if u + a1 <= v1:
            return u + a1
        new = v1 + a2 * (a1 - (v1 - u)) // a1
    else:
        new = u + a2
    return new if new <= v2 else v2 + s[AMAX] * (new - v2) // a2


@compiled
def _slower_by_d2(s: Cells, u: int) -> int:
    """Speed after one tick of deceleration from above V1, where D2 has a part in it; maybe below zero."""
    v1, v2, d2 = s[V1], s[V2], s[D2]
    new = u - s[DMAX]
    if u <= v2:
        new = u - d2
    elif new < v2:
        new = v2 - d2 * (s[DMAX] - (u - v2)) // s[DMAX]
    return new if new >= v1 or v1 == 0 else v1 - s[D1] * (v1 - new) // d2


@inlined
def _slower(s: Cells, u: int, more: bool) -> int:
    """Speed after one tick of deceleration, maybe below zero: DMAX down to V2, D2 to V1, D1 below; 0 leaves a segment
    out."""
    v1 = s[V1]
    if more and s[V2] > v1 and u > v1 and u - s[DMAX] < s[V2]:
        return _slower_by_d2(s, u)
    if u - s[DMAX] >= v1 or v1 == 0:
        return u - s[DMAX]
    if u <= v1:
        return u - s[D1]
    return v1 - s[D1] * (s[DMAX] - (u - v1)) // s[DMAX]


@inlined
def allowed(s: Cells, way: int, kept: int, more: bool) -> int:
    """The highest speed u with u + `kept` ticks of u + braking distance from u <= `way` [1/2^25 step], at least 1."""
    stop = s[VSTOP]
    ticks = 1 + kept
    if way <= stop * ticks:
        return max(way // ticks, 1)
    left = float(way)
    knee = float(stop)
    d = float(s[DMAX])
    if s[V1] > stop:
        v1, d1 = float(s[V1]), float(s[D1])
        below = (v1 * v1 - knee * knee) / (2.0 * d1)
        if left <= v1 * ticks + below:
            return _speed_of(d1, knee, left, ticks)
        left -= below
        knee = v1
    if more and s[V2] > s[V1] and s[V2] > stop:
        v2, d2 = float(s[V2]), float(s[D2])
        below = (v2 * v2 - knee * knee) / (2.0 * d2)
        if left <= v2 * ticks + below:
            return _speed_of(d2, knee, left, ticks)
        left -= below
        knee = v2
    return _speed_of(d, knee, left, ticks)


@inlined
def _speed_of(d: float, knee: float, left: float, ticks: int) -> int:
    """The speed from which `left` suffices for so many ticks of it and then to brake by `d` down to `knee`."""
    reach = d * ticks
    return max(math.floor(math.sqrt(reach * reach + knee * knee + 2.0 * d * left) - reach), 1)


@inlined
def _bound_braking(s: Cells, f: Floats) -> None:
    """What says at a glance that the way left suffices to brake, where it does so by far."""
    v1, stop = float(s[V1]), float(s[VSTOP])
    f[BRAKE_REST] = 0.0
    if s[V2] > s[V1]:
        f[BRAKE_SQUARE] = 0.5 / min(s[DMAX], s[D2], s[D1])
        return
    f[BRAKE_SQUARE] = 0.5 / s[DMAX]
    if v1 > stop:  # exact above V1; below it too much, with D1 above DMAX everywhere
        f[BRAKE_REST] = max((v1 * v1 - stop * stop) / (2.0 * s[D1]) - v1 * v1 * f[BRAKE_SQUARE], 0.0)


@inlined
def _brake(s: Cells, u: int, more: bool) -> int:
    """Speed after one tick of braking to a stop from VSTOP, by the deceleration ramp."""
    u = _slower(s, u, more)
    return 0 if u < s[VSTOP] or u <= 0 else u


@inlined
def _ramp(s: Cells, f: Floats, more: bool) -> int:
    """One tick of the ramp generator: moves X and V, returns the steps made (signed).

    more : whether V2 or TVMAX may have a part in it
    """
    v = s[V]
    mode = s[MODE]
    direction = 1 if v > 0 else -1
    u = abs(v)
    if s[LATCHED] & _STOP_SG or _deviates(s):
        return _move(s, direction, 0)
    way = wrap32(s[XT] - s[X])
    if v == 0:
        if s[ZWAIT] > 0:
            s[ZWAIT] -= 1
            return 0
        if mode == HOLD_MODE:
            return 0
        direction = 1 if mode == FORWARD or (mode == POSITION and way > 0) else -1
        if s[VMAX] == 0 or (mode == POSITION and way == 0):
            return 0
        if (direction < 0 and s[LSTOP]) or (direction > 0 and s[RSTOP]):
            return 0
        if mode == POSITION and s[HEADING] == -direction:
            s[LATCHED] |= _SECOND_MOVE
        s[HEADING] = 0
        u = min(s[VSTART], s[VMAX])
        if mode != POSITION:
            return _move(s, direction, min(u + s[AMAX], s[VMAX]))
    elif (direction < 0 and s[LSTOP]) or (direction > 0 and s[RSTOP]):
        return _move(s, direction, _brake(s, u, more) if s[SW] & _SOFT_STOP else 0)
    if mode == POSITION:
        left = direction * way * (1 << STEP_BITS) - s[ACC]
        lowest = _slower(s, u, more)
        if left <= 0 or s[VMAX] == 0:
            u = 0 if lowest < s[VSTOP] or lowest <= 0 else lowest
            if u == 0 and way != 0:
                s[HEADING] = direction
            return _move(s, direction, u)
        wanted = _faster(s, u, more)
        if wanted > s[VMAX]:
            wanted = s[VMAX]
        new = wanted
        if left <= (wanted + f[BRAKE_SQUARE] * wanted * wanted + f[BRAKE_REST]) * BRAKE_MARGIN + 2.0:
            new = min(wanted, allowed(s, left, 0, more))  # a root and divisions, near the target only
        if more and s[TVMAX]:
            new = _by_tvmax(s, u if v != 0 else 0, wanted, new, left)
        if v != 0:  # a start takes no more of VSTART than the way allows
            new = max(new, lowest)
        if new >= left and new <= s[VSTOP] + max(s[DMAX], s[D1], s[D2] if more and s[V2] > s[V1] else 0):
            s[ACC] = 0
            s[X] = s[XT]
            s[V] = 0
            s[ZWAIT] = s[TZERO]
            return way
        return _move(s, direction, new)
    if mode == HOLD_MODE:
        return _move(s, direction, u)
    if direction == (1 if mode == FORWARD else -1) and s[VMAX] > 0:
        u = min(u + s[AMAX], s[VMAX]) if u < s[VMAX] else max(u - s[AMAX], s[VMAX])
        return _move(s, direction, u)
    u -= s[AMAX]
    return _move(s, direction, 0 if u < s[VSTOP] or u <= 0 else u)


@compiled
def _by_tvmax(s: Cells, u: int, wanted: int, new: int, left: int) -> int:
    """The speed of a positioning motor that goes at `u` and may go at `new`, where TVMAX has a part in it.

    wanted : one tick of acceleration on; new : that, or what the way left allows without TVMAX
    """
    if new > u:
        if s[SLOPE] < 0 and s[VWAIT] > 0:
            return u
        return max(min(wanted, allowed(s, left, s[TVMAX], True)), u)
    return u if s[SLOPE] > 0 and s[VWAIT] > 0 else new


@compiled
def _keep_slope(s: Cells, before: int, u: int) -> None:
    """Note which way the speed changed to `u`: TVMAX counts from there."""
    if u == 0:
        s[VWAIT] = s[SLOPE] = 0
    elif u != before:
        s[SLOPE] = 1 if u > before else -1
        s[VWAIT] = s[TVMAX]
    elif s[VWAIT] > 0:
        s[VWAIT] -= 1


@inlined
def _move(s: Cells, direction: int, u: int) -> int:
    """Go on for one tick at speed `u`; at 0 the wait begins and what was left of a step is dropped."""
    if u == 0:
        if s[V] != 0:
            s[V] = 0
            s[ZWAIT] = s[TZERO]
        s[ACC] = 0
        return 0
    s[V] = direction * u
    u += s[ACC]
    s[ACC] = u & ((1 << STEP_BITS) - 1)
    steps = direction * (u >> STEP_BITS)
    s[X] = wrap32(s[X] + steps)
    return steps


@inlined
def _deviates(s: Cells) -> bool:
    """Whether an encoder holds the motor."""
    return (s[INTERNAL + E_EXCEEDED] & s[INTERNAL + E_STOPS] | s[EXTERNAL + E_EXCEEDED] & s[EXTERNAL + E_STOPS]) != 0


# --- driver --------------------------------------------------------------------------------------


@inlined
def _sequence(s: Cells, steps: int) -> None:
    """Steps turn the field. With intpol a step is spread over the time to the next one, so it lags by one."""
    mres = s[MRES]
    s[FIELD] += s[SHAFT] * steps * (1 << mres)
    look = s[FIELD]
    if s[INTPOL] and mres and s[V] != 0:
        behind = (1 << mres) - ((s[ACC] << mres) >> STEP_BITS)
        look -= s[SHAFT] * behind if s[V] > 0 else -s[SHAFT] * behind
    s[LOOK] = look


@inlined
def _compared(velocity: int) -> int:
    """What velocity thresholds look at: bits 22..8 of a velocity (9 fraction bits)."""
    return velocity >> VELOCITY_BITS + 8


@compiled
def at_high_velocity(s: Cells) -> None:
    """What is different from the high velocity on: full steps, and another chopper; DcStep from its least velocity."""
    speed = _compared(abs(s[V]))
    s[DCSTEP] = s[VDCMIN] != 0 and speed >= _compared(s[VDCMIN])
    high = s[TSTEP] <= s[THIGH]
    if s[COOL_V] >= 0:
        high = s[V] != 0 and speed >= _compared(s[HIGH_V])
    if s[DCSTEP]:  # "triggers the same actions as exceeding THIGH" (DS-TMC5160, VDCMIN)
        high = True
        s[STEALTH] = 0
    else:
        s[DC_TICKS] = s[DC_HELD] = s[DC_LOST] = 0
    s[FULL] = s[DCSTEP] or (high and s[VHIGHFS])
    s[SLOW_ONLY] = high and s[VHIGHCHM]
    apart = s[FULL] or s[OUTSIDE] == BY_CURRENTS
    s[CHOPPER] = CLASSIC if s[CHM] or s[SLOW_ONLY] else IN_FULL_STEPS if apart else REGULATED
    s[AT_HIGH] = s[VHIGHFS] or s[VHIGHCHM] or s[VDCMIN]


@inlined
def _thresholds(s: Cells) -> None:
    """TSTEP and what hangs on it."""
    u = abs(s[V]) << s[MRES]
    tstep = NO_TSTEP if u == 0 else min((1 << 33) // u, NO_TSTEP)
    s[TSTEP] = tstep
    if s[COOL_V] >= 0:
        s[STEALTH] = s[EN_PWM] != 0 and _compared(abs(s[V])) < _compared(s[COOL_V])
    else:
        s[STEALTH] = (
            s[EN_PWM] != 0
            and (s[TPWMTHRS] == 0 or tstep >= s[TPWMTHRS])
            and (tstep > s[TCOOLTHRS] or s[SG4] != 0)
            and tstep > s[THIGH]
        )
    if s[AT_HIGH]:
        at_high_velocity(s)


@inlined
def _in_range(s: Cells) -> bool:
    """Whether CoolStep may work."""
    if s[COOL_V] >= 0:
        return _compared(s[COOL_V]) <= _compared(abs(s[V])) <= _compared(s[HIGH_V])
    return s[TSTEP] <= s[TCOOLTHRS] and s[TSTEP] > s[THIGH] and s[DCSTEP] == 0


@compiled
def _back_to_stealth(s: Cells, f: Floats) -> None:
    """Bound what the regulation begins with as StealthChop takes over again: PWM_LIM its bits 7 to 4, PWM_AMPL all."""
    f[PWM_AUTO] = min(f[PWM_AUTO], s[PWM_LIM] * 16.0 + 15.0 if s[PWM_KIND] == TUNED else float(s[PWM_OFS]))
    s[PWM_STEPS] = 0


@compiled
def _switch_bridges(s: Cells, f: Floats, bridges: int) -> None:
    """Another way to drive the coils from this tick on."""
    if bridges == VOLTAGE:
        _back_to_stealth(s, f)
    s[BRIDGES] = bridges
    s[REST] = s[TUNING] = 0


@compiled
def _varied(s: Cells) -> int:
    """Current scale of a motor in motion, where it is not always IRUN."""
    if s[BOOST] and s[ACTUAL] != 0:
        return s[BOOST] - 1
    if s[SLOW] and not _in_range(s):
        return s[SLOW] - 1
    return s[COOL_CS] if s[SEMIN] else s[IRUN]


@compiled
def _freed(s: Cells) -> bool:
    """Whether the hold current has flowed as long as it may."""
    s[TUNING] = s[DOWN] < s[FREE_AFTER]
    if s[TUNING]:
        s[DOWN] += 1
    return s[DOWN] >= s[FREE_AFTER]


@inlined
def _standing(s: Cells, f: Floats, steps: int) -> int:
    """Standstill and the way from run to hold current; returns events."""
    events = 0
    freed = False
    if steps != 0:
        s[STILL] = s[DOWN] = 0
        s[PHASE] = RUN
    elif s[STILL] < s[STILL_LIMIT]:
        s[STILL] += 1
        s[DOWN] = 0
        if s[STILL] >= s[STILL_LIMIT]:
            events = _EV_STANDSTILL
            s[SG] = 0
            s[SG_VALID] = 0
    elif s[PHASE] == RUN:
        s[DOWN] += 1
        if s[DOWN] >= s[TPOWER]:
            s[PHASE] = RAMPING_DOWN
            s[DOWN] = 0
    elif s[PHASE] == RAMPING_DOWN:
        s[DOWN] += 1
        if s[DOWN] >= s[IHOLDDELAY]:
            s[DOWN] = 0
            s[CS] -= 1
            if s[CS] <= s[IHOLD] or s[IHOLDDELAY] == 0:
                s[PHASE] = HOLD
    if s[PHASE] == RUN:
        wanted = _varied(s) if s[VARIES] else s[IRUN]
        if s[CS] >= wanted or s[IRUNDELAY] == 0:
            s[CS] = wanted
            s[UP] = 0
        else:
            s[UP] += 1
            if s[UP] >= s[IRUNDELAY]:
                s[UP] = 0
                s[CS] += 1
    elif s[PHASE] == HOLD:
        s[CS] = s[IHOLD]
        freed = s[FREE_AFTER] != 0 and _freed(s)
    bridges = s[CHOPPER]
    if s[STEALTH]:
        bridges = VOLTAGE
        if s[PHASE] == HOLD and s[IHOLD] == 0 and s[FREEWHEEL]:
            bridges = OPEN if s[FREEWHEEL] == 1 else SHORTED
    if freed or s[SAGGED] or not s[DRIVER_ON]:
        bridges = OPEN
    if bridges != s[BRIDGES]:
        _switch_bridges(s, f, bridges)
    return events


@inlined
def _coil(f: Floats, i: float, goal: float, emf: float, bridges: int) -> float:
    """Current of a coil one physics step later: the regulator's wish within what the supply can do.

    An open bridge leads what is left of the current back into the supply; a shorted one is no voltage at all. With
    constant off time a current rises with the whole supply, and falls with its share `FALL` besides what resistance
    and back-EMF take.
    """
    free = f[KEEP] * i - f[GAIN] * emf
    if bridges == SHORTED:
        return free
    reach = f[GAIN] * f[SUPPLY]
    if bridges == OPEN:
        wanted = 0.0
    elif bridges == VOLTAGE:
        wanted = free + f[GAIN] * goal
    else:
        wanted = i + f[ALPHA] * (goal - i)
        if abs(goal - wanted) < NANO_AMPERE:
            wanted = goal
        if bridges == CLASSIC:
            on = reach if goal > 0.0 else -reach
            away, back = free + on, free - on * f[FALL]
            return min(max(wanted, min(away, back)), max(away, back))
    return min(max(wanted, free - reach), free + reach)


@inlined
def _flux(f: Floats, sine: float, cosine: float) -> tuple[float, float]:
    """Torque of each coil an ampere, of a motor whose phases are unlike or more than a sine; also its back-EMF."""
    square = sine * sine
    of_a = (f[FLUX_A] - f[FLUX_A3] * square) * cosine
    return of_a, -(f[FLUX_B] + f[FLUX_B3] * square) * sine - f[FLUX_BX] * cosine


@inlined
def _pull(f: Floats, theta: float, omega: float) -> float:
    """One physics step of a load on a spring; the torque with which it pulls at the rotor."""
    before, half = f[LOAD_OMEGA], f[SPRING_PLAY]
    apart = theta - f[LOAD_THETA]
    stretch = max(apart - half, 0.0) + min(apart + half, 0.0)
    pull = 0.0
    if stretch != 0.0 or half == 0.0:
        pull = f[SPRING] * stretch + f[SPRING_DAMPING] * (omega - before)
        if half > 0.0 and pull * stretch < 0.0:  # flanks that part do not hold each other
            pull = 0.0
    new = before + (pull - f[LOAD_TORQUE]) * f[LOAD_DT_J]
    held = f[LOAD_STICTION] if before == 0.0 else f[LOAD_FRICTION]
    if new > held:
        new -= held
    elif new < -held:
        new += held
    else:
        new = 0.0
    f[LOAD_OMEGA] = new
    f[LOAD_THETA] += new * f[DT]
    return pull


@compiled
def _sag(s: Cells, f: Floats) -> bool:
    """Let the supply at the driver follow the current that is drawn from it; whether it stays where it is.

    Voltage and current of the last physics step; what flows back charges nothing.
    """
    volts_a = (f[IA] - f[KEEP] * f[IA0]) / f[GAIN] + f[EMF_A]
    volts_b = (f[IB] - f[KEEP] * f[IB0]) / f[GAIN] + f[EMF_B]
    power = (volts_a * (f[IA] + f[IA0]) + volts_b * (f[IB] + f[IB0])) / 2.0
    drop = 0.0
    if f[SUPPLY] > 0.0:
        drop = min(max(f[SUPPLY_OHM] * power / f[SUPPLY], 0.0), f[SOURCE])
    change = f[SOURCE] - drop - f[SUPPLY]
    stays = abs(change) <= LEAST_SAG
    if not stays:
        f[SUPPLY] += f[SUPPLY_LAG] * change
    s[SAGGED] = f[SUPPLY] < f[LEAST_SUPPLY]
    s[SAG_SEEN] |= s[SAGGED]
    return stays


@inlined
def _turn_by(s: Cells, f: Floats, ref_a: float, ref_b: float, bridges: int, apart: bool) -> None:
    """The physics of one tick, in `SUBSTEPS` steps of semi-implicit Euler; sets REST. `apart`: the load may
    be on a spring and the supply sag, which costs nothing where neither does."""
    theta, omega, ia, ib = f[THETA], f[OMEGA], f[IA], f[IB]
    teeth, kt, td, load = f[TEETH], f[KT], f[TD], f[LOAD]
    uneven, coupled = s[UNEVEN] != 0, apart and s[COUPLED] != 0
    of_a = of_b = 0.0
    dt, dt_j, damp, friction, stiction = f[DT], f[DT_J], f[DAMP], f[FRICTION], f[STICTION]
    at, sine, cosine, lasts = f[ANGLE], f[SINE], f[COSINE], s[WAVE_STEPS]
    torque = 0.0
    resting = True
    for _ in range(s[SUBSTEPS]):
        angle = teeth * theta
        by = angle - at
        if lasts <= 0 or by > MOST_ROTATED or by < -MOST_ROTATED:
            sine, cosine = math.sin(angle), math.cos(angle)
            lasts = WAVE_LASTS
        elif by != 0.0:
            square = by * by
            sin_by = by * (1.0 + square * (-1.0 / 6.0 + square * (1.0 / 120.0 - square * (1.0 / 5040.0))))
            cos_by = 1.0 + square * (-0.5 + square * (1.0 / 24.0 + square * (-1.0 / 720.0 + square * (1.0 / 40320.0))))
            sine, cosine = sine * cos_by + cosine * sin_by, cosine * cos_by - sine * sin_by
            lasts -= 1
        at = angle
        emf_a, emf_b = kt * omega * cosine, -kt * omega * sine
        if uneven:
            of_a, of_b = _flux(f, sine, cosine)
            emf_a, emf_b = omega * of_a, omega * of_b
        new_a = _coil(f, ia, ref_a, emf_a, bridges)
        new_b = _coil(f, ib, ref_b, emf_b, bridges)
        torque = kt * (new_a * cosine - new_b * sine)
        if uneven:
            torque = new_a * of_a + new_b * of_b
        # sin(4e) = 2 sin(2e) cos(2e)
        detent = td * 4.0 * sine * cosine * (1.0 - 2.0 * sine * sine)
        if coupled:
            stood = f[LOAD_OMEGA] == 0.0
            load = _pull(f, theta, omega)
            resting = resting and stood and f[LOAD_OMEGA] == 0.0
        if s[BLOCKED]:
            new = 0.0
        else:
            new = (omega + (torque - detent - load) * dt_j) * damp
            held = stiction if omega == 0.0 else friction
            if new > held:
                new -= held
            elif new < -held:
                new += held
            else:
                new = 0.0
        resting = resting and new == 0.0 and omega == 0.0 and new_a == ia and new_b == ib
        f[IA0], f[IB0], f[EMF_A], f[EMF_B] = ia, ib, emf_a, emf_b
        ia, ib, omega = new_a, new_b, new
        theta += omega * dt
    if f[LOW_END] < f[HIGH_END]:  # once a tick: at 10 turns a second it is a hundredth of a full step too far in
        if coupled:
            if f[LOAD_THETA] < f[LOW_END]:
                f[LOAD_THETA], f[LOAD_OMEGA] = f[LOW_END], max(f[LOAD_OMEGA], 0.0)
            elif f[LOAD_THETA] > f[HIGH_END]:
                f[LOAD_THETA], f[LOAD_OMEGA] = f[HIGH_END], min(f[LOAD_OMEGA], 0.0)
        elif theta < f[LOW_END]:
            theta, omega = f[LOW_END], max(omega, 0.0)
        elif theta > f[HIGH_END]:
            theta, omega = f[HIGH_END], min(omega, 0.0)
    if f[PLAY] > 0.0:
        half = f[PLAY] / 2.0
        f[BEHIND] = min(max(f[BEHIND] + theta - f[THETA], -half), half)
    f[THETA], f[OMEGA], f[IA], f[IB], f[TORQUE] = theta, omega, ia, ib, torque
    f[ANGLE], f[SINE], f[COSINE], s[WAVE_STEPS] = at, sine, cosine, lasts
    f[REF_A], f[REF_B] = ref_a, ref_b
    if apart and f[SUPPLY_OHM] > 0.0:
        resting = _sag(s, f) and resting
    s[REST] = resting


@compiled
def _turn_apart(s: Cells, f: Floats, ref_a: float, ref_b: float) -> None:
    """The physics of one tick with the load on a spring, or a supply that sags."""
    _turn_by(s, f, ref_a, ref_b, s[BRIDGES], True)


@compiled
def turn(s: Cells, f: Floats, ref_a: float, ref_b: float) -> None:
    """The physics of one tick, whatever the bridges do; sets REST."""
    if s[APART]:
        _turn_apart(s, f, ref_a, ref_b)
    else:
        _turn_by(s, f, ref_a, ref_b, s[BRIDGES], False)


@inlined
def _drive_motor(s: Cells, f: Floats, table: Floats) -> None:
    """References from the sequencer, then the regulated motor, unless it rests and nothing has changed."""
    scale = f[FULL_SCALE] * (s[CS] + 1) / 32.0
    look = s[LOOK]
    ref_a = scale * table[CHOPPED + (look & 1023)]
    ref_b = scale * table[CHOPPED + ((look + 256) & 1023)]
    if not s[REST] or ref_a != f[REF_A] or ref_b != f[REF_B]:
        _turn_by(s, f, ref_a, ref_b, REGULATED, False)


# --- DcStep --------------------------------------------------------------------------------------


@compiled
def _commutate(s: Cells, f: Floats, steps: int) -> int:
    """DcStep: the next full step waits until the motor has followed; returns the steps that are made.

    The chip sees it by how long current is let in: what slow decay takes out of a coil, (R i + e) t_off, the supply
    brings back with what it has above that. In the coil that turns round next the back-EMF e is Kt w sin(lag - 45 deg)
    against the current, so its time falls below DC_TIME at a certain lag of the rotor, 45 degrees where DC_TIME is that
    of a coil at rest. That lag is waited for here, within `DC_EARLY` and `DC_LATE`, with the rotor's mean speed since
    the last full step: so a ringing rotor does not mislead it. From then on the velocity is that at which the full step
    went by.

    A full step waits no longer than VDCMIN allows. The motor does not follow where the coil turned round last needs
    current for less than DC_SG: there is no back-EMF.
    """
    s[DC_TICKS] += 1
    way = s[SHAFT] if steps > 0 else -s[SHAFT]
    a_step = 1 << s[MRES]
    at = s[FIELD] >> 8
    if steps == 0 or (s[FIELD] + way * abs(steps) * a_step) >> 8 == at:
        return steps
    angle = f[TEETH] * f[THETA]
    emf = way * f[KT] * (angle - f[DC_MARK]) / (f[TEETH] * s[DC_TICKS] * s[SUBSTEPS] * f[DT])
    drop = abs(f[REF_A]) * (1.0 - f[KEEP]) / f[GAIN]
    t_off = s[T_OFF] * (2.0 if s[SLOW_ONLY] else 1.0)
    speed = (256 >> s[MRES] << STEP_BITS) // s[DC_TICKS]
    if speed > s[VDCMIN]:
        spare = f[SUPPLY] * s[DC_TIME] / (t_off + s[DC_TIME]) - drop
        late = DC_LATE if spare > 0.0 else -DC_EARLY
        if abs(spare) < abs(emf):
            late = min(max(math.asin(spare / abs(emf)), -DC_EARLY), DC_LATE)
        lag = way * ((at * 256 + 128) * (math.pi / 512.0) - angle)
        if s[DC_TIME] < s[T_BLANK] or lag > math.pi / 4.0 + late:
            left = (255 - (s[FIELD] & 255) if way > 0 else s[FIELD] & 255) // a_step
            made = left if steps > 0 else -left
            s[X] = wrap32(s[X] - steps + made)
            s[ACC] = (1 << STEP_BITS) - 1
            s[DC_HELD] = 1
            return made
    used = drop + 0.9 * emf  # the mean of the cosine about its peak
    spare = f[SUPPLY] - used
    s[DC_LOST] = spare > 0.0 and max(t_off * used / spare, float(s[T_BLANK])) < s[DC_SG]
    if s[DC_HELD]:
        speed = max(min(abs(s[V]), speed), s[VDCMIN])
        s[V] = speed if s[V] > 0 else -speed
    s[DC_TICKS] = s[DC_HELD] = 0
    f[DC_MARK] = angle
    return steps


@compiled
def _ramp_with_more(s: Cells, f: Floats) -> int:
    """One tick of a ramp in which V2, TVMAX or DcStep have a part, or of steps from outside: apart, for looks at them
    cost each tick of all."""
    if s[OUTSIDE]:
        return _come_from_outside(s)
    before = abs(s[V])
    steps = _ramp(s, f, True)
    if s[DCSTEP]:
        steps = _commutate(s, f, steps)
    if s[TVMAX]:
        _keep_slope(s, before, abs(s[V]))
    return steps


# --- moved from outside --------------------------------------------------------------------------


@compiled
def _come_from_outside(s: Cells) -> int:
    """One tick of a driver that gets steps or currents: the steps that came. V becomes their mean speed over a full
    step, less as soon as the next one is late, and 0 where none came for the time of standstill."""
    steps = s[COMING]
    s[COMING] = 0
    s[X] = wrap32(s[X] + steps)
    s[GAP] += 1
    s[WINDOW] += 1
    s[MOVED] += steps
    whole = max(256 >> s[MRES], 1)
    if steps == 0:
        if s[GAP] >= s[STILL_LIMIT]:
            s[V] = s[WINDOW] = s[MOVED] = 0
        elif s[V] != 0:
            slowest = (whole << STEP_BITS) // s[WINDOW]
            if slowest < abs(s[V]) // 2:
                s[V] = slowest if s[V] > 0 else -slowest
        return 0
    if s[V] == 0 or (s[V] > 0) != (steps > 0):
        s[V] = (abs(steps) << STEP_BITS) // max(min(s[GAP], s[STILL_LIMIT]), 1) * (1 if steps > 0 else -1)
        s[WINDOW] = s[MOVED] = 0
    elif abs(s[MOVED]) >= whole:
        s[V] = (abs(s[MOVED]) << STEP_BITS) // s[WINDOW] * (1 if s[MOVED] > 0 else -1)
        s[WINDOW] = s[MOVED] = 0
    s[GAP] = 0
    return steps


@compiled
def take_steps(s: Cells, steps: int) -> None:
    """Steps (signed) that have come at STEP since the last call: the next tick makes them."""
    if steps != 0:
        s[COMING] += steps
        s[QUIET] = 0


@compiled
def take_currents(s: Cells, a: int, b: int) -> None:
    """Coil currents (signed, `CURRENT_PEAK` is the peak of the wave) from the next tick on.

    The field goes the shorter way to their angle; two currents of 0 have none.
    """
    if a == s[DIRECT_A] and b == s[DIRECT_B]:
        return
    s[DIRECT_A], s[DIRECT_B] = a, b
    s[QUIET] = s[REST] = 0
    if a != 0 or b != 0:
        at = math.floor(math.atan2(float(a), float(b)) * 512.0 / math.pi)
        s[COMING] += (at - s[FIELD] - s[COMING] + 512 & 1023) - 512


# --- StealthChop ---------------------------------------------------------------------------------


@compiled
def pwm_amplitude(s: Cells, f: Floats) -> float:
    """StealthChop's amplitude now, 0..255 (DS-TMC5160 7.1, 7.4; DS-TMC5130 7.2)."""
    velocity = 0.0 if s[V] == 0 else 256.0 / s[TSTEP]
    if s[PWM_KIND] == TUNED:
        amplitude = s[OFS_AUTO] * (s[CS] + 1) / 32.0 + s[GRAD_AUTO] * velocity
        if s[AUTOSCALE]:
            amplitude += f[PWM_AUTO]
    elif s[AUTOSCALE]:
        amplitude = f[PWM_AUTO]
    else:
        amplitude = s[PWM_OFS] + (s[PWM_GRAD] * velocity if s[PWM_KIND] == AMPLITUDE else 0.0)
    return min(max(amplitude, 0.0), 255.0)


@compiled
def _stealth_volts(s: Cells, f: Floats) -> float:
    """Voltage at the peak of the wave in this tick. A motor at rest is regulated here, one in motion at full steps."""
    if s[AUTOSCALE] and s[V] == 0:
        _regulate_at_rest(s, f)
    else:
        s[PWM_WAIT] = s[PWM_TUNED] = s[TUNING] = 0
    f[PWM_SUM] = pwm_amplitude(s, f)
    return f[SUPPLY] * PWM_PEAK * f[PWM_SUM]


@compiled
def _wished_current(s: Cells, f: Floats) -> float:
    """Current that is regulated to [A]; 0: it is too small to be seen, and the amplitude stays as it was calculated.

    Shorter pulses than the blank time cannot be measured (DS-TMC5160 7.3.1); PWM_OFS 0 forbids what lies below.
    """
    wanted = f[FULL_SCALE] * (s[CS] + 1) / 32.0
    if wanted >= f[PWM_FLOOR]:
        return wanted
    return 0.0 if s[PWM_KIND] == TUNED and s[PWM_OFS] else f[PWM_FLOOR]


@compiled
def _regulate_at_rest(s: Cells, f: Floats) -> None:
    """A standing motor: PWM_OFS_AUTO is measured while the run current flows (AT#1), an amplitude is regulated."""
    tuned = s[PWM_KIND] == TUNED
    if tuned:
        if s[STILL] < s[STILL_LIMIT]:
            return
        f[PWM_AUTO] = 0.0
        if s[CS] != s[IRUN]:
            s[PWM_WAIT] = s[TUNING] = 0
            return
    s[TUNING] = not s[PWM_TUNED] or s[CS] != s[PWM_CS]
    s[PWM_WAIT] += 1
    if s[PWM_WAIT] < (TUNING_TICKS if tuned else REGULATION_TICKS):
        return
    s[PWM_WAIT] = 0
    wanted = _wished_current(s, f)
    current = math.sqrt(f[IA] * f[IA] + f[IB] * f[IB])
    s[PWM_CS] = s[CS]
    if tuned:
        found = s[OFS_AUTO]
        if wanted > 0.0:
            # what cannot be seen is not scaled by, but doubled
            ratio = wanted / current if current >= f[PWM_FLOOR] and current > 0.0 else 2.0
            found = min(math.floor(s[OFS_AUTO] * ratio + 0.5), 255)
            if s[OFS_AUTO] == 0 and current < wanted:
                found = 1
        s[PWM_TUNED] = found == s[OFS_AUTO]
        s[OFS_AUTO] = found
    else:
        s[PWM_TUNED] = not _regulate(s, f, current)
    s[TUNING] = not s[PWM_TUNED]


@compiled
def _regulate(s: Cells, f: Floats, current: float) -> bool:
    """Change the amplitude towards the wished current by what PWM_REG, or PWM_GRAD, allows for a half wave; whether it
    was off by more than half an increment."""
    wanted = _wished_current(s, f)
    if wanted == 0.0:
        f[PWM_AUTO] = 0.0
        return False
    if s[PWM_KIND] == TUNED:
        at_rest, most, low = s[OFS_AUTO] * (s[CS] + 1) / 32.0, s[PWM_REG] / 2.0, -255.0
    else:
        at_rest, most, low = max(f[PWM_SUM], 4.0), s[PWM_GRAD] / 2.0, 0.0
    error = at_rest * (1.0 - current / wanted)
    new = min(max(f[PWM_AUTO] + min(max(PWM_LOOP * error, -most), most), low), 255.0)
    changes = abs(error) > 0.5 and new != f[PWM_AUTO]
    f[PWM_AUTO] = new
    return changes


@compiled
def _stealth_in_motion(s: Cells, f: Floats, current: float) -> None:
    """The regulation at the end of a full step, when one coil has had a half wave; then PWM_GRAD_AUTO (AT#2).

    AT#2 is done at constant velocity, with the run current, where velocity asks for half to three times the amplitude
    at rest; what PWM_GRAD_AUTO takes over the regulation gives away (DS-TMC5160 7.2.1).
    """
    if not s[AUTOSCALE]:
        return
    _regulate(s, f, current)
    if s[PWM_KIND] != TUNED or not s[AUTOGRAD] or s[ACTUAL] != 0 or s[CS] != s[IRUN]:
        return
    at_rest = s[OFS_AUTO] * (s[IRUN] + 1) / 32.0
    if not 1.5 * at_rest < f[PWM_SUM] < min(4.0 * at_rest, 255.0):
        return
    s[PWM_STEPS] += 1
    if s[PWM_STEPS] < TUNING_STEPS:
        return
    s[PWM_STEPS] = 0
    worth = 256.0 / s[TSTEP]
    change = 1 if f[PWM_AUTO] > worth / 2.0 else -1 if f[PWM_AUTO] < -worth / 2.0 else 0
    if 0 <= s[GRAD_AUTO] + change <= 255:
        s[GRAD_AUTO] += change
        f[PWM_AUTO] -= change * worth


@compiled
def _drive_otherwise(s: Cells, f: Floats, table: Floats) -> None:
    """The same where a PWM sets the coils' voltage, in full steps, with constant off time, and without current; with a
    load on a spring, or a supply that sags."""
    bridges = s[BRIDGES]
    wave = CHOPPED if bridges == REGULATED else WAVE
    scale = _stealth_volts(s, f) if bridges == VOLTAGE else f[FULL_SCALE] * (s[CS] + 1) / 32.0
    look = s[LOOK]
    if s[FULL]:  # both coils alike: the middle of the full step
        look = s[FIELD] & ~255 | 128
    ref_a = scale * table[wave + (look & 1023)]
    ref_b = scale * table[wave + ((look + 256) & 1023)]
    if s[OUTSIDE] == BY_CURRENTS:
        ref_a, ref_b = scale * s[DIRECT_A] / CURRENT_PEAK, scale * s[DIRECT_B] / CURRENT_PEAK
    if bridges == CLASSIC:
        f[FALL] = 0.0 if s[SLOW_ONLY] else f[FALL_CHM]
        if not s[SLOW_ONLY]:
            ref_a += scale * f[SINE_OFFSET] * math.copysign(1.0, ref_a)
            ref_b += scale * f[SINE_OFFSET] * math.copysign(1.0, ref_b)
    if not s[REST] or ref_a != f[REF_A] or ref_b != f[REF_B]:
        turn(s, f, ref_a, ref_b)


# --- StallGuard2 and CoolStep --------------------------------------------------------------------


@inlined
def open_window(s: Cells, f: Floats) -> None:
    """StallGuard2 begins to average anew."""
    f[MARK] = f[TEETH] * f[THETA]
    f[SUM_T] = f[SUM_I2] = 0.0
    s[SG_TICKS] = 0
    s[SG_FROM] = s[LOOK]


@compiled
def stall_guard(s: Cells, f: Floats) -> None:
    """A new value at the end of a full step of the field.

    From the torque's share of what the current can hold, how much of the field's way the rotor has followed, and how
    much of the current is really there; the fall with speed below `V_HALF` is the missing back-EMF. What the rotor does
    not follow counts against it, so a clamped shaft has to be lifted far by SGT before it tells anything but 0.
    """
    ticks = max(s[SG_TICKS], 1)
    turned = s[LOOK] - s[SG_FROM]
    followed = (f[TEETH] * f[THETA] - f[MARK]) * 1024.0 / (turned * 2.0 * math.pi)
    current = math.sqrt(f[SUM_I2] / ticks)
    torque = abs(f[SUM_T]) / ticks
    open_window(s, f)
    if s[STEALTH]:
        s[SG_COUNT] = s[SG_SUM] = 0
        if abs(turned) >= 128:
            _stealth_in_motion(s, f, current)
        if not s[SG4]:
            s[COOL_CS] = s[IRUN]
            s[SG] = s[SG_VALID] = 0
            return
    if abs(turned) < 128:
        return  # the rest of the full step in which the motor started says nothing yet
    s[RNG] = (s[RNG] * 0x5DEECE66D + 0xB) & 0xFFFFFFFFFFFF
    speed = abs(s[V]) * f[FS_A_V]
    wanted = f[FULL_SCALE] * (s[CS] + 1) / 32.0
    value = 0.0
    if current > 0.0 and wanted > 0.0:
        followed = min(max(followed, 0.0), 1.0)
        value = f[S0] * speed / (speed + f[V_HALF]) * followed
        value *= min(current / wanted, 1.0) * (1.0 - min(torque / (f[KT] * current), 1.0))
        value -= WITHOUT_EMF * f[S0] * (1.0 - followed)
    value += (f[NOISE] + f[NOISE_V] * speed) * (s[RNG] / float(1 << 47) - 1.0)
    if f[POLES] != 0.0:  # of four full steps one is high, one low
        value += f[POLES] * math.sin((s[LOOK] >> 8) * 0.5 * math.pi)
    if s[STEALTH]:
        _stall_guard_4(s, value)
        return
    value += 8.0 * s[SGT]
    measured = int(min(max(value, 0.0), 1023.0))
    if s[SFILT]:
        s[SG_SUM] += measured
        s[SG_COUNT] += 1
        if s[SG_COUNT] < 4:
            return
        measured = s[SG_SUM] // 4
        s[SG_SUM] = s[SG_COUNT] = 0
    s[SG] = measured
    s[SG_VALID] = 1
    _cool_step(s)


@compiled
def _stall_guard_4(s: Cells, value: float) -> None:
    """A value of StallGuard4: eight bits, told doubled, or with the filter the mean of the latest four."""
    measured = int(min(max(value / 2.0, 0.0), 255.0))
    s[SG4_LAST] = (s[SG4_LAST] << 8 | measured) & 0xFFFFFFFF
    if s[SG4_FILTER]:
        last = s[SG4_LAST]
        measured = ((last & 255) + (last >> 8 & 255) + (last >> 16 & 255) + (last >> 24)) // 4
    s[SG] = 2 * measured
    s[SG_VALID] = 1
    _cool_step(s)


@inlined
def _cool_step(s: Cells) -> None:
    """CoolStep's answer to a new value of StallGuard2, or of StallGuard4 with StealthChop."""
    if s[SEMIN] == 0 or not _in_range(s):
        s[COOL_CS] = s[IRUN]
        s[COOL_DOWN] = 0
        return
    lowest = max((s[IRUN] + 1) // (4 if s[SEIMIN] else 2) - 1, 0)
    if s[SG] < 32 * s[SEMIN]:
        s[COOL_CS] = min(s[COOL_CS] + (1 << s[SEUP]), s[IRUN])
        s[COOL_DOWN] = 0
    elif s[SG] >= 32 * (s[SEMIN] + s[SEMAX] + 1):
        s[COOL_DOWN] += 1
        if s[COOL_DOWN] >= (32, 8, 2, 1)[s[SEDN]]:
            s[COOL_DOWN] = 0
            s[COOL_CS] = max(s[COOL_CS] - 1, lowest)
    else:
        s[COOL_DOWN] = 0


@inlined
def stalled(s: Cells) -> bool:
    """DRV_STATUS.stallGuard: a value of 0 while the motor is driven with SpreadCycle, with StealthChop one of
    StallGuard4 up to twice its threshold, with DcStep what DC_SG finds. Not at standstill (a reading)."""
    if s[DCSTEP]:
        return s[DC_LOST] != 0
    if s[STEALTH]:
        return s[SG4] != 0 and s[SG_VALID] != 0 and s[V] != 0 and s[SG] <= 2 * s[SG4_THRS]
    return s[SG_VALID] != 0 and s[SG] == 0 and s[V] != 0


@inlined
def stall_may_stop(s: Cells) -> bool:
    """Whether the speed is in StallGuard2's range."""
    if s[STALL_V] >= 0:
        return abs(s[V]) >= s[STALL_V]
    if s[COOL_V] >= 0:
        return _in_range(s)
    return s[TSTEP] <= s[TCOOLTHRS]


@compiled
def ramp_stat(s: Cells) -> int:
    """RAMP_STAT."""
    v, mode, way = s[V], s[MODE], wrap32(s[XT] - s[X])
    # the direction it goes or is asked to go; hold mode asks for none
    heading = v
    if v == 0:
        heading = way if mode == POSITION else 1 if mode == FORWARD else -1 if mode == BACKWARD else 0
    word = s[LATCHED] | s[LSEEN] | s[RSEEN] << 1
    if s[LSTOP] and heading < 0:
        word |= 1 << 4
    if s[RSTOP] and heading > 0:
        word |= 1 << 5
    if s[FAST]:
        word |= 1 << 8
    if way == 0:
        word |= 1 << 9
    if v == 0:
        word |= 1 << 10
    if s[ZWAIT] > 0:
        word |= 1 << 11
    if stalled(s) and stall_may_stop(s):
        word |= 1 << 13
    return word | s[VSEEN] << 14


@compiled
def driver_stat(s: Cells) -> int:
    """The part of DRV_STATUS that the cells tell."""
    word = s[SG] | s[CS] << 16
    if s[STEALTH]:
        word |= 1 << 14
    if s[FULL]:
        word |= 1 << 15
    if stalled(s):
        word |= 1 << 24
    if s[STILL] >= s[STILL_LIMIT]:
        word |= 1 << 31
    return word


# --- stage and encoders --------------------------------------------------------------------------


@inlined
def physical(s: Cells, f: Floats) -> int:
    """The switches: 1 left, 2 right, 4 home."""
    theta = f[LOAD_THETA] if s[COUPLED] else f[THETA]
    play, held = f[SWITCH_PLAY], s[PHYS]
    pressed = 0
    if theta <= f[LEFT_AT] + play * (held & 1):
        pressed |= 1
    if theta >= f[RIGHT_AT] - play * (held >> 1 & 1):
        pressed |= 2
    of_home = play * (held >> 2 & 1)
    if f[HOME_FROM] - of_home <= theta <= f[HOME_TO] + of_home:
        pressed |= 4
    return (pressed & ~s[FORCE] | s[FORCED] & s[FORCE]) & s[PINS]


@compiled
def see_switches(s: Cells) -> None:
    """What the ramp generator makes of the switches: SW_MODE's polarity, swap and enable."""
    mode = s[SW]
    left = (s[PHYS] ^ mode >> 2) & 1
    right = (s[PHYS] >> 1 ^ mode >> 3) & 1
    if mode >> 4 & 1:
        left, right = right, left
    s[LSEEN], s[RSEEN] = left, right
    s[LSTOP], s[RSTOP] = left & mode, right & mode >> 1


@compiled
def _see_virtual_stops(s: Cells, f: Floats) -> None:
    """The stops at positions, beside those of the switches: XACTUAL or X_ENC at VIRTUAL_STOP_L or below, at
    VIRTUAL_STOP_R or above. Where the comparison includes the position itself on the left is a reading."""
    see_switches(s)
    place = s[X]
    if s[VIRTUAL] & 4:
        place = position_of(s, EXTERNAL, external_counts(s, f))
    s[VSEEN] = 0
    if s[VIRTUAL] & 1 and place <= s[VLEFT]:
        s[VSEEN] = s[LSTOP] = 1
    if s[VIRTUAL] & 2 and place >= s[VRIGHT]:
        s[VSEEN] |= 2
        s[RSTOP] = 1


@compiled
def _switches_moved(s: Cells, f: Floats, pressed: int) -> None:
    """Switch edges: latches, then stops."""
    left, right = s[LSEEN], s[RSEEN]
    s[PHYS] = pressed
    see_switches(s)
    mode = s[SW]
    latched = 0
    if s[LSEEN] != left and mode >> (5 if s[LSEEN] else 6) & 1:
        latched |= _LATCH_L
    if s[RSEEN] != right and mode >> (7 if s[RSEEN] else 8) & 1:
        latched |= _LATCH_R
    if latched:
        s[LATCHED] |= latched
        s[XLATCH] = s[X]
        if mode >> 9 & 1:
            s[ENC_LATCH] = position_of(s, EXTERNAL, external_counts(s, f))


@inlined
def internal_angle(f: Floats) -> float:
    """The magnet's angle as the encoder sees it [rad], not wrapped."""
    x = f[THETA] + f[SLIP_I] - f[ZERO]
    return x + f[E1] * math.sin(x + f[P1]) + f[E2] * math.sin(2.0 * x + f[P2])


@compiled
def internal_counts(f: Floats) -> int:
    """The same in counts."""
    return math.floor(internal_angle(f) * f[SCALE_I] + 0.5)


@compiled
def external_counts(s: Cells, f: Floats) -> int:
    """Counter behind A and B, not wrapped."""
    if s[RIGID]:
        a_turn, counts = 1024 * int(f[TEETH]), s[EXTERNAL + E_PER_TURN]
        place = s[LOOK] + s[OFFSET] + s[SLIP_M]
        if f[SCALE_E] < 0:
            place = -place
        turns = place // a_turn
        return turns * counts + (2 * (place - turns * a_turn) * counts + a_turn) // (2 * a_turn)
    x = f[THETA] + f[SLIP_E]
    if s[UNTRUE]:
        x -= f[BEHIND]
        x += f[EX1] * math.sin(x + f[PX1]) + f[EX2] * math.sin(2.0 * x + f[PX2])
        x += f[EXS] * math.sin(f[LINES] * x + f[PXS])
    return math.floor(x * f[SCALE_E] + 0.5)


@compiled
def position_of(s: Cells, at: int, counts: int) -> int:
    """Microsteps that an encoder shows for a counter value."""
    moved = (counts - s[at + E_BASE_COUNTS]) * s[at + E_NUM] // s[at + E_DEN]
    return wrap32(s[at + E_BASE] + moved)


@compiled
def _look_at(s: Cells, at: int, counts: int) -> int:
    """Null and deviation of one encoder; returns bit 0 for deviation, bit 2 for null."""
    events = 0
    per_turn = s[at + E_PER_TURN]
    turn = counts // per_turn
    if turn != s[at + E_TURN]:
        if s[at + E_NULL]:
            s[at + E_NULL] = 0
            s[at + E_BASE] = 0
            s[at + E_BASE_COUNTS] = max(turn, s[at + E_TURN]) * per_turn
            events |= _EV_NULL
        s[at + E_TURN] = turn
    if s[at + E_LIMIT] > 0 and not s[at + E_EXCEEDED]:
        deviation = abs(wrap32(s[X] - position_of(s, at, counts)))
        if deviation > s[at + E_LIMIT]:
            s[at + E_EXCEEDED] = 1
            events |= _EV_DEVIATION
    return events


@inlined
def _clearly_fine(s: Cells, at: int, counts: float, ratio: float, bound: float) -> bool:
    """Whether an encoder need not be worked out: no null is waited for, and the angle says that the limit is far."""
    if s[at + E_NULL]:
        return False
    if s[at + E_LIMIT] == 0 or s[at + E_EXCEEDED]:
        return True
    deviation = s[X] - s[at + E_BASE] - (counts - s[at + E_BASE_COUNTS]) * ratio
    return abs(deviation) + bound < s[at + E_LIMIT]


@inlined
def _look_at_both(s: Cells, f: Floats) -> int:
    """Events of both encoders."""
    events = 0
    seen = (f[THETA] + f[SLIP_I] - f[ZERO]) * f[SCALE_I]
    if not _clearly_fine(s, INTERNAL, seen, f[RATIO_I], f[BOUND_I]):
        events = _look_at(s, INTERNAL, internal_counts(f))
    seen = (f[THETA] + f[SLIP_E]) * f[SCALE_E]
    if not _clearly_fine(s, EXTERNAL, seen, f[RATIO_E], f[BOUND_E]):
        events |= _look_at(s, EXTERNAL, external_counts(s, f)) << 1
    return events


@inlined
def n_condition(mode: int, counts: int, per_turn: int) -> bool:
    """Whether N, and A and B unless they are ignored, are as ENCMODE asks. A is high in the middle two counts of a
    line, B in the last two."""
    if (counts % per_turn < N_WIDTH) != (mode >> 2 & 1 != 0):
        return False
    if mode >> 3 & 1:
        return True
    phase = counts & 3
    return (mode & 1 != 0) == (phase == 1 or phase == 2) and (mode >> 1 & 1 != 0) == (phase >= 2)


@inlined
def _n_event(s: Cells, counts: int) -> None:
    """What ENCMODE asks for upon an N event."""
    mode = s[N_MODE]
    s[N_FLAG] = 1
    if mode >> 4 & 1 or s[N_ONCE]:
        s[N_ONCE] = 0
        s[ENC_LATCH] = position_of(s, EXTERNAL, counts)
        if mode >> 9 & 1:
            s[XLATCH] = s[X]
        if mode >> 8 & 1:
            s[EXTERNAL + E_BASE] = 0
            s[EXTERNAL + E_BASE_COUNTS] = counts


@compiled
def n_restart(s: Cells, f: Floats) -> None:
    """Take the N line as it is from here on: an active level counts at once, edges have to come first."""
    mode, counts = s[N_MODE], external_counts(s, f)
    s[N_AT] = counts
    if s[N_HAS] and not mode >> 6 & 3 and n_condition(mode, counts, s[EXTERNAL + E_PER_TURN]):
        _n_event(s, counts)
    n_bounds(s)


@inlined
def n_bounds(s: Cells) -> None:
    """How far the encoder may go until N has to be looked at again, and whether at all."""
    mode, at, per_turn = s[N_MODE], s[N_AT], s[EXTERNAL + E_PER_TURN]
    s[N_ON] = s[N_HAS] and (mode >> 4 & 1 or s[N_ONCE] or not s[N_FLAG])
    s[N_LOW] = s[N_HIGH] = at
    place = at % per_turn
    if mode >> 2 & 1 and place >= N_WIDTH:
        s[N_LOW], s[N_HIGH] = at - place + N_WIDTH, at - place + per_turn - 1


@compiled
def look_for_n(s: Cells, counts: int) -> None:
    """Take the N line through all counts from the last one to this: N may have come and gone between two ticks.

    Where A and B only repeat themselves between two pulses, and turns the turn before, counts are passed over: an
    event latches and clears as the latest two and the first have left it, however many came between.
    """
    mode, per_turn = s[N_MODE], s[EXTERNAL + E_PER_TURN]
    edges = mode >> 6 & 3
    at, way = s[N_AT], 1 if counts > s[N_AT] else -1
    if at > s[N_LOW] or at < s[N_HIGH]:
        at = s[N_HIGH] if way > 0 else s[N_LOW]
    was = n_condition(mode, at, per_turn)
    turns_from, passed = at, 0
    while at != counts:
        if abs(at - turns_from) > 2 * per_turn and abs(counts - at) > 2 * per_turn:
            at += way * ((abs(counts - at) - 2 * per_turn) // per_turn * per_turn)
        if passed >= N_REPEATS:
            place = at % per_turn
            left = min(per_turn - 1 - place if way > 0 else place - N_WIDTH, abs(counts - at))
            if left > 2 * N_REPEATS:
                at += way * ((left - N_REPEATS) // 4 * 4)
                passed = 0
        at += way
        passed = passed + 1 if at % per_turn >= N_WIDTH else 0
        now = n_condition(mode, at, per_turn)
        begins, ends = now and not was, was and not now
        if (edges == 0 and now) or (edges & 1 != 0 and begins) or (edges & 2 != 0 and ends):
            _n_event(s, at)
        was = now
    s[N_AT] = counts
    n_bounds(s)


# --- without physics -----------------------------------------------------------------------------


@compiled
def _follow(s: Cells, f: Floats, table: Floats) -> None:
    """The shaft of a rigid motor is where the field is."""
    look = s[LOOK]
    scale = f[FULL_SCALE] * (s[CS] + 1) / 32.0
    f[IA] = f[IA0] = f[REF_A] = scale * table[look & 1023]
    f[IB] = f[IB0] = f[REF_B] = scale * table[(look + 256) & 1023]
    f[THETA] = (look + s[OFFSET]) * (math.pi / 512.0 / f[TEETH])
    f[OMEGA] = s[SHAFT] * s[V] * f[FS_A_V] * (math.pi / 2.0 / f[TEETH])
    s[REST] = 1


@inlined
def _rigid_load(s: Cells, f: Floats) -> None:
    """StallGuard2 of a motor that nothing can load."""
    speed = abs(s[V]) * f[FS_A_V]
    value = f[S0] * speed / (speed + f[V_HALF])
    if not s[STEALTH]:
        s[SG] = int(min(max(value + 8.0 * s[SGT], 1.0), 1023.0))
    elif s[SG4]:
        _stall_guard_4(s, value)
    else:
        s[SG] = 0


@inlined
def _ahead(target: int, x: int, direction: int) -> int:
    """Steps from `x` to `target` in this direction, 1 to 2^32."""
    return ((direction * (target - x) - 1) & 0xFFFFFFFF) + 1


@inlined
def _steady_steps(s: Cells, f: Floats, direction: int) -> int:
    """Steps that a rigid motor can make before anything but a sum changes; less than one: none."""
    if s[X] == s[XT] or s[INTERNAL + E_LIMIT] or s[INTERNAL + E_NULL] or s[EXTERNAL + E_NULL]:
        return 0
    steps = min(_ahead(s[XT], s[X], direction), _ahead(s[X_COMPARE], s[X], direction)) - 1
    a_step = 1 << s[MRES]
    way = direction * s[SHAFT]
    # the field is behind by up to a step with interpolation, and a microstep is lost to rounding
    spare = 2 * a_step + 2
    microstep = math.pi / 512.0 / f[TEETH]
    for cell, side in ((LEFT_AT, 1.0), (RIGHT_AT, -1.0), (HOME_FROM, -1.0), (HOME_TO, 1.0)):
        for play in (0.0, side * f[SWITCH_PLAY]):
            left = way * (f[cell] + play - f[THETA]) / microstep
            if left > -2.0 and left < 1e12:
                steps = min(steps, (int(left) - spare) // a_step)
    per_turn = s[EXTERNAL + E_PER_TURN]
    counting = way if f[SCALE_E] > 0 else -way
    counts_a_step = a_step * per_turn / (1024.0 * f[TEETH])
    if s[N_ON]:
        left = float(s[N_HIGH] - s[N_AT] if counting > 0 else s[N_AT] - s[N_LOW]) - 2.0
        steps = min(steps, int(left / counts_a_step) - 3)
    if s[EXTERNAL + E_LIMIT] and not s[EXTERNAL + E_EXCEEDED]:
        deviation = abs(wrap32(s[X] - position_of(s, EXTERNAL, external_counts(s, f))))
        a_step_off = abs(1.0 - counting * direction * counts_a_step * f[RATIO_E])
        left = s[EXTERNAL + E_LIMIT] - deviation - f[BOUND_E] - 2.0 * counts_a_step * abs(f[RATIO_E]) - 4.0
        if left < a_step_off * steps:
            steps = int(left / a_step_off) if left > 0 else 0
    return steps


@inlined
def _braking_way(s: Cells, u: float) -> float:
    """From speed `u` down to VSTOP [1/2^25 step]."""
    stop = float(s[VSTOP])
    v1 = float(max(s[V1], s[VSTOP]))
    v2 = max(float(s[V2]), v1) if s[V2] > s[V1] else v1
    brake = max(u * u - v2 * v2, 0.0) / (2.0 * s[DMAX])
    if v2 > v1:
        knee = min(v2, u)
        brake += max(knee * knee - v1 * v1, 0.0) / (2.0 * s[D2])
    if v1 > stop:
        knee = min(v1, u)
        brake += max(knee * knee - stop * stop, 0.0) / (2.0 * s[D1])
    return brake


@compiled
def _repeats(s: Cells, steps: int) -> int:
    """How often the way of the last `steps` to XACTUAL came upon one of the repetitions of X_COMPARE."""
    now = wrap32(s[X] - s[X_COMPARE])
    ahead = now if steps > 0 else -now
    # `ahead` counts the way that was gone: of ahead - way + 1 to ahead each multiple is one
    return ahead // s[X_REPEAT] - (ahead - abs(steps)) // s[X_REPEAT]


@compiled
def _leap(s: Cells, f: Floats, table: Floats, end: int) -> bool:
    """Add up ticks of a rigid motor at constant velocity, at most until `end`; whether there were any."""
    v, u, mode = s[V], abs(s[V]), s[MODE]
    direction = 1 if v > 0 else -1
    # a motor so slow that it counts as standing between two steps has to be seen ticking
    if s[PHASE] != RUN or (1 << STEP_BITS) // u + 2 >= s[STILL_LIMIT]:
        return False
    if s[LATCHED] & _STOP_SG or _deviates(s) or (direction < 0 and s[LSTOP]) or (direction > 0 and s[RSTOP]):
        return False
    if s[VIRTUAL] or (s[IRUNDELAY] and s[CS] < s[IRUN]):
        return False
    ticks = min(end - s[TICK], LONGEST_LEAP)
    if mode == POSITION:
        if u != s[VMAX]:
            return False
        left = direction * wrap32(s[XT] - s[X]) * (1 << STEP_BITS) - s[ACC]
        brake = _braking_way(s, float(u))
        # doubles and their floor in `allowed`: far less than this
        ticks = min(ticks, (left - int(brake) - 8 * u - (1 << 34)) // u)
    elif mode != HOLD_MODE and (u != s[VMAX] or (direction > 0) != (mode == FORWARD)):
        return False
    if ticks < 1:
        return False
    steps = min(_steady_steps(s, f, direction), 1 << 35)
    ticks = min(ticks, ((steps << STEP_BITS) + (1 << STEP_BITS) - 1 - s[ACC]) // u)
    if steps < 0 or ticks < 1:
        return False
    way = s[ACC] + ticks * u
    s[ACC] = way & ((1 << STEP_BITS) - 1)
    steps = way >> STEP_BITS
    s[X] = wrap32(s[X] + direction * steps)
    if s[X_REPEAT] > 1:
        s[PASSED] += _repeats(s, direction * steps)
    s[VWAIT] = max(s[VWAIT] - ticks, 0)
    s[STILL] = s[ACC] // u if steps else s[STILL] + ticks
    s[TICK] += ticks
    _sequence(s, direction * steps)
    _follow(s, f, table)
    if s[N_ON]:
        s[N_AT] = external_counts(s, f)
    return True


# --- time ----------------------------------------------------------------------------------------


@inlined
def _tick(s: Cells, f: Floats, table: Floats) -> int:
    """One tick; returns the events that happened in it."""
    before = s[V]
    events = 0
    if s[VIRTUAL]:
        _see_virtual_stops(s, f)
    stopping = (before < 0 and s[LSTOP]) or (before > 0 and s[RSTOP])
    if stopping and not s[STOPPING]:
        events |= _EV_SWITCH_STOP
    s[STOPPING] = stopping
    waiting = s[ZWAIT]
    steps = _ramp_with_more(s, f) if s[MORE] else _ramp(s, f, False)
    now = s[V]
    s[ACTUAL] = now - before
    if now != before:
        _thresholds(s)
        if s[RIGID]:
            _rigid_load(s, f)
        if now == 0:
            s[ACTUAL] = 0
            events |= _EV_STOPPED
        elif before == 0:
            s[ACTUAL] = 0  # a jump to VSTART is no acceleration, nor one from VSTOP
            open_window(s, f)
            s[SG_VALID] = s[SG_SUM] = s[SG_COUNT] = 0
            s[COOL_CS] = s[IRUN]
            s[COOL_DOWN] = 0
    reached = s[X] == s[XT]
    if reached != s[REACHED]:
        s[REACHED] = reached
        if reached:
            s[LATCHED] |= _POS_REACHED
    if steps != 0:
        if s[X_REPEAT] > 1:
            s[PASSED] += _repeats(s, steps)
        elif 0 < (-1 if steps < 0 else 1) * wrap32(s[X_COMPARE] - s[X] + steps) <= abs(steps):
            s[PASSED] += 1
    arrived = reached and now == 0 and s[MODE] == POSITION
    if arrived and not s[ARRIVED]:
        events |= _EV_POSITION
    s[ARRIVED] = arrived
    if s[MODE] == FORWARD:
        fast = now == s[VMAX]
    elif s[MODE] == BACKWARD:
        fast = now == -s[VMAX]
    else:
        fast = abs(now) == s[VMAX]
    if fast != s[FAST]:
        s[FAST] = fast
        if fast:
            events |= _EV_VELOCITY
    whole = s[LOOK] >> 8
    _sequence(s, steps)
    events |= _standing(s, f, steps)
    if s[RIGID]:
        _follow(s, f, table)
    elif s[BRIDGES] == REGULATED and not s[APART]:
        _drive_motor(s, f, table)
    else:
        _drive_otherwise(s, f, table)
    pressed = physical(s, f)
    if pressed != s[PHYS]:
        events |= (pressed ^ s[PHYS]) * _EV_LEFT
        _switches_moved(s, f, pressed)
    if now != 0 and not s[RIGID]:
        f[SUM_T] += f[TORQUE]
        f[SUM_I2] += f[IA] * f[IA] + f[IB] * f[IB]
        s[SG_TICKS] += 1
        if s[LOOK] >> 8 != whole:
            stall_guard(s, f)
            if s[SW] & _SG_STOP and stalled(s) and stall_may_stop(s):
                s[LATCHED] |= _STOP_SG
                s[V] = s[ACC] = 0
                s[ZWAIT] = s[TZERO]
                _thresholds(s)
                events |= _EV_STALL | _EV_STOPPED
    if s[ENCODERS]:
        events |= _look_at_both(s, f)
    if s[N_ON]:
        counts = external_counts(s, f)
        if counts != s[N_AT]:
            if counts < s[N_LOW] or counts > s[N_HIGH]:
                look_for_n(s, counts)
            else:
                s[N_AT] = counts
    s[STEADY] = s[RIGID] == LEAPS and before == now and now != 0 and events == 0
    still = before == 0 and now == 0 and waiting == 0 and events == 0
    s[QUIET] = still and s[REST] and s[PHASE] == HOLD and not s[TUNING]
    return events


@compiled
def advance(s: Cells, f: Floats, table: Floats, until: int) -> int:
    """Bring the drive to clock `until`, or to the first tick with a watched event; returns those events or 0."""
    end = until // TICK_CLOCKS
    watch = s[WATCH]
    while s[TICK] < end:
        if s[QUIET]:
            s[TICK] = end
            break
        if s[STEADY] and _leap(s, f, table, end):
            continue
        s[TICK] += 1
        events = _tick(s, f, table) & watch
        if events:
            s[CLOCK] = s[TICK] * TICK_CLOCKS
            return events
    s[CLOCK] = until
    return 0


@compiled
def refresh(s: Cells, f: Floats) -> None:
    """Take over what Python wrote into the cells since the last `advance`."""
    s[QUIET] = s[REST] = s[STEADY] = s[PWM_TUNED] = s[TUNING] = 0
    if s[RIGID]:
        # turned by hand or switched on, it comes to rest where the field is
        ahead = f[THETA] * f[TEETH] * 512.0 / math.pi - s[LOOK]
        s[OFFSET] = 1024 * math.floor(ahead / 1024.0 + 0.5)
        s[SLIP_M] = math.floor(f[SLIP_E] * f[TEETH] * 512.0 / math.pi + 0.5)
    s[VARIES] = s[SEMIN] != 0 or s[BOOST] != 0 or s[SLOW] != 0
    s[MORE] = s[V2] != 0 or s[TVMAX] != 0 or s[VDCMIN] != 0 or s[OUTSIDE] != 0
    _bound_braking(s, f)
    s[VSEEN] = 0
    if s[VIRTUAL]:
        _see_virtual_stops(s, f)
    else:
        see_switches(s)
    _thresholds(s)
    if s[X] != s[XT]:
        s[REACHED] = s[ARRIVED] = 0
    if s[N_ON]:  # turned by hand, it is not taken through all counts between
        counts = external_counts(s, f)
        if counts != s[N_AT]:
            s[N_AT] = counts
            n_bounds(s)
    s[ENCODERS] = 0
    for at in (INTERNAL, EXTERNAL):
        s[at + E_TURN] = (internal_counts(f) if at == INTERNAL else external_counts(s, f)) // s[at + E_PER_TURN]
        if s[at + E_LIMIT] > 0 or s[at + E_NULL]:
            s[ENCODERS] = 1
    f[RATIO_I] = s[INTERNAL + E_NUM] / s[INTERNAL + E_DEN]
    f[RATIO_E] = s[EXTERNAL + E_NUM] / s[EXTERNAL + E_DEN]
    # the harmonics, half a count of rounding, a microstep of rounding, and one of each to spare
    f[BOUND_I] = ((abs(f[E1]) + abs(f[E2])) * f[SCALE_I] + 2.0) * abs(f[RATIO_I]) + 2.0
    f[BOUND_E] = ((f[EX1] + f[EX2] + f[EXS] + f[PLAY]) * abs(f[SCALE_E]) + 2.0) * abs(f[RATIO_E]) + 2.0
