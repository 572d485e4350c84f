"""Starts: what triggers them, registers that wait for them, pipeline and shadow registers.

Timing below a tick of 64 clocks is rounded up to it. Which stages and sets there are stands in the fact sheet, 7.
"""

# numpy's stubs type a cell as Any; inside compiled code it is an int64 or a float64 and nothing else.
# mypy: disable-error-code="no-any-return"

from __future__ import annotations

from . import layout as c
from .compiled import compiled, inlined
from .layout import Cells
from .units import signed

_ALL = (
    c.R_VMAX,
    c.R_AMAX,
    c.R_DMAX,
    c.R_ASTART,
    c.R_DFINAL,
    c.R_VBREAK,
    c.R_VSTART,
    c.R_VSTOP,
    c.R_BOW1,
    c.R_BOW1 + 1,
    c.R_BOW1 + 2,
    c.R_BOW1 + 3,
    c.RAMPMODE,
)
_BOWS = (c.R_VMAX, c.R_AMAX, c.R_DMAX, c.R_BOW1, c.R_BOW1 + 1, c.R_BOW1 + 2, c.R_BOW1 + 3)
_WITH_VSTART = (c.R_VMAX, c.R_AMAX, c.R_DMAX, c.R_ASTART, c.R_DFINAL, c.R_VBREAK, c.R_VSTART)
_WITH_VSTOP = (c.R_VMAX, c.R_AMAX, c.R_DMAX, c.R_ASTART, c.R_DFINAL, c.R_VBREAK, c.R_VSTOP)
_SET = 7
_PIPED = (c.XTARGET, c.POS_COMP, c.GEAR_RATIO, c.GENERAL_CONF)


@compiled
def follow(r: Cells, s: Cells) -> None:
    """Act on what is written, but for registers that wait for a start."""
    s[c.PENDING] &= r[c.START_CONF] & 15
    waits = s[c.PENDING]
    if not waits & 1:
        s[c.ACT_XTARGET] = signed(r[c.XTARGET])
    if not waits & 2:
        s[c.ACT_VMAX] = r[c.R_VMAX]
    if not waits & 4:
        s[c.ACT_RAMPMODE] = r[c.RAMPMODE]
    if not waits & 8:
        s[c.ACT_GEAR] = r[c.GEAR_RATIO]


@inlined
def start_pin_active(r: Cells, s: Cells) -> bool:
    """Whether START has its active level, after the filter."""
    return (s[c.SEEN] & c.PIN_START != 0) == (r[c.START_CONF] >> 9 & 1 != 0)


@compiled
def trigger(r: Cells, s: Cells, pin_edge: bool, events: int) -> None:
    """See whether something triggers a start: the edge of START, or new `events` that START_CONF chooses."""
    conf = r[c.START_CONF]
    by_pin = pin_edge and conf >> 5 & 1 and start_pin_active(r, s)
    reached = events & 1 | (events >> 2 & 1) << 1 | (events >> 1 & 1) << 2  # TARGET, VEL, POS_COMP
    if s[c.START_AT] != c.NEVER or not (by_pin or reached & conf >> 6 & 7):
        return
    delay = 0 if by_pin and conf >> 10 & 1 else r[c.START_DELAY]
    s[c.START_AT] = s[c.TICK] + (delay + c.TICK_CLOCKS - 1) // c.TICK_CLOCKS


@inlined
def is_due(r: Cells, s: Cells) -> bool:
    """Whether a start happens now. With busy_state_en it waits until all others let START go."""
    if s[c.START_AT] > s[c.TICK]:
        return False
    return not r[c.START_CONF] >> 11 & 1 or start_pin_active(r, s)


@compiled
def start(r: Cells, s: Cells) -> None:
    """A start: waiting registers count, pipeline and shadow registers move."""
    conf = r[c.START_CONF]
    s[c.START_AT] = c.NEVER
    s[c.STARTED] += 1
    if not conf >> 5 & 1:
        s[c.START_OUT] = s[c.TICK] + (r[c.START_OUT_ADD] + 1 + c.TICK_CLOCKS - 1) // c.TICK_CLOCKS
    s[c.PENDING] = 0
    if conf >> 4 & 1:
        if s[c.MISSED] >= (conf >> 20 & 15):
            s[c.MISSED] = 0
            _shadow(r, conf)
        else:
            s[c.MISSED] += 1
    if conf >> 12 & 15:
        _pipeline(r, conf)
    follow(r, s)


@inlined
def _change_places(r: Cells, register: int, shadow: int, back: int, cyclic: bool) -> None:
    old = r[register]
    r[register] = r[shadow]
    if cyclic:
        r[back] = old


@inlined
def _shadow(r: Cells, conf: int) -> None:
    """Shadow registers replace those of the ramp. Of two sets the second moves up, and the old values behind it."""
    option, cyclic = conf >> 16 & 3, conf >> 18 & 1 != 0
    if option == 0:
        for n in range(len(_ALL)):
            _change_places(r, _ALL[n], c.SH_REG0 + n, c.SH_REG0 + n, cyclic)
        return
    for n in range(_SET):
        first = c.SH_REG0 + n
        if option == 1:
            register = _BOWS[n]
        elif option == 2:
            register = _WITH_VSTART[n]
        else:
            register = _WITH_VSTOP[n]
        old = r[register]
        r[register] = r[first]
        r[first] = r[first + _SET]
        if cyclic:
            r[first + _SET] = old


@compiled
def _pipeline(r: Cells, conf: int) -> None:
    """X_PIPE0..7 move on by one, each segment into its register; XPIPE_REWRITE_REG names stages that get the old value.

    Segments by the number of enabled registers: all 8 stages; from 0 and 4; from 0, 3 and 6; from 0, 2, 4 and 6.
    """
    enabled = conf >> 12 & 15
    rewrite = conf >> 24 & 0xFF
    count = (enabled & 1) + (enabled >> 1 & 1) + (enabled >> 2 & 1) + (enabled >> 3 & 1)
    length = (8, 4, 3, 2)[count - 1]
    begin = 0
    for n in range(4):
        if not enabled >> n & 1:
            continue
        end = min(begin + length, 8)
        old = r[_PIPED[n]]
        r[_PIPED[n]] = r[c.X_PIPE0 + begin]
        for stage in range(begin, end - 1):
            r[c.X_PIPE0 + stage] = r[c.X_PIPE0 + stage + 1]
        for stage in range(begin, end):
            if rewrite >> stage & 1:
                r[c.X_PIPE0 + stage] = old
        begin = end
