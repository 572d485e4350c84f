"""Datagrams of a told format: those of known chips to the bit, every format both ways, and what does not fit."""

from __future__ import annotations

import itertools
import random

import pytest

from app.errors import BadReply, WrongState
from app.links import datagram32, datagram40
from app.links.spi_access import SpiAccess, TaggedAccess
from app.links.spi_datagram import Request, answer, data_of, decode, encode
from app.registers.spi_format import USUAL, SpiFormat, TaggedFormat

FORMS = [
    SpiFormat(*told)  # type: ignore[arg-type]
    for told in itertools.product(
        (8, 16, 32, 48, 64), (1, 7, 8, 10, 15), ("high", "low"), (0, 1), ("big", "little"), ("next", "same")
    )
]


@pytest.mark.parametrize("write", [False, True])
def test_the_datagrams_of_known_chips_are_formats_too(write: bool) -> None:
    data = 0x12_3456 if write else 0
    old = SpiFormat(24, write_bit="low", write_is=0, answer="same")
    assert encode(old, Request(0x2A, write, data)) == datagram32.Request(0x2A, not write, data).encode()
    assert encode(USUAL, Request(0x2A, write, data)) == datagram40.Request(0x2A, write, data).encode()


def test_every_format_says_and_hears_the_same() -> None:
    numbers = random.Random(15)
    for form in FORMS:
        request = Request(
            numbers.randrange(form.address_max + 1), numbers.random() < 0.5, numbers.getrandbits(form.data_bits)
        )
        frame = encode(form, request)
        assert len(frame) == form.frame_bytes
        assert decode(form, frame) == request
        assert data_of(form, answer(form, request.data, 1)) == request.data


def test_bytes_of_two_formats_by_hand() -> None:
    # 10 address bits behind the write bit of two bytes, as the maker's C code shifts them (TMC-API).
    assert encode(SpiFormat(address_bits=10), Request(0x385, True, 0x01020304)).hex() == "838501020304"
    assert encode(SpiFormat(16, byte_order="little"), Request(0x05, False, 0x1234)).hex() == "053412"


@pytest.mark.parametrize("told", [{"data_bits": 12}, {"data_bits": 72}, {"address_bits": 0}, {"address_bits": 16}])
def test_a_format_that_cannot_be_is_refused(told: dict[str, int]) -> None:
    with pytest.raises(ValueError, match="not"):
        SpiFormat(**told)  # type: ignore[arg-type]


def test_what_does_not_fit_is_refused() -> None:
    form = SpiFormat(16)
    for request in (Request(128, False), Request(1, True, 1 << 16), Request(-1, False)):
        with pytest.raises(ValueError, match="not"):
            encode(form, request)
    access = SpiAccess(form)
    with pytest.raises(BadReply, match="2 bytes instead of 3"):
        access.words([b"\0\0", b"\0\0\0"])
    with pytest.raises(BadReply, match="1 replies to 2 frames"):
        access.check_all(access.write_frames([(1, 2)]), [b"\0\0\0"])


def test_answers_come_with_the_next_or_the_same() -> None:
    later, same = SpiAccess(SpiFormat(16)), SpiAccess(SpiFormat(16, answer="same"))
    assert len(later.read_frames((1, 2))) == 3
    assert later.words([b"\0\xff\xff", b"\0\0\1", b"\0\0\2"]) == [1, 2]
    assert len(same.read_frames((1, 2))) == 2
    assert same.words([b"\0\0\1", b"\0\0\2"]) == [1, 2]
    assert later.read_frames(()) == same.read_frames(()) == ()
    assert [later.is_read(frame) for frame in (later.write_frame(1, 1), later.read_frames((1,))[0])] == [False, True]


# --- 20 bits whose uppermost say the register -----------------------------------------------------


def test_upper_bits_say_the_register() -> None:
    access = TaggedAccess(TaggedFormat())
    told = {0x8: 0x2_0000 | 5, 0xC: 0x1_1935, 0xD: 0x8202, 0xE: 0x0505, 0xF: 0xF040}
    frames = {address: access.write_frame(address, word).hex() for address, word in told.items()}
    # API, tmc/ic/TMC2660: DRVCTRL 00, CHOPCONF 100, SMARTEN 101, SGCSCONF 110, DRVCONF 111
    assert frames == {0x8: "020005", 0xC: "091935", 0xD: "0a8202", 0xE: "0c0505", 0xF: "0ef040"}
    for address, frame in frames.items():
        assert access.form.address_of(int(frame, 16)) == address


def test_a_status_is_read_only_once_the_selecting_register_is_known_and_leaves_it_as_it_was() -> None:
    access = TaggedAccess(TaggedFormat())
    with pytest.raises(WrongState, match="no status can be read yet"):
        access.read_frames((1,))
    (frame,) = access.write_frames([(0xF, 0xF040)])
    with pytest.raises(WrongState):  # it has not gone out
        access.read_frames((1,))
    access.check_all((frame,), (b"\0\0\0",))
    assert [each.hex() for each in access.read_frames((1, 2))] == ["0ef050", "0ef040", "0ef060", "0ef040"]
    # Of 24 bits the first 20 are the answer.
    assert access.words([b"\0\0\0", b"\xab\xcd\xe0", b"\0\0\0", b"\x00\x00\x10"]) == [0xABCDE, 1]
    access.on_state("failed", None)
    with pytest.raises(WrongState):
        access.read_frames((1,))


def test_a_status_is_not_written_nor_a_register_read() -> None:
    access = TaggedAccess(TaggedFormat())
    with pytest.raises(ValueError, match="a status cannot be written"):
        access.write_frame(1, 0)
    with pytest.raises(ValueError, match="data is 17 bits"):
        access.write_frame(0xC, 1 << 17)
    access.check_all(access.write_frames([(0xF, 0)]), (b"\0\0\0",))
    with pytest.raises(ValueError, match="cannot be read"):
        access.read_frames((0xC,))
