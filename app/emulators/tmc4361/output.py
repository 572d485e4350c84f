"""The step output: pulses, their length, the direction and its setup time, and the way to the field.

A pulse takes STP_LENGTH_ADD + 1 clocks and as long a pause after it (half of that with toggle_step, where each edge is
a step). Steps that come faster merge for the driver: XACTUAL counts them, the field does not turn. Steps in the
DIR_SETUP_TIME after a change of direction are held back and follow as fast as pulses go (DS-TMC4361 8.1).
"""

# numpy's stubs type a cell as Any; inside compiled code it is an int64 or a float64 and nothing else.
# mypy: disable-error-code="no-any-return"

from __future__ import annotations

from . import layout as c
from .compiled import compiled, inlined
from .layout import Cells


@inlined
def microstep(r: Cells) -> int:
    """What a step turns the field by [1/256 full step]. Where reverse_motor_dir turns it is the sequencer's affair."""
    return 1 << min(r[c.STEP_CONF] & 15, 8)


@compiled
def send(r: Cells, s: Cells, steps: int) -> None:
    """Send `steps` (signed) in this tick, or hold them back."""
    wanted = s[c.HELD] + steps
    if wanted == 0:
        s[c.HELD] = s[c.DRAIN] = 0
        return
    direction = 1 if wanted > 0 else -1
    now = s[c.TICK] * c.TICK_CLOCKS
    if direction != s[c.DIR]:
        s[c.DIR] = direction
        s[c.TURNS] += 1
        setup = r[c.STP_LENGTH] >> 16 & 0xFFFF
        s[c.READY] = now - c.TICK_CLOCKS + setup
        s[c.DRAIN] = setup > 0
    begin = max(max(s[c.READY], s[c.FREE]), now - c.TICK_CLOCKS)
    if begin >= now:
        waiting = abs(wanted) if s[c.DRAIN] else min(abs(wanted), 1)
        s[c.TOO_FAST] += abs(wanted) - waiting
        s[c.HELD] = direction * waiting
        return
    length = (r[c.STP_LENGTH] & 0xFFFF) + 1
    period = length if r[c.GENERAL_CONF] >> 4 & 1 else 2 * length
    count = min(abs(wanted), (now - begin + period - 1) // period)
    s[c.FREE] = begin + count * period
    left = abs(wanted) - count
    if left == 0:
        s[c.DRAIN] = 0
    elif left > 1 and not s[c.DRAIN]:  # one may wait for the next tick: that is no more than rounding
        s[c.TOO_FAST] += left - 1
        left = 1
    s[c.HELD] = direction * left
    s[c.STEPS] += count
    s[c.NET] += direction * count
    s[c.FIELD] += direction * count * microstep(r)
