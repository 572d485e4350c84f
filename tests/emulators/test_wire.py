"""Datagrams, address space and power-on: DS-TMC428 chapters 6 and 7, DS-TMC4210 chapter 5."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.registers.catalog import MODELS
from app.registers.model import Access
from tests.emulators.harness import GLOBAL, POWER_DOWN, Bench

MODEL_NAMES = ("tmc428", "tmc4210")


@pytest.mark.sheet("DS-TMC4210", "5")
@pytest.mark.sheet("DS-TMC428", "6.1")
@pytest.mark.sheet("DS-TMC428", "7.2")
@pytest.mark.sheet("DS-TMC4210", "5.3")
@pytest.mark.parametrize("model", MODEL_NAMES)
def test_registers_are_zero_after_power_on_but_the_divider_and_fixed_bits(model: str) -> None:
    bench = Bench(model)
    for register in MODELS[model].table:
        if register.address < 0x40 and register.name != "REFERENCE_SWITCHES":
            assert bench.read(register.address) == (register.reset or 0), register.name
    assert bench.read(GLOBAL) >> 8 & 0xFF == 15


@pytest.mark.sheet("DS-TMC428", "7.3")
@pytest.mark.sheet("DS-TMC428", "11.1")
def test_ram_is_noise_after_power_on_and_the_seed_decides_which() -> None:
    def ram(bench: Bench) -> list[int]:
        return [bench.read(address) for address in range(0x40, 0x80)]

    bench, twin, other = Bench(options={"seed": 7}), Bench(options={"seed": 7}), Bench(options={"seed": 8})
    first = ram(bench)
    assert first == ram(twin) != ram(other)
    assert len(set(first)) > 40
    bench.patch(power_cycle=True)
    assert ram(bench) != first


@pytest.mark.sheet("DS-TMC428", "6.2")
@pytest.mark.sheet("DS-TMC428", "6.5")
def test_datagram_examples() -> None:
    """The write to %001101 and its reply, the read, and the pair of RAM words.

    The sheet prints 33 digits and a status of 10010101 for its first reply; with INT = 0, as its text
    says, that is 00010101.
    """
    bench = Bench()
    written = 0b0001101_0_000000000000000100100011
    assert bench.device.exchange(written.to_bytes(4, "big")) == bytes([0b00010101, 0, 0, 0])
    read = 0b0001101_1 << 24
    assert bench.device.exchange(read.to_bytes(4, "big")) == bytes([0b00010101, 0, 0x01, 0x23])
    ram = 0b1111111_0_0000000000100011_00100001
    bench.device.exchange(ram.to_bytes(4, "big"))
    assert bench.device.exchange(bytes([0xFF, 0, 0, 0])) == bytes([0b00010101, 0, 0b100011, 0b100001])


@pytest.mark.sheet("DS-TMC4210", "5.2.3")
def test_datagram_examples_of_the_tmc4210() -> None:
    bench = Bench("tmc4210")
    bench.write(0b001101, 0x123)
    assert bench.read(0b001101) == 0x123
    bench.write(0b1111111, 0b100011_00_100001)
    assert bench.read(0b1111111) == 0b100011_00_100001


@pytest.mark.sheet("DS-TMC4210", "5.2.2")
@pytest.mark.sheet("DS-TMC428", "6.4")
def test_reply_status_is_that_before_the_write() -> None:
    bench = Bench()
    bench.write(0x00, 5)
    assert bench.status & 1 == 1
    bench.read(0x00)
    assert bench.status & 1 == 0


@pytest.mark.sheet("DS-TMC428", "6.4")
@pytest.mark.parametrize("axis", [0, 1, 2])
def test_status_bits_of_each_motor(axis: int) -> None:
    bench = Bench(options={"wiring": "left-only"})
    bench.read(0)
    assert bench.status == 0b010101
    bench.write(axis << 4, 100)
    bench.switch(axis, left=True)
    bench.read(0)
    assert bench.status == 0b010101 ^ 1 << 2 * axis | 2 << 2 * axis


@pytest.mark.sheet("DS-TMC4210", "5.2.2.2")
def test_status_bits_of_the_tmc4210() -> None:
    bench = Bench("tmc4210")
    seen = []
    for change in ({}, {"left": True}, {"left": False, "right": True}, {"right": False}):
        bench.switch(**change)
        bench.read(0)
        seen.append(bench.status)
    bench.patch(inputs={"gp_in": True})
    bench.read(0)
    assert [*seen, bench.status] == [0x01, 0x03, 0x21, 0x01, 0x09]


@pytest.mark.sheet("DS-TMC4210", "6.2.1.5")
@pytest.mark.sheet("DS-TMC4210", "6.2.2")
@pytest.mark.sheet("DS-TMC4210", "5.2.2.2")
def test_right_switch_leaves_the_status_once_mot1r_is_set() -> None:
    bench = Bench("tmc4210")
    bench.switch(right=True)
    bench.read(0)
    assert (bench.status >> 5 & 1, bench.read(0x3E)) == (1, 0)
    bench.write(GLOBAL, 1 << 21 | 0xF00)
    bench.read(0)
    assert (bench.status >> 5 & 1, bench.read(0x3E)) == (0, 1)


@pytest.mark.sheet("DS-TMC4210", "5.2.2.2")
@pytest.mark.sheet("DS-TMC4210", "1.5.3")
def test_sdo_int_leaves_only_the_interrupt_on_the_output_pin() -> None:
    bench = Bench("tmc4210")
    bench.write(0x34, 2)
    assert bench.device.exchange(bytes([0x39 << 1 | 1, 0, 0, 0])) == b"\xff" * 4
    bench.device.exchange(bytes([0x0B << 1, 0, 0x40, 0]))
    bench.switch(left=True)
    assert bench.device.exchange(bytes([0x39 << 1 | 1, 0, 0, 0])) == b"\x00" * 4


@pytest.mark.sheet("DS-TMC428", "6.4")
@pytest.mark.sheet("DS-TMC428", "7.1")
@pytest.mark.sheet("DS-TMC428", "8")
@pytest.mark.sheet("DS-TMC428", "9")
@pytest.mark.sheet("DS-TMC4210", "5.2.2.1")
@pytest.mark.sheet("DS-TMC4210", "6.1")
@pytest.mark.sheet("DS-TMC4210", "6.2")
@pytest.mark.parametrize("model", MODEL_NAMES)
def test_unused_bits_read_zero_and_plain_registers_read_back(model: str) -> None:
    bench = Bench(model)
    plain = [
        register
        for register in MODELS[model].table
        if register.access is Access.RW and not register.volatile and register.name != "IF_CONFIGURATION_4210"
    ]
    assert len(plain) >= 10
    for word in (0xFFFFFF, 0x555555, 0xAAAAAA, 0):
        for register in plain:
            bench.write(register.address, word)
        for register in plain:
            fixed = 0x8000 if register.address & 0x4F == 0x09 else 0
            assert bench.read(register.address) == word & register.write_mask | fixed, register.name


@pytest.mark.sheet("DS-TMC428", "7.3")
@pytest.mark.sheet("DS-TMC428", "8.17")
@pytest.mark.sheet("DS-TMC428", "9.4")
@pytest.mark.parametrize("model", MODEL_NAMES)
def test_unused_addresses_ignore_writes_and_read_zero(model: str) -> None:
    bench = Bench(model)
    table = MODELS[model].table
    unused = [address for address in range(0x40) if table.at(address) is None]
    assert {0x3A, 0x3D} <= set(unused)
    before = [bench.read(register.address) for register in table]
    for address in unused:
        bench.write(address, 0xFFFFFF)
        assert bench.read(address) == 0
    assert [bench.read(register.address) for register in table] == before


@pytest.mark.sheet("DS-TMC428", "7.1")
@pytest.mark.parametrize("address", [0x07, 0x17, 0x27, 0x3E])
def test_read_only_registers_ignore_writes(address: int) -> None:
    bench = Bench()
    bench.write(address, 0xFFFFFF)
    assert bench.read(address) == 0


@pytest.mark.sheet("DS-TMC4210", "6.2.1.4")
@pytest.mark.sheet("DS-TMC4210", "5.3")
def test_type_version_is_read_only() -> None:
    bench = Bench("tmc4210")
    bench.write(0x39, 0)
    assert bench.read(0x39) == 0x429101


@pytest.mark.sheet("DS-TMC428", "9.5")
@pytest.mark.sheet("DS-TMC4210", "6.2.1.3")
@pytest.mark.parametrize("model", MODEL_NAMES)
def test_power_down_stops_the_clocks_until_the_next_datagram(model: str) -> None:
    bench = Bench(model)
    bench.write(0x34, 0x20)
    bench.ramp(mode=2)
    bench.write(0x04, 500)
    bench.seconds(0.01)
    moving = bench.x
    assert moving > 0
    bench.write(POWER_DOWN, 0)
    assert bench.device.state().powered_down
    carriage = bench.place()
    bench.seconds(10.0)
    assert bench.place() == carriage
    assert bench.device.state().powered_down
    assert bench.x == moving  # the read woke it, and registers were preserved
    assert not bench.device.state().powered_down
    bench.seconds(0.01)
    assert bench.x > moving


@pytest.mark.sheet("DS-TMC428", "9.5")
def test_a_switch_that_moved_in_power_down_is_seen_on_waking() -> None:
    bench = Bench(options={"wiring": "left-only"})
    bench.write(POWER_DOWN, 0)
    bench.switch(left=True)
    bench.seconds(1.0)
    assert bench.read(0x3E) == 0b10


@pytest.mark.sheet("DS-TMC428", "6.2")
@pytest.mark.parametrize("length", [0, 1, 3, 5, 8])
def test_a_frame_is_32_bits(length: int) -> None:
    with pytest.raises(ValueError, match="4 bytes"):
        Bench().device.exchange(bytes(length))


@settings(max_examples=60, deadline=None)
@given(
    st.sampled_from(MODEL_NAMES),
    st.lists(st.tuples(st.binary(min_size=4, max_size=4), st.floats(0, 0.01)), max_size=40),
)
def test_any_frames_are_answered(model: str, frames: list[tuple[bytes, float]]) -> None:
    bench = Bench(model)
    for frame, pause_s in frames:
        bench.seconds(pause_s)
        assert len(bench.device.exchange(frame)) == 4
    bench.seconds(0.1)
    bench.device.state()
