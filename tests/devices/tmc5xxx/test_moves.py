"""Moves, rotations and stops of every model, and what is expected of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.calc.units.tmc5xxx import VELOCITY_MAX, velocity_unit_pps
from app.devices.core.capabilities import PositionSetting
from app.devices.core.events import MotionStarted
from app.devices.core.results import AxisMove, MotionEnd
from app.devices.tmc5xxx.start_up import Start
from app.errors import OutOfRange, UsageError, WrongState
from app.registers.tmc5xxx.table import AXES
from tests.devices.tmc5xxx.harness import MODELS, START, Bench, bench

SIX_POINTS = replace(START, vstart=2_000, v1=20_000, a1=400_000, d1=500_000, dmax=150_000, vstop=4_000)


@pytest.mark.parametrize("model", MODELS)
async def test_a_move_ends_on_its_target(model: str) -> None:
    async with bench(model) as b:
        for axis in range(AXES[model]):
            started = await b.device.motion.move(axis, 30_000)
            assert (started.from_position, started.target_position, started.warnings) == (0, 30_000, [])
            assert started.predicted_duration_s is not None
            await b.clock.advance(started.predicted_duration_s - 0.02)
            assert (await b.state(axis)).moving
            await b.clock.advance(0.03)
            state = await b.state(axis)
            assert (state.position, state.moving, state.position_reached) == (30_000, False, True)
            assert (state.mode, state.velocity_pps) == ("position", 0)
            assert b.device.monitor.motion_ends(axis)[-1].reason == "target_reached"


@pytest.mark.parametrize("start", [START, SIX_POINTS], ids=["trapezoid", "six points"])
async def test_a_prediction_is_where_the_axis_is(start: Start) -> None:
    async with bench("tmc5130", start) as b:
        await b.device.motion.move(0, 51_200)
        expected = b.device.motion.prediction(0)
        assert expected is not None
        for _ in range(13):
            await b.clock.advance(0.1)
            state = await b.state()
            position = expected.at(np.array([state.time_s]))[0][0]
            assert abs(position - state.position) <= 3


async def test_two_axes_set_off_in_successive_datagrams() -> None:
    async with bench("tmc5072") as b:
        b.port.frames.clear()
        started = await b.device.motion.move_together([AxisMove(0, 20_000), AxisMove(1, -30_000)])
        assert [(move.axis, move.target_position) for move in started] == [(0, 20_000), (1, -30_000)]
        writes = [frame[0] & 0x7F for frame in b.port.frames if frame[0] & 0x80]
        assert writes[-2:] == [b.address("XTARGET", 0), b.address("XTARGET", 1)]
        assert [(await b.state(axis)).moving for axis in (0, 1)] == [True, True]
        await b.at_rest(1)
        assert [(await b.state(axis)).position for axis in (0, 1)] == [20_000, -30_000]


async def test_two_axes_set_off_together_out_of_velocity_mode_too() -> None:
    async with bench("tmc5062") as b:
        for axis in (0, 1):
            await b.device.stop(axis)
        b.port.frames.clear()
        await b.device.motion.move_together([AxisMove(1, 200), AxisMove(0, 100)])
        writes = [frame[0] & 0x7F for frame in b.port.frames if frame[0] & 0x80]
        assert writes[-2:] == [b.address("XTARGET", 1), b.address("XTARGET", 0)]
        await b.at_rest(1)
        assert [(await b.state(axis)).position for axis in (0, 1)] == [100, 200]


async def test_an_axis_is_in_a_move_together_once() -> None:
    async with bench("tmc5072") as b:
        with pytest.raises(UsageError, match="only once"):
            await b.device.motion.move_together([AxisMove(0, 1), AxisMove(0, 2)])
        with pytest.raises(UsageError, match="no axis"):
            await b.device.motion.move_together([])


async def test_one_axis_that_cannot_move_keeps_the_other_from_moving() -> None:
    async with bench("tmc5031") as b:
        await b.device.registers.write("AMAX", 1, 0)
        with pytest.raises(WrongState, match="axis 1 cannot change its speed: AMAX is 0"):
            await b.device.motion.move_together([AxisMove(0, 20_000), AxisMove(1, 20_000)])
        await b.clock.advance(0.5)
        assert (await b.state(0)).position == 0


async def test_a_move_under_way_is_sent_elsewhere_without_a_stop() -> None:
    async with bench() as b:
        await b.device.motion.move(0, 51_200)
        await b.clock.advance(0.4)
        assert (await b.state()).velocity_pps > 45_000
        started = await b.device.motion.move(0, 60_000)
        assert started.predicted_duration_s is not None
        await b.clock.advance(0.05)
        assert (await b.state()).velocity_pps > 45_000
        await b.clock.advance(started.predicted_duration_s)
        assert (await b.state()).position == 60_000


async def test_a_move_back_while_going_on_reverses() -> None:
    async with bench() as b:
        await b.device.motion.move(0, 51_200)
        await b.clock.advance(0.5)
        started = await b.device.motion.move(0, -1_000, relative=True)
        assert started.target_position == started.from_position - 1_000
        assert (await b.at_rest()).position == started.target_position
        assert "second_move" in b.event_names()


async def test_relative_moves_and_units_are_those_of_the_axis() -> None:
    async with bench() as b:
        await b.device.motion.move(0, 0.5, unit="rev")
        assert (await b.at_rest()).position == 25_600
        await b.device.motion.move(0, -90, relative=True, unit="deg")
        assert (await b.at_rest()).position == 12_800


async def test_microsteps_are_those_of_chopconf() -> None:
    async with bench("tmc5130") as b:
        await b.device.registers.write("CHOPCONF", 0, fields={"mres": 4})
        assert b.decoded.mechanics(0).microsteps_per_full_step == 16
        await b.device.motion.move(0, 1, unit="rev")
        assert (await b.at_rest()).position == 3_200


async def test_rotation_and_stop_leave_the_speed_limit_as_it_was_set() -> None:
    async with bench() as b:
        rotating = await b.device.motion.rotate(0, -20_000)
        assert rotating.velocity_pps == pytest.approx(-20_000, abs=1)
        assert rotating.velocity_chip == round(-20_000 / velocity_unit_pps())
        await b.clock.advance(0.5)
        state = await b.state()
        assert state.velocity_pps == state.target_velocity_pps == rotating.velocity_pps
        assert state.mode == "velocity"
        await b.device.stop(0)
        state = await b.at_rest()
        assert (state.velocity_pps, state.mode) == (0, "velocity")
        await b.device.motion.move(0, 51_200, relative=True)
        await b.clock.advance(0.5)
        assert (await b.state()).velocity_pps == pytest.approx(50_000, abs=1)  # not 20,000, and not 0


async def test_a_rotation_goes_over_into_a_move_and_back() -> None:
    async with bench() as b:
        await b.device.motion.rotate(0, 30_000)
        await b.clock.advance(0.6)
        position = (await b.state()).position
        await b.device.motion.move(0, position + 40_000)
        await b.clock.advance(0.1)
        assert (await b.state()).velocity_pps >= 29_999
        await b.device.motion.rotate(0, -10_000)
        await b.clock.advance(1.0)
        assert (await b.state()).velocity_pps == pytest.approx(-10_000, abs=1)


async def test_a_rotation_beyond_vmax_names_the_limit() -> None:
    async with bench() as b:
        with pytest.raises(OutOfRange, match="8388096 is the chip's limit") as told:
            await b.device.motion.rotate(0, 9e6)
        assert told.value.maximum == pytest.approx(VELOCITY_MAX * velocity_unit_pps())
        with pytest.raises(OutOfRange, match="standstill"):
            await b.device.motion.rotate(0, 1e-4)
        with pytest.raises(UsageError, match="no unit of velocity"):
            await b.device.motion.rotate(0, 1, "furlongs")
        assert (await b.device.motion.rotate(0, 1000, "chip")).velocity_chip == 1000


async def test_a_prediction_of_a_rotation_and_of_its_stop() -> None:
    async with bench() as b:
        for command in (b.device.motion.rotate(0, 40_000), b.device.motion.rotate(0, -30_000), b.device.stop(0)):
            await command
            expected = b.device.motion.prediction(0)
            assert expected is not None
            for _ in range(6):
                await b.clock.advance(0.06)
                state = await b.state()
                if not state.moving:
                    assert expected.ended_by == "stopped on command"
                    break
                position, velocity = expected.at(np.array([state.time_s]))
                assert abs(position[0] - state.position) <= 4
                assert velocity[0] == pytest.approx(state.velocity_pps, abs=60)


async def test_a_stop_at_once_brakes_as_hard_as_the_ramp_can() -> None:
    """INFERRED choice: immediate is AMAX 65535, which needs nothing to be known of switches."""
    async with bench() as b:
        await b.device.motion.move(0, -51_200)
        await b.clock.advance(0.5)
        before = await b.state()
        assert before.velocity_pps < -45_000
        b.port.frames.clear()
        await b.device.stop(0, "immediate")
        assert b.port.written(b.address("AMAX")) == [65_535]
        await b.clock.advance(0.0075)  # 50,000 pps at 7.63 million pps^2: 6.6 ms
        state = await b.state()
        assert state.velocity_pps == 0
        assert abs(state.position - before.position) < 200
        # The user's acceleration comes back with the next move.
        b.port.frames.clear()
        started = await b.device.motion.move(0, 0)
        assert b.port.written(b.address("AMAX")) == [round(200_000 / 116.415321827)]
        assert started.predicted_duration_s is not None
        await b.clock.advance(started.predicted_duration_s + 0.01)
        assert (await b.state()).position == 0


async def test_a_stop_brakes_first_and_changes_the_mode_behind() -> None:
    async with bench() as b:
        await b.device.motion.move(0, 51_200)
        await b.clock.advance(0.5)
        b.port.frames.clear()
        assert (await b.device.stop(0)).ok
        writes = [frame[0] & 0x7F for frame in b.port.frames if frame[0] & 0x80]
        assert writes == [b.address("VMAX"), b.address("AMAX"), b.address("RAMPMODE")]
        state = await b.at_rest()
        assert state.position < 51_200
        end = b.device.monitor.motion_ends(0)[-1]
        assert (end.reason, end.position) == ("stop_command", state.position)


async def test_an_amax_of_0_does_not_keep_a_motor_from_stopping() -> None:
    async with bench() as b:
        await b.device.motion.rotate(0, 20_000)
        await b.clock.advance(0.5)
        await b.device.registers.write("AMAX", 0, 0)
        await b.device.stop(0)
        assert (await b.at_rest()).velocity_pps == 0
        with pytest.raises(WrongState, match="AMAX is 0"):
            await b.device.motion.move(0, 0)  # the user's own AMAX is the one that counts


async def test_a_stop_of_one_axis_leaves_the_other_alone() -> None:
    async with bench("tmc5072") as b:
        for axis in (0, 1):
            await b.device.motion.rotate(axis, 10_000)
        await b.clock.advance(0.5)
        await b.device.stop(1)
        await b.at_rest(1)
        assert (await b.state(0)).velocity_pps == pytest.approx(10_000, abs=1)
        assert [outcome.ok for outcome in await b.device.stop_axes([0, 1])] == [True, True]
        await b.at_rest(0)


async def test_stops_are_told_before_anything_waits() -> None:
    async with bench() as b:
        await b.device.motion.rotate(0, 10_000)
        guard = b.device.session.stop_guard([0])
        await b.device.stop(0)
        with pytest.raises(WrongState, match="overtook"):
            guard()


async def test_a_fresh_chip_says_what_it_needs() -> None:
    async with bench(start=None) as b:
        with pytest.raises(WrongState, match="VMAX is 0"):
            await b.device.motion.move(0, 100)
        await b.device.registers.write("VMAX", 0, 50_000)
        with pytest.raises(WrongState, match="AMAX is 0"):
            await b.device.motion.move(0, 100)
        await b.device.registers.write("AMAX", 0, 1_000)
        with pytest.raises(WrongState, match="DMAX is 0, and nothing brakes"):
            await b.device.motion.move(0, 100)
        await b.device.registers.write("DMAX", 0, 1_000)
        await b.device.registers.write("V1", 0, 1_000)
        with pytest.raises(WrongState, match="A1 is 0"):
            await b.device.motion.move(0, 100)
        await b.device.registers.write("A1", 0, 1_000)
        with pytest.raises(WrongState, match="D1 is 0"):
            await b.device.motion.move(0, 100)
        await b.clock.advance(1)
        assert (await b.state()).position == 0


@pytest.mark.parametrize(
    ("writes", "warning"),
    [
        ({"VSTART": 5_000}, "VSTOP, 10, is below VSTART, 5000"),
        ({"VSTOP": 0}, "VSTOP is 0, which positioning must not have"),
        ({"VSTOP": 5}, "below 10 the last microsteps may take long"),
        ({"D1": 0}, "D1 is 0, which positioning must not have"),
        ({"VSTART": 60_000}, "is below VSTART, 60000"),
        ({"TZEROWAIT": 31_250}, "for 1 s before it turns round"),
        ({"IHOLD_IRUN": 0x70003}, "IRUN is 0"),
        ({"CHOPCONF": 0x0001_01D0}, "toff is 0: the driver is off"),
        ({"SW_MODE": 0xC00}, "do not go together"),
    ],
)
async def test_a_setting_that_nobody_may_want_is_warned_of(writes: dict[str, int], warning: str) -> None:
    async with bench("tmc5130") as b:
        for name, value in writes.items():
            await b.device.registers.write(name, 0, value)
        started = await b.device.motion.move(0, 1_000)
        assert any(warning in told for told in started.warnings), started.warnings


async def test_vmax_above_the_limit_is_not_taken() -> None:
    async with bench() as b:
        with pytest.raises(OutOfRange, match=str(VELOCITY_MAX)):
            await b.device.registers.write("VMAX", 0, VELOCITY_MAX + 1)


async def test_a_switch_that_is_active_is_warned_of_and_stops() -> None:
    async with bench() as b:
        b.switches(right=True)
        await b.clock.advance(0.01)
        started = await b.device.motion.move(0, 10_000)
        assert started.warnings == ["the right switch is active and stops motion that way"]
        await b.clock.advance(1)
        state = await b.state()
        assert (state.position, state.moving, state.switches.right) == (0, False, True)
        started = await b.device.motion.move(0, -10_000)
        assert started.warnings == []
        assert (await b.at_rest()).position == -10_000
        assert (await b.device.motion.rotate(0, 5_000)).warnings == [
            "the right switch is active and stops motion that way"
        ]


async def test_targets_keep_within_32_bits_unless_they_may_go_over_the_end() -> None:
    async with bench() as b:
        with pytest.raises(OutOfRange, match="target of axis 0"):
            await b.device.motion.move(0, 2**31)
        await b.device.need(PositionSetting).set_position(0, 2**31 - 100)
        with pytest.raises(OutOfRange, match="distance of axis 0"):
            await b.device.motion.move(0, -100)
        started = await b.device.motion.retarget(0, -(2**31) + 900)
        assert started.target_position == -(2**31) + 900
        assert (await b.at_rest()).position == -(2**31) + 900  # 1000 on, over the end


async def test_setting_the_position_moves_nothing_and_takes_the_encoder_along() -> None:
    async with bench() as b:
        await b.device.motion.move(0, 10_000)
        before = await b.at_rest()
        assert before.deviation is not None
        assert await b.device.need(PositionSetting).set_position(0, 250) == 9_750
        await b.clock.advance(0.2)
        after = await b.state()
        assert (after.position, after.moving) == (250, False)
        assert after.deviation == before.deviation
        await b.device.motion.rotate(0, 1_000)
        await b.clock.advance(0.1)
        with pytest.raises(WrongState, match="moves"):
            await b.device.need(PositionSetting).set_position(0, 0)


async def test_a_motion_is_told_when_it_starts_and_ends() -> None:
    async with bench() as b:
        await b.device.motion.move(0, 5_000)
        await _passes(b, 2.0)
        starts = [told for told in b.told if isinstance(told, MotionStarted)]
        ends = [told for told in b.told if isinstance(told, MotionEnd)]
        assert [start.axis for start in starts] == [0]
        assert [(end.reason, end.position) for end in ends] == [("target_reached", 5_000)]


async def _passes(b: Bench, seconds: float) -> None:
    for _ in range(int(seconds / 0.05)):
        await b.clock.advance(0.05)
