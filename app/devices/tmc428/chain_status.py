"""What the drivers of the chain tell: flags in the bits that come back with every datagram (DS-TMC428 9.1).

Where drivers of the chain are devices of their own, each look at an axis has the chain sent once more as it is (a cover
datagram of length 0, DS-TMC428 9.3), and takes what came back. Nothing is waited for: what has not come yet is taken by
the next look. Without such drivers nothing is sent, and the cover registers are left to whoever uses them by hand.
"""

from __future__ import annotations

from ...registers.tmc428.status import STATUS_TMC428
from ...registers.tmcdrivers.tmc2660 import FLAGS
from ..core.register_io import RegisterIO
from ..core.register_link import RegisterLink
from ..core.results import AxisState
from ..core.signs import Evidence, Sign, hot
from .cover import ChainCover
from .interrupts import Interrupts
from .memory import RampMemory

DRIVER_BITS = 20
"""Of a driver whose answer ends with `FLAGS`."""
SLOW_FULLSTEPS_PER_S = 400.0
"""Faster than that flags of open loads tell nothing (DS-TMC2660 6.10, "slow motion"; the figure INFERRED)."""
FAULTS = {
    "OT": "is too hot and has switched off",
    "S2GA": "sees a short to ground at phase A, and is off",
    "S2GB": "sees a short to ground at phase B, and is off",
}
OPEN = ("OLA", "OLB")
STALL = "SG"
_CDGW = 1 << STATUS_TMC428.index("CDGW")


class ChainStatus:
    """The latest flags by axis, and what they mean."""

    def __init__(self, link: RegisterLink, memory: RampMemory, cover: ChainCover, interrupts: Interrupts) -> None:
        self._session = link.session
        self._memory = memory
        self._cover = cover
        self._interrupts = interrupts
        table = link.table
        self._where, self._datagram = table.get("cover_pos_cover_len"), table.get("cover_datagram")
        self._low, self._high = table.get("datagram_low_word"), table.get("datagram_high_word")
        self._asked = False
        self._flags: dict[int, int] = {}

    async def look(self, io: RegisterIO) -> None:
        """Take what came back since the last look, and ask anew. Raises LinkError."""
        named = self._session.driven()
        places = self._cover.places
        if not named or not places or not self._memory.drives_chain:
            self._flags, self._asked = {}, False
            return
        if await self._waits(io):
            return
        if self._asked:
            await self._take(io)
        await io.write(self._where, 0)
        await io.write(self._datagram, 0)
        self._asked = True
        if not await self._waits(io):
            await self._take(io)

    async def _waits(self, io: RegisterIO) -> bool:
        await io.read(self._where)
        return bool(io.status & _CDGW)

    async def _take(self, io: RegisterIO) -> None:
        low, high = await io.read_many((self._low, self._high))
        self._asked = False
        for axis in self._session.driven():
            place = self._cover.places[axis] if axis < len(self._cover.places) else None
            if place is None or place.length != DRIVER_BITS:
                self._flags.pop(axis, None)
                continue
            reply = place.reply(high << 24 | low)
            if reply.known & 0xFF == 0xFF:
                self._flags[axis] = reply.word & 0xFF
                self._interrupts.driver_told(axis, reply.word & 0xFF, io.time_s)

    def flags(self, axis: int) -> dict[str, bool]:
        """By name, `driver_OT`; none where its driver is no device, or has not answered yet."""
        word = self._flags.get(axis)
        return {} if word is None else {f"driver_{name}": bool(word >> bit & 1) for bit, name in enumerate(FLAGS)}

    def faults(self, axis: int, state: AxisState) -> tuple[Sign, ...]:
        """What the driver of the axis has switched off for, and a coil that is not connected."""
        who = self._who(axis)
        found = [
            Sign(f"{who} {what}", (Evidence(f"{who}: {name}", "1", state.time_s),))
            for name, what in FAULTS.items()
            if state.flags.get(f"driver_{name}")
        ]
        open_coils = [name for name in OPEN if state.flags.get(f"driver_{name}")]
        if open_coils and self._slow(axis, state):
            evidence = tuple(Evidence(f"{who}: {name}", "1", state.time_s) for name in open_coils)
            coils = "coils A and B" if len(open_coils) > 1 else f"coil {open_coils[0][-1]}"
            found.append(Sign(f"{who} finds no load at {coils}: is the motor connected?", evidence))
        return tuple(found)

    def warnings(self, axis: int, state: AxisState) -> tuple[Sign, ...]:
        """What the driver of the axis warns of and goes on."""
        who = self._who(axis)
        return hot(state.flags, "driver_OTPW", "driver_OT", Evidence(f"{who}: OTPW", "1", state.time_s), who)

    def stalling(self, axis: int, state: AxisState) -> Sign | None:
        """That the motor does not follow, while it is stepped."""
        if not state.moving or not state.flags.get(f"driver_{STALL}"):
            return None
        who = self._who(axis)
        return Sign(f"{who} tells of a stall: the motor does not follow", (Evidence(f"{who}: SG", "1", state.time_s),))

    def _slow(self, axis: int, state: AxisState) -> bool:
        microsteps = self._memory.microsteps(axis) or 1
        return state.moving and abs(state.velocity_pps) / microsteps <= SLOW_FULLSTEPS_PER_S

    def _who(self, axis: int) -> str:
        return self._session.driven().get(axis, f"the driver of axis {axis}")
