"""SPI: 40 bits, whose answer comes with the next ones, and the status byte of this moment.

The status bytes are those of the data sheets of the TMC5031 (page 17) for chips with two axes, and of the TMC5130's
and TMC5160's for those with one.
"""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.clock import VirtualClock
from app.emulators.tmc5xxx import MODELS, EmulatedTmc5xxx, Tmc5xxxModel, Tmc5xxxOptions
from app.emulators.tmc5xxx.family import FAMILY
from app.links.datagram40 import read, write
from tests.emulators.tmc5xxx.rig import DUAL, SINGLE, Bench, moving

XACTUAL, XTARGET = 0x21, 0x2D
RESET = 1


@pytest.mark.parametrize("model", MODELS)
@given(words=st.lists(st.integers(0, 0xFFFFFFFF), min_size=1, max_size=8))
def test_the_data_belong_to_the_datagram_before(model: Tmc5xxxModel, words: list[int]) -> None:
    chip = EmulatedTmc5xxx(model, VirtualClock())
    told = [chip.exchange(write(XTARGET, word))[1:] for word in words] + [chip.exchange(read(XTARGET))[1:]]
    assert told == [bytes(4), *(word.to_bytes(4, "big") for word in words)]
    assert chip.exchange(read(XACTUAL))[1:] == words[-1].to_bytes(4, "big")
    assert chip.exchange(read(XACTUAL))[1:] == bytes(4)


@pytest.mark.parametrize("model", MODELS)
def test_a_read_is_taken_when_it_is_asked_for(model: Tmc5xxxModel) -> None:
    bench = moving(model)
    bench.put(RAMPMODE=1)
    bench.wait(1)
    bench.chip.exchange(read(XACTUAL), bench.now_s)
    then = bench.read("XACTUAL")
    bench.wait(1)
    assert int.from_bytes(bench.chip.exchange(read(XACTUAL), bench.now_s)[1:], "big") == then


def test_other_lengths() -> None:
    chip = EmulatedTmc5xxx("tmc5160", VirtualClock())
    with pytest.raises(ValueError, match="5 bytes"):
        chip.exchange(bytes(4))
    chip.transfer(b"\x77\x66" + write(XTARGET, 0x01020304))
    assert chip.transfer(bytes(2))[1:] == b"\x01", "less than 40 bits only fetch the beginning"
    assert chip.transfer(b"\xab\xcd" + read(XTARGET))[1:] == b"\x01\x02\x03\x04\xab\xcd", "more go on to the next chip"
    assert chip.exchange(read(XTARGET))[1:] == b"\x01\x02\x03\x04"


@pytest.mark.parametrize("model", SINGLE)
def test_the_status_byte_of_chips_with_one_axis(model: Tmc5xxxModel) -> None:
    bench = moving(model)
    standing, fast, there = 1 << 3, 1 << 4, 1 << 5
    assert bench.status == RESET | standing | there
    bench.write("GSTAT", bench.raw("GSTAT"))
    bench.put(XTARGET=100_000)
    bench.wait(0.1)
    assert bench.status == 0
    bench.wait(0.7)
    assert bench.status == fast
    bench.wait(1)
    assert bench.status & ~standing == there
    bench.stage(switches={"left": True})
    assert bench.status & 0xC0 == 1 << 6
    bench.stage(switches={"left": "auto", "right": True})
    assert bench.status & 0xC0 == 1 << 7
    bench.stage(motor={"temperature_c": 155})
    assert bench.status & 0b110 == 0b010


@pytest.mark.parametrize("model", SINGLE)
def test_a_stall_is_told_by_the_status_byte(model: Tmc5xxxModel) -> None:
    bench = moving(model, rigid=False)
    bench.put(RAMPMODE=1)
    bench.wait(1)
    assert not bench.status & 1 << 2
    bench.stage(blocked=True)
    bench.wait(0.2)
    assert bench.status & 1 << 2


@pytest.mark.parametrize("model", DUAL)
def test_the_status_byte_of_chips_with_two_axes(model: Tmc5xxxModel) -> None:
    bench = moving(model, axis=1)
    assert bench.status == RESET | 1 << 3, "VMAX of motor 1 is 0, and so is its velocity"
    bench.raw("GSTAT")
    bench.put(axis=0, VMAX=1000)
    bench.put(axis=1, RAMPMODE=1)
    bench.wait(0.1)
    assert bench.status == 0
    bench.wait(0.9)
    assert bench.status == 1 << 4
    bench.stage(axis=0, switches={"left": True})
    assert bench.status == 1 << 4 | 1 << 5
    bench.stage(axis=1, switches={"left": True, "right": True})
    assert bench.status == 1 << 4 | 1 << 5 | 1 << 6
    bench.stage(axis=1, motor={"temperature_c": 155})
    assert bench.status & 0b110 == 0b100
    bench.stage(axis=0, motor={"temperature_c": 155})
    assert bench.status & 0b110 == 0b110


@pytest.mark.parametrize("model", MODELS)
def test_faults_between_the_chip_and_us(model: Tmc5xxxModel) -> None:
    bench = Bench(model)
    bench.patch(faults={"silence": True})
    with pytest.raises(TimeoutError):
        bench.chip.exchange(write(XTARGET, 7))
    bench.patch(faults={"silence": False, "unplugged": True})
    with pytest.raises(ConnectionError):
        bench.chip.exchange(read(XTARGET))
    with pytest.raises(ConnectionError):
        bench.read("XTARGET")
    bench.patch(faults={"unplugged": False})
    assert bench.read("XTARGET") == 7, "a silent chip obeys"
    bench.patch(faults={"bit_error_rate": 1.0})
    bench.chip.exchange(read(XTARGET))
    assert bench.chip.exchange(read(XTARGET))[1:] == b"\xff\xff\xff\xf8"


def test_the_factory_makes_each() -> None:
    for model in MODELS:
        assert FAMILY.make(model, VirtualClock(), Tmc5xxxOptions(clock_hz=12e6)).state().clock_hz == 12e6
