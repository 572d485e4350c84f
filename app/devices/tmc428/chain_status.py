"""What the drivers of the chain tell: flags in the bits that come back with every datagram (DS-TMC428 9.1).

Where the chain has drivers whose answers are known (TMC26x that are devices of their own, TMC23x and TMC24x by their
bits in the RAM), each look at an axis has the chain sent once more as it is (a cover datagram of length 0, DS-TMC428
9.3), and takes what came back. Nothing is waited for: what has not come yet is taken by the next look. Nothing
is sent without such drivers, nor where a user has covers of some length go to drivers that are no devices: then what
came back with the latest of those counts.
"""

from __future__ import annotations

from ...registers.tmc428.status import STATUS_TMC428
from ...registers.tmcdrivers import tmc236, tmc2660
from ..core.cover import CoverReply
from ..core.register_io import RegisterIO
from ..core.register_link import RegisterLink
from ..core.results import AxisState
from ..core.signs import Evidence, Sign, hot
from .axis_roles import field_of
from .cover import ChainCover, Place
from .interrupts import Interrupts
from .memory import RampMemory

TMC26X_BITS = 20
"""Of a driver whose answer ends with `tmc2660.FLAGS`."""
SLOW_FULLSTEPS_PER_S = 400.0
"""Faster than that flags of open loads tell nothing (DS-TMC2660 6.10, "slow motion"; the figure INFERRED)."""
FAULTS = {
    "OT": "is too hot and has switched off",
    "S2GA": "sees a short to ground at phase A, and is off",
    "S2GB": "sees a short to ground at phase B, and is off",
    "OCA": "sees too much current in coil A: is it shorted?",
    "OCB": "sees too much current in coil B: is it shorted?",
    "OCHS": "sees too much current on its high side: is a coil shorted to ground?",
    "UV": "has too little supply voltage",
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
        self._length = field_of(self._where, "cover_len")
        self._asked = False
        self._flags: dict[int, dict[str, bool]] = {}
        self._measures: set[int] = set()
        """Axes whose TMC24x has told of a load: of it no load value is a stall, of a TMC23x it is nothing."""

    async def learn(self) -> None:
        """Find out which drivers there are, where that is not known. Raises LinkError."""
        if self._memory.drives_chain:
            await self._cover.learn()

    async def look(self, io: RegisterIO) -> None:
        """Take what came back since the last look, and ask anew. Raises LinkError."""
        told = self._telling() if self._memory.drives_chain else {}
        if not told:
            self._flags, self._asked = {}, False
            self._measures.clear()
            return
        where = await io.read(self._where)
        if io.status & _CDGW:
            return
        covers = self._length.unpack(where) > 0
        by_hand = covers and not self._session.driven()
        if self._asked or by_hand:
            await self._take(io, told)
        if by_hand:
            return
        if covers:
            await io.write(self._where, 0)
        await io.write(self._datagram, 0)
        self._asked = True
        await io.read(self._where)
        if not io.status & _CDGW:
            await self._take(io, told)

    def _telling(self) -> dict[int, Place]:
        """Places of the drivers whose answers are known, by axis."""
        driven = self._session.driven()
        return {
            axis: place
            for axis, place in enumerate(self._cover.places[: len(self._session.axes)])
            if place.driver in tmc236.NAMES or (axis in driven and place.length == TMC26X_BITS)
        }

    async def _take(self, io: RegisterIO, told: dict[int, Place]) -> None:
        low, high = await io.read_many((self._low, self._high))
        self._asked = False
        self._flags = {axis: flags for axis, flags in self._flags.items() if axis in told}
        for axis, place in told.items():
            reply = place.reply(high << 24 | low)
            flags = self._tmc24x(axis, reply) if place.driver in tmc236.NAMES else _tmc26x(reply)
            if flags:
                self._flags[axis] = flags
                self._interrupts.driver_told(axis, flags, io.time_s)

    def _tmc24x(self, axis: int, reply: CoverReply) -> dict[str, bool]:
        """The flags of an answer; none where nobody has answered."""
        if reply.known != (1 << tmc236.BITS) - 1 or not reply.word & tmc236.PRESENT:
            return {}
        if tmc236.load_of(reply.word):
            self._measures.add(axis)
        return tmc236.flags_of(reply.word)

    def flags(self, axis: int) -> dict[str, bool]:
        """By name, `driver_OT`; none where nothing is known of its driver, or it has not answered yet."""
        return {f"driver_{name}": value for name, value in self._flags.get(axis, {}).items()}

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
        """That the motor does not follow while it is stepped, by StallGuard2, or by the load value of a TMC24x."""
        if not state.moving:
            return None
        who = self._who(axis)
        if state.flags.get(f"driver_{STALL}"):
            return Sign(
                f"{who} tells of a stall: the motor does not follow", (Evidence(f"{who}: SG", "1", state.time_s),)
            )
        load = [state.flags.get(f"driver_{name}") for name in tmc236.LOAD_FLAGS]
        if axis not in self._measures or any(load) or self._slow(axis, state):
            return None
        told = Evidence(f"{who}: LD2 LD1 LD0", "0", state.time_s)
        return Sign(f"{who} measures its greatest load (LD 0): the motor may not follow", (told,))

    def _slow(self, axis: int, state: AxisState) -> bool:
        microsteps = self._memory.microsteps(axis) or 1
        return state.moving and abs(state.velocity_pps) / microsteps <= SLOW_FULLSTEPS_PER_S

    def _who(self, axis: int) -> str:
        return self._session.driven().get(axis, f"the driver of axis {axis}")


def _tmc26x(reply: CoverReply) -> dict[str, bool]:
    """The flags of an answer; none where the controller does not show them."""
    if reply.known & 0xFF != 0xFF:
        return {}
    return {name: bool(reply.word >> bit & 1) for bit, name in enumerate(tmc2660.FLAGS)}
