"""Input pins: levels from the stage and from outside, through the filters of DS-TMC4361 6, and what switches then do.

A switch of the stage makes its pin high where it is pressed. A filter samples every 2^SR clocks, counted from power-on,
and needs FILT_L + 1 equal samples; what has passed counts from the next tick on.
"""

# numpy's stubs type a cell as Any; inside compiled code it is an int64 or a float64 and nothing else.
# mypy: disable-error-code="no-any-return"

from __future__ import annotations

from . import layout as c
from .compiled import compiled, inlined
from .feedback.layout import SHAFT_FULLSTEPS
from .layout import Cells, Floats
from .units import signed

XLATCH_DONE = 1 << 16
_CENTRES = (6, 9)
_FREEZE_CLOCKS = 3


@compiled
def levels(r: Cells, s: Cells, f: Floats, fb: Floats) -> int:
    """The pins as they are. START is pulled to its inactive level, NFREEZE high."""
    place = fb[SHAFT_FULLSTEPS]
    high = c.PIN_FREEZE if r[c.START_CONF] >> 9 & 1 else c.PIN_FREEZE | c.PIN_START
    if place <= f[c.LEFT_AT]:
        high |= c.PIN_STOPL
    if place >= f[c.RIGHT_AT]:
        high |= c.PIN_STOPR
    if f[c.HOME_LOW] <= place <= f[c.HOME_HIGH]:
        high |= c.PIN_HOME
    return high & ~s[c.FORCE] | s[c.FORCED] & s[c.FORCE]


@inlined
def _passes_at(r: Cells, pin: int, clock: int) -> int:
    """The clock at which a level that began at `clock` has passed the filter of its pin."""
    if pin == c.PIN_FREEZE:
        return clock + _FREEZE_CLOCKS
    shift = 16 if pin == c.PIN_START else 8
    word = r[c.INPUT_FILT_CONF] >> shift
    period = 1 << (word & 7)
    return (clock + period - 1) // period * period + (word >> 4 & 7) * period


@compiled
def filtered(r: Cells, s: Cells, clock: int) -> int:
    """Follow the pins' levels; returns which of the filtered ones have changed by `clock`."""
    changed = s[c.PASSING] = 0
    different = s[c.INPUTS] ^ s[c.SEEN]
    for n in range(c.PINS):
        pin = 1 << n
        if not different & pin:
            s[c.FILTER + n] = c.NEVER
            continue
        if s[c.FILTER + n] == c.NEVER:
            s[c.FILTER + n] = _passes_at(r, pin, clock)
        if s[c.FILTER + n] <= clock:
            s[c.FILTER + n] = c.NEVER
            changed |= pin
        else:
            s[c.PASSING] = 1
    s[c.SEEN] ^= changed
    return changed


@inlined
def stop_pins(r: Cells, s: Cells) -> int:
    """Enabled stop switches that are active: 1 STOPL, 2 STOPR."""
    conf = r[c.REFERENCE_CONF]
    active = 0
    if conf & 1 and (s[c.SEEN] & c.PIN_STOPL != 0) == (conf >> 2 & 1 != 0):
        active |= 1
    if conf & 2 and (s[c.SEEN] & c.PIN_STOPR != 0) == (conf >> 3 & 1 != 0):
        active |= 2
    return active


@inlined
def virtual_stops(r: Cells, s: Cells) -> int:
    """Enabled virtual stops that are met: 1 left, 2 right.

    In circular motion with the left limit above the right one the zone between them is closed: the stop on whose side
    it was entered is met.
    """
    conf = r[c.REFERENCE_CONF]
    left, right = signed(r[c.VIRT_STOP_LEFT]), signed(r[c.VIRT_STOP_RIGHT])
    met = (1 if conf >> 6 & 1 and s[c.X] <= left else 0) | (2 if conf >> 7 & 1 and s[c.X] >= right else 0)
    if conf >> 22 & 1 and conf >> 6 & conf >> 7 & 1 and left > right:
        if met != 3:
            s[c.ZONE] = 0
        elif s[c.ZONE] == 0:
            s[c.ZONE] = 2 if s[c.DIR] > 0 else 1
        return s[c.ZONE]
    return met


@compiled
def closed(r: Cells, s: Cells, pins: int, virtual: int) -> int:
    """Directions that no ramp may take: 1 negative, 2 positive.

    A stop closes its direction while it is active, and afterwards until its event is cleared (DS-TMC4361 9.1).
    """
    events = s[c.EVENTS]
    for n in range(2):
        s[c.LBLOCK + n] = pins >> n & 1 or (s[c.LBLOCK + n] and events >> (11 + n) & 1)
        s[c.VLBLOCK + n] = virtual >> n & 1 or (s[c.VLBLOCK + n] and events >> (13 + n) & 1)
    left, right = s[c.LBLOCK], s[c.RBLOCK]
    if r[c.REFERENCE_CONF] >> 4 & 1:  # invert_stop_direction, which virtual stops do not know
        left, right = right, left
    return (1 if left or s[c.VLBLOCK] else 0) | (2 if right or s[c.VRBLOCK] else 0)


@compiled
def latch(r: Cells, s: Cells, changed: int) -> None:
    """X_LATCH at the edges of STOPL and STOPR that REFERENCE_CONF chooses."""
    conf = r[c.REFERENCE_CONF]
    for n in range(2):
        pin = c.PIN_STOPL if n == 0 else c.PIN_STOPR
        if changed & pin:
            active = (s[c.SEEN] & pin != 0) == (conf >> (2 + n) & 1 != 0)
            if conf >> ((11 if active else 10) + 2 * n) & 1:
                s[c.X_LATCH] = s[c.X]
                s[c.PULSES] |= XLATCH_DONE


@inlined
def _home_level(r: Cells, s: Cells) -> int:
    return 1 if s[c.SEEN] & c.PIN_HOME else 0


@inlined
def _found_home(r: Cells, s: Cells, place: int) -> None:
    r[c.X_HOME] = place & 0xFFFFFFFF
    r[c.REFERENCE_CONF] &= ~(1 << 20)
    s[c.PULSES] |= XLATCH_DONE


@compiled
def track_home(r: Cells, s: Cells, changed: int, heading: int, n_event: bool) -> None:
    """start_home_tracking: at the next event that `home_event` describes X_HOME becomes the place of it.

    The four bits of `home_event` draw HOME_REF over the way, from negative to positive positions, with X_HOME in the
    middle: 2 is the rising edge of a high zone, 4 its falling edge, 6 its centre; 13, 11, 9 are those of a low zone;
    3 and 12 have one edge only. 0 is the next N event. A stop switch that is home (bits 14, 15) finds it where it
    becomes active, whatever home_event says: a choice.
    """
    conf = r[c.REFERENCE_CONF]
    if not conf >> 20 & 1:
        s[c.HOME_ENTERED] = 0
        return
    for n in range(2):  # stop_left_is_home, stop_right_is_home
        pin = c.PIN_STOPL if n == 0 else c.PIN_STOPR
        if conf >> (14 + n) & 1 and changed & pin and (s[c.SEEN] & pin != 0) == (conf >> (2 + n) & 1 != 0):
            _found_home(r, s, s[c.X])
            return
    drawn = conf >> 16 & 15
    if drawn == 0:
        if n_event:
            _found_home(r, s, s[c.X])
        return
    if not changed & c.PIN_HOME:
        return
    level = _home_level(r, s)
    if drawn in _CENTRES:
        if level == (drawn >> 1 & 1):
            s[c.HOME_ENTERED], s[c.HOME_AT] = 1, s[c.X]
        elif s[c.HOME_ENTERED]:
            _found_home(r, s, signed(s[c.HOME_AT] + signed(s[c.X] - s[c.HOME_AT]) // 2))
        return
    left, right = drawn >> 2 & 1, drawn >> 1 & 1
    if level == (right if heading > 0 else left) and left != right:
        _found_home(r, s, s[c.X])


@compiled
def home_error(r: Cells, s: Cells) -> bool:
    """HOME_ERROR_F: HOME_REF contradicts the position, outside X_HOME +- HOME_SAFETY_MARGIN.

    Where the level tells the side (3, 12) both sides are judged; a zone is of unknown width, so only that it is met
    elsewhere is an error.
    """
    drawn = r[c.REFERENCE_CONF] >> 16 & 15
    if drawn == 0:
        return False
    away = s[c.X] - signed(r[c.X_HOME])
    if abs(away) <= r[c.HOME_SAFETY_MARGIN] & 0xFFFF:
        return False
    level = _home_level(r, s)
    if drawn in (3, 12):
        return level != (drawn & 1 if away > 0 else drawn >> 3 & 1)
    zone = 1 if drawn in (2, 4, 6) else 0
    return level == zone
