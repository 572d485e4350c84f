"""The step output: pulses, their length, the direction and its setup time, and the way to the field.

A pulse takes STP_LENGTH_ADD + 1 clocks and as long a pause after it (half of that with toggle_step, where each edge is
a step). Steps that come faster merge for the driver: XACTUAL counts them, the field does not turn. Steps in the
DIR_SETUP_TIME after a change of direction are held back and follow as fast as pulses go (DS-TMC4361 8.1).
"""

# numpy's stubs type a cell as Any; inside compiled code it is an int64 or a float64 and nothing else.
# mypy: disable-error-code="no-any-return"

from __future__ import annotations

from .compiled import compiled, inlined
from .layout import (
    DIR,
    DRAIN,
    FIELD,
    FREE,
    GENERAL_CONF,
    HELD,
    READY,
    STEP_CONF,
    STEPS,
    STP_LENGTH,
    TICK,
    TICK_CLOCKS,
    TOO_FAST,
    TURNS,
    Cells,
)


@inlined
def microstep(r: Cells) -> int:
    """What a step turns the field by [1/256 full step]. Where reverse_motor_dir turns it is the sequencer's affair."""
    return 1 << min(r[STEP_CONF] & 15, 8)


@compiled
def send(r: Cells, s: Cells, steps: int) -> None:
    """Send `steps` (signed) in this tick, or hold them back."""
    wanted = s[HELD] + steps
    if wanted == 0:
        s[HELD] = s[DRAIN] = 0
        return
    direction = 1 if wanted > 0 else -1
    now = s[TICK] * TICK_CLOCKS
    if direction != s[DIR]:
        s[DIR] = direction
        s[TURNS] += 1
        setup = r[STP_LENGTH] >> 16 & 0xFFFF
        s[READY] = now - TICK_CLOCKS + setup
        s[DRAIN] = setup > 0
    begin = max(max(s[READY], s[FREE]), now - TICK_CLOCKS)
    if begin >= now:
        waiting = abs(wanted) if s[DRAIN] else min(abs(wanted), 1)
        s[TOO_FAST] += abs(wanted) - waiting
        s[HELD] = direction * waiting
        return
    length = (r[STP_LENGTH] & 0xFFFF) + 1
    period = length if r[GENERAL_CONF] >> 4 & 1 else 2 * length
    count = min(abs(wanted), (now - begin + period - 1) // period)
    s[FREE] = begin + count * period
    left = abs(wanted) - count
    if left == 0:
        s[DRAIN] = 0
    elif left > 1 and not s[DRAIN]:  # one may wait for the next tick: that is no more than rounding
        s[TOO_FAST] += left - 1
        left = 1
    s[HELD] = direction * left
    s[STEPS] += count
    s[FIELD] += direction * count * microstep(r)
