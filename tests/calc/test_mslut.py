"""The table's registers: decoded as real chips show it, encoded as public firmware does, refused with the place.

The TMC4361 data sheet that we had ends before its chapter 11.2; what is held here are register dumps of real chips
from public issue threads, and the vectors of public drivers and printer firmware.
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from app.calc.microsteps.mslut import (
    POWER_ON,
    MslutRegisters,
    NotEncodable,
    Reason,
    Segment,
    Wave,
    checked,
    decode,
    encode,
    encode_in,
    refusals,
    segments_of,
)

DUMPS = [
    pytest.param(8, 12, 247, id="TMC5160 at 8"),
    pytest.param(30, 45, 243, id="TMC5160 at 30"),
    pytest.param(68, 100, 225, id="TMC2208 at 68"),
    pytest.param(584, -107, -224, id="TMC2130 at 584"),
    pytest.param(648, -184, -166, id="TMC2240 at 648"),
]
# A linearity correction of 100 thousandths at amplitude 247, as printer firmware encodes it.
POWER_1100 = MslutRegisters(
    (0xA492487E, 0x294A52A4, 0x492494A5, 0x82110912, 0x00000080, 0xDB777DF8, 0x252AAAD6, 0x00808449),
    0xFFA20659,
    0x00F70000,
)


def power_wave(exponent: float, amplitude: int = 247) -> list[int]:
    """Written out here on its own: round(A * sin^f) at the beginning of each microstep."""
    return [int(amplitude * math.sin(2 * math.pi * i / 1024) ** exponent + 0.5) for i in range(256)]


@st.composite
def encodable(draw: st.DrawFn) -> Wave:
    """Any wave of up to four segments that stays within 0..255: where it would not, it is flat from there on."""
    borders = sorted(draw(st.lists(st.integers(1, 255), min_size=2, max_size=2)))
    lows = draw(st.lists(st.integers(-1, 2), min_size=3, max_size=3))
    bits = draw(st.lists(st.integers(0, 1), min_size=256, max_size=256))
    values = [draw(st.integers(0, 200))]
    for index in range(1, 256):
        following = values[-1] + lows[sum(index >= border for border in borders)] + bits[index]
        if not 0 <= following <= 255:
            values += [values[-1]] * (256 - index)
            break
        values.append(following)
    mirror = 2 * values[0] - lows[0] - bits[0]
    assume(all(-256 <= mirror - value <= 255 for value in values))
    return Wave(tuple(values), mirror)


@pytest.mark.parametrize(("position", "current_a", "current_b"), DUMPS)
def test_the_power_on_wave_is_what_real_chips_show(position: int, current_a: int, current_b: int) -> None:
    assert decode(POWER_ON).currents(position) == (current_a, current_b)


def test_the_power_on_wave_is_a_rounded_sine_at_half_steps() -> None:
    wave = decode(POWER_ON)
    assert list(wave.values) == [int(248 * math.sin((2 * math.pi * i + math.pi) / 1024) + 0.5) - 1 for i in range(256)]
    assert wave.values[-1] == POWER_ON.start >> 16 == 247
    assert (wave.period().min(), wave.period().max()) == (-248, 247)


def test_a_wave_steps_into_an_entry_with_that_entrys_bit() -> None:
    # The rival reading (bit i leads from i to i + 1) ends at 248, which START_SIN90 and every dump contradict.
    wave = decode(POWER_ON)
    moved = decode(MslutRegisters(POWER_ON.words, POWER_ON.select, POWER_ON.start ^ 1))
    assert [b - a for a, b in zip(wave.values, moved.values, strict=True)] == [1] * 256


def test_difference_0_acts_at_the_zero_crossing_alone() -> None:
    period = decode(POWER_ON).period()
    assert (period[511], period[512]) == (0, -1)
    flipped = MslutRegisters((POWER_ON.words[0] ^ 1, *POWER_ON.words[1:]), POWER_ON.select, POWER_ON.start)
    other = decode(flipped).period()
    assert (other[:512] == period[:512]).all()
    assert (other[512:] == period[512:] - 1).all()


def test_nothing_steps_at_the_peaks_and_the_period_closes() -> None:
    period = decode(POWER_ON).period()
    assert period[255] == period[256]
    assert period[767] == period[768]
    assert period[0] - period[1023] == period[511] - period[512]


def test_phase_b_is_256_positions_ahead() -> None:
    wave = decode(POWER_1100)
    period = wave.period()
    for position in (0, 1, 255, 256, 700, 1023, 1024, -1):
        assert wave.currents(position) == (period[position % 1024], period[(position + 256) % 1024])


def test_the_sine_power_wave_has_the_firmwares_registers() -> None:
    assert encode(power_wave(1.1), mirror=0) == POWER_1100
    assert decode(POWER_1100) == Wave(tuple(power_wave(1.1)), 0)
    assert segments_of(POWER_1100.select) == (Segment(0, 5, 0), Segment(6, 161, 1), Segment(162, 255, 0))


def test_the_power_on_wave_in_its_own_segments_is_the_power_on_registers() -> None:
    assert segments_of(POWER_ON.select) == (Segment(0, 127, 1), Segment(128, 255, 0))
    assert encode_in(decode(POWER_ON), segments_of(POWER_ON.select)) == POWER_ON


def test_the_power_on_values_with_an_opposite_half_have_the_firmwares_registers() -> None:
    registers = encode(decode(POWER_ON).values, mirror=0)
    assert (registers.words[0], registers.words[4]) == (0xAAAAB556, 0xF8000000)
    assert (registers.select >> 8, registers.select & 0xFF) == (0xFF9A02, 0b01_01_10_01)


@pytest.mark.parametrize("thousandths", range(30, 201))
def test_every_linearity_correction_comes_back_exactly(thousandths: int) -> None:
    wave = Wave(tuple(power_wave(1 + thousandths / 1000)), 0)
    assert decode(encode(wave.values, wave.mirror)) == wave
    assert wave.values[-1] == 247


@given(encodable())
def test_whatever_can_be_encoded_comes_back_exactly(wave: Wave) -> None:
    registers = encode(wave.values, wave.mirror)
    assert decode(registers) == wave
    assert registers.start >> 16 & 0xFF == wave.values[-1]
    assert len(segments_of(registers.select)) <= 4
    assert encode_in(wave, segments_of(registers.select)) == registers


@given(
    words=st.lists(st.integers(0, 2**32 - 1), min_size=8, max_size=8),
    select=st.integers(0, 2**32 - 1),
    start=st.integers(0, 2**32 - 1),
)
def test_whatever_a_chip_holds_is_decoded(words: list[int], select: int, start: int) -> None:
    registers = MslutRegisters(tuple(words), select, start)
    wave = decode(registers)
    segments = segments_of(select)
    assert [segments[0].first, segments[-1].last] == [0, 255]
    assert all(after.first == before.last + 1 for before, after in pairwise(segments))
    steps = np.diff([2 * wave.values[0] - wave.zero_step - wave.mirror, *wave.values])
    for segment in segments:
        assert set(steps[max(1, segment.first) : segment.last + 1]) <= {segment.low, segment.low + 1}
    assert wave.zero_step - segments[0].low in (0, 1)


def test_fewest_segments_are_used() -> None:
    straight = [index // 2 for index in range(256)]
    assert len(segments_of(encode(straight, 0).select)) == 1
    assert len(segments_of(encode(decode(POWER_ON).values).select)) == 2


def test_a_segment_may_be_the_last_entry_alone() -> None:
    values = [index // 2 for index in range(255)] + [130]
    wave = Wave(tuple(values), 0)
    assert decode(encode(values, 0)) == wave
    assert segments_of(encode(values, 0).select)[-1] == Segment(255, 255, 2)


def bent(**changes: int) -> list[int]:
    """The power-on values with some of them changed: at3=200."""
    values = list(decode(POWER_ON).values)
    for name, value in changes.items():
        values[int(name.removeprefix("at"))] = value
    return values


@pytest.mark.parametrize(
    ("values", "mirror", "index", "reason", "words"),
    [
        (bent(at100=213), -1, 100, "difference", r"\+72 from the one before, allowed is -1..\+3"),
        (bent(at200=100), -1, 200, "difference", "-1"),
        (bent(at255=256), -1, 255, "value", "256, allowed is 0..255"),
        (bent(at0=-1), 0, 0, "value", "-1, allowed is 0..255"),
        ([10, *bent()[1:]], 0, 0, "zero_crossing", r"\+20 at its zero crossing"),
    ],
)
def test_a_refusal_names_place_and_reason(
    values: list[int], mirror: int, index: int, reason: Reason, words: str
) -> None:
    with pytest.raises(NotEncodable, match=f"entry {index}: .*{words}") as caught:
        encode(values, mirror)
    assert caught.value.refusal.index == index
    assert caught.value.refusal.reason == reason


def test_a_wave_may_begin_high_and_fall() -> None:
    values = [100 + i for i in range(128)] + [227 - i for i in range(128)]
    assert decode(encode(values, mirror=199)) == Wave(tuple(values), 199)


def test_a_fifth_segment_is_refused_where_it_would_begin() -> None:
    # pairs {0,1} and {1,2} in turn, 40 entries each
    values = [0]
    for index in range(1, 256):
        values.append(values[-1] + (index % 2 if (index // 40) % 2 == 0 else 1 + (index % 8 == 0)))
    found = list(refusals(checked(values, 0)))
    places = [refusal.index for refusal in found if refusal.reason == "segments"]
    assert places
    assert 160 <= places[0] < 168
    with pytest.raises(NotEncodable, match="segment 5 would begin here, a table has 4"):
        encode(values, 0)
    # going on as the fourth does, four are enough
    straight = values[: places[0]] + [values[places[0] - 1] + more for more in range(1, 257 - places[0])]
    assert decode(encode(straight, 0)).values == tuple(straight)


def test_a_negative_half_beyond_nine_bits_is_refused() -> None:
    values = [0, *[min(255, 2 * i) for i in range(1, 256)]]
    assert decode(encode(values, -1)).period().min() == -256
    with pytest.raises(NotEncodable, match=r"negative half is -257, allowed is -256\.\.255"):
        encode(values, -2)


def test_all_refusals_are_told_from_left_to_right() -> None:
    found = list(refusals(checked(bent(at50=300, at200=0))))
    assert [(refusal.index, refusal.reason) for refusal in found] == [
        (50, "value"),
        (50, "difference"),
        (51, "difference"),
        (200, "difference"),
        (201, "difference"),
    ]


@pytest.mark.parametrize("values", [[], [0] * 255, [0] * 257, [*[0] * 255, 1.5], [*[0] * 255, True]])
def test_what_is_no_quarter_wave_is_an_error(values: list[int]) -> None:
    with pytest.raises(ValueError, match=r"256 values|whole number"):
        encode(values)


@pytest.mark.parametrize(
    ("words", "select", "start"),
    [((0,) * 7, 0, 0), ((0,) * 7 + (2**32,), 0, 0), ((0,) * 8, -1, 0), ((0,) * 8, 0, 2**32)],
)
def test_registers_are_eight_words_of_32_bits_and_two_more(words: tuple[int, ...], select: int, start: int) -> None:
    with pytest.raises(ValueError, match=r"8 words|allowed is"):
        MslutRegisters(words, select, start)


def test_the_dac_offset_beside_the_start_values_is_kept_apart() -> None:
    registers = encode(power_wave(1.1), 0).with_dac_offset(0x5A)
    assert registers.start == 0x5AF7_0000
    assert decode(registers) == decode(POWER_1100)
    assert registers.with_dac_offset(0) == POWER_1100
