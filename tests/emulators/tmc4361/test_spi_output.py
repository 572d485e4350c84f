"""What the SPI output sends by itself, by spi_output_format, and what a TMC23x or TMC24x behind it tells."""

from __future__ import annotations

import pytest

from app.emulators.tmc4361 import Tmc4361Patch, Tmc4361State
from tests.emulators.tmc4361.rig import TRAPEZOID_VELOCITY, Ramp, Rig

TMC23X, TMC24X = 8, 9
CURRENT_B_FULL = 247
"""At place 0 of the microstep table, with A at 0 (DS-TMC4361 11)."""


def state(rig: Rig) -> Tmc4361State:
    described = rig.chip.state(rig.now_s)
    assert isinstance(described, Tmc4361State)
    return described


def out(rig: Rig) -> list[str]:
    rig.now_s += 1e-3
    told = state(rig).spi_output
    return [] if told is None else told.datagrams


def at(place: int, form: int, **words: int) -> Rig:
    """A chip at rest at a place of the microstep table [1/1024], all currents scaled by 1."""
    rig = Rig()
    rig.ramp(Ramp(), 5)
    rig.write("XTARGET", place)
    rig.now_s += 2.0
    for name, word in words.items():
        rig.write(name, word)
    rig.write("SPI_OUT_CONF", form)
    return rig


@pytest.mark.parametrize(
    ("form", "place", "told"),
    [
        (0, 0, []),
        (11, 0, []),
        (15, 0, []),
        (4, 0, ["11111111"]),
        (5, 0, [f"{0:09b}{CURRENT_B_FULL:09b}"]),
        (5, 512, [f"{0x1FF:09b}{-CURRENT_B_FULL - 1 & 0x1FF:09b}"]),
        (10, 0, [f"00{0:09b}0{CURRENT_B_FULL:08b}"]),
        (8, 0, ["000000011110"]),
        (9, 512, ["000001011111"]),
    ],
)
def test_what_goes_out_by_format(form: int, place: int, told: list[str]) -> None:
    assert out(at(place, form)) == told


@pytest.mark.parametrize(
    ("mixed_decay", "rest", "constant"), [(0, "0", "0"), (1, "0", "0"), (2, "0", "1"), (3, "1", "1")]
)
def test_mixed_decay_of_a_tmc24x(mixed_decay: int, rest: str, constant: str) -> None:
    rig = at(0, TMC24X | mixed_decay << 4)
    assert out(rig)[0][0] + out(rig)[0][6] == rest * 2
    rig.ramp(Ramp(vmax=2000.0), TRAPEZOID_VELOCITY)
    rig.now_s += 1.0
    assert out(rig)[0][0] + out(rig)[0][6] == constant * 2


LENGTH, COMMAND = 24 << 13, 4 << 7


@pytest.mark.parametrize(
    ("form", "place", "told"),
    [
        (1, 0, ["0011" + f"{256:09b}" + "0" * 11, "1001" + f"{256 + CURRENT_B_FULL:09b}" + "0" * 11]),
        (2, 0, ["0011" + "00000000" + "0" * 12, "1001" + f"{CURRENT_B_FULL:08b}" + "0" * 12]),
        (3, 512, ["0011" + "00000001" + "0" * 12, "1001" + f"{CURRENT_B_FULL + 1:08b}" + "0" * 12]),
        (6, 0, ["0011" + "11111111" + "0" * 12]),
    ],
)
def test_what_a_dac_gets_is_its_command_and_behind_it_the_value(form: int, place: int, told: list[str]) -> None:
    assert out(at(place, form | LENGTH | COMMAND, DAC_ADDR=0x0009_0003)) == told


@pytest.mark.parametrize(
    ("form", "place", "levels"), [(2, 0, (False, False)), (2, 512, (True, True)), (3, 0, (True, True))]
)
def test_phases_of_absolute_values_are_at_stpout_and_dirout(form: int, place: int, levels: tuple[bool, bool]) -> None:
    pins = state(at(place, form)).pins
    assert (pins.step, pins.direction) == levels


def test_an_offset_is_added_to_what_a_dac_gets_and_to_nothing_else() -> None:
    offset = {"START_SIN___START_SIN90_120___DAC_OFFSET": 0xF0F7_0000}
    assert out(at(0, 1, **offset)) == [f"{256 - 16:09b}", f"{256 + CURRENT_B_FULL - 16:09b}"]
    assert out(at(0, 5, **offset)) == out(at(0, 5)) != []


def driver_bits(rig: Rig) -> int:
    rig.now_s += 1e-3
    return rig.read("STATUS_FLAGS") >> 24


UV, OT, OTPW, OCHS, OLA, OLB = 1 << 0, 1 << 1, 1 << 2, 1 << 7, 1 << 5, 1 << 6


@pytest.mark.parametrize(
    ("patch", "bits", "answer"),
    [
        ({}, 0, 0x100),
        ({"motor": {"temperature_c": 160.0}}, OT | OTPW, 0x1C0),
        ({"motor": {"temperature_c": 125.0}}, OTPW, 0x140),
        ({"motor": {"short_to_ground": "a"}}, OCHS, 0x110),
        ({"motor": {"connected": False}}, OLA | OLB, 0x10C),
        ({"supply_v": 2.0}, UV, 0x120),
    ],
)
def test_status_of_a_tmc23x_is_that_of_its_answer(patch: dict[str, object], bits: int, answer: int) -> None:
    rig = at(0, TMC23X)
    rig.chip.patch(Tmc4361Patch.model_validate(patch), rig.now_s)
    assert driver_bits(rig) == bits
    assert rig.read("POLLING_STATUS") == answer
    rig.write("COVER_LOW", 0)
    rig.now_s += 1e-3
    assert rig.read("COVER_DRV_LOW") == answer


STALL_FLAG, LIMIT_1 = 1 << 7, 1 << 8


@pytest.mark.parametrize(
    ("more", "shown", "stopped"),
    [(STALL_FLAG | LIMIT_1, True, True), (LIMIT_1, False, True), (STALL_FLAG, False, False)],
)
def test_a_load_value_below_the_limit_is_a_stall_of_a_tmc24x(more: int, shown: bool, stopped: bool) -> None:
    rig = Rig()
    rig.write("SPI_OUT_CONF", TMC24X | more)
    rig.write("VSTALL_LIMIT", 10_000)
    rig.ramp(Ramp(vmax=30_000.0), TRAPEZOID_VELOCITY)
    rig.now_s += 1.0
    assert not driver_bits(rig) & UV
    assert rig.read("POLLING_STATUS") >> 9 > 0
    rig.chip.patch(Tmc4361Patch.model_validate({"blocked": True}), rig.now_s)
    rig.now_s += 0.3
    assert bool(driver_bits(rig) & UV) == shown
    assert bool(rig.read("STATUS_FLAGS") >> 11 & 1) == stopped
