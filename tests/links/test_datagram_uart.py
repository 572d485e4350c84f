"""UART datagrams of the TMC5xxx: published vectors, an independent CRC, and every flipped bit found."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.links.datagram_uart import HOST, UartForm, crc8

forms = st.one_of(st.builds(UartForm, st.integers(0, HOST - 1)), st.just(UartForm(None)))
registers = st.integers(0, 127)
words = st.integers(0, (1 << 32) - 1)


def bitwise_crc(data: bytes) -> int:
    """Bit by bit, as the chip's shift register does it."""
    crc = 0
    for byte in data:
        for bit in range(8):
            feedback = (crc >> 7) ^ (byte >> bit & 1)
            crc = (crc << 1 & 0xFF) ^ (0x07 if feedback else 0)
    return crc


@given(st.binary(max_size=20))
def test_the_table_counts_as_the_shift_register(data: bytes) -> None:
    assert crc8(data) == bitwise_crc(data)


@pytest.mark.parametrize(
    ("frame", "bytes_hex"),
    [
        (UartForm(0).read(0x00), "05 00 00 48"),  # both widely published
        (UartForm(0).read(0x06), "05 00 06 6f"),
        (UartForm(1).read(0x21), "05 01 21 6b"),
        (UartForm(0).write(0x27, 200_000), "05 00 a7 00 03 0d 40 31"),
        (UartForm(0).reply(0x21, -500 & 0xFFFF_FFFF), "05 ff 21 ff ff fe 0c 97"),
        (UartForm(None).write(0x24, 10_000), "05 a4 00 00 27 10 71"),
    ],
)
def test_known_datagrams(frame: bytes, bytes_hex: str) -> None:
    assert frame == bytes.fromhex(bytes_hex)


@given(forms, registers, words)
def test_an_answer_is_what_was_said(form: UartForm, register: int, word: int) -> None:
    reply = form.reply(register, word)
    assert len(reply) == form.reply_bytes
    assert form.data_of(register, reply) == word
    assert len(form.write(register, word)) == form.write_bytes
    assert len(form.read(register)) == form.read_bytes


@given(forms, registers, words, st.data())
def test_no_flipped_bit_goes_unseen(form: UartForm, register: int, word: int, data: st.DataObject) -> None:
    reply = bytearray(form.reply(register, word))
    bit = data.draw(st.integers(0, 8 * len(reply) - 1))
    reply[bit // 8] ^= 1 << bit % 8
    with pytest.raises(ValueError, match="CRC"):
        form.data_of(register, bytes(reply))


def test_what_is_wrong_with_an_answer_is_told() -> None:
    form = UartForm(3)
    with pytest.raises(ValueError, match="7 bytes instead of 8"):
        form.data_of(0x21, form.reply(0x21, 5)[:-1])
    with pytest.raises(ValueError, match="register 0x22 instead of 0x21"):
        form.data_of(0x21, form.reply(0x22, 5))
    with pytest.raises(ValueError, match="no answer to the host"):  # the echo of a write on the single wire
        form.data_of(0x21, form.write(0x21, 5))


def test_what_cannot_be_sent_is_refused() -> None:
    for refused in (lambda: UartForm(255), lambda: UartForm(0).read(128), lambda: UartForm(0).write(0, 1 << 32)):
        with pytest.raises(ValueError, match=r"is|not"):
            refused()
