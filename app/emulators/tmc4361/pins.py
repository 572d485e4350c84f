"""Input pins: levels from the stage and from outside, through the filters of DS-TMC4361 6, and what switches then do.

A switch of the stage makes its pin high where it is pressed. A filter samples every 2^SR clocks, counted from power-on,
and needs FILT_L + 1 equal samples; what has passed counts from the next tick on.
"""

# numpy's stubs type a cell as Any; inside compiled code it is an int64 or a float64 and nothing else.
# mypy: disable-error-code="no-any-return"

from __future__ import annotations

from .compiled import compiled, inlined
from .feedback.layout import SHAFT_FULLSTEPS
from .layout import (
    DIR,
    EVENTS,
    FILTER,
    FORCE,
    FORCED,
    HOME_AT,
    HOME_ENTERED,
    HOME_HIGH,
    HOME_LOW,
    HOME_SAFETY_MARGIN,
    INPUT_FILT_CONF,
    INPUTS,
    LBLOCK,
    LEFT_AT,
    NEVER,
    PASSING,
    PIN_FREEZE,
    PIN_HOME,
    PIN_START,
    PIN_STOPL,
    PIN_STOPR,
    PINS,
    PULSES,
    RBLOCK,
    REFERENCE_CONF,
    RIGHT_AT,
    SEEN,
    START_CONF,
    VIRT_STOP_LEFT,
    VIRT_STOP_RIGHT,
    VLBLOCK,
    VRBLOCK,
    X_HOME,
    X_LATCH,
    ZONE,
    Cells,
    Floats,
    X,
)
from .units import signed

XLATCH_DONE = 1 << 16
_CENTRES = (6, 9)
_FREEZE_CLOCKS = 3


@compiled
def levels(r: Cells, s: Cells, f: Floats, fb: Floats) -> int:
    """The pins as they are. START is pulled to its inactive level, NFREEZE high."""
    place = fb[SHAFT_FULLSTEPS]
    high = PIN_FREEZE if r[START_CONF] >> 9 & 1 else PIN_FREEZE | PIN_START
    if place <= f[LEFT_AT]:
        high |= PIN_STOPL
    if place >= f[RIGHT_AT]:
        high |= PIN_STOPR
    if f[HOME_LOW] <= place <= f[HOME_HIGH]:
        high |= PIN_HOME
    return high & ~s[FORCE] | s[FORCED] & s[FORCE]


@inlined
def _passes_at(r: Cells, pin: int, clock: int) -> int:
    """The clock at which a level that began at `clock` has passed the filter of its pin."""
    if pin == PIN_FREEZE:
        return clock + _FREEZE_CLOCKS
    shift = 16 if pin == PIN_START else 8
    word = r[INPUT_FILT_CONF] >> shift
    period = 1 << (word & 7)
    return (clock + period - 1) // period * period + (word >> 4 & 7) * period


@compiled
def filtered(r: Cells, s: Cells, clock: int) -> int:
    """Follow the pins' levels; returns which of the filtered ones have changed by `clock`."""
    changed = s[PASSING] = 0
    different = s[INPUTS] ^ s[SEEN]
    for n in range(PINS):
        pin = 1 << n
        if not different & pin:
            s[FILTER + n] = NEVER
            continue
        if s[FILTER + n] == NEVER:
            s[FILTER + n] = _passes_at(r, pin, clock)
        if s[FILTER + n] <= clock:
            s[FILTER + n] = NEVER
            changed |= pin
        else:
            s[PASSING] = 1
    s[SEEN] ^= changed
    return changed


@inlined
def stop_pins(r: Cells, s: Cells) -> int:
    """Enabled stop switches that are active: 1 STOPL, 2 STOPR."""
    conf = r[REFERENCE_CONF]
    active = 0
    if conf & 1 and (s[SEEN] & PIN_STOPL != 0) == (conf >> 2 & 1 != 0):
        active |= 1
    if conf & 2 and (s[SEEN] & PIN_STOPR != 0) == (conf >> 3 & 1 != 0):
        active |= 2
    return active


@inlined
def virtual_stops(r: Cells, s: Cells) -> int:
    """Enabled virtual stops that are met: 1 left, 2 right.

    In circular motion with the left limit above the right one the zone between them is closed: the stop on whose side
    it was entered is met.
    """
    conf = r[REFERENCE_CONF]
    left, right = signed(r[VIRT_STOP_LEFT]), signed(r[VIRT_STOP_RIGHT])
    met = (1 if conf >> 6 & 1 and s[X] <= left else 0) | (2 if conf >> 7 & 1 and s[X] >= right else 0)
    if conf >> 22 & 1 and conf >> 6 & conf >> 7 & 1 and left > right:
        if met != 3:
            s[ZONE] = 0
        elif s[ZONE] == 0:
            s[ZONE] = 2 if s[DIR] > 0 else 1
        return s[ZONE]
    return met


@compiled
def closed(r: Cells, s: Cells, pins: int, virtual: int) -> int:
    """Directions that no ramp may take: 1 negative, 2 positive.

    A stop closes its direction while it is active, and afterwards until its event is cleared (DS-TMC4361 9.1).
    """
    events = s[EVENTS]
    for n in range(2):
        s[LBLOCK + n] = pins >> n & 1 or (s[LBLOCK + n] and events >> (11 + n) & 1)
        s[VLBLOCK + n] = virtual >> n & 1 or (s[VLBLOCK + n] and events >> (13 + n) & 1)
    left, right = s[LBLOCK], s[RBLOCK]
    if r[REFERENCE_CONF] >> 4 & 1:  # invert_stop_direction, which virtual stops do not know
        left, right = right, left
    return (1 if left or s[VLBLOCK] else 0) | (2 if right or s[VRBLOCK] else 0)


@compiled
def latch(r: Cells, s: Cells, changed: int) -> None:
    """X_LATCH at the edges of STOPL and STOPR that REFERENCE_CONF chooses."""
    conf = r[REFERENCE_CONF]
    for n in range(2):
        pin = PIN_STOPL if n == 0 else PIN_STOPR
        if changed & pin:
            active = (s[SEEN] & pin != 0) == (conf >> (2 + n) & 1 != 0)
            if conf >> ((11 if active else 10) + 2 * n) & 1:
                s[X_LATCH] = s[X]
                s[PULSES] |= XLATCH_DONE


@inlined
def _home_level(r: Cells, s: Cells) -> int:
    return 1 if s[SEEN] & PIN_HOME else 0


@inlined
def _found_home(r: Cells, s: Cells, place: int) -> None:
    r[X_HOME] = place & 0xFFFFFFFF
    r[REFERENCE_CONF] &= ~(1 << 20)
    s[PULSES] |= XLATCH_DONE


@compiled
def track_home(r: Cells, s: Cells, changed: int, heading: int, n_event: bool) -> None:
    """start_home_tracking: at the next event that `home_event` describes X_HOME becomes the place of it.

    The four bits of `home_event` draw HOME_REF over the way, from negative to positive positions, with X_HOME in the
    middle: 2 is the rising edge of a high zone, 4 its falling edge, 6 its centre; 13, 11, 9 are those of a low zone;
    3 and 12 have one edge only. 0 is the next N event. A stop switch that is home (bits 14, 15) finds it where it
    becomes active, whatever home_event says: a choice.
    """
    conf = r[REFERENCE_CONF]
    if not conf >> 20 & 1:
        s[HOME_ENTERED] = 0
        return
    for n in range(2):  # stop_left_is_home, stop_right_is_home
        pin = PIN_STOPL if n == 0 else PIN_STOPR
        if conf >> (14 + n) & 1 and changed & pin and (s[SEEN] & pin != 0) == (conf >> (2 + n) & 1 != 0):
            _found_home(r, s, s[X])
            return
    drawn = conf >> 16 & 15
    if drawn == 0:
        if n_event:
            _found_home(r, s, s[X])
        return
    if not changed & PIN_HOME:
        return
    level = _home_level(r, s)
    if drawn in _CENTRES:
        if level == (drawn >> 1 & 1):
            s[HOME_ENTERED], s[HOME_AT] = 1, s[X]
        elif s[HOME_ENTERED]:
            _found_home(r, s, signed(s[HOME_AT] + signed(s[X] - s[HOME_AT]) // 2))
        return
    left, right = drawn >> 2 & 1, drawn >> 1 & 1
    if level == (right if heading > 0 else left) and left != right:
        _found_home(r, s, s[X])


@compiled
def home_error(r: Cells, s: Cells) -> bool:
    """HOME_ERROR_F: HOME_REF contradicts the position, outside X_HOME +- HOME_SAFETY_MARGIN.

    Where the level tells the side (3, 12) both sides are judged; a zone is of unknown width, so only that it is met
    elsewhere is an error.
    """
    drawn = r[REFERENCE_CONF] >> 16 & 15
    if drawn == 0:
        return False
    away = s[X] - signed(r[X_HOME])
    if abs(away) <= r[HOME_SAFETY_MARGIN] & 0xFFFF:
        return False
    level = _home_level(r, s)
    if drawn in (3, 12):
        return level != (drawn & 1 if away > 0 else drawn >> 3 & 1)
    zone = 1 if drawn in (2, 4, 6) else 0
    return level == zone
