"""What drivers of register chips say and what they believe, over SPI datagrams and over an evaluation board."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.clock import VirtualClock
from app.emulators.board.board import EmulatedBoard
from app.emulators.tmc4361 import EmulatedTmc4361
from app.links import datagram40, tmcl
from app.links.errors import BadReply
from app.links.register_access import LandungsbrueckeAccess, RegisterAccess, Spi40Access, access_of, cut

X_COMPARE, X_TARGET, VIRTUAL_LEFT, VERSION = 0x32, 0x37, 0x33, 0x7F
WORDS = st.integers(0, 0xFFFF_FFFF)


class Far:
    """An emulated chip behind one kind of access."""

    def __init__(self, kind: str) -> None:
        clock = VirtualClock()
        self.chip = EmulatedTmc4361(clock)
        self.access: RegisterAccess = Spi40Access() if kind == "spi" else LandungsbrueckeAccess()
        self._board = EmulatedBoard(self.chip) if kind == "board" else None

    def say(self, frames: tuple[bytes, ...]) -> list[bytes]:
        if self._board is None:
            return [self.chip.exchange(frame) for frame in frames]
        replies = [self._board.receive(frame) for frame in frames]
        return [reply for reply in replies if reply is not None]


@pytest.fixture(params=["spi", "board"])
def far(request: pytest.FixtureRequest) -> Far:
    return Far(str(request.param))


def test_what_is_written_is_read_in_one_chain(far: Far) -> None:
    access = far.access
    writes = [(X_COMPARE, 0xFFFF_FFFE), (VIRTUAL_LEFT, 0x8000_0000), (X_TARGET, 0)]
    frames = access.write_frames(writes)
    access.check_all(frames, far.say(frames))
    asked = [X_TARGET, X_COMPARE, VIRTUAL_LEFT, X_COMPARE]
    frames = access.read_frames(asked)
    replies = far.say(frames)
    access.check_all(frames, replies)
    assert access.words(replies) == [0, 0xFFFF_FFFE, 0x8000_0000, 0xFFFF_FFFE]
    assert {len(frame) for frame in frames} == {access.frame_bytes}
    assert {len(reply) for reply in replies} == {access.reply_bytes}
    assert cut(access, b"".join(replies)) == replies


def test_a_single_write(far: Far) -> None:
    frame = far.access.write_frame(X_COMPARE, 77)
    (reply,) = far.say((frame,))
    far.access.check(frame, reply)
    assert far.access.words(far.say(far.access.read_frames([X_COMPARE]))) == [77]


def test_nothing_costs_nothing(far: Far) -> None:
    assert far.access.read_frames([]) == far.access.write_frames([]) == ()
    assert far.access.words([]) == []
    assert far.access.status([]) is None


@pytest.mark.sheet("002", "5.1")
def test_every_spi_reply_bears_the_status_and_no_reply_of_a_board_does() -> None:
    spi, board = Far("spi"), Far("board")
    replies = spi.say(spi.access.read_frames([0x0E, VERSION]))
    assert spi.access.status(replies) == replies[-1][0]
    assert replies[0][0] & 0x80, "the reset event, which is selected by default"
    assert not replies[-1][0] & 0x80, "cleared by reading EVENTS"
    assert board.access.status(board.say(board.access.read_frames([VERSION]))) is None


@pytest.mark.sheet("002", "5.1")
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
    frames = far.access.read_frames([VERSION, VERSION])
    with pytest.raises(BadReply, match="replies to"):
        far.access.check_all(frames, far.say(frames)[:-1])
    with pytest.raises(BadReply, match="no whole number"):
        cut(far.access, b"".join(far.say(frames))[:-1])


@given(st.binary(min_size=9, max_size=9))
def test_a_board_is_believed_only_with_checksum_module_command_and_status(reply: bytes) -> None:
    access = LandungsbrueckeAccess()
    believable = tmcl.sound(reply) and reply[1] == 1 and reply[2] in (100, 101) and reply[3] == 148
    if believable:
        assert access.words([reply]) == [int.from_bytes(reply[4:8], "big")]
    else:
        with pytest.raises(BadReply):
            access.words([reply])


def test_a_board_that_refuses_is_told_in_its_words() -> None:
    access = LandungsbrueckeAccess("landungsbruecke /dev/x")
    reply = tmcl.Reply(2, 1, 2, 148).encode()
    with pytest.raises(BadReply, match=r"landungsbruecke /dev/x: the board refuses: invalid command"):
        access.words([reply])


def test_addresses_of_twelve_bits_and_axes_share_the_motor_byte() -> None:
    access = LandungsbrueckeAccess(motor=3)
    assert access.read_frames([0xA21])[0][:4] == bytes((1, 148, 0x21, 0xA3))
    assert access.write_frame(0x21, 5)[:8] == bytes((1, 146, 0x21, 3, 0, 0, 0, 5))
    for wrong in (lambda: access.read_frames([0x1000]), lambda: access.write_frame(0, 1 << 32)):
        with pytest.raises(ValueError, match="is"):
            wrong()
    with pytest.raises(ValueError, match="motor"):
        LandungsbrueckeAccess(motor=16)


def test_the_kind_of_a_link_says_how() -> None:
    for kind in ("emulator", "tcp", "spidev"):
        assert isinstance(access_of({"kind": kind}, "tmc4361"), Spi40Access)
    board = access_of({"kind": "landungsbruecke", "port": "/dev/ttyACM0", "motor": 2}, "tmc4361")
    assert isinstance(board, LandungsbrueckeAccess)
    assert (board.motor, board.name) == (2, "landungsbruecke /dev/ttyACM0")
