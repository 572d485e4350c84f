"""Why `Drive.advance` came back before its time."""

from __future__ import annotations

import enum
from dataclasses import dataclass


class EventKind(enum.IntFlag):
    """What may happen in a tick; several may fall together. `Drive.watch` says which of them end an `advance`."""

    POSITION_REACHED = 1
    """XACTUAL has become XTARGET in positioning mode and the motor stopped there."""
    STOPPED = 2
    """The ramp generator's velocity has become zero, for whatever reason."""
    SWITCH_LEFT = 4
    """The left switch has changed, either way: see `Drive.switches`. As it is on the stage (or forced)."""
    SWITCH_RIGHT = 8
    SWITCH_HOME = 16
    SWITCH_STOP = 32
    """A stop switch has begun to stop the motor (hard or soft, SW_MODE)."""
    STALL_STOP = 64
    """StallGuard2 has stopped the motor; it stays stopped until RAMP_STAT.event_stop_sg is cleared."""
    DEVIATION_INTERNAL = 128
    """XACTUAL and the internal encoder have come further apart than its limit (and the motor stops, if it is to)."""
    DEVIATION_EXTERNAL = 256
    INTERNAL_NULL = 512
    """The internal encoder has passed its zero while its `clear_on_null` was armed, and was cleared."""
    EXTERNAL_NULL = 1024
    STANDSTILL = 2048
    """No step for 2^20 clocks (DRV_STATUS.stst has become 1)."""
    VELOCITY_REACHED = 4096
    """VACTUAL has become what the ramp generator was asked for (RAMP_STAT.velocity_reached has become 1)."""


@dataclass(frozen=True, slots=True)
class Event:
    """What ended an `advance`."""

    kinds: EventKind
    """Those of `Drive.watch` that happened in this tick."""
    clocks: int
    """When [clocks]: equals `Drive.clocks`, a multiple of `TICK_CLOCKS`."""
    position: int
    """XACTUAL then [microsteps]."""
