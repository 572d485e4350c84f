"""A velocity over time, played in HOLD_MODE: judged first, point by point, and ended by a stop at once."""

from __future__ import annotations

import asyncio

import numpy as np
import pytest

from app.devices.core.axis_limits import AxisLimits
from app.devices.core.config import AxisSettings
from app.devices.manager import DeviceChange
from app.errors import OutOfRange, SoftLimit, UsageError, WrongState
from app.procedures.procedures import Procedures
from app.registers.catalog import MODELS
from tests.devices.harness import Bench, bench

CHIPS = [name for name, model in MODELS.items() if model.can("ramp.pmul")]
TIME_S, VELOCITY_PPS = [0.0, 0.2, 0.6, 0.8], [0.0, 8000.0, 8000.0, 0.0]
WAY = 8000 * 0.6


async def played(b: Bench, procedures: Procedures, within_s: float = 3.0) -> None:
    for _ in range(int(within_s / 0.01)):
        await b.clock.advance(0.01)
        if procedures.profile_state(b.device, 0).state != "running":
            return
    raise AssertionError(procedures.profile_state(b.device, 0))


@pytest.mark.sheet("DS-TMC428", "8.6")
@pytest.mark.sheet("DS-TMC428", "8.12")
@pytest.mark.parametrize("model", CHIPS)
async def test_the_motor_goes_by_the_profile_and_not_by_its_ramp(model: str) -> None:
    async with bench(model) as b:
        procedures = Procedures(b.clock)
        assert procedures.profile_state(b.device, 0).state == "idle"
        begun = await procedures.start_profile(b.device, 0, TIME_S, VELOCITY_PPS, 200.0)
        assert begun.summary is not None
        assert begun.summary.points == 161
        seen = []
        for _ in range(60):
            await b.clock.advance(0.01)
            seen.append((await b.device.monitor.axis_state(0)).velocity_pps)
        assert max(seen) == pytest.approx(8000, abs=2 * begun.summary.step_pps)
        assert sum(7900 < one < 8100 for one in seen) > 30, "it holds what was drawn, not V_MAX"
        await played(b, procedures)
        state = procedures.profile_state(b.device, 0)
        assert (state.state, state.sent, state.skipped) == ("done", 161, 0), state
        axis = await b.device.monitor.axis_state(0)
        assert (axis.velocity_pps, axis.mode) == (0, "HOLD_MODE")
        assert state.position == axis.position
        assert axis.position == pytest.approx(WAY, rel=0.02)
        assert axis.position == pytest.approx(begun.summary.end, abs=20)
        await b.device.motion.move(0, 0)
        assert await b.at_rest() == 0, "and the ramp is there again with the next move"


async def test_how_late_each_point_was_is_told() -> None:
    async with bench() as b:
        procedures = Procedures(b.clock)
        await procedures.start_profile(b.device, 0, TIME_S, VELOCITY_PPS, 100.0)
        await played(b, procedures)
        play = procedures.profile_play(b.device, 0)
        assert play is not None
        late = play.lateness_ms()
        assert len(late) == len(play.times_s()) == 81
        # Time of this test goes on in steps, of 10 ms at the most: what comes late by that is told as that.
        assert all(one is not None and -1e-6 <= one <= 10.001 for one in late)
        state = play.state
        assert state.late_max_ms == max(one for one in late if one is not None)
        assert state.late_median_ms is not None
        assert state.late_p99_ms is not None
        assert state.late_median_ms <= state.late_p99_ms <= state.late_max_ms


async def test_what_comes_too_late_is_left_out_and_the_profile_gets_no_longer() -> None:
    async with bench() as b:
        procedures = Procedures(b.clock)
        await procedures.start_profile(b.device, 0, TIME_S, VELOCITY_PPS, 1000.0)
        turn = b.device.session.queue.turn()
        await b.clock.advance(0.3)
        async with turn:  # somebody else has the line for 50 ms
            await b.clock.advance(0.05)
        await played(b, procedures)
        state = procedures.profile_state(b.device, 0)
        assert state.state == "done"
        assert 40 <= state.skipped <= 60
        assert state.sent + state.skipped == 801
        play = procedures.profile_play(b.device, 0)
        assert play is not None
        assert sum(one is None for one in play.lateness_ms()) == state.skipped
        assert (await b.device.monitor.axis_state(0)).position == pytest.approx(WAY, rel=0.02)


async def test_a_link_that_is_too_late_stops_the_motor() -> None:
    async with bench() as b:
        procedures = Procedures(b.clock)
        await procedures.start_profile(b.device, 0, TIME_S, VELOCITY_PPS, 100.0)
        await b.clock.advance(0.3)
        async with b.device.session.queue.turn():
            await b.clock.advance(0.15)
        await b.clock.advance(1.0)
        state = procedures.profile_state(b.device, 0)
        assert (state.state, "late at point" in state.message) == ("failed", True), state
        assert (await b.device.monitor.axis_state(0)).velocity_pps == 0


@pytest.mark.parametrize("how", ["device", "procedure", "move"])
async def test_a_stop_ends_it_at_once(how: str) -> None:
    async with bench() as b:
        procedures = Procedures(b.clock)
        await procedures.start_profile(b.device, 0, TIME_S, VELOCITY_PPS, 500.0)
        await b.clock.advance(0.4)
        if how == "device":
            await b.device.stop(0, "immediate")
        elif how == "procedure":
            await procedures.stop_profile(b.device, 0)
        else:
            await b.device.motion.move(0, 12_000)
        await b.clock.advance(0.0)
        state = procedures.profile_state(b.device, 0)
        assert state.state == "aborted"
        sent = state.sent
        rest = await b.at_rest()
        assert procedures.profile_state(b.device, 0).sent == sent, "nothing of it came after that"
        assert (rest == 12_000) == (how == "move")


async def test_a_stop_while_it_is_judged_keeps_it_from_beginning() -> None:
    async with bench() as b:
        procedures = Procedures(b.clock)
        async with b.device.session.queue.turn():
            begun = asyncio.create_task(procedures.start_profile(b.device, 0, TIME_S, VELOCITY_PPS, 500.0))
            await b.clock.advance(0.001)
            stopped = asyncio.create_task(b.device.stop(0))
            await b.clock.advance(0.001)
        with pytest.raises(WrongState, match="a stop of axis 0 overtook"):
            await begun
        await stopped
        await b.clock.advance(0.1)
        assert (await b.device.monitor.axis_state(0)).velocity_pps == 0


def limited(**limits: float) -> DeviceChange:
    return DeviceChange(axes=(AxisSettings(limits=AxisLimits(**limits)), AxisSettings(), AxisSettings()))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("limits", "quantity"),
    [
        ({"velocity_max_pps": 7000.0}, "velocity"),
        ({"acceleration_max_pps2": 39_000.0}, "acceleration"),
        ({"position_max": 4000}, "position"),
        ({"position_min": 0, "position_max": 4700}, "position"),
    ],
)
async def test_soft_limits_hold_before_anything_is_sent(limits: dict[str, float], quantity: str) -> None:
    async with bench(v_actual_writable="hold-mode") as b:
        device = b.device
        if quantity == "acceleration":  # the chip's own ramp has to be below it before the limit is set
            await device.registers.write("a_max", 0, 50)
        await b.manager.edit(device.id, limited(**limits))
        device = b.manager.devices[0]
        procedures = Procedures(b.clock)
        before = device.session.motion_commands[0]
        with pytest.raises(SoftLimit) as refused:
            await procedures.start_profile(device, 0, TIME_S, VELOCITY_PPS, 200.0)
        assert refused.value.quantity == quantity
        assert device.session.motion_commands[0] == before
        assert procedures.profile_state(device, 0).state == "idle"


async def test_what_cannot_be_is_refused_before_anything_is_sent() -> None:
    async with bench() as b:
        procedures = Procedures(b.clock)
        for time_s, velocity_pps, rate_hz, error in (
            ([0.0, 1.0], [0.0, 5.0], None, UsageError),
            ([0.0, 1.0, 2.0], [0.0, 1e6, 0.0], None, OutOfRange),
            ([0.0, 0.0001, 1.0], [0.0, 100.0, 0.0], None, OutOfRange),
            ([0.0, 300.0, 600.0], [0.0, 100.0, 0.0], 1000.0, OutOfRange),
            ([0.0, 1.0, 599.0, 600.0], [0.0, 30_000.0, 30_000.0, 0.0], None, OutOfRange),
        ):
            with pytest.raises(error):
                await procedures.start_profile(b.device, 0, time_s, velocity_pps, rate_hz)
        assert procedures.profile_state(b.device, 0).state == "idle"


async def test_an_axis_that_moves_and_time_that_runs_otherwise_are_no_ground_for_it() -> None:
    async with bench() as b:
        procedures = Procedures(b.clock)
        await b.device.motion.rotate(0, 3000)
        await b.clock.advance(0.2)
        await procedures.start_profile(b.device, 0, TIME_S, VELOCITY_PPS, 100.0)
        await b.clock.advance(0.1)
        state = procedures.profile_state(b.device, 0)
        assert (state.state, "moves" in state.message) == ("failed", True)
    async with bench(time_scale=10.0) as b:
        with pytest.raises(WrongState, match="set its time scale to 1"):
            await Procedures(b.clock).start_profile(b.device, 0, TIME_S, VELOCITY_PPS, 100.0)


async def test_a_profile_played_backwards_brings_the_motor_back() -> None:
    async with bench() as b:
        procedures = Procedures(b.clock)
        time_s = np.linspace(0, 1, 101)
        there = 4000 * np.sin(np.pi * time_s) ** 2
        there[-1] = 0
        for velocity in (there, -there):
            await procedures.start_profile(b.device, 0, time_s.tolist(), velocity.tolist(), None)
            await played(b, procedures)
        assert abs((await b.device.monitor.axis_state(0)).position) <= 2
