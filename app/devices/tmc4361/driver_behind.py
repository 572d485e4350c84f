"""The motor driver behind the chip: cover datagrams to it, and what it has to be told so that a stall stops the motor.

What was said to a TMC26x is remembered, for nothing of it can be read: by its registers, through here or by writes of
COVER_LOW. A stall is the chip's affair (stop_on_stall, VSTALL_LIMIT); how soon one is seen the driver's (SGT).
"""

from __future__ import annotations

from collections.abc import Sequence

from ...errors import WrongState
from ...registers.model import to_signed
from ..core.capabilities import StallStop
from ..core.cover import CoverCarrier, CoverReply
from ..core.register_io import RegisterIO, Write
from ..core.register_link import RegisterLink
from ..core.results import WriteItem
from . import roles
from .cruise import Cruise
from .memory import ChipMemory
from .position import Position

BITS_26X = 20
LENGTHS = {8: 12, 9: 12, 10: BITS_26X, 11: BITS_26X, 12: 40, 13: 40}
"""Bits of a datagram, by spi_output_format, where cover_data_length is 0 (NOTES-TMC4361-IO 9)."""
COVERS_ALONE = 15
TAG = 17
SGCSCONF, DRVCONF = 6, 7
"""What bits 19..17 of a datagram to a TMC26x say."""
CS, SGT, SGT_BITS, SFILT, RDSEL = 0, 8, 7, 16, 4
RDSEL_LOAD = 1
HOST_DATAGRAM_CLOCKS = 160
"""A datagram to the chip takes at least this long: 40 bits at a quarter of its clock (NOTES-TMC4361-IO 1)."""


class DriverBehind(CoverCarrier, StallStop):
    """Carries datagrams to the driver behind one TMC4361, and has its stalls stop the motor."""

    def __init__(self, link: RegisterLink, memory: ChipMemory, cruise: Cruise, position: Position) -> None:
        self._link = link
        self._session = link.session
        self._memory = memory
        self._cruise = cruise
        self._position = position

    # --- cover datagrams -------------------------------------------------------------------------

    async def cover(self, axis: int, bits: int, words: Sequence[int]) -> list[CoverReply]:
        """As `CoverCarrier` says. Each is sent once, and its answer read when it must have come."""
        self._session.axis(axis)
        self._session.require_connected()
        async with self._link.turn() as turn:
            io = self._link.io(turn)
            conf = await io.read(roles.SPI_OUT_CONF)
            length = _length(conf)
            if length != bits:
                raise WrongState(
                    f"the chip sends {length} bits to the driver of axis {axis}, not {bits}"
                    if length
                    else "the chip sends no datagrams: its SPI output is off",
                    "write SPI_OUT_CONF: spi_output_format as the driver is wired, cover_data_length 0",
                )
            return [await self._send(io, conf, bits, word) for word in words]

    async def _send(self, io: RegisterIO, conf: int, bits: int, word: int) -> CoverReply:
        wide = bits > roles.COVER_LOW.width
        low, high = word & 0xFFFF_FFFF, word >> 32
        asked = (roles.STATUS,) * _waits(conf, bits), (roles.COVER_DRV_LOW, *((roles.COVER_DRV_HIGH,) if wide else ()))
        writes = (*((Write(roles.COVER_HIGH, high),) if wide else ()), Write(roles.COVER_LOW, low))
        _, words = await io.chain(*writes, *asked)
        self._memory.sent(roles.COVER_LOW, low)
        answer = words[0] | (words[1] << 32 if wide else 0)
        everything = (1 << bits) - 1
        return CoverReply(answer & everything, everything)

    # --- stalls ----------------------------------------------------------------------------------

    async def full_step(self, axis: int) -> int:
        self._session.axis(axis)
        await self._require_known()
        return self._memory.microsteps

    def cruise_pps(self, axis: int) -> float | None:
        return self._position.cruise_pps(axis)

    async def stall_threshold(self, axis: int) -> int:
        self._session.axis(axis)
        stall_guard, _ = await self._require_known()
        return to_signed(stall_guard >> SGT & (1 << SGT_BITS) - 1, SGT_BITS)

    async def stall_writes(
        self, axis: int, velocity_pps: float, threshold: int, current_percent: float | None, *, stops: bool
    ) -> Sequence[WriteItem]:
        word, _ = await self._require_known()
        mask = (1 << SGT_BITS) - 1
        word = word & ~(mask << SGT | 1 << SFILT) | (threshold & mask) << SGT
        if current_percent is not None:
            word = word & ~0x1F | max(0, round(32 * current_percent / 100) - 1) << CS
        # a driver that follows steps goes on after its event is cleared: the way back from an end is such a move
        stop = {"stop_on_stall": int(stops), "drv_after_stall": 1}
        return [
            WriteItem(roles.REFERENCE_CONF.name, axis, fields=dict(stop)),
            WriteItem(roles.VSTALL_LIMIT.name, axis, round(velocity_pps)),
            WriteItem(roles.COVER_LOW.name, axis, word),
        ]

    def set_before(self, item: WriteItem) -> WriteItem | None:
        """Of the driver the same register as was said last; of VSTALL_LIMIT, which cannot be read, what was written."""
        if item.name == roles.COVER_LOW.name:
            return WriteItem(item.name, item.axis, self._memory.covered.get(SGCSCONF))
        if item.name == roles.VSTALL_LIMIT.name:
            return WriteItem(item.name, item.axis, self._memory.held_unread(roles.VSTALL_LIMIT))
        return None

    async def load(self, axis: int) -> int:
        _, conf = await self._require_known()
        asking = conf & ~(3 << RDSEL) | RDSEL_LOAD << RDSEL
        return (await self.cover(axis, BITS_26X, (asking, asking)))[-1].word >> 10

    async def call_here(self, axis: int, position: int) -> None:
        await self._position.set_position(axis, position)

    async def _require_known(self) -> tuple[int, int]:
        """SGCSCONF and DRVCONF as they were said last. Raises WrongState where no TMC26x is behind that was set up."""
        conf = await self._link.read_once(roles.SPI_OUT_CONF)
        if _length(conf) != BITS_26X:
            raise WrongState(
                "the axis measures no stall: SPI_OUT_CONF names no TMC26x behind the chip",
                "search its reference by a switch, or write SPI_OUT_CONF.spi_output_format as the driver is wired",
            )
        covered = self._memory.covered
        if SGCSCONF not in covered or DRVCONF not in covered:
            raise WrongState(
                "nobody knows how the driver behind is set up: none of it can be read",
                "write DRVCONF and SGCSCONF of the driver, by its own device or as cover datagrams",
            )
        return covered[SGCSCONF], covered[DRVCONF]


def _length(spi_out_conf: int) -> int:
    """Bits of a cover datagram; 0 where none is sent."""
    form = roles.OUTPUT_FORMAT.unpack(spi_out_conf)
    given: int = roles.COVER_LENGTH.unpack(spi_out_conf)
    if form == COVERS_ALONE:
        return given or BITS_26X
    return (given or LENGTHS.get(form, 0)) if form in LENGTHS else 0


def _waits(spi_out_conf: int, bits: int) -> int:
    """How many datagrams to the chip pass until a cover datagram's answer is there: as long as one that may be under
    way takes, and itself."""
    clocks = bits * max(spi_out_conf >> 20 & 15, 1) + bits * max(spi_out_conf >> 24 & 15, 1) + (spi_out_conf >> 28)
    return 1 + 2 * clocks // HOST_DATAGRAM_CLOCKS
