"""The 32-bit datagram against the data sheets' own examples."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.links import datagram32
from app.links.datagram32 import Reply, Request
from app.registers.tmc428.status import STATUS_TMC428, STATUS_TMC4210


def frame(bits: str) -> bytes:
    return int(bits, 2).to_bytes(4, "big")


@pytest.mark.sheet("DS-TMC428", "6.5")
@pytest.mark.sheet("DS-TMC4210", "5.2.3")
def test_the_sample_datagrams() -> None:
    """Some samples are printed with 33 digits; 24 data bits are what the text says."""
    assert datagram32.write(0b001101, 0x000123) == frame("0" + "001101" + "0" + "000000000000000100100011")
    assert datagram32.read(0b001101) == frame("00011011" + "0" * 24)
    assert Reply.decode(frame("10010101" + "000000000000000100100011")) == Reply(0b10010101, 0x000123)
    assert datagram32.write(0b1111111, 0b100011_00_100001) == frame("11111110000000000010001100100001")
    assert datagram32.read(0b1111111) == frame("11111111" + "0" * 24)


@pytest.mark.sheet("DS-TMC428", "6.4")
def test_status_bits_of_the_tmc428() -> None:
    """The sample status %10010101: interrupt set, no switch, every motor at its target."""
    flags = datagram32.status_flags(0b10010101, STATUS_TMC428)
    assert {name for name, on in flags.items() if on} == {"INT", "xEQt1", "xEQt2", "xEQt3"}


@pytest.mark.sheet("DS-TMC4210", "5.2.2.2")
def test_status_bits_of_the_tmc4210() -> None:
    flags = datagram32.status_flags(0b10101011, STATUS_TMC4210)
    assert {name for name, on in flags.items() if on} == {"INT", "R_R", "GP_IN", "R_L", "xEQt1"}


@given(st.integers(0, 0x7F), st.booleans(), st.integers(0, 0xFF_FFFF))
def test_requests_survive_the_wire(address: int, read: bool, data: int) -> None:
    request = Request(address, read, data)
    assert Request.decode(request.encode()) == request


@given(st.integers(0, 0xFF), st.integers(0, 0xFF_FFFF))
def test_replies_survive_the_wire(status: int, data: int) -> None:
    assert Reply.decode(Reply(status, data).encode()) == Reply(status, data)


@pytest.mark.parametrize("length", [0, 1, 3, 5, 8])
def test_a_frame_of_another_length_is_refused(length: int) -> None:
    with pytest.raises(ValueError, match="4 bytes"):
        Reply.decode(bytes(length))


@pytest.mark.parametrize(("address", "data"), [(-1, 0), (0x80, 0), (0, -1), (0, 1 << 24)])
def test_a_request_that_cannot_be_sent_is_refused(address: int, data: int) -> None:
    with pytest.raises(ValueError, match="is"):
        Request(address, False, data)
