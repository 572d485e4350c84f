"""The simulation kernel of an emulated TMC4361: it brings the chip, and what hangs on it, to an absolute clock.

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

from . import layout as c
from .compiled import compiled, inlined
from .dcstep import made, waits
from .feedback import layout as fl
from .feedback.kernel import motor_and_encoder_tick, regulation_tick
from .layout import Cells, Floats
from .output import microstep, send
from .pins import XLATCH_DONE, closed, filtered, home_error, latch, levels, stop_pins, track_home, virtual_stops
from .plan import TRAPEZOID
from .ramp import count, decide, distance, external_steps, go_on, slow_down
from .starts import follow, is_due, start, trigger
from .units import signed, take_over

_EV_POS_COMP, _EV_FROZEN, _EV_ENC_DONE, _EV_SER_FAIL, _EV_SER_DONE = 1 << 1, 1 << 10, 1 << 20, 1 << 21, 1 << 23
_EV_COVER_DONE, _EV_STALL, _EV_MOTOR = 1 << 25, 1 << 29, 1 << 30
_FB_PULSES = c.FB_ENC_DONE | c.FB_SER_FAIL | c.FB_SER_DONE | c.FB_LATCH_X | c.FB_N_EVENT | c.FB_SET_X | c.FB_SENT
_STOPS = 0xC3 | 1 << 26
"""What stops in REFERENCE_CONF: the switches, the virtual limits, a stall."""


@inlined
def _heading(f: Floats) -> int:
    return 1 if f[c.V] > 0.0 else -1 if f[c.V] < 0.0 else 0


@inlined
def _ramp_state(f: Floats) -> int:
    """RAMP_STATE_F: 0 constant, 1 |v| rising, 2 |v| falling."""
    slope = f[c.A] * f[c.V]
    return 1 if slope > 0.0 or (f[c.V] == 0.0 and f[c.A] != 0.0) else 2 if slope < 0.0 else 0


# --- flags and events --------------------------------------------------------------------------------------------


@inlined
def _compared(r: Cells, s: Cells, fb: Floats) -> int:
    """How far beyond the compare position the compared one is."""
    conf = r[c.REFERENCE_CONF]
    mode = conf >> 28 & 3
    if mode == 3:
        return s[c.REV_CNT] - signed(r[c.POS_COMP])
    by_encoder = conf >> 25 & 1
    place = int(fb[fl.ENC_POS]) if by_encoder else s[c.X]
    if mode == 0:
        return signed(place - signed(r[c.POS_COMP]))
    if mode == 1:
        return signed(place - signed(r[c.X_HOME]))
    return signed(place - (fb[fl.INTEGERS_AT :].view(np.int64)[fl.LATCH] if by_encoder else s[c.X_LATCH]))


@compiled
def flags(r: Cells, s: Cells, f: Floats, fb: Floats, pins: int, virtual: int) -> int:
    """STATUS, and the conditions whose rising edges are events; returns the new events of this tick."""
    v = f[c.V]
    word = s[c.FEEDBACK]
    ramp_state = _ramp_state(f)
    state = 1 if v > 0.0 else 2 if v < 0.0 else 0
    status = (word & c.FB_STATUS_MASK) | state << 3 | ramp_state << 5 | pins << 7 | virtual << 9
    if s[c.X] == s[c.ACT_XTARGET] and word & c.FB_TARGET_OK and s[c.SURPLUS] == 0:
        status |= 1
    if s[c.BEYOND] == 0:
        status |= 2
    positioning = s[c.ACT_RAMPMODE] & 4 != 0
    if (abs(v) if positioning else v) == f[c.VMAX]:
        status |= 4
    stalled = word & c.FB_STALLED != 0 and abs(v) > (r[c.VSTALL_LIMIT] & 0xFFFFFF)
    if stalled:
        status |= 1 << 11
    if home_error(r, s):
        status |= 1 << 12
    s[c.STATUS] = status
    now = status & 7 | 1 << (3 + state) | 1 << (6 + ramp_state) | pins << 11 | virtual << 13
    if s[c.ACT_RAMPMODE] & 3 == TRAPEZOID and f[c.VBREAK] > 0.0 and abs(v) > f[c.VBREAK]:
        now |= 1 << 9
    if s[c.FROZEN]:
        now |= _EV_FROZEN
    now |= (status >> 12 & 1) << 15  # HOME_ERROR
    now |= (word >> 13 & 7) << 17 & (1 << 17 | 1 << 18 | 1 << 19)  # FS_ACTIVE, ENC_FAIL, N_ACTIVE
    if status >> 20 & 15:
        now |= 1 << 24
    if word & c.FB_ENC_VEL0:
        now |= 1 << 26
    if word & c.FB_CL_MAX:
        now |= 1 << 27
    now |= (word >> 19 & 1) << 28
    driver = status >> 24 & r[c.STEP_CONF] >> 16 & 0xFF
    before = s[c.FLAGS]
    new = now & ~before | s[c.PULSES]
    if driver & ~(before >> 32):
        new |= _EV_MOTOR
    s[c.FLAGS] = now | driver << 32
    s[c.PULSES] = 0
    s[c.EVENTS] |= new
    return new


# --- writes ------------------------------------------------------------------------------------------------------


@inlined
def _wake(r: Cells, s: Cells) -> None:
    """A change at START lets stopped clocks run again: a choice, as for datagrams."""
    s[c.GATED] = 0
    s[c.GATE_AT] = c.NEVER
    r[c.RESET_CLK_GATING] &= ~7


@inlined
def _settle(r: Cells, s: Cells, f: Floats, fb: Floats, ramp: bool) -> None:
    """Take over what Python wrote into the cells. `ramp`: into something that the ramp generator goes by."""
    s[c.IDLE] = 0
    s[c.FEEDBACK] &= ~c.FB_QUIET  # of before the write: the unit has its say first, at the next even tick
    s[c.INPUTS] = levels(r, s, f, fb)
    if s[c.GATED]:
        if not (s[c.SEEN] ^ s[c.INPUTS]) & c.PIN_START:
            return
        _wake(r, s)
    follow(r, s)
    take_over(r, s, f)
    if r[c.RESET_CLK_GATING] & 7 == 7 and r[c.GENERAL_CONF] >> 17 & 1 and s[c.GATE_AT] == c.NEVER:
        s[c.GATE_AT] = s[c.TICK] + 1 + r[c.CLK_GATING_DELAY] // c.TICK_CLOCKS
    if not r[c.REFERENCE_CONF] >> 26 & 1 or (r[c.REFERENCE_CONF] >> 27 & 1 and not s[c.EVENTS] & _EV_STALL):
        s[c.STALLED] = 0
    if ramp or s[c.KIND] == c.IDLING:
        s[c.REPLAN] = 1


# --- time --------------------------------------------------------------------------------------------------------


@inlined
def _inputs_changed(r: Cells, s: Cells, f: Floats, changed: int) -> None:
    """What switches, START and NFREEZE do when their filters let a change pass."""
    latch(r, s, changed)
    track_home(r, s, changed, _heading(f), False)
    if changed & c.PIN_START:
        trigger(r, s, True, 0)
    if changed & c.PIN_FREEZE and not s[c.SEEN] & c.PIN_FREEZE and not s[c.FROZEN]:
        s[c.FROZEN] = 1
        slow_down(r, s, f, f[c.DFREEZE], c.FREEZING)


@inlined
def _feed_back(r: Cells, s: Cells, f: Floats, fb: Floats) -> None:
    """The feedback unit's turn."""
    v = f[c.V]
    out = regulation_tick(fb, s[c.X], v)
    f[c.V_OUT] = out
    if out != v:
        f[c.EXTRA] += (out - v) * (c.FEEDBACK_CLOCKS // c.TICK_CLOCKS) * f[c.DT] * microstep(r)
        whole = math.floor(f[c.EXTRA])
        f[c.EXTRA] -= whole
        s[c.FIELD] += int(whole)
    state = _ramp_state(f) | (4 if v != 0.0 else 0) | (8 if s[c.FROZEN] else 0)
    word = motor_and_encoder_tick(fb, s[c.FIELD], out, s[c.TICK] * c.TICK_CLOCKS, s[c.X], state)
    n_begins = word & ~s[c.FEEDBACK] & c.FB_N_ACTIVE
    s[c.FEEDBACK] = word
    if word & _FB_PULSES or n_begins:
        if word & c.FB_ENC_DONE:
            s[c.PULSES] |= _EV_ENC_DONE
        if word & c.FB_SENT:
            s[c.PULSES] |= _EV_COVER_DONE
        if word & c.FB_SER_FAIL:
            s[c.PULSES] |= _EV_SER_FAIL
        if word & c.FB_SER_DONE:
            s[c.PULSES] |= _EV_SER_DONE
        if word & c.FB_LATCH_X:
            s[c.X_LATCH] = s[c.X]
            s[c.PULSES] |= XLATCH_DONE
        if word & c.FB_N_EVENT or n_begins:  # armed or not, homing waits for it
            track_home(r, s, 0, _heading(f), True)
        if word & c.FB_SET_X:
            s[c.X] = int(fb[fl.X_NEW])
            s[c.REPLAN] = 1
    s[c.INPUTS] = levels(r, s, f, fb)


@inlined
def _stops(r: Cells, s: Cells, f: Floats, pins: int, virtual: int) -> None:
    """Stops of switches, virtual stops and stalls."""
    conf = r[c.REFERENCE_CONF]
    closing = closed(r, s, pins, virtual)
    if s[c.KIND] == c.IDLING and s[c.CLOSED] & ~closing:
        s[c.REPLAN] = 1
    s[c.CLOSED] = closing
    heading = _heading(f)
    if heading == 0 or s[c.KIND] not in (c.MOVING, c.TO_ZERO):
        return
    ahead = 1 if heading < 0 else 2
    if s[c.STATUS] >> 11 & 1 and conf >> 26 & 1 and not s[c.STALLED]:
        s[c.STALLED] = 1
        s[c.PULSES] |= _EV_STALL
        slow_down(r, s, f, 0.0, c.STOPPING)
    elif closing & ahead:
        by_pin = pins >> 1 | pins << 1 if conf >> 4 & 1 else pins
        soft = conf >> 5 & 1 != 0 if by_pin & ahead else conf >> 8 & 3 == 2
        slow_down(r, s, f, f[c.DSTOP] if soft else 0.0, c.STOPPING)


@inlined
def _move(r: Cells, s: Cells, f: Floats, fb: Floats) -> None:
    """Steps of this tick: from the plan, or from outside."""
    steps = 0
    kind = s[c.KIND]
    if s[c.EXT_LEFT] != 0 or kind == c.EXTERNAL:
        steps = external_steps(r, s, f)
        if kind != c.EXTERNAL:
            s[c.REPLAN] |= steps != 0  # sd_indirect_control: the target has moved
            steps = 0
    if kind != c.IDLING and kind != c.EXTERNAL:
        if r[c.GENERAL_CONF] >> 21 & 3 and waits(r, s, f, fb):
            s[c.PLAN_TICK] += 1  # the whole plan is that much later
        else:
            steps = go_on(r, s, f)
            made(r, s, steps)
    if steps != 0:
        count(r, s, f, steps)
    if steps != 0 or s[c.HELD] != 0:
        send(r, s, steps)
    if kind != c.IDLING and s[c.KIND] == c.IDLING:  # the end of a plan
        s[c.STANDBY_AT] = s[c.TICK] + 1 + r[c.STDBY_DELAY] // c.TICK_CLOCKS
        s[c.REPLAN] = 1
        if kind == c.MOVING and r[c.REFERENCE_CONF] >> 21 & 1 and s[c.ACT_RAMPMODE] & 4 and distance(r, s, f) == 0:
            s[c.PULSES] |= 1  # clr_pos_at_target: XACTUAL is no longer there when flags are looked at
            s[c.X] = 0


@inlined
def _tick(r: Cells, s: Cells, f: Floats, fb: Floats) -> None:
    """One tick, but for what comes of it."""
    s[c.TICK] += 1
    tick = s[c.TICK]
    awake = not s[c.GATED]
    if awake:
        if s[c.KIND] != c.IDLING or s[c.EXT_LEFT] != 0 or s[c.HELD] != 0:
            _move(r, s, f, fb)
        if tick == s[c.ZERO_WAIT]:
            s[c.REPLAN] = 1
        if tick >= s[c.COVER_AT]:
            s[c.COVER_AT] = c.NEVER
            s[c.PULSES] |= _EV_COVER_DONE
    if tick & 1 == 0:  # the motor lives on with stopped clocks, too
        _feed_back(r, s, f, fb)
    if awake:
        beyond = s[c.BEYOND]
        now_beyond = s[c.BEYOND] = _compared(r, s, fb)
        if (beyond < 0 < now_beyond or now_beyond < 0 < beyond) and abs(now_beyond - beyond) < 1 << 16:
            s[c.PULSES] |= _EV_POS_COMP  # passed within the tick


@inlined
def _rest(r: Cells, s: Cells) -> None:
    """At rest: standby, clocks that stop, and whether all that follows can be passed over."""
    tick = s[c.TICK]
    if tick >= s[c.STANDBY_AT]:
        s[c.STANDBY] = 1
    if tick >= s[c.GATE_AT] and (not r[c.GENERAL_CONF] >> 18 & 1 or s[c.STANDBY]):
        s[c.GATED] = 1
    if not s[c.FEEDBACK] & c.FB_QUIET or s[c.HELD] != 0 or s[c.EXT_LEFT] != 0:
        return
    wake = c.NEVER
    if not s[c.GATED]:
        wake = min(s[c.START_AT], s[c.COVER_AT])
        for due in (s[c.START_OUT], s[c.ZERO_WAIT], s[c.STANDBY_AT], s[c.GATE_AT]):
            if tick < due:
                wake = min(wake, due)
        if s[c.SEEN] != s[c.INPUTS]:
            for n in range(c.PINS):
                wake = min(wake, (s[c.FILTER + n] + c.TICK_CLOCKS - 1) // c.TICK_CLOCKS)
    if wake > tick:
        s[c.IDLE] = 1
        s[c.WAKE] = wake


@compiled
def advance(r: Cells, s: Cells, f: Floats, fb: Floats, until: int, written: int) -> None:
    """Take over what Python has written (`written`: 0 nothing, 1 something, 2 something that the ramp goes by), then
    bring the chip to clock `until`, or while START is watched to the tick in which its output changes.
    """
    end = until // c.TICK_CLOCKS
    put_out = s[c.START_OUT] > s[c.TICK]
    if written:
        _settle(r, s, f, fb, written > 1)
        s[c.BEYOND] = _compared(r, s, fb)
    while written or s[c.TICK] < end:
        clock = s[c.CLOCK]
        if not written:
            if s[c.WATCH] and (s[c.START_OUT] > s[c.TICK]) != put_out:
                s[c.CLOCK] = s[c.TICK] * c.TICK_CLOCKS
                return
            if s[c.IDLE]:
                last = min(s[c.WAKE] - 1, end)
                if last > s[c.TICK]:
                    s[c.TICK] = last
                    continue
                s[c.IDLE] = 0
            _tick(r, s, f, fb)
            clock = s[c.TICK] * c.TICK_CLOCKS
        written = 0
        if s[c.GATED]:
            if s[c.FEEDBACK] & c.FB_QUIET:
                s[c.IDLE], s[c.WAKE] = 1, c.NEVER
            continue
        if s[c.SEEN] != s[c.INPUTS] or s[c.PASSING]:
            changed = filtered(r, s, clock)
            if changed:
                _inputs_changed(r, s, f, changed)
        pins = virtual = 0
        if r[c.REFERENCE_CONF] & _STOPS or s[c.CLOSED]:
            pins = stop_pins(r, s)
            virtual = virtual_stops(r, s)
            _stops(r, s, f, pins, virtual)
        while True:
            if s[c.REPLAN]:
                s[c.REPLAN] = 0
                decide(r, s, f)
                if s[c.KIND] != c.IDLING:
                    s[c.STANDBY], s[c.STANDBY_AT] = 0, c.NEVER
            new = flags(r, s, f, fb, pins, virtual)
            if new & 7:
                trigger(r, s, False, new)
            if s[c.START_AT] > s[c.TICK] or not is_due(r, s):
                break
            start(r, s)
            take_over(r, s, f)
            s[c.REPLAN] = 1
            s[c.BEYOND] = _compared(r, s, fb)
        if s[c.KIND] == c.IDLING:
            _rest(r, s)
    s[c.CLOCK] = until


__all__ = ["advance"]
