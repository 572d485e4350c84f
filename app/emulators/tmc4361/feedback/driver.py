"""A real driver behind the chip: pulses or current datagrams to it, its status back, and its motor on in time.

What the sources leave open is read like this:

- a current datagram goes out where a current has changed, as soon as the SPI output is free: its 20 or 40 bits and the
  rest of SPI_OUT_BLOCK_TIME after them;
- the driver is asked for its status every 2^POLL_BLOCK_EXP such times, with currents over SPI as with steps (where
  disable_polling ends it), and STATUS 31:24 is what it has told last;
- a scale that is transferred (scale_val_transfer_en) becomes CS = scale / 8, the rest of SGCSCONF stays; of a TMC2130
  IRUN and IHOLD;
- a TMC2130 is asked and told as a TMC26x is, in datagrams of its own: its currents are XDIRECT's;
- each of these makes a COVER_DONE, unless cover_done_only_for_cover keeps that for cover datagrams (STEPPYR);
- freewheeling sends currents of 0; over step and direction it does nothing.
"""

# mypy: disable-error-code="no-any-return"

from __future__ import annotations

from ...drive import kernel as k
from ..compiled import compiled, inlined
from . import layout as c
from .layout import Cells, Floats, bit

CURRENTS = (0, 10, 12)
"""spi_output_format by which a driver behind is told currents, by which it is; the next one is that by steps."""
SCALE_TRANSFER, NO_POLLING, PWM_OUT = 5, 6, 23
BITS = (0, 20, 40)
"""Of a datagram, by driver."""
_SG, _STST = 1 << 0, 1 << 7
"""Of its flags, bit 0 being STATUS 24."""


@inlined
def _datagram_clocks(n: Cells, conf: int) -> int:
    """Clocks of a datagram, and of the rest behind it."""
    return BITS[n[c.DRIVER]] * max((conf >> 20 & 15) + (conf >> 24 & 15), 2) + (conf >> 28 & 15)


@inlined
def _send_currents(n: Cells, conf: int, clock: int) -> bool:
    """Send what has changed, if the output is free; whether nothing is left to send."""
    a, b = n[c.CURRENT_A_SPI], n[c.CURRENT_B_SPI]
    if n[c.FREE]:
        a = b = 0
    if a == n[c.SENT_A] and b == n[c.SENT_B]:
        return True
    if clock < n[c.SEND_AT]:
        return False
    n[c.TOLD] = 1
    n[c.SENT_A], n[c.SENT_B] = a, b
    n[c.SEND_AT] = clock + _datagram_clocks(n, conf)
    if n[k.OUTSIDE] == k.BY_CURRENTS:
        k.take_currents(n, a, b)
    else:
        n[c.STRAY] = 1
    return True


@inlined
def _send_scale(n: Cells) -> None:
    """The current scale of SGCSCONF."""
    scale = n[c.SCALE] >> 3
    if scale != n[k.IRUN]:
        n[c.TOLD] = 1
        n[k.IRUN] = n[k.IHOLD] = n[k.COOL_CS] = scale
        n[k.QUIET] = 0


@inlined
def _now(n: Cells) -> int:
    """The driver's flags as they are."""
    flags = n[c.HOT]
    if k.stalled(n):
        flags |= _SG
    if n[k.STILL] >= n[k.STILL_LIMIT]:
        flags |= _STST
    return flags


@inlined
def _poll(n: Cells, conf: int, form: int, clock: int) -> bool:
    """Ask the driver when it is time; whether nothing new is to be learnt."""
    way = form - CURRENTS[n[c.DRIVER]]
    if (way != 0 and way != 1) or (way == 1 and bit(conf, NO_POLLING)):
        return True
    now = _now(n)
    if clock >= n[c.POLL_AT]:
        n[c.TOLD] = 1
        n[c.POLLED] = now
        n[c.POLL_AT] = clock + _datagram_clocks(n, conf) + (max(conf >> 28 & 15, 1) << (conf >> 8 & 15))
    return now == n[c.POLLED]


@compiled
def drive_behind(fb: Floats, n: Cells, turned: int, clock: int) -> None:
    """One tick of the driver and its motor, every other time: they are worked out every 256 clocks.

    `turned` : what the coils' phase has turned by in this tick [1/256 full step]
    """
    n[c.STEP_REST] += n[c.DIRECTION] * turned
    if clock & (c.MOTOR_CLOCKS - 1) >= c.MOTOR_CLOCKS // 2:
        return
    table = fb[c.TABLE : c.SIZE]
    conf = n[c.SPI_OUT_CONF]
    form = conf & 15
    if n[k.TICK] < clock // k.TICK_CLOCKS - 1:  # what comes now is of this tick, however long it was quiet before
        k.advance(n, fb, table, clock - k.TICK_CLOCKS)
    shift = min(n[c.STEP_CONF] & 15, 8)
    steps = n[c.STEP_REST] >> shift
    n[c.STEP_REST] -= steps << shift
    if steps != 0 and n[k.OUTSIDE] == k.BY_STEPS and not bit(n[c.GENERAL_CONF], PWM_OUT):
        k.take_steps(n, steps)
    settled = True
    by_currents = CURRENTS[n[c.DRIVER]]
    if form == by_currents:
        settled = _send_currents(n, conf, clock)
    elif form == by_currents + 1 and bit(conf, SCALE_TRANSFER):
        _send_scale(n)
    k.advance(n, fb, table, clock)
    n[c.SETTLED] = _poll(n, conf, form, clock) and settled and n[k.QUIET] != 0
