"""The TMC4361's datagram, bit by bit."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.links import datagram40
from app.links.datagram40 import Reply, Request

ADDRESSES = st.integers(0, 0x7F)
WORDS = st.integers(0, 0xFFFF_FFFF)


@pytest.mark.sheet("DS-TMC4361", "5.1")
def test_the_bytes_on_the_wire() -> None:
    assert datagram40.read(0x21) == bytes.fromhex("21 00 00 00 00")
    assert datagram40.write(0x24, 0xABCDEF) == bytes.fromhex("a4 00 ab cd ef"), "0x80 is added for a write"
    assert Reply(0x81, 0x123456).encode() == bytes.fromhex("81 00 12 34 56")


@given(ADDRESSES, st.booleans(), WORDS)
def test_a_request_survives(address: int, write: bool, data: int) -> None:
    request = Request(address, write, data)
    assert Request.decode(request.encode()) == request


@given(st.integers(0, 255), WORDS)
def test_a_reply_survives(status: int, data: int) -> None:
    assert Reply.decode(Reply(status, data).encode()) == Reply(status, data)


@given(st.binary(min_size=5, max_size=5))
def test_any_five_bytes_are_a_datagram(frame: bytes) -> None:
    assert Request.decode(frame).encode() == frame
    assert Reply.decode(frame).encode() == frame


@given(st.binary(max_size=12).filter(lambda frame: len(frame) != 5))
def test_no_other_length_is_one(frame: bytes) -> None:
    for kind in (Request, Reply):
        with pytest.raises(ValueError, match="5 bytes"):
            kind.decode(frame)


@pytest.mark.parametrize(("address", "data"), [(-1, 0), (0x80, 0), (0, -1), (0, 1 << 32)])
def test_what_does_not_fit_is_refused(address: int, data: int) -> None:
    with pytest.raises(ValueError, match="is"):
        datagram40.write(address, data)


@pytest.mark.sheet("DS-TMC4361", "5.1")
@given(st.lists(ADDRESSES, max_size=8))
def test_a_chain_of_n_reads_costs_one_datagram_more(addresses: list[int]) -> None:
    frames = datagram40.read_chain(addresses)
    assert len(frames) == (len(addresses) + 1 if addresses else 0)
    assert [frame[0] for frame in frames[:-1]] == addresses
    assert all(frame[1:] == bytes(4) for frame in frames)
    if frames:
        assert frames[-1][0] == 0x7F, "what comes last must clear nothing"
