"""One reading of all that tells how the axis is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ...links.queue import Priority
from ...registers.model import Register
from ..core.register_io import RegisterIO, Snapshot
from ..core.register_link import RegisterLink
from .memory import DriverMemory
from .resets import Resets
from .roles import FINEST, STANDS


@dataclass(frozen=True, slots=True)
class Reading:
    """What was read, and when, device time [s]."""

    held: Snapshot
    asked_s: float
    time_s: float


@dataclass(frozen=True, slots=True)
class Reader:
    """Reads the driver; whoever keeps something in mind is told."""

    link: RegisterLink
    memory: DriverMemory
    resets: Resets

    async def read_axis(self, priority: Priority = Priority.COMMAND) -> Reading:
        """The axis now, in a turn of its own. Raises LinkError."""
        rows = self.memory.rows
        load, _ = rows.load
        asked = (*rows.remembered, rows.mscnt, rows.tstep, rows.drv_status, load, rows.inputs)
        async with self.link.turn(priority) as turn:
            return await self.read(self.link.io(turn), asked)

    async def read(self, io: RegisterIO, asked: Sequence[Register]) -> Reading:
        """These registers and GSTAT, which comes last: no reset that changed the others can be missing."""
        gstat = self.memory.rows.gstat
        unique = tuple({row.address: row for row in (*asked, gstat)}.values())
        held = Snapshot(unique, await io.read_many(unique))
        reading = Reading(held, io.asked_s, io.time_s)
        await self.resets.check(io, held.word(gstat))  # first: a reset makes forget what was seen before
        self.memory.saw(held)
        return reading

    def speed_pps(self, held: Snapshot) -> float:
        """How fast the motor is stepped, by TSTEP, with its direction [microsteps/s].

        The direction is that of VACTUAL, else of DIR; which of its levels is which way is inferred.
        """
        memory = self.memory
        tstep = held.value(memory.rows.tstep)
        if tstep == STANDS or not tstep:
            return 0.0
        speed = self.link.session.clock_hz / tstep * memory.microsteps / FINEST
        velocity = memory.velocity
        if velocity:
            return speed if velocity > 0 else -speed
        rows = memory.rows
        return -speed if rows.direction_pin.unpack(held.word(rows.inputs)) else speed
