"""V2, A2, D2 and TVMAX: the drive against a ramp that is worked out in small steps of velocity, and nothing else."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.emulators.drive import TICK_CLOCKS, Drive, DriveOptions, EventKind
from app.emulators.drive import kernel as k
from tests.emulators.drive.rig import TICK_S, acceleration, until, velocity, wait, write

STEPS = 300
"""Steps of velocity from one corner of a ramp to the next."""
TOLERANCE_TICKS = 16
"""As in `test_ramp`; with TVMAX one more for the tick in which the speed is taken."""
RAMP = {
    "VSTART": 100,
    "A1": 8000,
    "V1": 40_000,
    "A2": 4000,
    "V2": 90_000,
    "AMAX": 1500,
    "VMAX": 160_000,
    "DMAX": 2000,
    "D2": 5000,
    "D1": 9000,
    "VSTOP": 200,
}

ramps = st.fixed_dictionaries(
    {
        **{name: st.integers(200, 250_000) for name in ("A1", "A2", "AMAX", "DMAX", "D2", "D1")},
        "VSTART": st.integers(0, 500),
        "V1": st.one_of(st.just(0), st.integers(1000, 200_000)),
        "V2": st.one_of(st.just(0), st.integers(1000, 400_000)),
        "VMAX": st.integers(20_000, 600_000),
        "VSTOP": st.integers(500, 1000),
        "TVMAX": st.one_of(st.just(0), st.integers(1, 3000)),
    }
)


def leg(ramp: dict[str, int], low: float, high: float, names: tuple[str, str, str]) -> tuple[float, float]:
    """Time [s] and way from one speed to another, step by step; of the three accelerations the one that holds there."""
    if high <= low:
        return 0.0, 0.0
    v1, v2 = velocity(ramp["V1"]), velocity(ramp["V2"])
    corners = [low, *sorted(corner for corner in (v1, v2) if low < corner < high), high]
    speeds = np.unique(np.concatenate([np.linspace(a, b, STEPS) for a, b in pairwise(corners)]))
    middle = (speeds[1:] + speeds[:-1]) / 2
    first, second, last = (acceleration(ramp[name]) for name in names)
    rates = np.where(middle < v1, first, np.where(middle < v2, second, last))
    dt = np.diff(speeds) / rates
    return float(dt.sum()), float((middle * dt).sum())


def duration(ramp: dict[str, int], distance: int) -> tuple[float, float]:
    """How long a move takes [s], and its highest speed [pps], by trying speeds."""
    start, stop, most = (velocity(ramp[name]) for name in ("VSTART", "VSTOP", "VMAX"))
    kept = ramp.get("TVMAX", 0) * 512 / 16e6

    def whole(peak: float) -> tuple[float, float]:
        up = leg(ramp, min(start, peak), peak, ("A1", "A2", "AMAX"))
        down = leg(ramp, min(stop, peak), peak, ("D1", "D2", "DMAX"))
        return up[0] + down[0], up[1] + down[1]

    low, high = 0.0, most
    if (whole(most)[1] + kept * most) <= distance:
        low = most
    else:
        for _ in range(40):
            middle = (low + high) / 2
            low, high = (middle, high) if whole(middle)[1] + kept * middle <= distance else (low, middle)
    time_s, way = whole(low)
    return time_s + (distance - way) / low, low


@given(ramp=ramps, distance=st.integers(2000, 300_000))
@settings(max_examples=25, deadline=None)
def test_a_move_takes_as_long_as_the_ramp_in_small_steps(ramp: dict[str, int], distance: int) -> None:
    drive = Drive()
    write(drive, ramp | {"XTARGET": distance})
    expected, _ = duration(ramp, distance)
    event = until(drive, EventKind.POSITION_REACHED, 2 * expected + 1)
    assert drive.read("XACTUAL") == distance
    assert abs(event.clocks / TICK_CLOCKS - expected / TICK_S) <= TOLERANCE_TICKS


def test_each_acceleration_holds_between_its_corners() -> None:
    drive = Drive()
    write(drive, RAMP | {"XTARGET": 400_000})
    seen: set[tuple[str, int]] = set()
    before = 0
    while drive.read("XACTUAL") != 400_000:
        drive.advance(drive.clocks + TICK_CLOCKS)
        now, change = drive.read("VACTUAL"), drive.read("AACTUAL")
        if change:
            low, high = sorted((before, now))
            names = ("A1", "A2", "AMAX") if change > 0 else ("D1", "D2", "DMAX")
            if high <= RAMP["V1"]:
                seen.add((names[0], abs(change)))
            elif RAMP["V1"] < low and high <= RAMP["V2"]:
                seen.add((names[1], abs(change)))
            elif low > RAMP["V2"]:
                seen.add((names[2], abs(change)))
        before = now
    by_name = {name: [value for other, value in seen if other == name] for name, _ in seen}
    assert set(by_name) == {"A1", "A2", "AMAX", "D1", "D2", "DMAX"}
    for name, values in by_name.items():
        # a braking tick takes what the way left allows: about the register, never more
        assert max(values) <= RAMP[name] + 1
        assert any(value == pytest.approx(RAMP[name], rel=0.01) for value in values)


@pytest.mark.parametrize("tvmax", [0, 300, 5000])
@pytest.mark.parametrize("distance", [3000, 40_000, 300_000])
def test_the_speed_is_kept_for_tvmax_before_it_brakes(tvmax: int, distance: int) -> None:
    drive = Drive()
    write(drive, RAMP | {"TVMAX": tvmax, "XTARGET": distance})
    speeds = []
    while drive.read("XACTUAL") != distance:
        drive.advance(drive.clocks + TICK_CLOCKS)
        speeds.append(int(drive._s[k.V]))
    top = max(speeds)
    kept = sum(speed == top for speed in speeds)
    assert kept >= 2 * tvmax, "units of 512 clocks, two ticks each"
    _, peak = duration(RAMP | {"TVMAX": tvmax}, distance)
    assert velocity(top / 512) == pytest.approx(peak, rel=0.02)


def test_a_new_target_on_the_way_is_reached_with_tvmax_too() -> None:
    drive = Drive()
    write(drive, RAMP | {"TVMAX": 1000, "XTARGET": 300_000})
    wait(drive, 0.15)
    for target in (drive.read("XACTUAL") + 50, -20_000, 5, 80_000):
        drive.write("XTARGET", target)
        wait(drive, 0.1)
    until(drive, EventKind.POSITION_REACHED)
    assert drive.read("XACTUAL") == 80_000


def test_velocity_mode_knows_neither() -> None:
    drive = Drive()
    write(drive, RAMP | {"TVMAX": 1000, "RAMPMODE": 1})
    for _ in range(40):
        drive.advance(drive.clocks + TICK_CLOCKS)
    assert drive.read("AACTUAL") == RAMP["AMAX"]


def test_a_rigid_motor_leaps_over_tvmax_as_it_ticks_through_it() -> None:
    def run(leaps: bool) -> tuple[list[tuple[int, int]], int]:
        drive = Drive(DriveOptions(rigid=True))
        drive.moves_by_leaps = leaps
        write(drive, RAMP | {"TVMAX": 4000, "XTARGET": 500_000, "X_COMPARE_REPEAT": 1000})
        seen = []
        for _ in range(60):
            wait(drive, 0.1)
            seen.append((drive.read("XACTUAL"), drive.read("VACTUAL")))
        return seen, drive.positions_passed

    assert run(True) == run(False)
    assert run(True)[1] == 500


@pytest.mark.parametrize("way", [1, -1])
def test_the_compare_repeats_each_way(way: int) -> None:
    drive = Drive()
    write(drive, RAMP | {"X_COMPARE_REPEAT": 700, "XTARGET": way * 7001})
    drive.x_compare = 100
    until(drive, EventKind.POSITION_REACHED)
    expected = [place for place in range(100 - 20 * 700, 100 + 20 * 700, 700) if 0 < way * place <= 7001]
    assert drive.positions_passed == len(expected)
