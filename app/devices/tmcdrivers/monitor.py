"""The axis as it is now.

Its position is that in the microstep table, within four full steps: more no register tells. Nobody sees why a motor
came to rest that is stepped from outside.
"""

from __future__ import annotations

from dataclasses import dataclass

from ...links.queue import Priority
from ..core.capabilities import AxisMonitor, LatchedFlags, PositionCounter, Registers
from ..core.counter import CounterReading
from ..core.results import AxisState, MotionEnd, Switches
from ..core.session import Session
from ..core.signs import Signs
from .memory import DriverMemory
from .reader import Reader
from .resets import Resets
from .roles import FINEST
from .signs import signs

NUMBERS = frozenset({"SG_RESULT", "CS_ACTUAL"})
"""Fields of DRV_STATUS that are no flags."""


@dataclass(frozen=True, slots=True)
class Monitor(AxisMonitor):
    """Tells how the axis is."""

    session: Session
    memory: DriverMemory
    reader: Reader
    resets: Resets

    async def axis_state(self, axis: int, priority: Priority = Priority.COMMAND) -> AxisState:
        self.session.axis(axis)
        self.session.require_connected()
        reading = await self.reader.read_axis(priority)
        memory, held = self.memory, reading.held
        rows, speed = memory.rows, self.reader.speed_pps(held)
        velocity = memory.velocity
        flags: dict[str, bool] = {}
        for row in (rows.drv_status, rows.gstat):
            fields = row.unpack(self.resets.shown(row, held.word(row)))
            flags |= {name: bool(value) for name, value in fields.items() if name not in NUMBERS}
        pins = held.fields(rows.inputs)
        flags |= {name: bool(pins[name]) for name in (rows.disable_pin, "DIAG") if name in pins}
        return AxisState(
            position=held.value(rows.mscnt) * memory.microsteps // FINEST,
            target_position=None,
            velocity_pps=speed,
            target_velocity_pps=None if not velocity else velocity * memory.velocity_unit_pps,
            acceleration_pps2=None,
            position_reached=False,
            moving=speed != 0 or bool(velocity),
            mode="velocity" if velocity or (velocity is None and speed) else "step/dir",
            switches=Switches(None, None, None),
            flags=flags,
            time_s=reading.time_s,
        )

    def signs(self, axis: int, state: AxisState) -> Signs:
        self.session.axis(axis)
        return signs(self.memory, self.resets.seen, state)

    def motion_ends(self, axis: int) -> tuple[MotionEnd, ...]:
        self.session.axis(axis)
        return ()


@dataclass(frozen=True, slots=True)
class PlaceInTable(PositionCounter):
    """The place in the microstep table, which nobody can follow: it goes round with every four full steps."""

    session: Session
    memory: DriverMemory
    reader: Reader
    resets: Resets

    async def poll(self, axis: int) -> CounterReading:
        self.session.axis(axis)
        self.session.require_connected()
        before = self.resets.seen
        reading = await self.reader.read_axis()
        place = reading.held.value(self.memory.rows.mscnt) * self.memory.microsteps // FINEST
        return CounterReading(place, reading.asked_s, self.resets.seen > before)

    def counter_bits(self, axis: int) -> int | None:
        self.session.axis(axis)
        return None


@dataclass(frozen=True, slots=True)
class FlagClearing(LatchedFlags):
    """Writes the 1s to GSTAT that it shows, or reads it, where that clears it."""

    memory: DriverMemory
    registers: Registers

    async def clear_flags(self, axis: int, /) -> None:
        row = self.memory.rows.gstat
        shown = await self.registers.read(row.name, None)
        if not row.read_clears:
            await self.registers.write(row.name, None, value=shown.value)
