"""Cover datagrams to the drivers of the chain, and their answers (DS-TMC428 9.1 to 9.3)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ...calc.driver_chain.chain import decode_chain
from ...calc.driver_chain.model import STATUS_BITS
from ...errors import LinkTimeout, WrongState
from ...registers.tmc428.status import STATUS_TMC428
from ...registers.tmc428.tmc428 import RAM_CHAIN, RAM_TABLE
from ..core.changes import RegisterChanged
from ..core.cover import CoverCarrier, CoverReply
from ..core.events import DeviceEvent, StateChanged
from ..core.register_io import RegisterIO
from ..core.register_link import RegisterLink
from .axis_roles import field_of
from .memory import RampMemory
from .ram import RAM_MASK, RAM_WORDS, Ram
from .resets import Resets

COVER_BITS_MAX = 24
WAIT_S, POLL_S = 0.5, 0.001
"""How long a datagram is waited for, and how often it is looked for [s]; one of 64 bits takes 2 ms at the most."""
_CDGW = 1 << STATUS_TMC428.index("CDGW")


@dataclass(frozen=True, slots=True)
class Place:
    """The bits of one driver in the datagram: the first, counted from 0, how many, of how many in all, and which driver
    they are for, as far as they tell ("custom" where they do not)."""

    first: int
    length: int
    total: int
    driver: str

    def reply(self, stored: int) -> CoverReply:
        """Its answer in the last 48 bits that came back. The chain is one shift register: what comes back while a
        driver's bits go out stands where they stood, counted from the first."""
        shift, mask = self.total - self.first - self.length, (1 << self.length) - 1
        seen = max(min(STATUS_BITS - shift, self.length), 0)
        return CoverReply(stored >> shift & mask, (1 << seen) - 1)


def places_of(ram_words: Sequence[int], lsmd: int) -> tuple[Place, ...]:
    """Where the drivers stand, by axis; none where the chain is not set up."""
    chain = decode_chain(ram_words, lsmd)
    if chain.length_bits is None or chain.length_bits > len(chain.bits):
        return ()
    motors = [bit.motor for bit in chain.bits]
    return tuple(
        Place(motors.index(motor), motors.count(motor), len(motors), chain.drivers[motor].driver)
        for motor in range(chain.lsmd + 1)
    )


class ChainCover(CoverCarrier):
    """Covers the bits of one driver in the next datagram, and takes out of what comes back what is its own."""

    def __init__(self, link: RegisterLink, memory: RampMemory, resets: Resets, ram: Ram) -> None:
        self._link = link
        self._session = link.session
        self._memory = memory
        self._resets = resets
        self._ram = ram
        table = link.table
        self._where, self._datagram = table.get("cover_pos_cover_len"), table.get("cover_datagram")
        self._low, self._high = table.get("datagram_low_word"), table.get("datagram_high_word")
        self._length, self._position = field_of(self._where, "cover_len"), field_of(self._where, "cover_pos")
        self._chain = frozenset(
            row.name for row in table if RAM_CHAIN <= row.address < RAM_TABLE or row.field_named("LSMD")
        )
        """Registers that say what the chain is."""
        self._places: tuple[Place, ...] | None = None
        """As the RAM was read; None where it has to be read again."""
        self._seen_resets = 0
        self._session.listen(self._heard)

    @property
    def places(self) -> tuple[Place, ...]:
        """Where the drivers stand, by axis, as the RAM was read last; none before it was."""
        return self._places or ()

    async def cover(self, axis: int, bits: int, words: Sequence[int]) -> list[CoverReply]:
        self._session.axis(axis)
        self._session.require_connected()
        if bits > COVER_BITS_MAX:
            raise WrongState(
                f"a cover datagram has at most {COVER_BITS_MAX} bits, and this driver takes {bits}",
                "drive it by step and direction, and give it a wire of its own",
            )
        if not self._memory.drives_chain:
            raise WrongState("the outputs give steps (en_sd), so no datagram reaches a driver", "clear en_sd")
        place = await self._place(axis)
        if place.length != bits:
            raise WrongState(
                f"the chain in the RAM has {place.length} bits for the driver of axis {axis}, this one takes {bits}",
                "write a chain with it (page Driver chain)",
            )
        replies = []
        async with self._session.queue.turn() as turn:
            io = self._link.io(turn)
            for word in words:
                replies.append(place.reply(await self._exchange(io, place, word)))  # noqa: PERF401 (one after another)
        return replies

    async def _exchange(self, io: RegisterIO, place: Place, word: int) -> int:
        """What the registers hold of the answer to a datagram that was covered by `word`."""
        await self._until_sent(io)
        await io.write(self._where, self._length.pack(place.length) | self._position.pack(place.first))
        await io.write(self._datagram, word)
        await self._until_sent(io)
        low, high = await io.read_many((self._low, self._high))
        return high << 24 | low

    async def _until_sent(self, io: RegisterIO) -> None:
        """Wait until no cover datagram waits (CDGW). Raises LinkTimeout."""
        clock = self._session.clock
        until_s = clock.now() + WAIT_S
        while True:
            await io.read(self._where)
            if not io.status & _CDGW:
                return
            if clock.now() >= until_s:
                raise LinkTimeout(self._session.port.name, WAIT_S, "a cover datagram: the chain sends nothing (CDGW)")
            await clock.sleep(POLL_S)

    async def learn(self) -> tuple[Place, ...]:
        """Where the drivers stand, by axis; the RAM is read where that is not known. Raises LinkError."""
        resets = sum(self._resets.count(each.index) for each in self._session.axes)
        if self._places is None or resets != self._seen_resets:
            held = await self._ram.read_driver_chain()
            words = [word & RAM_MASK for word in held.ram_words[:RAM_WORDS]]
            self._places, self._seen_resets = places_of(words, held.lsmd), resets
        return self._places

    async def _place(self, axis: int) -> Place:
        places = await self.learn()
        if axis < len(places):
            return places[axis]
        raise WrongState(
            f"the chain in the RAM has no driver for axis {axis}"
            if places
            else "no chain of drivers is in the RAM: it is not set up since power-on",
            "write a chain with this driver (page Driver chain)",
        )

    def _heard(self, event: DeviceEvent) -> None:
        """Whatever may have changed the chain has it read again."""
        if isinstance(event, StateChanged) or (isinstance(event, RegisterChanged) and event.register in self._chain):
            self._places = None
