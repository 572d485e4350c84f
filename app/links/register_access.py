"""What the driver of a register chip says to a port, and makes of the answer, by the kind of the link.

Sans-io: frames to send in a row (`Turn.exchange_many`, one call a chain) and replies to judge. Over SPI
the words come pipelined, so the frames of one call belong together: ports of such chips are `ChainPort`s
and let nobody come between. Over an evaluation board every register is one TMCL command. Over a UART a register is one
datagram, and the port has each write counted by the chip.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol

from ..errors import BadReply
from ..registers import catalog
from ..registers.entry import Slot
from ..registers.evaluation_board import BoardOpcode
from ..registers.spi_format import TaggedFormat
from ..registers.wires import BOARD
from . import datagram40, datagram_uart, tmcl
from .datagram_uart import IFCNT, UartForm
from .spi_access import SpiAccess, TaggedAccess, check_count


class RegisterAccess(Protocol):
    """Raw unsigned 32-bit words by address, as frames. Addresses and data that cannot be raise ValueError."""

    @property
    def frame_bytes(self) -> int:
        """The length of every frame; over a UART of those that read."""
        ...

    @property
    def reply_bytes(self) -> int:
        """The length of every reply, so that the joined replies of a sample can be cut (`cut`)."""
        ...

    def read_frames(self, addresses: Sequence[int]) -> tuple[bytes, ...]:
        """The frames that read these registers in this order; none for none. Reading twice what reading clears
        clears it twice: every address costs exactly one access, and what else is sent clears nothing."""
        ...

    def words(self, replies: Sequence[bytes]) -> list[int]:
        """One word for each address asked, out of the replies to all of `read_frames`. Raises BadReply."""
        ...

    def status(self, replies: Sequence[bytes]) -> int | None:
        """The SPI status byte of the last reply; None where the link brings none. Raises BadReply."""
        ...

    def write_frame(self, address: int, data: int) -> bytes:
        """The one frame that writes `data`, 32 raw bits."""
        ...

    def write_frames(self, writes: Sequence[tuple[int, int]]) -> tuple[bytes, ...]:
        """The frames that write (address, data) in this order such that `check_all` can tell whether every one
        arrived; none for none."""
        ...

    def is_read(self, frame: bytes) -> bool:
        """Whether `frame` reads, and writes nothing."""
        ...

    def check(self, frame: bytes, reply: bytes) -> None:
        """Raises BadReply where `reply` cannot be the reply to `frame`."""
        ...

    def check_all(self, frames: Sequence[bytes], replies: Sequence[bytes]) -> None:
        """Raises BadReply where the replies cannot be those to `frames`, sent in a row and nobody between."""
        ...


class Spi40Access:
    """40-bit datagrams (DS-TMC4361 5.1). `name` names the link in errors, `fetch` is what ends a chain.

    A reply alone shows nothing but its length. Writes show themselves in the reply after: `check_all`.
    """

    frame_bytes = datagram40.FRAME_BYTES
    reply_bytes = datagram40.FRAME_BYTES

    def __init__(self, name: str = "spi", fetch: bytes = datagram40.FETCH) -> None:
        self.name = name
        self._fetch = fetch

    def read_frames(self, addresses: Sequence[int]) -> tuple[bytes, ...]:
        return datagram40.read_chain(addresses, self._fetch)

    def words(self, replies: Sequence[bytes]) -> list[int]:
        for reply in replies:
            self._check_length(reply)
        return datagram40.words_of_chain(replies)

    def status(self, replies: Sequence[bytes]) -> int | None:
        if not replies:
            return None
        self._check_length(replies[-1])
        return replies[-1][0]

    def write_frame(self, address: int, data: int) -> bytes:
        return datagram40.write(address, data)

    def write_frames(self, writes: Sequence[tuple[int, int]]) -> tuple[bytes, ...]:
        return (*(datagram40.write(address, data) for address, data in writes), self._fetch) if writes else ()

    def is_read(self, frame: bytes) -> bool:
        return not frame[0] & datagram40.WRITE_BIT

    def check(self, frame: bytes, reply: bytes) -> None:
        del frame  # the reply speaks of the frame before
        self._check_length(reply)

    def check_all(self, frames: Sequence[bytes], replies: Sequence[bytes]) -> None:
        check_count(self.name, frames, replies)
        for reply in replies:
            self._check_length(reply)
        for frame, reply in zip(frames, replies[1:], strict=False):
            if frame[0] & datagram40.WRITE_BIT and frame[1:] != reply[1:]:
                address = frame[0] & datagram40.ADDRESS_MAX
                raise BadReply(self.name, f"what {address:#04x} was written with came back otherwise", reply)

    def _check_length(self, reply: bytes) -> None:
        if len(reply) != datagram40.FRAME_BYTES:
            raise BadReply(self.name, f"{len(reply)} bytes instead of {datagram40.FRAME_BYTES}", reply)


class BoardAccess:
    """Registers through an evaluation board: TMCL 146 writes and 148 reads the motion controller, 147 and 149 the
    driver.

    `motor` is the board's channel, the chip's axis or its block of registers. Where a register's address is wider than
    a chip's own, what is above it is that block. The type byte has eight bits of an address; the others go into the
    upper part of the motor byte.
    """

    frame_bytes = tmcl.FRAME_BYTES
    reply_bytes = tmcl.FRAME_BYTES

    def __init__(self, name: str = BOARD, motor: int = 0, slot: Slot | None = None) -> None:
        if not 0 <= motor <= 0xF:
            raise ValueError(f"motor is 0..15, not {motor}")
        slot = slot or Slot()
        self.name = name
        self.motor = motor
        self.address = slot.module
        driver = slot.side == "driver"
        self.read_opcode = BoardOpcode.READ_DRV if driver else BoardOpcode.READ_MC
        self.write_opcode = BoardOpcode.WRITE_DRV if driver else BoardOpcode.WRITE_MC
        self._address_bits = slot.address_bits
        self._block_bits = 16 - slot.address_bits
        self._block_mask = (1 << self._block_bits) - 1 if slot.blocks else 0

    def read_frames(self, addresses: Sequence[int]) -> tuple[bytes, ...]:
        return tuple(self._frame(self.read_opcode, address, 0) for address in addresses)

    def words(self, replies: Sequence[bytes]) -> list[int]:
        return [self._word(reply, self.read_opcode) for reply in replies]

    def status(self, replies: Sequence[bytes]) -> int | None:
        del replies  # the board keeps it to itself
        return None

    def write_frame(self, address: int, data: int) -> bytes:
        if not 0 <= data <= datagram40.DATA_MASK:
            raise ValueError(f"data is 32 bits, not {data:#x}")
        return self._frame(self.write_opcode, address, data)

    def write_frames(self, writes: Sequence[tuple[int, int]]) -> tuple[bytes, ...]:
        return tuple(self.write_frame(address, data) for address, data in writes)

    def is_read(self, frame: bytes) -> bool:
        return frame[1] in (BoardOpcode.READ_MC, BoardOpcode.READ_DRV) or tmcl.is_retriable(frame)

    def check(self, frame: bytes, reply: bytes) -> None:
        answer = tmcl.check_reply(self.name, frame, reply)
        if not answer.ok:
            raise BadReply(self.name, f"the board refuses: {answer.status_text}", reply)

    def check_all(self, frames: Sequence[bytes], replies: Sequence[bytes]) -> None:
        check_count(self.name, frames, replies)
        for frame, reply in zip(frames, replies, strict=True):
            self.check(frame, reply)

    def _frame(self, opcode: BoardOpcode, address: int, value: int) -> bytes:
        most = self._block_mask << self._address_bits | (1 << self._address_bits) - 1
        if not 0 <= address <= most:
            raise ValueError(f"an address is 0x000..{most:#x}, not {address:#x}")
        block, within = address >> self._address_bits, address & (1 << self._address_bits) - 1
        motor = self.motor | block | within >> 8 << self._block_bits
        return tmcl.Request(self.address, opcode, address & 0xFF, motor, value).encode()

    def address_of(self, frame: bytes) -> int:
        """The register that a frame of `read_opcode` or `write_opcode` is about."""
        within = frame[2] | frame[3] >> self._block_bits << 8
        return (frame[3] & self._block_mask) << self._address_bits | within

    def _word(self, reply: bytes, opcode: BoardOpcode) -> int:
        # The command that was asked need not be at hand: of it only address and command number matter here.
        self.check(tmcl.Request(self.address, opcode).encode(), reply)
        return int.from_bytes(reply[4:8], "big")


class UartAccess:
    """Datagrams with a CRC (TMC5160A data sheet 1.14, 5.1). `name` names the link in errors.

    A write has no answer of its own. The port asks for IFCNT behind each, raises BadReply where the chip has not
    counted exactly that write, and gives the reading of IFCNT as the reply: only the port sees what went out meanwhile.
    """

    def __init__(self, name: str = "uart", form: UartForm | None = None) -> None:
        self.name = name
        self.form = form or UartForm()
        self._reads = [self.form.read(address) for address in range(datagram_uart.WRITE_BIT)]

    @property
    def frame_bytes(self) -> int:
        return self.form.read_bytes

    @property
    def reply_bytes(self) -> int:
        return self.form.reply_bytes

    def read_frames(self, addresses: Sequence[int]) -> tuple[bytes, ...]:
        for address in addresses:
            if not 0 <= address < datagram_uart.WRITE_BIT:
                raise ValueError(f"a register is 0x00..0x7f, not {address:#x}")
        return tuple([self._reads[address] for address in addresses])

    def words(self, replies: Sequence[bytes]) -> list[int]:
        return [self._word(reply, reply[-6] if len(reply) == self.reply_bytes else 0) for reply in replies]

    def status(self, replies: Sequence[bytes]) -> int | None:
        del replies  # a UART brings none
        return None

    def write_frame(self, address: int, data: int) -> bytes:
        return self.form.write(address, data)

    def write_frames(self, writes: Sequence[tuple[int, int]]) -> tuple[bytes, ...]:
        return tuple(self.form.write(address, data) for address, data in writes)

    def is_read(self, frame: bytes) -> bool:
        return not self.form.is_write(frame)

    def check(self, frame: bytes, reply: bytes) -> None:
        self._word(reply, IFCNT if self.form.is_write(frame) else self.form.register_of(frame))

    def check_all(self, frames: Sequence[bytes], replies: Sequence[bytes]) -> None:
        check_count(self.name, frames, replies)
        counted: int | None = None
        for frame, reply in zip(frames, replies, strict=True):
            self.check(frame, reply)
            if self.form.is_write(frame):
                before, counted = counted, self._word(reply, IFCNT) & 0xFF
                if before == counted:  # it went on by one, or by more where a stop came between
                    register = self.form.register_of(frame)
                    raise BadReply(self.name, f"the chip has not counted the write of {register:#04x}", reply)

    def _word(self, reply: bytes, register: int) -> int:
        try:
            return self.form.data_of(register, reply)
        except ValueError as error:
            raise BadReply(self.name, str(error), reply) from error


def access_of(link: Mapping[str, object], model: str) -> RegisterAccess:
    """How registers of `model` are reached over `link`, whose options its port has already been made of."""
    kind = link.get("kind")
    if kind == BOARD:
        motor = link.get("motor", 0)
        assert isinstance(motor, int)  # the factory of the port has checked it
        return BoardAccess(f"{BOARD} {link.get('port', '')}", motor, catalog.find_model(model).slot)
    if kind == "uart" or datagram_uart.alone(model):
        node = link.get("node", 0)
        assert isinstance(node, int)  # likewise
        return UartAccess(f"{kind} {link.get('port', '')}".rstrip(), datagram_uart.form_of(model, node))
    known = catalog.find_model(model)
    if isinstance(known.spi, TaggedFormat):
        return TaggedAccess(known.spi, str(kind))
    if known.spi is not None:
        return SpiAccess(known.spi, str(kind), known.fetch_address)
    if not datagram40.speaks(model):  # emulated here: as through a board, where there is no SPI that we could speak
        return BoardAccess(str(kind), slot=known.slot)
    return Spi40Access(str(kind), datagram40.fetch_of(model))
