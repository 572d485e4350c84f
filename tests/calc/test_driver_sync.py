"""chopSync and dcStep of a TMC4361 in physical units."""

from __future__ import annotations

from typing import Any

import pytest

from app.calc.tmc4361.driver_sync import DcStep, chopsync, dcstep


def of_dcstep(**changed: Any) -> DcStep:
    given: dict[str, Any] = {
        "mode": 3,
        "dc_vel_pps": 102_400,
        "microsteps": 256,
        "full_steps_per_rev": 200,
        "dc_time": 80,
        "dc_sg": 2,
        "blank": 400,
        "slowest": 400_000,
        "output_format": 11,
    }
    return dcstep(16e6, **{**given, **changed})


@pytest.mark.sheet("DS-TMC4361", "17.5")
def test_the_choppers_clock_is_fclk_over_its_divider() -> None:
    found = chopsync(640, 16e6, output_format=9, pin=2, doubled=True, wanted_hz=36_000)
    assert (found.hz, found.rest_hz) == (25e3, 50e3)
    assert found.nearest_div == 444
    assert found.warnings == ()
    assert chopsync(640, 16e6, output_format=8, pin=2, doubled=True).rest_hz == 25e3
    assert chopsync(640, 16e6, output_format=8, pin=2, doubled=False, wanted_hz=1e6).nearest_div == 96


@pytest.mark.parametrize(
    ("div", "output_format", "pin", "words"),
    [(90, 9, 2, "96 to 818"), (818, 9, 2, "can be heard"), (640, 11, 2, "TMC23x or TMC24x"), (640, 8, 3, "STDBY_CLK")],
)
def test_what_does_not_fit_chopsync_is_said(div: int, output_format: int, pin: int, words: str) -> None:
    found = chopsync(div, 16e6, output_format=output_format, pin=pin, doubled=False)
    assert any(words in said for said in found.warnings)


@pytest.mark.sheet("DS-TMC4361", "11.4")
def test_dcsteps_registers_as_speeds_and_times() -> None:
    found = of_dcstep()
    assert found.full_steps_per_s == 400
    assert found.full_step_s == 2.5e-3
    assert found.rpm == pytest.approx(120)
    assert found.least_full_steps_per_s == 40
    assert found.least_rpm == pytest.approx(12)
    assert found.on_time_s == 5e-6
    assert found.lost_s == 2e-6
    assert found.blank_s == 25e-6
    assert found.warnings == ()


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"dc_vel_pps": 0}, "never acts"),
        ({"v_max_pps": 50_000.0}, "not below VMAX"),
        ({"slowest": 30_000}, "cannot be waited for"),
        ({"slowest": 0}, "DC_LSPTM is 0"),
        ({"dc_time": 0}, "DC_TIME is 0"),
        ({"dc_sg": 6}, "counts as lost"),
        ({"blank": 60_000}, "nothing is compared"),
        ({"output_format": 9}, "TMC26x"),
        ({"mode": 2}, "TMC2130"),
    ],
)
def test_what_does_not_fit_dcstep_is_said(change: dict[str, Any], words: str) -> None:
    assert any(words in said for said in of_dcstep(**change).warnings)


def test_nothing_is_said_of_a_dcstep_that_is_off() -> None:
    assert of_dcstep(mode=0, dc_vel_pps=0, dc_time=0).warnings == ()


def test_impossible_numbers_are_refused() -> None:
    with pytest.raises(ValueError, match="CHOPSYNC_DIV"):
        chopsync(0, 16e6, output_format=8, pin=2, doubled=False)
    with pytest.raises(ValueError, match="full step"):
        of_dcstep(microsteps=0)
