"""How the axis of such a driver is, and which chip answers."""

from __future__ import annotations

from dataclasses import dataclass

from ....errors import CannotMove, LinkError, WrongState
from ....links.queue import Priority
from ....links.spi_access import TaggedAccess
from ....registers.tmcdrivers.tmc2660 import FLAGS
from ...core.capabilities import AxisMonitor, Identity, PositionCounter
from ...core.counter import CounterReading
from ...core.results import AxisState, MotionEnd, Switches
from ...core.session import Session
from ...core.signs import Evidence, Sign, Signs, hot, start_up, write
from .memory import FINEST, STANDS, TaggedMemory
from .status import StatusReader

ALL_ONES = 0xF_FFFF
FAULTS = {
    "OT": "the driver is too hot and has switched off",
    "S2GA": "phase A is shorted to ground, and the driver is off",
    "S2GB": "phase B is shorted to ground, and the driver is off",
}
OFF_TIME = 5
SHADOW = "nothing that is written to it can be read: its registers show what was written over this connection"
UNKNOWN = "nothing of it is known: each datagram to this driver writes, and none was sent since it was connected"


@dataclass(frozen=True, slots=True)
class TaggedMonitor(AxisMonitor):
    """Tells how the axis is. Speed and direction no status tells."""

    session: Session
    memory: TaggedMemory
    reader: StatusReader

    async def axis_state(self, axis: int, priority: Priority = Priority.COMMAND) -> AxisState:
        self.session.axis(axis)
        self.session.require_connected()
        flags: dict[str, bool] = {}
        place, time_s = 0, self.session.device_time_s()
        if self.memory.answers:
            status = await self.reader.read_all(priority)
            row, time_s = self.memory.rows.scale, status.time_s
            flags = {name: bool(status.value(row, name)) for name in FLAGS}
            place = (status.value(self.memory.rows.place, "MSTEP") or 0) * (self.memory.microsteps or FINEST) // FINEST
        moving = bool(flags) and not flags[STANDS] and not self.memory.takes_currents
        return AxisState(
            position=place,
            target_position=None,
            velocity_pps=0.0,
            target_velocity_pps=None,
            acceleration_pps2=None,
            position_reached=False,
            moving=moving,
            mode="currents" if self.memory.takes_currents else "step/dir",
            switches=Switches(None, None, None),
            flags=flags,
            time_s=time_s,
        )

    def signs(self, axis: int, state: AxisState) -> Signs:
        self.session.axis(axis)
        memory, rows, when_s = self.memory, self.memory.rows, state.time_s
        faults = tuple(
            Sign(
                cause,
                (Evidence(f"{rows.scale.name}.{name}", "1", when_s),),
                (write(rows.chopper.name, 0, 0, "toff"),) if name.startswith("S2G") else (),
            )
            for name, cause in FAULTS.items()
            if state.flags.get(name)
        )
        warnings = hot(state.flags, "OTPW", "OT", Evidence(f"{rows.scale.name}.OTPW", "1", when_s))
        if not memory.answers:
            return Signs(blocks=(Sign(UNKNOWN, (), (start_up(0),)),))
        if memory.field(rows.chopper, "toff") == 0:
            name = f"{rows.chopper.name}.toff"
            remedies = (start_up(0), write(rows.chopper.name, 0, OFF_TIME, "toff"))
            off = Sign(f"the driver is off ({name} is 0)", (Evidence(name, "0", when_s),), remedies)
            return Signs(faults, warnings, (off,))
        return Signs(faults, warnings)

    def motion_ends(self, axis: int) -> tuple[MotionEnd, ...]:
        self.session.axis(axis)
        return ()


@dataclass(frozen=True, slots=True)
class TaggedPlace(PositionCounter):
    """The place in the microstep table, which nobody can follow: it goes round with every four full steps."""

    session: Session
    memory: TaggedMemory
    reader: StatusReader

    async def poll(self, axis: int) -> CounterReading:
        self.session.axis(axis)
        self.session.require_connected()
        if not self.memory.answers:
            raise CannotMove(UNKNOWN, "write DRVCONF", axis)
        row = self.memory.rows.place
        status = await self.reader.read((row,))
        return CounterReading(
            (status.value(row, "MSTEP") or 0) * (self.memory.microsteps or FINEST) // FINEST, status.asked_s, None
        )

    def counter_bits(self, axis: int) -> int | None:
        self.session.axis(axis)
        return None


@dataclass(frozen=True, slots=True)
class TaggedIdentity(Identity):
    """It has no version, and no register that could be read without being written first."""

    memory: TaggedMemory
    reader: StatusReader

    async def probe(self) -> str:
        title = self.memory.rows.model.title
        if not self.memory.answers:
            await self._write_once_more()
        if not self.memory.answers:
            return f"a {title} may be there: it has nothing that could be read before something is written"
        row = self.memory.rows.scale
        status = await self.reader.read((row,))
        if status.words[row.address] == ALL_ONES:
            raise WrongState(f"no {title} answers here: all bits read 1", "check power, wiring and chip select")
        return f"something that can be a {title} answers"

    async def _write_once_more(self) -> None:
        """After a failure: DRVCONF as it was, as every question writes it; before anything was written, nothing."""
        port, row = self.reader.link.session.port, self.memory.rows.configuration
        word = self.memory.last_configuration
        if word is not None:
            async with self.reader.link.turn() as turn:
                await self.reader.link.io(turn).write(row, word)
            self.memory.sent(row, word)
        elif port.traits.way is not None:
            try:
                await port.traits.way.require_way()
            except LinkError as error:
                self.reader.link.session.link_result(error)  # no frame went out that would have told of it
                raise

    async def refresh(self) -> None:
        """See whether it still answers."""
        await self.probe()

    @property
    def shortcomings(self) -> tuple[str, ...]:
        return (SHADOW,)

    def only_reads(self, frame: bytes) -> bool:
        return self.reader.link.access.is_read(frame)

    async def let_go(self) -> None:
        """The driver does nothing on its own."""


def tagged(access: object) -> bool:
    """Whether registers go by datagrams that say a register by their upper bits."""
    return isinstance(access, TaggedAccess)
