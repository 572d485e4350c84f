"""Which current scale holds when: DS-TMC428 8.9, against the emulated chip and its chain."""

from __future__ import annotations

from itertools import pairwise

import pytest

from app.calc.ramps.ticked import RampParameters
from app.calc.tmc428.current_scales import CurrentScales, ScaledRamp, rest_delay_s, scale_of, scaled_ramp
from tests.emulators.harness import (
    A_MAX,
    CONTINUOUS,
    COVER,
    COVER_DATAGRAM,
    CURRENT,
    DIVIDERS,
    MODE,
    NO_STOPS,
    V_MAX,
    V_MIN,
    X_TARGET,
    Bench,
    P,
    free_bench,
)

RAMP = RampParameters(v_min=1, v_max=900, a_max=200, ramp_div=6, pulse_div=5, pmul=58, pdiv=4)
"""p = 186 / 128, 93 % of what a_max asks for."""


def eighths_at(found: ScaledRamp, time_s: float) -> float:
    return next(span.eighths for span in found.spans if span.start_s <= time_s < span.end_s)


@pytest.mark.sheet("DS-TMC428", "8.9")
@pytest.mark.parametrize(
    ("velocity", "change", "threshold", "expected"),
    [
        (0, 0, 0, "is_v0"),
        (0, -300, 10, "is_v0"),
        (5, 0, 0, "is_aleat"),
        (5, 10, 10, "is_aleat"),
        (5, -11, 10, "is_agtat"),
        (5, 2047, 1023, "is_agtat"),
        (5, 2047, 1024, "is_aleat"),
    ],
)
def test_table_8_2(velocity: int, change: int, threshold: int, expected: str) -> None:
    assert scale_of(velocity, change, threshold) == expected


@pytest.mark.sheet("DS-TMC428", "8.9")
def test_a_move_accelerates_by_agtat_cruises_by_aleat_and_rests_by_v0() -> None:
    found = scaled_ramp(RAMP, 20_000, CurrentScales(is_v0=2, is_aleat=5, is_agtat=0, a_threshold=100))
    scales = [span.scale for span in found.spans]
    assert scales[:3] == ["is_v0", "is_agtat", "is_aleat"]
    assert scales[-2:] == ["is_aleat", "is_v0"]
    accelerates = found.spans[1]
    # v_max / a_max ramp ticks of 1/256 each
    ticks = round((accelerates.end_s - accelerates.start_s) * RAMP.clock_hz / RAMP.ramp_period_clocks)
    assert abs(ticks - 900 * 256 / 200) <= 1
    assert found.rest_delay_s == rest_delay_s(6, 16e6) == 255 * 32 * 64 / 16e6
    assert found.spans[-1].start_s == pytest.approx(found.motion_s + found.rest_delay_s)
    assert sum(found.time_s.values()) == pytest.approx(found.spans[-1].start_s)
    share = found.time_s["is_agtat"] * 1.0 + found.time_s["is_aleat"] * (5 / 8) ** 2
    assert found.heat == pytest.approx(share / sum(found.time_s.values()))
    for before, after in pairwise(found.spans):
        assert before.end_s == pytest.approx(after.start_s)


@pytest.mark.sheet("DS-TMC428", "8.9")
def test_the_emulated_chain_gets_the_scales_that_are_predicted() -> None:
    """The cosine stands still on its maximum in full steps: its DAC is the scale, for every moment of the move."""
    scales = CurrentScales(is_v0=2, is_aleat=5, is_agtat=7, a_threshold=100)
    found = scaled_ramp(RAMP, 3_000, scales, continuous_update=True)
    bench: Bench = free_bench()
    bench.three_drivers(0x702 | CONTINUOUS)
    for register, value in (
        (MODE, NO_STOPS),
        (DIVIDERS, 5 << 12 | 6 << 8),
        (P, 58 << 8 | 4),
        (A_MAX, 200),
        (V_MIN, 1),
        (V_MAX, 900),
        (CURRENT, 7 << 20 | 5 << 16 | 2 << 12 | 100),
        (COVER, 0),
    ):
        bench.write(register, value)
    bench.seconds(1.0)
    # begin on a ramp tick, as the calculation does
    period_s = RAMP.ramp_period_clocks / RAMP.clock_hz
    bench.clock.set(-(-bench.clock.now() // period_s) * period_s)
    start = bench.clock.now()
    bench.write(X_TARGET, 3_000)
    seen: set[int] = set()
    compared = 0
    datagram_s = 45e-6
    for place in range(400):
        at = (place + 0.5) / 400 * (found.spans[-1].start_s * 1.1)
        bench.clock.set(start + at)
        bench.write(COVER_DATAGRAM, 0)
        bench.clock.set(start + at + 2 * datagram_s)
        near = {eighths_at(found, max(at + off, -1e-6)) for off in (-2 * period_s, 0, 2 * period_s)}
        if len(near) > 1:
            continue  # a change is too near to say which side of it the datagram saw
        dac = bench.driver().dac_b
        assert dac == 63 * int(near.pop()) // 8, at
        seen.add(dac)
        compared += 1
    assert bench.x == 3_000
    assert compared > 200
    assert seen == {63 * eighths // 8 for eighths in (2, 5, 7)}


@pytest.mark.sheet("DS-TMC428", "8.9")
@pytest.mark.parametrize(
    ("scales", "continuous", "words"),
    [
        (CurrentScales(1, 4, 7, 1024), True, "signed"),
        (CurrentScales(1, 4, 7, 200), True, "never holds"),
        (CurrentScales(0, 4, 7, 10), True, "0 stands for 100 %"),
        (CurrentScales(5, 4, 7, 10), True, "above that in motion"),
        (CurrentScales(1, 4, 2, 10), True, "below that of constant"),
        (CurrentScales(1, 4, 7, 10), False, "continuous_update"),
    ],
)
def test_what_does_not_work_as_it_seems_is_said(scales: CurrentScales, continuous: bool, words: str) -> None:
    assert any(words in said for said in scaled_ramp(RAMP, 2_000, scales, continuous).warnings)


def test_nothing_is_said_of_what_the_sheet_advises() -> None:
    assert scaled_ramp(RAMP, 2_000, CurrentScales(2, 5, 5, 100), continuous_update=True).warnings == ()


@pytest.mark.parametrize(("field", "value"), [("is_v0", 8), ("is_agtat", -1), ("a_threshold", 2048)])
def test_a_field_out_of_range_is_refused(field: str, value: int) -> None:
    with pytest.raises(ValueError, match=field):
        CurrentScales(**{field: value})


def test_a_ramp_of_too_many_ticks_is_refused_with_what_helps() -> None:
    slow = RampParameters(v_min=1, v_max=20, a_max=1, ramp_div=0, pulse_div=8, pmul=0, pdiv=13)
    with pytest.raises(ValueError, match="shorter distance"):
        scaled_ramp(slow, 100_000, CurrentScales())


def test_no_move_is_rest_alone() -> None:
    found = scaled_ramp(RAMP, 0, CurrentScales(is_v0=3))
    assert {span.scale for span in found.spans} == {"is_v0"}
    assert found.braking_below is None
