"""The serial encoder output: clock in, bits out, against the calculator that shares no code with it."""

from __future__ import annotations

import pytest

from app.calc.tmc4361.serial_encoder import Frame
from app.emulators.tmc4361 import Tmc4361Options, Tmc4361Patch
from app.emulators.tmc4361.options import ListenChange
from tests.emulators.tmc4361.rig import Rig

ENABLE = 1 << 24
TURN = 51_200
"""Microsteps a turn after power-on."""


def rig(angle_bits: int, turn_bits: int, *, gray: bool = False, mtime: int = 0) -> Rig:
    made = Rig(Tmc4361Options())
    made.write("ENC_OUT_DATA", angle_bits - 1 | max(turn_bits - 1, 0) << 5)
    made.write("ENC_OUT_RES", 1 << angle_bits)
    made.write("ENC_IN_CONF", (1 << 14 if turn_bits else 0) | gray << 30)
    made.write("SPI_OUT_CONF", mtime << 4)
    made.write("GENERAL_CONF", made.read("GENERAL_CONF") | ENABLE)
    return made


def heard(made: Rig, clocks: int, rate_hz: float = 100e3) -> tuple[tuple[int, ...], bool]:
    """Clock the output; the bits, and whether they were those of before."""
    state = made.chip.patch(Tmc4361Patch(listen=ListenChange(clocks=clocks, rate_hz=rate_hz)))
    output = state.encoder_output
    return tuple(map(int, output.heard)), output.repeated


@pytest.mark.sheet("DS-TMC4361", "15")
@pytest.mark.sheet("DS-TMC4361", "15.1")
@pytest.mark.sheet("DS-TMC4361", "17.10")
@pytest.mark.parametrize("gray", [False, True])
@pytest.mark.parametrize("position", [0, 1, 12_800, TURN - 1, TURN, 5 * TURN + 25_600, -1, -TURN])
def test_a_listener_reads_turns_and_angle_of_enc_pos(position: int, gray: bool) -> None:
    made = rig(12, 8, gray=gray)
    made.write("ENC_POS", position)
    bits, repeated = heard(made, 20)
    turns, angle, _ = Frame(12, 8, gray=gray).place(bits)
    assert turns == (position // TURN) & 0xFF
    assert angle == position % TURN * 4096 // TURN
    assert not repeated


@pytest.mark.sheet("DS-TMC4361", "15.1")
def test_without_turns_the_answer_is_shorter_and_what_follows_is_zero() -> None:
    made = rig(10, 0)
    made.write("ENC_POS", TURN // 2)
    bits, _ = heard(made, 14)
    assert bits == (1, *[0] * 9, 0, 0, 0, 0)


@pytest.mark.sheet("DS-TMC4361", "15.1")
@pytest.mark.sheet("DS-TMC4361", "17.5")
def test_within_the_monoflop_time_the_same_value_comes_again() -> None:
    made = rig(12, 0, mtime=1600)  # 0.1 ms at 16 MHz
    made.write("ENC_POS", 12_800)
    first, _ = heard(made, 12)
    made.write("ENC_POS", 25_600)
    made.now_s += 12 / 100e3 + 0.9e-4
    made.read("VERSION_NO")
    assert heard(made, 12) == (first, True)
    made.now_s += 2 * (12 / 100e3 + 1.1e-4)
    made.read("VERSION_NO")
    again, repeated = heard(made, 12)
    assert (Frame(12).place(again)[1], repeated) == (2048, False)


@pytest.mark.sheet("DS-TMC4361", "15.1")
def test_a_clock_too_fast_for_the_filter_and_an_output_that_is_off_give_a_line_at_rest() -> None:
    made = rig(12, 0)
    made.write("ENC_POS", 12_800)
    made.write("INPUT_FILT_CONF", (3 << 4 | 4) << 24)  # four samples of 16 clocks: 4 us
    assert heard(made, 12, 1e6)[0] == (1,) * 12
    assert heard(made, 12, 100e3)[0] != (1,) * 12
    made.write("GENERAL_CONF", made.read("GENERAL_CONF") & ~ENABLE)
    assert heard(made, 12)[0] == (1,) * 12


@pytest.mark.sheet("DS-TMC4361", "14.3")
@pytest.mark.parametrize("kind", ["ssi", "spi"])
def test_another_encoder_on_the_shaft_answers_at_once(kind: str) -> None:
    made = Rig(Tmc4361Options())
    code = {"ssi": 1, "spi": 3}[kind]
    made.write("ENC_IN_DATA", 12 | 11 << 5)
    made.write("ENC_IN_RES", 1 << 13)
    made.write("ENC_IN_CONF", 1 << 12 | 1 << 13)
    made.write("SER_CLK_IN_HIGH_LOW", 8 << 16 | 8)
    made.write("GENERAL_CONF", made.read("GENERAL_CONF") & ~(3 << 10) | code << 10)
    made.now_s += 0.01
    assert made.signed("ENC_POS") == 0  # the incremental encoder that was there sends nothing of the kind
    made.chip.patch(
        Tmc4361Patch.model_validate(
            {
                "encoder": {"kind": kind, "single_turn_bits": 13, "multi_turn_bits": 12, "zero_fullsteps": -50.0},
                "stage": {"position_fullsteps": 0.0},
            }
        )
    )
    made.now_s += 0.02
    assert made.signed("ENC_POS") == pytest.approx(50 * 256, abs=8)
    assert made.chip.state().encoder.kind == kind
