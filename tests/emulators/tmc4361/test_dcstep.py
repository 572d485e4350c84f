"""dcStep and chopSync of the emulated TMC4361: DS-TMC4361 11.4, and facts of later sheets and headers."""

from __future__ import annotations

import pytest

from app.emulators.tmc4361 import Tmc4361Options, Tmc4361Patch
from tests.emulators.tmc4361.rig import TRAPEZOID_POSITION, Ramp, Rig

FAR = 1_000_000
FAST = Ramp(vmax=1_200_000, amax=1.5e6, dmax=1.5e6)
"""More than the motor can follow at 24 V."""
TMC26X = 3 << 21


def going(friction_nm: float, mode: int, **registers: int) -> Rig:
    """Sent far away against friction."""
    rig = Rig(Tmc4361Options())
    rig.ramp(FAST, TRAPEZOID_POSITION)
    for name, word in {"DC_VEL": 150_000, "DC_LSPTM": 400_000, **registers}.items():
        rig.write(name, word)
    rig.write("GENERAL_CONF", rig.read("GENERAL_CONF") | mode)
    rig.now_s += 0.1
    rig.read("VERSION_NO")
    rig.chip.patch(Tmc4361Patch(friction=friction_nm))
    rig.write("XTARGET", FAR)
    return rig


def arrives(rig: Rig, within_s: float) -> float:
    """How long it takes to XTARGET."""
    begun_s = rig.now_s
    while rig.signed("XACTUAL") != FAR:
        rig.now_s += 0.05
        assert rig.now_s - begun_s < within_s
    lasted_s = rig.now_s - begun_s
    rig.now_s += 0.3
    rig.read("VERSION_NO")
    return lasted_s


def rotor(rig: Rig) -> float:
    return rig.chip.state().truth.rotor_fullsteps * 256


@pytest.mark.sheet("DS-TMC4361", "11.4")
@pytest.mark.sheet("DS-TMC4361", "17.1")
@pytest.mark.parametrize("friction_nm", [0.1, 0.25])
def test_with_dcstep_a_motor_that_cannot_follow_comes_later_and_loses_no_step(friction_nm: float) -> None:
    lost = going(friction_nm, 0)
    planned_s = arrives(lost, 5.0)
    assert abs(rotor(lost) - FAR) > 10_000
    held = going(friction_nm, TMC26X)
    assert arrives(held, 10.0) > 1.2 * planned_s
    assert rotor(held) == pytest.approx(FAR, abs=256)


@pytest.mark.sheet("DS-TMC4361", "11.4")
def test_more_load_is_slower() -> None:
    assert arrives(going(0.25, TMC26X), 10.0) > arrives(going(0.05, TMC26X), 10.0)


@pytest.mark.sheet("DS-TMC4361", "11.4")
def test_a_motor_without_load_waits_for_nothing_below_dc_vel() -> None:
    rig = Rig(Tmc4361Options())
    rig.ramp(Ramp(vmax=100_000, amax=4e5, dmax=4e5), TRAPEZOID_POSITION)
    plain = Rig(Tmc4361Options())
    plain.ramp(Ramp(vmax=100_000, amax=4e5, dmax=4e5), TRAPEZOID_POSITION)
    for each in (rig, plain):
        each.write("DC_VEL", 150_000)
    rig.write("GENERAL_CONF", rig.read("GENERAL_CONF") | TMC26X)
    for each in (rig, plain):
        each.write("XTARGET", 60_000)
        each.now_s = 0.6
    assert rig.read("XACTUAL") == plain.read("XACTUAL")
    assert not rig.chip.state().dcstep.enabled


@pytest.mark.sheet("DS-TMC4361", "11.4")
def test_a_blocked_motor_gets_a_full_step_every_dc_lsptm() -> None:
    rig = going(0.0, TMC26X, DC_LSPTM=160_000)  # 10 ms
    while not rig.chip.state().dcstep.enabled:
        rig.now_s += 0.01
        rig.read("VERSION_NO")
    rig.chip.patch(Tmc4361Patch(blocked=True))
    rig.now_s += 0.2
    first = rig.signed("XACTUAL")
    assert not rig.chip.state().dcstep.step_ready or rig.chip.state().dcstep.waited_s < 0.0101
    rig.now_s += 1.0
    # 100 full steps a second, and the ways between them
    assert (rig.signed("XACTUAL") - first) / 256 == pytest.approx(100, abs=6)


@pytest.mark.sheet("DS-TMC4361", "17.1")
def test_dcstep_is_off_in_a_closed_loop_with_pwm_and_without_dc_vel() -> None:
    for change in ({"DC_VEL": 0}, {"ENC_IN_CONF": 1 << 22}):
        rig = going(0.0, TMC26X, **change)
        rig.now_s += 0.3
        rig.read("VERSION_NO")
        assert not rig.chip.state().dcstep.enabled


@pytest.mark.sheet("DS-TMC4361", "17.5")
@pytest.mark.parametrize(("divider", "hz"), [(640, 25_000.0), (96, 16e6 / 96), (818, 16e6 / 818)])
def test_chopsync_gives_its_clock_at_stdby_clk(divider: int, hz: float) -> None:
    rig = Rig(Tmc4361Options())
    rig.write("CHOPSYNC_DIV", divider)
    general = rig.read("GENERAL_CONF") & ~(3 << 13)
    for chosen, expected in ((0, None), (2, hz), (3, 16e6)):
        rig.write("GENERAL_CONF", general | chosen << 13)
        assert rig.chip.state().pins.clock_out_hz == expected


@pytest.mark.sheet("DS-TMC4361", "17.5")
def test_chopsync_doubles_at_standstill_for_a_tmc24x() -> None:
    rig = Rig(Tmc4361Options())
    rig.write("SPI_OUT_CONF", 9 | 1 << 12)
    rig.write("CHOPSYNC_DIV", 640)
    rig.write("GENERAL_CONF", rig.read("GENERAL_CONF") & ~(3 << 13) | 2 << 13)
    assert rig.chip.state().pins.clock_out_hz == 50_000
    rig.ramp(Ramp(), TRAPEZOID_POSITION)
    rig.write("XTARGET", 100_000)
    rig.now_s += 0.2
    rig.read("VERSION_NO")
    assert rig.chip.state().pins.clock_out_hz == 25_000
