"""Moves, rotations and stops over every ramp type, and what is expected of them."""

from __future__ import annotations

import numpy as np
import pytest

from app.devices.core.capabilities import PositionSetting
from app.devices.core.events import MotionStarted
from app.devices.core.results import AxisMove, MotionEnd, StopMode
from app.devices.tmc4361.start_up import Start
from app.errors import OutOfRange, UsageError, WrongState
from tests.devices.tmc4361.harness import bench

MODES = {"hold": 4, "trapezoid": 5, "S-ramp": 6}


@pytest.mark.sheet("DS-TMC4361", "8.2")
@pytest.mark.parametrize("shape", MODES)
async def test_a_move_ends_on_its_target_in_every_ramp_type(shape: str) -> None:
    async with bench() as b:
        await b.device.registers.write("RAMPMODE", 0, MODES[shape])
        started = await b.device.motion.move(0, 30_000)
        assert (started.from_position, started.target_position) == (0, 30_000)
        assert started.predicted_duration_s is not None
        await b.clock.advance(started.predicted_duration_s + 0.01)
        state = await b.state()
        assert (state.position, state.moving, state.position_reached) == (30_000, False, True)
        assert state.mode == f"positioning, {shape}"


async def test_a_prediction_is_where_the_axis_is() -> None:
    async with bench() as b:
        await b.device.motion.move(0, 51_200)
        expected = b.device.motion.prediction(0)
        assert expected is not None
        for _ in range(12):
            await b.clock.advance(0.1)
            state = await b.state()
            position = expected.at(np.array([state.time_s]))[0][0]
            assert abs(position - state.position) <= 2


async def test_a_move_under_way_is_sent_elsewhere_without_a_stop() -> None:
    async with bench() as b:
        await b.device.motion.move(0, 51_200)
        await b.clock.advance(0.4)
        fast = await b.state()
        assert fast.velocity_pps > 40_000
        started = await b.device.motion.move(0, 60_000)
        assert started.predicted_duration_s is not None
        await b.clock.advance(0.05)
        assert (await b.state()).velocity_pps > 40_000
        await b.clock.advance(started.predicted_duration_s)
        assert (await b.state()).position == 60_000


async def test_a_move_back_while_going_on_reverses() -> None:
    async with bench() as b:
        await b.device.motion.move(0, 51_200)
        await b.clock.advance(0.5)
        started = await b.device.motion.move(0, -1_000, relative=True)
        assert started.target_position == started.from_position - 1_000
        assert (await b.at_rest()).position == started.target_position


async def test_relative_moves_and_units_are_those_of_the_axis() -> None:
    async with bench() as b:
        await b.device.motion.move(0, 0.5, unit="rev")
        assert (await b.at_rest()).position == 25_600
        await b.device.motion.move(0, -90, relative=True, unit="deg")
        assert (await b.at_rest()).position == 12_800


async def test_rotation_and_stop_leave_the_speed_limit_as_it_was_set() -> None:
    async with bench() as b:
        rotating = await b.device.motion.rotate(0, -20_000)
        assert (rotating.velocity_chip, rotating.velocity_pps) == (-5_120_000, -20_000)
        await b.clock.advance(0.5)
        assert (await b.state()).velocity_pps == -20_000
        await b.device.stop(0)
        state = await b.at_rest()
        assert (state.velocity_pps, state.mode) == (0, "velocity, S-ramp")
        await b.device.motion.move(0, 51_200, relative=True)
        await b.clock.advance(0.5)
        assert (await b.state()).velocity_pps == 50_000  # not 20,000, and not 0


async def test_a_rotation_goes_over_into_a_move_and_back() -> None:
    async with bench() as b:
        await b.device.motion.rotate(0, 30_000)
        await b.clock.advance(0.6)
        position = (await b.state()).position
        await b.device.motion.move(0, position + 40_000)
        await b.clock.advance(0.1)
        assert (await b.state()).velocity_pps >= 30_000
        await b.device.motion.rotate(0, -10_000)
        await b.clock.advance(1.0)
        assert (await b.state()).velocity_pps == -10_000


async def test_a_rotation_beyond_half_the_clock_names_the_limit() -> None:
    async with bench() as b:
        with pytest.raises(OutOfRange, match=r"8000000 pps are the chip's limit") as told:
            await b.device.motion.rotate(0, 9e6)
        assert told.value.maximum == pytest.approx(8e6)
        with pytest.raises(OutOfRange, match="standstill"):
            await b.device.motion.rotate(0, 1e-4)


@pytest.mark.sheet("DS-TMC4361", "8.2.2")
async def test_a_stop_while_an_s_ramp_positions_goes_by_velocity_mode() -> None:
    async with bench() as b:
        await b.device.motion.move(0, 51_200)
        await b.clock.advance(0.5)
        b.port.frames.clear()
        assert (await b.device.stop(0)).ok
        writes = [frame[0] & 0x7F for frame in b.port.frames if frame[0] & 0x80 and frame[0] & 0x7F in (0x20, 0x24)]
        assert writes == [0x24, 0x20, 0x24]
        assert b.port.written(0x24) == [1, 0]
        state = await b.at_rest()
        assert state.mode == "velocity, S-ramp"
        assert state.position < 51_200


@pytest.mark.sheet("DS-TMC4361", "8.2.1")
async def test_a_stop_at_once_takes_no_ramp() -> None:
    async with bench() as b:
        await b.device.motion.move(0, -51_200)
        await b.clock.advance(0.5)
        before = await b.state()
        assert before.velocity_pps < -40_000
        await b.device.stop(0, "immediate")
        await b.clock.advance(0.001)
        state = await b.state()
        assert state.velocity_pps == 0
        assert abs(state.position - before.position) <= 2
        # The shape of ramps comes back with the next move.
        await b.device.motion.move(0, 0)
        assert (await b.state()).mode == "positioning, S-ramp"


@pytest.mark.parametrize("mode", ["ramp", "immediate"])
async def test_a_stop_of_an_axis_that_stands_moves_nothing(mode: StopMode) -> None:
    async with bench() as b:
        await b.device.motion.move(0, 1_000)
        await b.at_rest()
        sent = b.wire.state().step_output.steps_sent
        await b.device.stop(0, mode)
        await b.clock.advance(0.5)
        assert b.wire.state().step_output.steps_sent == sent


async def test_a_stop_acts_though_vmax_waits_for_a_start() -> None:
    async with bench() as b:
        await b.device.motion.rotate(0, 20_000)
        await b.clock.advance(0.5)
        await b.device.registers.write(
            "START_CONF", 0, fields={"start_en[1]": 1, "start_en[2]": 1, "trigger_events[0]": 1}
        )
        assert (await b.device.stop(0)).ok
        assert (await b.at_rest()).velocity_pps == 0
        assert (await b.device.registers.read("START_CONF", 0)).fields["start_en[1]"] == 0


async def test_a_ramp_that_never_slows_down_is_stopped_at_once() -> None:
    async with bench() as b:
        await b.device.motion.rotate(0, 20_000)
        await b.clock.advance(0.5)
        await b.device.registers.write("DMAX", 0, 0)
        await b.device.stop(0)
        await b.clock.advance(0.01)
        assert (await b.state()).velocity_pps == 0


async def test_what_cannot_move_says_why() -> None:
    async with bench(None) as b:
        with pytest.raises(WrongState, match="VMAX is 0"):
            await b.device.motion.move(0, 100)
        await b.device.registers.write("VMAX", 0, 256_000)
        await b.device.registers.write("RAMPMODE", 0, 6)
        with pytest.raises(WrongState, match="AMAX is 0"):
            await b.device.motion.move(0, 100)
        await b.device.registers.write("GENERAL_CONF", 0, fields={"sdin_mode": 1})
        with pytest.raises(WrongState, match="STPIN"):
            await b.device.motion.move(0, 100)


async def test_a_target_beyond_32_bits_names_the_range() -> None:
    async with bench() as b:
        with pytest.raises(OutOfRange, match=r"allowed is -2147483648\.\.2147483647"):
            await b.device.motion.move(0, 2**31)
        with pytest.raises(UsageError, match="one axis"):
            await b.device.motion.move_together([AxisMove(0, 1), AxisMove(0, 2)])


async def test_a_target_that_waits_for_a_start_is_warned_of() -> None:
    async with bench() as b:
        await b.device.registers.write("START_CONF", 0, fields={"start_en[0]": 1, "trigger_events[0]": 1})
        started = await b.device.motion.move(0, 5_000)
        assert any("start signal" in warning for warning in started.warnings)
        assert started.predicted_duration_s is None
        await b.clock.advance(1)
        assert (await b.state()).position == 0


async def test_another_clock_than_the_chip_was_told_is_warned_of() -> None:
    async with bench() as b:
        await b.device.registers.write("CLK_FREQ", 0, 8_000_000)
        assert any("CLK_FREQ" in warning for warning in (await b.device.motion.move(0, 100)).warnings)


async def test_a_frozen_chip_says_what_helps() -> None:
    async with bench() as b:
        b.freeze()
        await b.clock.advance(0.01)
        with pytest.raises(WrongState, match="frozen"):
            await b.device.motion.move(0, 100)


# --- switches -----------------------------------------------------------------------------------


@pytest.mark.sheet("DS-TMC4361", "9.1")
async def test_a_switch_that_stops_the_motor_is_the_reason_and_says_where() -> None:
    async with bench() as b:
        await b.device.motion.move(0, 51_200)
        await b.clock.advance(0.5)
        b.switches(right=True)
        state = await b.at_rest()
        assert state.switches.right is True
        await b.clock.advance(0.5)
        end = b.device.monitor.motion_ends(0)[-1]
        assert (end.reason, end.position) == ("right_switch", state.position)
        assert b.device.motion.prediction(0) is None


@pytest.mark.sheet("DS-TMC4361", "9.1")
async def test_looking_never_lets_a_stopped_axis_set_off_again() -> None:
    async with bench() as b:
        await b.device.motion.move(0, 51_200)
        await b.clock.advance(0.5)
        b.switches(right=True)
        stopped = (await b.at_rest()).position
        b.switches(right=False)
        await b.clock.advance(3)  # many looks, all of which see STOPR_EVENT
        assert (await b.state()).position == stopped
        # A command to move does what it takes.
        await b.device.motion.move(0, stopped + 500)
        assert (await b.at_rest()).position == stopped + 500


async def test_a_move_into_an_active_switch_is_warned_of_and_one_away_from_it_goes() -> None:
    async with bench() as b:
        b.switches(left=True)
        await b.clock.advance(0.01)
        assert any("left switch" in warning for warning in (await b.device.motion.move(0, -500)).warnings)
        await b.clock.advance(0.5)
        assert (await b.state()).position == 0
        assert not (await b.state()).moving
        started = await b.device.motion.move(0, 700)
        assert started.warnings == []
        assert (await b.at_rest()).position == 700


async def test_ends_and_starts_are_told() -> None:
    async with bench() as b:
        await b.device.motion.move(0, 5_000)
        await b.at_rest()
        await b.clock.advance(0.3)
        started = [event for event in b.told if isinstance(event, MotionStarted)]
        ended = [event for event in b.told if isinstance(event, MotionEnd)]
        assert len(started) == 1
        assert [(end.reason, end.position) for end in ended] == [("target_reached", 5_000)]


# --- by hand ------------------------------------------------------------------------------------


async def test_a_target_written_by_hand_is_predicted() -> None:
    async with bench() as b:
        await b.device.registers.write("XTARGET", 0, 20_000)
        expected = b.device.motion.prediction(0)
        assert expected is not None
        await b.clock.advance(expected.duration_s + 0.01)
        assert (await b.state()).position == 20_000
        assert expected.position[-1] == pytest.approx(20_000)


@pytest.mark.sheet("DS-TMC4361", "8.2.2")
async def test_stopping_an_s_ramp_by_vmax_alone_is_noted() -> None:
    async with bench() as b:
        await b.device.motion.move(0, 51_200)
        await b.clock.advance(0.5)
        assert "8.2.2" in (await b.device.registers.write("VMAX", 0, 0)).note


async def test_the_position_is_set_where_the_motor_stands() -> None:
    async with bench() as b:
        await b.device.motion.move(0, 10_000)
        await b.at_rest()
        encoder = (await b.device.registers.read("ENC_POS", 0)).value
        shaft = b.wire.state().truth.rotor_fullsteps
        assert await b.device.need(PositionSetting).set_position(0, 500) == 9_500
        state = await b.state()
        assert (state.position, state.encoder_position) == (500, encoder - 9_500)
        await b.clock.advance(1)
        assert b.wire.state().truth.rotor_fullsteps == pytest.approx(shaft, abs=0.05)
        await b.device.motion.rotate(0, 1_000)
        await b.clock.advance(0.2)
        with pytest.raises(WrongState, match="moves"):
            await b.device.need(PositionSetting).set_position(0, 0)


async def test_a_start_up_takes_what_the_registers_hold() -> None:
    async with bench(Start(vmax=12_345.5, amax=99_999.75, dmax=50_000, bow=123_456)) as b:
        held = {
            name: (await b.device.registers.read(name, 0)).value for name in ("VMAX", "AMAX", "DMAX", "BOW1", "BOW3")
        }
        assert held == {"VMAX": 3_160_448, "AMAX": 399_999, "DMAX": 200_000, "BOW1": 123_456, "BOW3": 61_728}
        assert b.device.axes[0].microsteps_per_full_step in (None, 256)
    with pytest.raises(UsageError, match="fCLK/2"):
        async with bench(Start(vmax=8.2e6, amax=1e6)):
            pass
