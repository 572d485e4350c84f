"""SixPoint ramps: the tick law against the continuous curve, its limits, and changes on the fly."""

from __future__ import annotations

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from app.emulators.drive import TICK_CLOCKS, Drive, EventKind
from app.emulators.drive import kernel as k
from tests.emulators.drive.oracle import PlainRamp
from tests.emulators.drive.rig import (
    ONE_TURN_A_SECOND,
    TICK_S,
    TRAPEZOID,
    acceleration,
    bit,
    duration,
    until,
    velocity,
    wait,
    write,
)

TOLERANCE_TICKS = 16
"""How much longer (or shorter) than the continuous ramp a move may take: 256 us. Measured: -0.5 to 8 ticks."""

ramps = st.fixed_dictionaries(
    {
        "VSTART": st.integers(0, 3000),
        "A1": st.integers(20, 65_535),
        "V1": st.one_of(st.just(0), st.integers(1, 300_000)),
        "AMAX": st.integers(50, 65_535),
        "VMAX": st.integers(4000, 2**23 - 512),
        "DMAX": st.integers(50, 65_535),
        "D1": st.integers(20, 65_535),
        "VSTOP": st.integers(1, 4000),
    }
)
distances = st.one_of(st.integers(1, 500), st.integers(1, 60_000)).flatmap(lambda d: st.sampled_from([d, -d]))


def hidden(drive: Drive) -> int:
    """The velocity with its nine fraction bits."""
    return int(drive._s[k.V])


@given(ramp=ramps, distance=distances)
@settings(max_examples=100, deadline=None)
def test_a_move_ends_on_its_target_after_the_time_of_the_continuous_ramp(ramp: dict[str, int], distance: int) -> None:
    drive = Drive()
    write(drive, ramp | {"XTARGET": distance})
    expected = duration(ramp, abs(distance))
    event = until(drive, EventKind.STOPPED | EventKind.POSITION_REACHED, 2 * expected + 1)
    assert event.position == drive.read("XACTUAL") == distance
    assert EventKind.POSITION_REACHED in event.kinds
    assert abs(event.clocks / TICK_CLOCKS - expected / TICK_S) <= TOLERANCE_TICKS
    flags = drive.read("RAMP_STAT")
    assert bit(flags, 7)
    assert bit(flags, 9)
    assert bit(flags, 10)
    assert not bit(flags, 12)


@given(ramp=ramps, distance=distances)
@settings(max_examples=25, deadline=None)
def test_no_tick_is_faster_than_vmax_or_accelerates_more_than_it_may(ramp: dict[str, int], distance: int) -> None:
    assume(duration(ramp, abs(distance)) < 0.1)
    drive = Drive()
    write(drive, ramp | {"XTARGET": distance})
    start, stop = ramp["VSTART"] * 512, ramp["VSTOP"] * 512
    up, down = max(ramp["A1"], ramp["AMAX"]), max(ramp["D1"], ramp["DMAX"])
    if ramp["V1"] == 0:
        up, down = ramp["AMAX"], ramp["DMAX"]
    last = 0
    while drive.read("XACTUAL") != distance:
        drive.advance(drive.clocks + TICK_CLOCKS)
        now = abs(hidden(drive))
        assert now <= ramp["VMAX"] * 512
        assert now - last <= up + (start if last == 0 else 0)
        assert last - now <= down + (stop if now == 0 else 0)
        last = now
    assert hidden(drive) == 0


@given(
    first=ramps,
    changes=st.lists(
        st.tuples(
            st.integers(1, 1500),
            st.sampled_from(["XTARGET", "VMAX", "AMAX", "DMAX", "A1", "V1", "D1", "VSTART", "VSTOP", "RAMPMODE"]),
            st.integers(0, 1 << 17),
        ),
        max_size=8,
    ),
    wait_units=st.integers(0, 60),
)
@settings(max_examples=40, deadline=None)
def test_the_kernel_equals_the_plain_oracle_whatever_is_changed_on_the_way(
    first: dict[str, int], changes: list[tuple[int, str, int]], wait_units: int
) -> None:
    drive, plain = Drive(), PlainRamp()

    def set_both(name: str, value: int) -> None:
        if name == "RAMPMODE":
            value %= 4
            plain.mode = value
        elif name == "XTARGET":
            value -= 1 << 16
            plain.target = value
        elif name in ("VMAX", "V1", "VSTART", "VSTOP"):
            setattr(plain, name.lower(), value * 512)
        else:
            value %= 1 << 16
            setattr(plain, name.lower(), max(value, 1 if name.startswith("D") else 0))
        drive.write(name, value)

    for name, value in first.items():
        set_both(name, min(value, (1 << 23) - 512))
    drive.write("TZEROWAIT", wait_units)
    plain.wait_ticks = 2 * wait_units
    set_both("XTARGET", (1 << 16) + 20_000)
    for ticks, name, value in [*changes, (1500, "VMAX", 60_000)]:
        field = 0
        for _ in range(ticks):
            field += plain.tick()
        before = int(drive._s[k.FIELD])
        drive.advance(drive.clocks + ticks * TICK_CLOCKS)
        assert drive.read("XACTUAL") == plain.x
        assert hidden(drive) == plain.v
        assert int(drive._s[k.ACC]) == plain.rest
        assert int(drive._s[k.FIELD]) - before == field
        set_both(name, value)


@given(
    ramp=ramps,
    targets=st.lists(st.tuples(st.integers(-40_000, 40_000), st.integers(0, 20_000)), min_size=1, max_size=5),
)
@settings(max_examples=40, deadline=None)
def test_a_target_changed_in_motion_is_reached_whether_ahead_or_behind(
    ramp: dict[str, int], targets: list[tuple[int, int]]
) -> None:
    drive = Drive()
    write(drive, ramp)
    for target, ticks in targets:
        drive.write("XTARGET", target)
        drive.advance(drive.clocks + ticks * TICK_CLOCKS)
    target = targets[-1][0]
    deadline = drive.clocks + round(400 * 16e6)
    drive.watch = EventKind.POSITION_REACHED
    if drive.read("XACTUAL") != target or drive.read("VACTUAL") != 0:
        while drive.advance(deadline) is not None and drive.read("XACTUAL") != target:
            pass
    assert drive.read("XACTUAL") == target
    assert drive.read("VACTUAL") == 0


@given(ramp=ramps, left=st.integers(1, 1 << 45))
@settings(max_examples=300, deadline=None)
def test_the_speed_taken_is_the_highest_that_can_still_be_braked(ramp: dict[str, int], left: int) -> None:
    drive, plain = Drive(), PlainRamp()
    write(drive, ramp)
    for name, value in ramp.items():
        setattr(plain, name.lower(), value * (512 if name.startswith("V") else 1))
    if ramp["V1"] == 0:
        plain.d1 = plain.dmax
    allowed = int(k.allowed(drive._s, left, 0, False))
    slack = 1e-9 * left + 1
    if allowed > 1:
        assert allowed + plain.braking_way(allowed) <= left + slack
    assert allowed + 1 + plain.braking_way(allowed + 1) > left - slack


def test_a_reversal_overshoots_waits_and_comes_back() -> None:
    drive = Drive()
    write(drive, TRAPEZOID | {"TZEROWAIT": 1000, "XTARGET": 200_000})
    wait(drive, 0.6)
    fast, here = velocity(drive.read("VACTUAL")), drive.read("XACTUAL")
    assert drive.read("VACTUAL") == TRAPEZOID["VMAX"]
    drive.write("XTARGET", here + 100)
    turning = until(drive, EventKind.STOPPED)
    assert turning.position - here == pytest.approx(fast**2 / 2 / acceleration(2000), rel=1e-3)
    assert bit(drive.read("RAMP_STAT"), 11)
    wait(drive, 0.0319)  # 1000 units of 512 clocks are 32 ms
    assert drive.read("XACTUAL") == turning.position
    assert not bit(drive.read("RAMP_STAT"), 12)
    back = until(drive, EventKind.POSITION_REACHED)
    assert back.position == here + 100
    assert bit(drive.read("RAMP_STAT"), 12)  # second_move
    drive.write("RAMP_STAT", 1 << 12)
    assert not bit(drive.read("RAMP_STAT"), 12)


def test_a_new_target_from_rest_is_no_second_move() -> None:
    drive = Drive()
    write(drive, TRAPEZOID | {"XTARGET": 1000})
    until(drive, EventKind.POSITION_REACHED)
    drive.write("XTARGET", -1000)
    until(drive, EventKind.POSITION_REACHED)
    assert not bit(drive.read("RAMP_STAT"), 12)


def test_velocity_mode_is_a_trapezoid_of_amax_both_ways() -> None:
    drive = Drive()
    write(drive, TRAPEZOID | {"A1": 1, "D1": 1, "DMAX": 1, "V1": 100_000, "VMAX": ONE_TURN_A_SECOND, "RAMPMODE": 2})
    until_full = until(drive, EventKind.VELOCITY_REACHED)
    ramp_s = velocity(ONE_TURN_A_SECOND) / acceleration(2000)
    assert until_full.clocks / 16e6 == pytest.approx(ramp_s, abs=3 * TICK_S)
    assert drive.read("VACTUAL") == -ONE_TURN_A_SECOND
    assert bit(drive.read("RAMP_STAT"), 8)
    wait(drive, 1.0)
    before = drive.read("XACTUAL")
    wait(drive, 1.0)
    assert drive.read("XACTUAL") - before == pytest.approx(-velocity(ONE_TURN_A_SECOND), abs=1)
    start = drive.clocks
    drive.write("VMAX", 0)
    assert until(drive, EventKind.STOPPED).clocks - start == pytest.approx(ramp_s * 16e6, abs=3 * TICK_CLOCKS)
    # the other way round: through zero
    write(drive, {"VMAX": 20_000, "RAMPMODE": 1})
    until(drive, EventKind.VELOCITY_REACHED)
    drive.write("RAMPMODE", 2)
    wait(drive, 0.05)
    until(drive, EventKind.VELOCITY_REACHED)
    assert drive.read("VACTUAL") == -20_000


def test_hold_mode_keeps_the_velocity() -> None:
    drive = Drive()
    write(drive, TRAPEZOID | {"RAMPMODE": 1})
    wait(drive, 0.1)
    v = drive.read("VACTUAL")
    assert 0 < v < TRAPEZOID["VMAX"]
    drive.write("RAMPMODE", 3)
    wait(drive, 0.5)
    assert drive.read("VACTUAL") == v
    write(drive, {"XTARGET": drive.read("XACTUAL") + 100_000, "RAMPMODE": 0})
    assert until(drive, EventKind.POSITION_REACHED).position == drive.read("XTARGET")


def test_positions_wrap_at_32_bits() -> None:
    drive = Drive()
    write(drive, TRAPEZOID | {"RAMPMODE": 3, "XACTUAL": 2**31 - 100})
    write(drive, {"XTARGET": -(2**31) + 100, "RAMPMODE": 0})
    event = until(drive, EventKind.POSITION_REACHED, 1.0)
    assert event.position == -(2**31) + 100
    assert event.clocks < 0.1 * 16e6


def test_a_target_set_where_the_motor_stands_moves_nothing() -> None:
    drive = Drive()
    write(drive, TRAPEZOID | {"XTARGET": 0})
    drive.watch = EventKind.STOPPED | EventKind.POSITION_REACHED
    assert drive.advance(1_000_000) is None
    assert bit(drive.read("RAMP_STAT"), 9)
    # but one that is reached within a single tick is told of
    write(drive, {"VSTOP": 200_000, "VSTART": 200_000, "VMAX": 300_000, "XTARGET": 1})
    event = drive.advance(2_000_000)
    assert event is not None
    assert event.kinds == EventKind.POSITION_REACHED
