"""The clockwork of an emulated TMC4361: it brings the chip, and what hangs on it, to an absolute clock.

A tick is 64 clocks: the inputs pass their filters, the ramp generator takes its place in its plan and sends the steps
to get there, stops and compare positions are looked at, starts happen, flags become events. The feedback unit and the
motor have every second tick. Where nothing moves and nothing is due the ticks are passed over, which changes no bit;
so it makes no difference in how many pieces time is advanced.

A write takes effect at once, from the state of the latest tick: no time passes between two datagrams of a
test, and a flag read after a write is of after the write.
"""

# numpy's stubs type a cell as Any; inside compiled code it is an int64 or a float64 and nothing else.
# mypy: disable-error-code="no-any-return"

from __future__ import annotations

import math

import numpy as np

from .compiled import compiled, inlined
from .feedback import layout as fl
from .feedback.kernel import motor_and_encoder_tick, regulation_tick
from .layout import (
    ACT_RAMPMODE,
    ACT_XTARGET,
    BEYOND,
    CLK_GATING_DELAY,
    CLOCK,
    CLOSED,
    COVER_AT,
    DFREEZE,
    DSTOP,
    DT,
    EVENTS,
    EXT_LEFT,
    EXTERNAL,
    EXTRA,
    FB_CL_MAX,
    FB_ENC_DONE,
    FB_ENC_VEL0,
    FB_LATCH_X,
    FB_N_ACTIVE,
    FB_N_EVENT,
    FB_QUIET,
    FB_SER_DONE,
    FB_SER_FAIL,
    FB_SET_X,
    FB_STALL,
    FB_STATUS_MASK,
    FB_TARGET_OK,
    FEEDBACK,
    FEEDBACK_CLOCKS,
    FIELD,
    FILTER,
    FLAGS,
    FREEZING,
    FROZEN,
    GATE_AT,
    GATED,
    GENERAL_CONF,
    HELD,
    IDLE,
    IDLING,
    INPUTS,
    KIND,
    MOVING,
    NEVER,
    PASSING,
    PIN_FREEZE,
    PIN_START,
    PINS,
    POS_COMP,
    PULSES,
    REFERENCE_CONF,
    REPLAN,
    RESET_CLK_GATING,
    REV_CNT,
    SEEN,
    STALLED,
    STANDBY,
    STANDBY_AT,
    START_AT,
    START_OUT,
    STATUS,
    STDBY_DELAY,
    STEP_CONF,
    STOPPING,
    SURPLUS,
    TICK,
    TICK_CLOCKS,
    TO_ZERO,
    V_OUT,
    VBREAK,
    VMAX,
    VSTALL_LIMIT,
    WAKE,
    X_HOME,
    X_LATCH,
    ZERO_WAIT,
    A,
    Cells,
    Floats,
    V,
    X,
)
from .output import microstep, send
from .pins import XLATCH_DONE, closed, filtered, home_error, latch, levels, stop_pins, track_home, virtual_stops
from .plan import TRAPEZOID
from .ramp import count, decide, distance, external_steps, go_on, slow_down
from .starts import follow, is_due, start, trigger
from .units import signed, take_over

_EV_POS_COMP, _EV_FROZEN, _EV_ENC_DONE, _EV_SER_FAIL, _EV_SER_DONE = 1 << 1, 1 << 10, 1 << 20, 1 << 21, 1 << 23
_EV_COVER_DONE, _EV_STALL, _EV_MOTOR = 1 << 25, 1 << 29, 1 << 30
_FB_PULSES = FB_ENC_DONE | FB_SER_FAIL | FB_SER_DONE | FB_LATCH_X | FB_N_EVENT | FB_SET_X
_STOPS = 0xC3 | 1 << 26
"""What stops in REFERENCE_CONF: the switches, the virtual limits, a stall."""


@inlined
def _heading(f: Floats) -> int:
    return 1 if f[V] > 0.0 else -1 if f[V] < 0.0 else 0


@inlined
def _ramp_state(f: Floats) -> int:
    """RAMP_STATE_F: 0 constant, 1 |v| rising, 2 |v| falling."""
    slope = f[A] * f[V]
    return 1 if slope > 0.0 or (f[V] == 0.0 and f[A] != 0.0) else 2 if slope < 0.0 else 0


# --- flags and events --------------------------------------------------------------------------------------------


@inlined
def _compared(r: Cells, s: Cells, fb: Floats) -> int:
    """How far beyond the compare position the compared one is."""
    conf = r[REFERENCE_CONF]
    mode = conf >> 28 & 3
    if mode == 3:
        return s[REV_CNT] - signed(r[POS_COMP])
    by_encoder = conf >> 25 & 1
    place = int(fb[fl.ENC_POS]) if by_encoder else s[X]
    if mode == 0:
        return signed(place - signed(r[POS_COMP]))
    if mode == 1:
        return signed(place - signed(r[X_HOME]))
    return signed(place - (fb[fl.INTEGERS_AT :].view(np.int64)[fl.LATCH] if by_encoder else s[X_LATCH]))


@compiled
def flags(r: Cells, s: Cells, f: Floats, fb: Floats, pins: int, virtual: int) -> int:
    """STATUS, and the conditions whose rising edges are events; returns the new events of this tick."""
    v = f[V]
    word = s[FEEDBACK]
    ramp_state = _ramp_state(f)
    state = 1 if v > 0.0 else 2 if v < 0.0 else 0
    status = (word & FB_STATUS_MASK) | state << 3 | ramp_state << 5 | pins << 7 | virtual << 9
    if s[X] == s[ACT_XTARGET] and word & FB_TARGET_OK and s[SURPLUS] == 0:
        status |= 1
    if s[BEYOND] == 0:
        status |= 2
    positioning = s[ACT_RAMPMODE] & 4 != 0
    if (abs(v) if positioning else v) == f[VMAX]:
        status |= 4
    stalled = word & FB_STALL != 0 and abs(v) > (r[VSTALL_LIMIT] & 0xFFFFFF)
    if stalled:
        status |= 1 << 11
    if home_error(r, s):
        status |= 1 << 12
    s[STATUS] = status
    now = status & 7 | 1 << (3 + state) | 1 << (6 + ramp_state) | pins << 11 | virtual << 13
    if s[ACT_RAMPMODE] & 3 == TRAPEZOID and f[VBREAK] > 0.0 and abs(v) > f[VBREAK]:
        now |= 1 << 9
    if s[FROZEN]:
        now |= _EV_FROZEN
    now |= (status >> 12 & 1) << 15  # HOME_ERROR
    now |= (word >> 13 & 7) << 17 & (1 << 17 | 1 << 18 | 1 << 19)  # FS_ACTIVE, ENC_FAIL, N_ACTIVE
    if status >> 20 & 15:
        now |= 1 << 24
    if word & FB_ENC_VEL0:
        now |= 1 << 26
    if word & FB_CL_MAX:
        now |= 1 << 27
    now |= (word >> 19 & 1) << 28
    driver = status >> 24 & r[STEP_CONF] >> 16 & 0xFF
    before = s[FLAGS]
    new = now & ~before | s[PULSES]
    if driver & ~(before >> 32):
        new |= _EV_MOTOR
    s[FLAGS] = now | driver << 32
    s[PULSES] = 0
    s[EVENTS] |= new
    return new


# --- writes ------------------------------------------------------------------------------------------------------


@inlined
def _wake(r: Cells, s: Cells) -> None:
    """A change at START lets stopped clocks run again: a choice, as for datagrams."""
    s[GATED] = 0
    s[GATE_AT] = NEVER
    r[RESET_CLK_GATING] &= ~7


@inlined
def _settle(r: Cells, s: Cells, f: Floats, fb: Floats, ramp: bool) -> None:
    """Take over what Python wrote into the cells. `ramp`: into something that the ramp generator goes by."""
    s[IDLE] = 0
    s[FEEDBACK] &= ~FB_QUIET  # of before the write: the unit has its say first, at the next even tick
    s[INPUTS] = levels(r, s, f, fb)
    if s[GATED]:
        if not (s[SEEN] ^ s[INPUTS]) & PIN_START:
            return
        _wake(r, s)
    follow(r, s)
    take_over(r, s, f)
    if r[RESET_CLK_GATING] & 7 == 7 and r[GENERAL_CONF] >> 17 & 1 and s[GATE_AT] == NEVER:
        s[GATE_AT] = s[TICK] + 1 + r[CLK_GATING_DELAY] // TICK_CLOCKS
    if not r[REFERENCE_CONF] >> 26 & 1 or (r[REFERENCE_CONF] >> 27 & 1 and not s[EVENTS] & _EV_STALL):
        s[STALLED] = 0
    if ramp or s[KIND] == IDLING:
        s[REPLAN] = 1


# --- time --------------------------------------------------------------------------------------------------------


@inlined
def _inputs_changed(r: Cells, s: Cells, f: Floats, changed: int) -> None:
    """What switches, START and NFREEZE do when their filters let a change pass."""
    latch(r, s, changed)
    track_home(r, s, changed, _heading(f), False)
    if changed & PIN_START:
        trigger(r, s, True, 0)
    if changed & PIN_FREEZE and not s[SEEN] & PIN_FREEZE and not s[FROZEN]:
        s[FROZEN] = 1
        slow_down(r, s, f, f[DFREEZE], FREEZING)


@inlined
def _feed_back(r: Cells, s: Cells, f: Floats, fb: Floats) -> None:
    """The feedback unit's turn."""
    v = f[V]
    out = regulation_tick(fb, s[X], v)
    f[V_OUT] = out
    if out != v:
        f[EXTRA] += (out - v) * (FEEDBACK_CLOCKS // TICK_CLOCKS) * f[DT] * microstep(r)
        whole = math.floor(f[EXTRA])
        f[EXTRA] -= whole
        s[FIELD] += int(whole)
    state = _ramp_state(f) | (4 if v != 0.0 else 0) | (8 if s[FROZEN] else 0)
    word = motor_and_encoder_tick(fb, s[FIELD], out, s[TICK] * TICK_CLOCKS, s[X], state)
    n_begins = word & ~s[FEEDBACK] & FB_N_ACTIVE
    s[FEEDBACK] = word
    if word & _FB_PULSES or n_begins:
        if word & FB_ENC_DONE:
            s[PULSES] |= _EV_ENC_DONE
        if word & FB_SER_FAIL:
            s[PULSES] |= _EV_SER_FAIL
        if word & FB_SER_DONE:
            s[PULSES] |= _EV_SER_DONE
        if word & FB_LATCH_X:
            s[X_LATCH] = s[X]
            s[PULSES] |= XLATCH_DONE
        if word & FB_N_EVENT or n_begins:  # armed or not, homing waits for it
            track_home(r, s, 0, _heading(f), True)
        if word & FB_SET_X:
            s[X] = int(fb[fl.X_NEW])
            s[REPLAN] = 1
    s[INPUTS] = levels(r, s, f, fb)


@inlined
def _stops(r: Cells, s: Cells, f: Floats, pins: int, virtual: int) -> None:
    """Stops of switches, virtual stops and stalls."""
    conf = r[REFERENCE_CONF]
    closing = closed(r, s, pins, virtual)
    if s[KIND] == IDLING and s[CLOSED] & ~closing:
        s[REPLAN] = 1
    s[CLOSED] = closing
    heading = _heading(f)
    if heading == 0 or s[KIND] not in (MOVING, TO_ZERO):
        return
    ahead = 1 if heading < 0 else 2
    if s[STATUS] >> 11 & 1 and conf >> 26 & 1 and not s[STALLED]:
        s[STALLED] = 1
        s[PULSES] |= _EV_STALL
        slow_down(r, s, f, 0.0, STOPPING)
    elif closing & ahead:
        by_pin = pins >> 1 | pins << 1 if conf >> 4 & 1 else pins
        soft = conf >> 5 & 1 != 0 if by_pin & ahead else conf >> 8 & 3 == 2
        slow_down(r, s, f, f[DSTOP] if soft else 0.0, STOPPING)


@inlined
def _move(r: Cells, s: Cells, f: Floats) -> None:
    """Steps of this tick: from the plan, or from outside."""
    steps = 0
    kind = s[KIND]
    if s[EXT_LEFT] != 0 or kind == EXTERNAL:
        steps = external_steps(r, s, f)
        if kind != EXTERNAL:
            s[REPLAN] |= steps != 0  # sd_indirect_control: the target has moved
            steps = 0
    if kind != IDLING and kind != EXTERNAL:
        steps = go_on(r, s, f)
    if steps != 0:
        count(r, s, f, steps)
    if steps != 0 or s[HELD] != 0:
        send(r, s, steps)
    if kind != IDLING and s[KIND] == IDLING:  # the end of a plan
        s[STANDBY_AT] = s[TICK] + 1 + r[STDBY_DELAY] // TICK_CLOCKS
        s[REPLAN] = 1
        if kind == MOVING and r[REFERENCE_CONF] >> 21 & 1 and s[ACT_RAMPMODE] & 4 and distance(r, s, f) == 0:
            s[PULSES] |= 1  # clr_pos_at_target: XACTUAL is no longer there when flags are looked at
            s[X] = 0


@inlined
def _tick(r: Cells, s: Cells, f: Floats, fb: Floats) -> None:
    """One tick, but for what comes of it."""
    s[TICK] += 1
    tick = s[TICK]
    awake = not s[GATED]
    if awake:
        if s[KIND] != IDLING or s[EXT_LEFT] != 0 or s[HELD] != 0:
            _move(r, s, f)
        if tick == s[ZERO_WAIT]:
            s[REPLAN] = 1
        if tick >= s[COVER_AT]:
            s[COVER_AT] = NEVER
            s[PULSES] |= _EV_COVER_DONE
    if tick & 1 == 0:  # the motor lives on with stopped clocks, too
        _feed_back(r, s, f, fb)
    if awake:
        beyond = s[BEYOND]
        now_beyond = s[BEYOND] = _compared(r, s, fb)
        if (beyond < 0 < now_beyond or now_beyond < 0 < beyond) and abs(now_beyond - beyond) < 1 << 16:
            s[PULSES] |= _EV_POS_COMP  # passed within the tick


@inlined
def _rest(r: Cells, s: Cells) -> None:
    """At rest: standby, clocks that stop, and whether all that follows can be passed over."""
    tick = s[TICK]
    if tick >= s[STANDBY_AT]:
        s[STANDBY] = 1
    if tick >= s[GATE_AT] and (not r[GENERAL_CONF] >> 18 & 1 or s[STANDBY]):
        s[GATED] = 1
    if not s[FEEDBACK] & FB_QUIET or s[HELD] != 0 or s[EXT_LEFT] != 0:
        return
    wake = NEVER
    if not s[GATED]:
        wake = min(s[START_AT], s[COVER_AT])
        for due in (s[START_OUT], s[ZERO_WAIT], s[STANDBY_AT], s[GATE_AT]):
            if tick < due:
                wake = min(wake, due)
        if s[SEEN] != s[INPUTS]:
            for n in range(PINS):
                wake = min(wake, (s[FILTER + n] + TICK_CLOCKS - 1) // TICK_CLOCKS)
    if wake > tick:
        s[IDLE] = 1
        s[WAKE] = wake


@compiled
def advance(r: Cells, s: Cells, f: Floats, fb: Floats, until: int, written: int) -> None:
    """Take over what Python has written (`written`: 0 nothing, 1 something, 2 something that the ramp goes by), then
    bring the chip to clock `until`.
    """
    end = until // TICK_CLOCKS
    if written:
        _settle(r, s, f, fb, written > 1)
        s[BEYOND] = _compared(r, s, fb)
    while written or s[TICK] < end:
        clock = s[CLOCK]
        if not written:
            if s[IDLE]:
                last = min(s[WAKE] - 1, end)
                if last > s[TICK]:
                    s[TICK] = last
                    continue
                s[IDLE] = 0
            _tick(r, s, f, fb)
            clock = s[TICK] * TICK_CLOCKS
        written = 0
        if s[GATED]:
            if s[FEEDBACK] & FB_QUIET:
                s[IDLE], s[WAKE] = 1, NEVER
            continue
        if s[SEEN] != s[INPUTS] or s[PASSING]:
            changed = filtered(r, s, clock)
            if changed:
                _inputs_changed(r, s, f, changed)
        pins = virtual = 0
        if r[REFERENCE_CONF] & _STOPS or s[CLOSED]:
            pins = stop_pins(r, s)
            virtual = virtual_stops(r, s)
            _stops(r, s, f, pins, virtual)
        while True:
            if s[REPLAN]:
                s[REPLAN] = 0
                decide(r, s, f)
                if s[KIND] != IDLING:
                    s[STANDBY], s[STANDBY_AT] = 0, NEVER
            new = flags(r, s, f, fb, pins, virtual)
            if new & 7:
                trigger(r, s, False, new)
            if s[START_AT] > s[TICK] or not is_due(r, s):
                break
            start(r, s)
            take_over(r, s, f)
            s[REPLAN] = 1
            s[BEYOND] = _compared(r, s, fb)
        if s[KIND] == IDLING:
            _rest(r, s)
    s[CLOCK] = until


__all__ = ["advance"]
