"""What drivers of register chips say and what they believe: over SPI datagrams, an evaluation board and a UART."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.clock import VirtualClock
from app.emulators.board.board import EmulatedBoard
from app.emulators.tmc5xxx import EmulatedTmc5xxx
from app.emulators.tmc4361 import EmulatedTmc4361
from app.errors import BadReply
from app.links import datagram40, datagram_uart, tmcl
from app.links.datagram_uart import IFCNT, UartForm
from app.links.register_access import BoardAccess, RegisterAccess, Spi40Access, UartAccess, access_of
from app.registers.catalog import MODELS
from app.registers.entry import Slot
from app.registers.evaluation_board import BoardOpcode

X_COMPARE, X_TARGET, VIRTUAL_LEFT, VERSION = 0x32, 0x37, 0x33, 0x7F
WORDS = st.integers(0, 0xFFFF_FFFF)


class Far:
    """An emulated TMC4361 behind one kind of access."""

    def __init__(self, kind: str) -> None:
        clock = VirtualClock()
        self.chip = EmulatedTmc4361(clock)
        self.access: RegisterAccess = Spi40Access() if kind == "spi" else BoardAccess()
        self._board = EmulatedBoard(self.chip) if kind == "board" else None
        self.registers = (X_COMPARE, VIRTUAL_LEFT, X_TARGET)

    def say(self, frames: tuple[bytes, ...]) -> list[bytes]:
        if self._board is None:
            return [self.chip.exchange(frame) for frame in frames]
        replies = [self._board.receive(frame) for frame in frames]
        return [reply for reply in replies if reply is not None]


class FarSixPoint(Far):
    """An emulated TMC5160 over SPI or its UART; over the latter what the port does is done here."""

    def __init__(self, kind: str) -> None:
        self.sixpoint = EmulatedTmc5xxx("tmc5160", VirtualClock())
        self.access = access_of({"kind": "uart" if kind == "uart" else "tcp"}, "tmc5160")
        self._uart = kind == "uart"
        self.registers = (0x39, 0x21, 0x2D)  # X_ENC, XACTUAL, XTARGET

    def say(self, frames: tuple[bytes, ...]) -> list[bytes]:
        if not self._uart:
            return [self.sixpoint.exchange(frame) for frame in frames]
        return [self.sixpoint.uart(frame) or self.sixpoint.uart(UartForm().read(IFCNT)) for frame in frames]


@pytest.fixture(params=["spi", "board", "spi of a TMC5160", "uart"])
def far(request: pytest.FixtureRequest) -> Far:
    kind = str(request.param)
    return FarSixPoint(kind) if "TMC5160" in kind or kind == "uart" else Far(kind)


def test_what_is_written_is_read_in_one_chain(far: Far) -> None:
    access = far.access
    one, two, three = far.registers
    writes = [(one, 0xFFFF_FFFE), (two, 0x8000_0000), (three, 0)]
    frames = access.write_frames(writes)
    access.check_all(frames, far.say(frames))
    asked = [three, one, two, one]
    frames = access.read_frames(asked)
    replies = far.say(frames)
    access.check_all(frames, replies)
    assert access.words(replies) == [0, 0xFFFF_FFFE, 0x8000_0000, 0xFFFF_FFFE]
    assert {len(frame) for frame in frames} == {access.frame_bytes}
    assert {len(reply) for reply in replies} == {access.reply_bytes}


def test_a_single_write(far: Far) -> None:
    frame = far.access.write_frame(far.registers[0], 77)
    (reply,) = far.say((frame,))
    far.access.check(frame, reply)
    assert far.access.words(far.say(far.access.read_frames([far.registers[0]]))) == [77]


def test_nothing_costs_nothing(far: Far) -> None:
    assert far.access.read_frames([]) == far.access.write_frames([]) == ()
    assert far.access.words([]) == []
    assert far.access.status([]) is None


@pytest.mark.sheet("DS-TMC4361", "5.1")
def test_every_spi_reply_bears_the_status_and_no_reply_of_a_board_does() -> None:
    spi, board = Far("spi"), Far("board")
    replies = spi.say(spi.access.read_frames([0x0E, VERSION]))
    assert spi.access.status(replies) == replies[-1][0]
    assert replies[0][0] & 0x80, "the reset event, which is selected by default"
    assert not replies[-1][0] & 0x80, "cleared by reading EVENTS"
    assert board.access.status(board.say(board.access.read_frames([VERSION]))) is None


@pytest.mark.sheet("DS-TMC4361", "5.1")
@given(st.lists(st.tuples(st.integers(0, 0x7F), WORDS), min_size=1, max_size=5), st.data())
def test_a_write_that_comes_back_otherwise_is_told(writes: list[tuple[int, int]], data: st.DataObject) -> None:
    access = Spi40Access()
    frames = access.write_frames(writes)
    mirrored = [bytes(5), *(bytes(1) + frame[1:] for frame in frames[:-1])]
    access.check_all(frames, mirrored)
    which, bit = data.draw(st.integers(1, len(writes))), data.draw(st.integers(0, 31))
    word = int.from_bytes(mirrored[which][1:], "big") ^ 1 << bit
    mirrored[which] = bytes(1) + word.to_bytes(4, "big")
    with pytest.raises(BadReply, match=f"{writes[which - 1][0]:#04x} was written"):
        access.check_all(frames, mirrored)


@given(st.binary(max_size=12).filter(lambda reply: len(reply) != 5))
def test_spi_replies_of_another_length(reply: bytes) -> None:
    access = Spi40Access()
    for judge in (access.words, access.status, lambda replies: access.check(datagram40.FETCH, replies[0])):
        with pytest.raises(BadReply, match="bytes instead of 5"):
            judge([reply])


def test_replies_that_are_too_few(far: Far) -> None:
    frames = far.access.read_frames([far.registers[0], far.registers[1]])
    with pytest.raises(BadReply, match="replies to"):
        far.access.check_all(frames, far.say(frames)[:-1])


@given(st.binary(min_size=9, max_size=9))
def test_a_board_is_believed_only_with_checksum_module_command_and_status(reply: bytes) -> None:
    access = BoardAccess()
    believable = tmcl.sound(reply) and reply[1] == 1 and reply[2] in (100, 101) and reply[3] == 148
    if believable:
        assert access.words([reply]) == [int.from_bytes(reply[4:8], "big")]
    else:
        with pytest.raises(BadReply):
            access.words([reply])


def test_a_board_that_refuses_is_told_in_its_words() -> None:
    access = BoardAccess("landungsbruecke /dev/x")
    reply = tmcl.Reply(2, 1, 2, 148).encode()
    with pytest.raises(BadReply, match=r"landungsbruecke /dev/x: the board refuses: invalid command"):
        access.words([reply])


def test_addresses_of_twelve_bits_and_axes_share_the_motor_byte() -> None:
    access = BoardAccess(motor=3)
    assert access.read_frames([0xA21])[0][:4] == bytes((1, 148, 0x21, 0xA3))
    assert access.write_frame(0x21, 5)[:8] == bytes((1, 146, 0x21, 3, 0, 0, 0, 5))
    for wrong in (lambda: access.read_frames([0x1000]), lambda: access.write_frame(0, 1 << 32)):
        with pytest.raises(ValueError, match="is"):
            wrong()
    with pytest.raises(ValueError, match="motor"):
        BoardAccess(motor=16)


def test_the_kind_of_a_link_says_how() -> None:
    for kind in ("emulator", "tcp", "spidev"):
        assert isinstance(access_of({"kind": kind}, "tmc4361"), Spi40Access)
    board = access_of({"kind": "landungsbruecke", "port": "/dev/ttyACM0", "motor": 2}, "tmc4361")
    assert isinstance(board, BoardAccess)
    assert (board.motor, board.name) == (2, "landungsbruecke /dev/ttyACM0")
    uart = access_of({"kind": "uart", "port": "/dev/ttyUSB0", "node": 3}, "tmc5072")
    assert isinstance(uart, UartAccess)
    assert (uart.form, uart.name) == (UartForm(3), "uart /dev/ttyUSB0")
    assert access_of({"kind": "uart"}, "tmc5062").frame_bytes == 3


def test_a_chain_ends_with_a_register_that_reading_leaves_alone() -> None:
    """VERSION_NO of the TMC4361 is at 0x7F, where a TMC5xxx has nothing, or the driver status of its second axis."""
    for model, row in MODELS.items():
        if row.datagram_bits == 40:
            address = access_of({"kind": "tcp"}, model).read_frames([1])[-1][0]
            register = row.table.at(address)
            assert register is not None, model
            assert register.access.readable, model
            assert not register.read_clears, model


def test_links_ask_the_catalog_how_a_chip_is_spoken_to() -> None:
    for name, model in MODELS.items():
        assert datagram40.speaks(name) is (model.datagram_bits == 40)
        assert datagram_uart.kind_of(name) == model.uart
    assert not datagram40.speaks("what nobody has")


@pytest.mark.parametrize("address", [0x000, 0x7F, 0x385, 0x7FF])
def test_a_driver_in_its_slot_and_blocks_of_registers(address: int) -> None:
    driver = BoardAccess(slot=Slot("driver"))
    read, write = driver.read_frames([address])[0], driver.write_frame(address, 5)
    assert (read[1], write[1]) == (BoardOpcode.READ_DRV, BoardOpcode.WRITE_DRV)
    assert (driver.address_of(read), driver.address_of(write)) == (address, address)
    blocks = BoardAccess(slot=Slot(module=3, address_bits=11, blocks=True))
    frame = blocks.read_frames([2 << 11 | address])[0]
    # As PyTrinamic sends it: the block below, the upper bits of the address above it.
    assert frame[:4] == bytes((3, BoardOpcode.READ_MC, address & 0xFF, 2 | address >> 8 << 5))
    assert blocks.address_of(frame) == 2 << 11 | address


def test_a_uart_is_believed_only_with_the_right_register_and_crc() -> None:
    access, form = UartAccess(), UartForm()
    read, write = form.read(0x21), form.write(0x21, 5)
    access.check(read, form.reply(0x21, 7))
    access.check(write, form.reply(IFCNT, 7))
    for frame, reply, why in (
        (read, form.reply(0x22, 7), "register 0x22"),
        (write, form.reply(0x21, 7), "register 0x21"),
        (read, form.reply(0x21, 7)[:-1] + b"\0", "CRC"),
        (read, b"", "0 bytes"),
    ):
        with pytest.raises(BadReply, match=why):
            access.check(frame, reply)
    with pytest.raises(BadReply, match="7 bytes"):
        access.words([form.reply(0x21, 7)[:-1]])


def test_a_count_of_writes_that_stands_still_is_told() -> None:
    access, form = UartAccess(), UartForm()
    frames = access.write_frames([(0x21, 1), (0x26, 2), (0x27, 3)])
    access.check_all(frames, [form.reply(IFCNT, count) for count in (254, 255, 0)])
    access.check_all(frames, [form.reply(IFCNT, count) for count in (1, 5, 6)])  # a stop came between
    with pytest.raises(BadReply, match="has not counted the write of 0x26"):
        access.check_all(frames, [form.reply(IFCNT, count) for count in (1, 1, 2)])


def test_what_cannot_be_said_over_a_uart() -> None:
    access = UartAccess()
    for wrong in (
        lambda: access.read_frames([0x80]),
        lambda: access.write_frame(0, 1 << 32),
        lambda: access.read_frames([-1]),
    ):
        with pytest.raises(ValueError, match="is"):
            wrong()
