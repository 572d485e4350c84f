"""The single wire: CRC, node addresses, the counter of writes, and a TMC5062 that has no node.

Datagrams are printed with their CRC as public sources have them, besides those that app.links.datagram_uart makes.
"""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.clock import VirtualClock
from app.emulators.tmc5xxx import EmulatedTmc5xxx, Tmc5xxxModel
from app.links.datagram_uart import UartForm
from tests.emulators.tmc5xxx.rig import Bench

WITH_NODES: tuple[Tmc5xxxModel, ...] = ("tmc5072", "tmc5130", "tmc5160")
XACTUAL, XTARGET, VMAX = 0x21, 0x2D, 0x27


@pytest.mark.parametrize("model", WITH_NODES)
def test_datagrams_as_they_are_published(model: Tmc5xxxModel) -> None:
    bench = Bench(model)
    assert bench.chip.uart(bytes.fromhex("05 00 a7 00 03 0d 40 31")) == b"", "VMAX = 200000: a write has no answer"
    assert bench.read("IFCNT") == 1
    bench.write("XACTUAL", -500)
    assert bench.chip.uart(UartForm(0).read(XACTUAL)) == bytes.fromhex("05 ff 21 ff ff fe 0c 97")
    assert bench.chip.uart(bytes.fromhex("05 00 00 48")) == UartForm(0).reply(0x00, bench.read("GCONF"))


def test_a_tmc5062_has_no_node_and_answers_with_f5() -> None:
    bench = Bench("tmc5062")
    form = UartForm(None)
    assert bench.chip.uart(bytes.fromhex("05 a4 00 00 27 10 71")) == b""
    assert bench.chip.uart(form.write(XTARGET, 0xDEADBEEF)) == b""
    reply = bench.chip.uart(form.read(XTARGET))
    assert reply[0] == 0xF5
    assert form.data_of(XTARGET, reply) == 0xDEADBEEF
    assert bench.read("IFCNT") == 2
    assert bench.chip.uart(UartForm(0).read(XTARGET)) == b"", "a datagram with a node is not one of its"


def test_a_tmc5031_has_no_uart() -> None:
    bench = Bench("tmc5031")
    for form in (UartForm(0), UartForm(None)):
        assert bench.chip.uart(form.write(XTARGET, 1)) == bench.chip.uart(form.read(XTARGET)) == b""
    assert bench.read("XTARGET") == 0
    assert bench.state().uart is None


@pytest.mark.parametrize("model", WITH_NODES)
@given(datagram=st.integers(0, 7), bit=st.integers(0, 7), value=st.integers(0, 0xFFFFFFFF))
def test_a_wrong_crc_is_no_datagram(model: Tmc5xxxModel, datagram: int, bit: int, value: int) -> None:
    """INFERRED: no source tells what a chip does with it; ours neither obeys nor counts nor answers."""
    chip = EmulatedTmc5xxx(model, VirtualClock())
    for sent in (UartForm(0).write(XTARGET, value), UartForm(0).read(XTARGET)):
        spoilt = bytearray(sent)
        spoilt[datagram % len(sent)] ^= 1 << bit
        assert chip.uart(bytes(spoilt)) == b""
    assert chip.read(XTARGET) == 0
    assert chip.read(0x02) == 0


@pytest.mark.parametrize("model", WITH_NODES)
@given(node=st.integers(0, 253), other=st.integers(0, 254))
def test_only_the_node_that_is_meant_obeys(model: Tmc5xxxModel, node: int, other: int) -> None:
    chip = EmulatedTmc5xxx(model, VirtualClock())
    chip.uart(UartForm(0).write(0x03, node))
    chip.uart(UartForm(node).write(XTARGET, 5))
    assert chip.read(XTARGET) == 5
    answer = chip.uart(UartForm(other).read(XTARGET))
    assert bool(answer) == (other == node)


@pytest.mark.parametrize("model", WITH_NODES)
def test_nextaddr_high_makes_the_address_one_more(model: Tmc5xxxModel) -> None:
    bench = Bench(model, node_pin=True)
    assert bench.state().uart.node == 1  # type: ignore[union-attr]
    assert bench.chip.uart(UartForm(0).read(0x02)) == b""
    bench.chip.uart(UartForm(1).write(0x03, 8))
    assert bench.chip.uart(UartForm(9).read(0x02)) == UartForm(9).reply(0x02, 1)
    bench.patch(pins={"nextaddr": False})
    assert bench.chip.uart(UartForm(8).read(0x02)) == UartForm(8).reply(0x02, 1)


@pytest.mark.parametrize("model", [*WITH_NODES, "tmc5062"])
def test_the_counter_of_writes_goes_round(model: Tmc5xxxModel) -> None:
    bench = Bench(model)
    form = UartForm(None if model == "tmc5062" else 0)
    for _ in range(257):
        bench.chip.uart(form.write(XTARGET, 1))
    bench.chip.write(XTARGET, 2)
    assert form.data_of(0x02, bench.chip.uart(form.read(0x02))) == 1, "SPI does not count"
    bench.patch(power_cycle=True)
    assert bench.read("IFCNT") == 0


@pytest.mark.parametrize("model", [*WITH_NODES, "tmc5062"])
@pytest.mark.parametrize(("code", "bits"), [(0, 8), (1, 8), (2, 24), (3, 24), (4, 40), (5, 40), (14, 120), (15, 120)])
def test_how_long_an_answer_waits(model: Tmc5xxxModel, code: int, bits: int) -> None:
    """SENDDELAY 11:8, and 7:4 in a TMC5062: odd multiples of 8 bit times (NOTES-TMC5XXX 7)."""
    bench = Bench(model)
    assert bench.chip.reply_delay_bits == 8
    bench.chip.write(0x03, code << (4 if model == "tmc5062" else 8))
    assert bench.chip.reply_delay_bits == bits
    assert bench.state().uart.reply_delay_bits == bits  # type: ignore[union-attr]


@pytest.mark.parametrize("model", WITH_NODES)
def test_faults_spoil_answers_only(model: Tmc5xxxModel) -> None:
    bench = Bench(model)
    bench.patch(faults={"silence": True})
    assert bench.chip.uart(UartForm(0).write(XTARGET, 3)) == b"", "nobody waits for the answer to a write"
    with pytest.raises(TimeoutError):
        bench.chip.uart(UartForm(0).read(XTARGET))
    bench.patch(faults={"silence": False, "bit_error_rate": 0.2})
    with pytest.raises(ValueError, match=r"CRC|begins|register"):
        UartForm(0).data_of(XTARGET, bench.chip.uart(UartForm(0).read(XTARGET)))
    assert bench.read("XTARGET") == 3
    bench.patch(faults={"unplugged": True})
    with pytest.raises(ConnectionError):
        bench.chip.uart(UartForm(0).read(XTARGET))


@pytest.mark.parametrize("datagram", [b"", b"\x05", b"\x05\x00", bytes.fromhex("07 00 00 48"), bytes(9)])
def test_what_is_no_datagram_is_not_answered(datagram: bytes) -> None:
    assert EmulatedTmc5xxx("tmc5160", VirtualClock()).uart(datagram) == b""
