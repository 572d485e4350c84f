"""The feedback unit behind a whole chip: everything here goes over its SPI."""

from __future__ import annotations

import pytest

from app.emulators.tmc4361 import Tmc4361Options, Tmc4361Patch
from app.emulators.tmc4361.feedback import EncoderPatch, ShaftEncoder
from tests.emulators.tmc4361.rig import HOLD_POSITION, S_POSITION, S_VELOCITY, TRAPEZOID_POSITION, Ramp, Rig

LATCH_RESET = 0x400
CALIBRATION, CLOSED_LOOP, PID_OVER_RAMP = 1 << 24, 1 << 22, 3 << 22
LOOP = {
    "ENC_IN_RES": 40_000,
    "CL_ANGLES": 255,
    "CL_DELTA_P": 1 << 16,
    "CL_TOLERANCE": 10,
    "CL_TR_TOLERANCE": 60,
    "ENC_VMEAN": 100 | 5 << 8 | 500 << 16,
    "ENC_VEL_ZERO": 160_000,
}
RAMP = Ramp(vmax=100_000, amax=2e6, dmax=2e6, bow1=4e6 * 4, bow2=1.6e7, bow3=1.6e7, bow4=1.6e7)


def ready(**registers: int) -> Rig:
    rig = Rig(Tmc4361Options())
    for name, word in (LOOP | registers).items():
        rig.write(name, word)
    rig.now_s += 0.2
    return rig


def calibrated(**registers: int) -> Rig:
    """The vendor's state machine: stop, to a full step at 10,000 pps, calibrate, close the loop."""
    rig = ready(**registers)
    rig.write("VMAX", 0)
    rig.write("RAMPMODE", HOLD_POSITION)
    rig.write("ENC_IN_CONF", LATCH_RESET)
    rig.write("VMAX", 10_000 << 8)
    for _ in range(5):
        way = (128 - rig.read("MSCNT")) % 256
        if way == 0:
            break
        rig.write("XTARGET", rig.read("XACTUAL") + way)
        rig.now_s += 0.1
    rig.now_s += 0.1
    rig.write("ENC_IN_CONF", LATCH_RESET | CALIBRATION)
    rig.now_s += 0.01
    rig.write("ENC_IN_CONF", LATCH_RESET | CLOSED_LOOP)
    rig.now_s += 0.2
    rig.events()
    return rig


@pytest.mark.sheet("DS-TMC4361", "14.4")
def test_the_vendors_calibration_closes_the_loop_and_a_load_costs_no_step() -> None:
    rig = calibrated()
    assert rig.signed("ENC_POS") == pytest.approx(rig.signed("XACTUAL"), abs=15)
    rig.chip.patch(Tmc4361Patch(load_torque_nm=0.35), rig.now_s)
    rig.now_s += 0.3
    rig.ramp(RAMP, S_POSITION)
    rig.write("XTARGET", 60_000)
    rig.now_s += 2.0
    assert rig.signed("XACTUAL") == 60_000
    assert abs(rig.signed("ENC_POS") - 60_000) < 256
    truth = rig.chip.state(rig.now_s).truth
    assert truth.lost_fullsteps == 0
    assert abs(truth.load_angle_deg) < 90


def test_held_back_the_chip_tells_cl_max_and_after_it_cl_fit_and_target_reached() -> None:
    rig = calibrated(ENC_POS_DEV_TOL=5000)
    rig.chip.patch(Tmc4361Patch(blocked=True), rig.now_s)
    rig.ramp(RAMP, TRAPEZOID_POSITION)
    rig.write("XTARGET", 20_000)
    rig.now_s += 1.0
    events = rig.events()
    assert {"CL_MAX", "ENC_FAIL"} <= events
    assert "TARGET_REACHED" not in events
    assert rig.signed("XACTUAL") == 20_000
    assert rig.signed("ENC_POS_DEV") < -19_000  # ENC_POS - XACTUAL: our reading
    assert not rig.read("STATUS_FLAGS") & 1
    rig.chip.patch(Tmc4361Patch(blocked=False), rig.now_s)
    rig.now_s += 0.5
    assert {"CL_FIT", "TARGET_REACHED"} <= rig.events()
    assert rig.read("STATUS_FLAGS") & (1 | 1 << 19) == 1 | 1 << 19
    assert rig.signed("ENC_POS") == pytest.approx(20_000, abs=10)


def test_pid_over_the_ramp_sends_more_steps_than_the_ramp() -> None:
    rig = ready(PID_P=256 * 40, PID_I_CLIP___PID_D_CLKDIV=500, PID_DV_CLIP=100_000, PID_TOLERANCE=3)
    rig.write("PID_I", 100)
    rig.write("ENC_POS", 0)
    rig.chip.patch(Tmc4361Patch(load_torque_nm=0.15), rig.now_s)
    rig.now_s += 0.2
    before = rig.signed("ENC_POS_DEV")
    assert before < -40
    rig.write("ENC_IN_CONF", LATCH_RESET | PID_OVER_RAMP)
    rig.now_s += 0.4
    assert abs(rig.signed("ENC_POS_DEV")) <= 5
    assert rig.signed("XACTUAL") == 0
    assert rig.read("MSCNT") == pytest.approx(-before, abs=30)


@pytest.mark.sheet("DS-TMC4361", "17.8")
def test_an_n_event_latches_both_positions_and_becomes_events() -> None:
    conf = LATCH_RESET | 1 << 3 | 1 << 4 | 1 << 5 | 1 << 9 | 1 << 11  # once, high active, its edge, without A and B
    rig = Rig(Tmc4361Options(encoder=ShaftEncoder(zero_fullsteps=50.0)))
    rig.write("ENC_IN_RES", 40_000)
    rig.now_s += 0.2
    rig.write("ENC_POS", 0)
    rig.events()
    rig.write("ENC_IN_CONF", conf)
    rig.ramp(RAMP, S_VELOCITY)
    rig.now_s += 0.6
    rig.write("VMAX", 0)
    rig.now_s += 0.5
    assert {"ENC_DONE", "N_ACTIVE", "XLATCH_DONE"} <= rig.events()
    assert rig.read("STATUS_FLAGS") >> 16 & 1
    assert rig.signed("ENC_LATCH") == pytest.approx(12_800, abs=60)
    assert rig.signed("X_LATCH") == pytest.approx(12_800, abs=120)
    rig.now_s += 0.001
    assert not rig.read("STATUS_FLAGS") >> 16 & 1  # ENC_LATCH was read
    assert not rig.read("ENC_IN_CONF") >> 3 & 1


def test_an_encoder_that_stands_is_an_event() -> None:
    rig = ready(ENC_VEL_ZERO=16_000)
    rig.now_s += 0.1
    rig.events()
    rig.ramp(RAMP, TRAPEZOID_POSITION)
    rig.write("XTARGET", 5000)
    rig.now_s += 0.05
    assert rig.signed("V_ENC_MEAN") > 0
    assert "ENC_VEL0" not in rig.events()
    rig.now_s += 1.0
    assert "ENC_VEL0" in rig.events()
    assert rig.signed("V_ENC") == rig.signed("V_ENC_MEAN") == 0


def test_slip_of_the_encoder_shows_as_deviation() -> None:
    rig = ready(ENC_POS_DEV_TOL=200)
    rig.write("ENC_POS", 0)
    rig.events()
    rig.chip.patch(Tmc4361Patch(encoder=EncoderPatch(slip_fullsteps=1.0)), rig.now_s)
    rig.now_s += 0.01
    assert rig.signed("ENC_POS_DEV") == pytest.approx(256, abs=3)
    assert "ENC_FAIL" in rig.events()


def looked_at(rig: Rig, seconds: float, looks: int) -> None:
    start = rig.now_s
    for look in range(1, looks + 1):
        rig.now_s = start + seconds * look / looks
        rig.read("ENC_POS")


NAMES = ("XACTUAL", "ENC_POS", "V_ENC", "V_ENC_MEAN", "MSCNT", "CURRENTA_B_SPI", "SCALE_PARAM")


def test_it_makes_no_difference_how_often_somebody_looks() -> None:
    """Neither while the motor moves nor while it rests and the chip passes over ticks."""
    words = []
    for looks in (1, 97):
        rig = calibrated(CURRENT_CONF=1 << 7, SCALE_VALUES=60 | 240 << 8 | 30 << 16)
        looked_at(rig, 3.0, looks)
        rig.chip.patch(Tmc4361Patch(load_torque_nm=0.2), rig.now_s)
        rig.ramp(RAMP, S_POSITION)
        rig.write("XTARGET", 40_000)
        looked_at(rig, 0.33, looks)
        words.append([rig.read(name) for name in NAMES])
        looked_at(rig, 1.5, looks)
        words.append([rig.read(name) for name in NAMES])
    assert words[:2] == words[2:]


@pytest.mark.sheet("DS-TMC4361", "14.3")
def test_nor_does_it_with_a_serial_encoder() -> None:
    words = []
    for looks in (1, 97):
        rig = Rig(Tmc4361Options(encoder=ShaftEncoder(kind="ssi")))
        for name, word in (
            ("GENERAL_CONF", 0x6020 | 1 << 10),
            ("ENC_IN_RES", 8192),
            ("ENC_IN_DATA", 12 | 11 << 5),
            ("ENC_IN_CONF", 1 << 12),
            ("ENC_VEL_ZERO", 16_000),
            ("SER_PTIME", 20_111),
        ):
            rig.write(name, word)
        looked_at(rig, 2.0, looks)
        rig.chip.patch(Tmc4361Patch(encoder=EncoderPatch(slip_fullsteps=1.0)), rig.now_s)
        looked_at(rig, 0.0014, looks)  # one answer later
        words.append([rig.read(name) for name in NAMES])
        assert rig.signed("V_ENC") == pytest.approx(256 / (20_111 / 16e6), rel=0.05)
        rig.ramp(RAMP, S_VELOCITY)
        looked_at(rig, 0.05, looks)
        words.append([rig.read(name) for name in NAMES])
        assert rig.signed("V_ENC") > 1000
    assert words[:2] == words[2:]
