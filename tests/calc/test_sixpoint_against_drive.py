"""Two readings of one ramp: the planner in continuous time, and the emulated TMC5160 tick by tick.

They share no line. A tick is 16 us, so what the planner does in no time the chip does within one, and each of the few
changes of acceleration may come a tick late: positions agree within some ticks at the speed they happen at.
"""

from __future__ import annotations

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from app.calc.ramps.sixpoint import MotionPlan, SixPoint, position_plan, velocity_plan
from app.calc.units.tmc5xxx import acceleration_pps2, velocity_pps
from app.emulators.drive import TICK_CLOCKS, Drive

CLOCK_HZ = 16e6
TICK_S = TICK_CLOCKS / CLOCK_HZ
POSITION, FORWARD, BACKWARD = 0, 1, 2
TICKS = 12
"""How many ticks of the highest speed the two may be apart: one for each change of acceleration, and the start."""

FAST_START = {
    "VMAX": 5000,
    "AMAX": 100,
    "DMAX": 100,
    "VSTART": 2700,
    "A1": 100,
    "V1": 0,
    "D1": 100,
    "VSTOP": 3000,
    "TZEROWAIT": 0,
    "V2": 0,
    "A2": 100,
    "D2": 100,
}
"""What it starts with is too fast for a short way with a long TVMAX."""


@st.composite
def registers(draw: st.DrawFn) -> dict[str, int]:
    """Ramps that end within some seconds."""
    v_stop = draw(st.integers(10, 5000))
    return {
        "VMAX": draw(st.integers(5_000, 400_000)),
        "AMAX": draw(st.integers(100, 20_000)),
        "DMAX": draw(st.integers(100, 20_000)),
        "VSTART": draw(st.integers(0, v_stop)),
        "A1": draw(st.integers(100, 20_000)),
        "V1": draw(st.one_of(st.just(0), st.integers(1_000, 200_000))),
        "D1": draw(st.integers(100, 20_000)),
        "VSTOP": v_stop,
        "TZEROWAIT": draw(st.integers(0, 3000)),
        "V2": draw(st.one_of(st.just(0), st.integers(1_000, 300_000))),
        "A2": draw(st.integers(100, 20_000)),
        "D2": draw(st.integers(100, 20_000)),
    }


def ramp_of(chip: dict[str, int]) -> SixPoint:
    return SixPoint(
        v_max=velocity_pps(chip["VMAX"]),
        a_max=acceleration_pps2(chip["AMAX"]),
        d_max=acceleration_pps2(chip["DMAX"]),
        v_start=velocity_pps(chip["VSTART"]),
        a1=acceleration_pps2(chip["A1"]),
        v1=velocity_pps(chip["V1"]),
        d1=acceleration_pps2(chip["D1"]),
        v_stop=velocity_pps(chip["VSTOP"]),
        t_zero_wait_s=chip["TZEROWAIT"] * 512 / CLOCK_HZ,
        v2=velocity_pps(chip["V2"]),
        a2=acceleration_pps2(chip["A2"]),
        d2=acceleration_pps2(chip["D2"]),
        t_v_max_s=chip.get("TVMAX", 0) * 512 / CLOCK_HZ,
    )


def drive_of(chip: dict[str, int]) -> Drive:
    drive = Drive()
    for register, value in chip.items():
        drive.write(register, value)
    return drive


def slack(ramp: SixPoint, plan: MotionPlan) -> float:
    """Microsteps that ticks may cost."""
    speeds = [velocity for phase in plan.phases for velocity in (phase.start_velocity_pps, phase.end_velocity_pps)]
    fastest = max(abs(velocity) for velocity in (*speeds, plan.end_velocity_pps, ramp.v_stop, ramp.v_start))
    return 2 + TICKS * TICK_S * fastest


def follow(drive: Drive, plan: MotionPlan, ramp: SixPoint, start: int) -> None:
    """Hold the chip's positions to the plan's, from now to a little after its end."""
    begin = drive.clocks
    allowed = slack(ramp, plan)
    for share in range(1, 41):
        time_s = plan.duration_s * share / 38
        drive.advance(begin + max(round(time_s * CLOCK_HZ), drive.clocks - begin))
        expected = float(plan.at((drive.clocks - begin) / CLOCK_HZ).position)
        assert drive.read("XACTUAL") - start == pytest.approx(expected, abs=allowed), time_s


@settings(max_examples=60, deadline=None)
@given(
    chip=registers(),
    distance=st.integers(-400_000, 400_000).filter(bool),
    tvmax=st.one_of(st.just(0), st.integers(1, 20_000)),
)
@example(chip=FAST_START, distance=1, tvmax=1590)
@example(chip=FAST_START, distance=1000, tvmax=20_000)
def test_moves_from_rest(chip: dict[str, int], distance: int, tvmax: int) -> None:
    chip = chip | {"TVMAX": tvmax}
    drive, ramp = drive_of(chip), ramp_of(chip)
    plan = position_plan(ramp, distance)
    drive.write("RAMPMODE", POSITION)
    drive.write("XTARGET", distance)
    follow(drive, plan, ramp, 0)
    drive.advance(drive.clocks + round(0.01 * CLOCK_HZ))
    assert drive.read("XACTUAL") == distance
    assert drive.read("VACTUAL") == 0


@settings(max_examples=60, deadline=None)
@given(
    chip=registers(), first=st.integers(50_000, 400_000), second=st.integers(-200_000, 400_000), at_s=st.floats(0.01, 1)
)
def test_moves_that_are_changed_under_way(chip: dict[str, int], first: int, second: int, at_s: float) -> None:
    drive, ramp = drive_of(chip), ramp_of(chip)
    drive.write("RAMPMODE", POSITION)
    drive.write("XTARGET", first)
    drive.advance(round(at_s * CLOCK_HZ))
    here, velocity = drive.read("XACTUAL"), velocity_pps(drive.read("VACTUAL"))
    if velocity == 0:
        return  # it was quicker than the change
    drive.write("XTARGET", second)
    plan = position_plan(ramp, second - here, velocity)
    tight = position_plan(ramp, second - here, velocity * 1.002)
    if (plan.overshoot > 0) != (tight.overshoot > 0):
        return  # on the verge: the chip's next tick decides whether it can still brake in time
    follow(drive, plan, ramp, here)


@settings(max_examples=40, deadline=None)
@given(chip=registers(), speed=st.integers(-400_000, 400_000), then=st.integers(-400_000, 400_000))
def test_rotations_and_stops(chip: dict[str, int], speed: int, then: int) -> None:
    drive, ramp = drive_of(chip), ramp_of(chip)

    def turn(velocity: int) -> None:
        drive.write("RAMPMODE", FORWARD if velocity >= 0 else BACKWARD)
        drive.write("VMAX", abs(velocity))

    turn(speed)
    plan = velocity_plan(ramp, velocity_pps(speed))
    follow(drive, plan, ramp, 0)
    here = drive.read("XACTUAL")
    before = velocity_pps(drive.read("VACTUAL"))
    turn(then)
    follow(drive, velocity_plan(ramp, velocity_pps(then), before), ramp, here)
