"""Moves and rotation: from any mode, several at once, refused with the reason, never clipped."""

from __future__ import annotations

import pytest

from app.devices.core.capabilities import PositionSetting
from app.devices.core.results import AxisMove
from app.errors import OutOfRange, UnknownThing, UsageError, WrongState
from app.links import datagram32
from app.registers.catalog import CHIPS_32
from tests.devices.harness import bench

BOTH = pytest.mark.parametrize("model", list(CHIPS_32))
PPS_PER_UNIT = 16e6 / (2**4 * 2048 * 32)


@BOTH
async def test_a_move_arrives_as_predicted(model: str) -> None:
    async with bench(model) as b:
        started = await b.device.motion.move(0, -20_000)
        assert (started.from_position, started.target_position, started.warnings) == (0, -20_000, [])
        assert started.predicted_duration_s is not None
        await b.clock.advance(started.predicted_duration_s - 0.01)
        assert (await b.device.monitor.axis_state(0)).moving
        await b.clock.advance(0.02)
        state = await b.device.monitor.axis_state(0)
        assert (state.position, state.target_position, state.moving) == (-20_000, -20_000, False)
        assert state.position_reached
        assert state.mode.upper() == "RAMP_MODE"


@BOTH
async def test_the_next_move_leaves_velocity_and_hold_mode_without_a_jerk_back(model: str) -> None:
    async with bench(model) as b:
        await b.device.motion.move(0, 1000)
        await b.at_rest()
        await b.device.motion.rotate(0, 5000)
        await b.clock.advance(1.0)
        between = (await b.device.monitor.axis_state(0)).position
        assert between > 5000
        await b.device.motion.move(0, between + 3000)
        # Had RAMP_MODE come before the target, the motor would have turned back toward 1000.
        for _ in range(10):
            await b.clock.advance(0.01)
            assert (await b.device.monitor.axis_state(0)).velocity_pps > 0
        assert await b.at_rest() == between + 3000
        await b.device.stop(0, "immediate")
        assert (await b.device.monitor.axis_state(0)).mode.upper() == "HOLD_MODE"
        await b.device.motion.move(0, 0)
        assert await b.at_rest() == 0


async def test_soft_mode_is_kept() -> None:
    async with bench() as b:
        await b.device.registers.write("rm", 0, fields={"rm": "SOFT_MODE"})
        await b.device.motion.move(0, 5000)
        assert (await b.device.monitor.axis_state(0)).mode == "SOFT_MODE"
        assert await b.at_rest() == 5000


async def test_relative_and_in_the_axis_s_units() -> None:
    async with bench() as b:
        await b.device.motion.move(0, 90, unit="deg")
        assert await b.at_rest() == 200 * 64 // 4
        started = await b.device.motion.move(0, -0.5, relative=True, unit="rev")
        assert started.target_position == 3200 - 6400
        assert await b.at_rest() == -3200
        rounded = await b.device.motion.move(0, 0.4, relative=True)
        assert rounded.target_position == -3200
        assert rounded.warnings == ["rounded to 0 microsteps"]
        with pytest.raises(UsageError, match="travel_mm_per_rev"):
            await b.device.motion.move(0, 1, unit="mm")
        with pytest.raises(UsageError, match="furlong"):
            await b.device.motion.move(0, 1, unit="furlong")


@pytest.mark.sheet("DS-TMC428", "9.10")
async def test_several_axes_start_in_successive_datagrams() -> None:
    async with bench() as b:
        await b.device.motion.rotate(1, 2000)  # in VELOCITY_MODE and turning: its start is the mode, not the target
        await b.clock.advance(0.1)
        frames: list[bytes] = []
        exchange = b.wire.exchange

        def listen(frame: bytes, at_s: float | None = None) -> bytes:
            frames.append(frame)
            return exchange(frame, at_s)

        b.wire.exchange = listen  # type: ignore[method-assign]
        started = await b.device.motion.move_together([AxisMove(axis, 1000 * (axis + 1)) for axis in range(3)])
        writes = [index for index, frame in enumerate(frames) if not frame[0] & 1]
        assert writes[-3:] == list(range(writes[-3], writes[-3] + 3))
        assert [one.started_at_s for one in started] == pytest.approx([b.clock.now()] * 3, abs=1e-9)
        for axis in range(3):
            assert await b.at_rest(axis) == 1000 * (axis + 1)


async def test_a_move_of_several_that_cannot_all_go_starts_none() -> None:
    async with bench() as b:
        await b.device.registers.write("v_max", 2, value=0)
        with pytest.raises(WrongState, match="axis 2 cannot move: v_max is 0"):
            await b.device.motion.move_together([AxisMove(0, 1000), AxisMove(2, 1000)])
        with pytest.raises(UsageError, match="twice"):
            await b.device.motion.move_together([AxisMove(0, 1000), AxisMove(0, 2000)])
        with pytest.raises(UsageError, match="no axis"):
            await b.device.motion.move_together([])
        assert (await b.device.registers.read("x_target", 0)).value == 0


@BOTH
@pytest.mark.parametrize(("name", "text"), [("v_max", "v_max is 0"), ("a_max", "a_max is 0")])
async def test_what_cannot_move_says_so(model: str, name: str, text: str) -> None:
    async with bench(model) as b:
        await b.device.registers.write(name, 0, value=0)
        with pytest.raises(WrongState, match=text) as caught:
            await b.device.motion.move(0, 1000)
        assert name in caught.value.way_out
        with pytest.raises(WrongState, match=text):
            await b.device.motion.rotate(0, 100)


@BOTH
async def test_p_as_after_power_on_is_refused_because_it_would_swing(model: str) -> None:
    async with bench(model) as b:
        unset = {"pmul": 128 if model == "tmc4210" else 0, "pdiv": 0}
        await b.device.registers.write("pmul_pdiv", 0, fields=dict(unset))
        with pytest.raises(WrongState, match="pmul and pdiv are as after power-on"):
            await b.device.motion.move(0, 1000)


async def test_a_p_that_does_not_fit_is_a_warning() -> None:
    async with bench() as b:
        await b.device.registers.write("pdiv", 0, value=5)
        assert "overshoot" in (await b.device.motion.move(0, 1000)).warnings[0]
        await b.device.registers.write("pdiv", 0, value=8)
        assert "slow" in (await b.device.motion.move(0, 1000)).warnings[0]


@pytest.mark.sheet("DS-TMC428", "8.1")
@pytest.mark.parametrize("target", [-(1 << 23) - 1, 1 << 23, 1e12, -1e300])
async def test_a_target_beyond_24_bits(target: float) -> None:
    async with bench() as b:
        with pytest.raises(OutOfRange) as caught:
            await b.device.motion.move(0, target)
        assert (caught.value.minimum, caught.value.maximum) == (-(1 << 23), (1 << 23) - 1)


@pytest.mark.parametrize("target", [float("nan"), float("inf")])
async def test_a_target_that_is_no_number(target: float) -> None:
    async with bench() as b:
        with pytest.raises(UsageError):
            await b.device.motion.move(0, target)
        with pytest.raises(OutOfRange):
            await b.device.motion.rotate(0, target)


@pytest.mark.sheet("DS-TMC428", "8.1")
async def test_a_distance_of_2_to_the_23_is_refused() -> None:
    async with bench() as b:
        await b.device.need(PositionSetting).set_position(0, -5)
        with pytest.raises(OutOfRange, match="the other way round"):
            await b.device.motion.move(0, (1 << 23) - 5)
        assert (await b.device.motion.move(0, (1 << 23) - 6)).target_position == (1 << 23) - 6


async def test_an_active_switch_in_the_way_is_a_warning() -> None:
    async with bench(stops=True, stages=[{"start_fullsteps": -1.0}]) as b:
        assert "left switch is active" in (await b.device.motion.move(0, -100)).warnings[0]
        state = await b.device.monitor.axis_state(0)
        assert (state.switches.left, state.moving, state.position_reached) == (True, False, False)
        assert (await b.device.motion.move(0, 100)).warnings == []
        assert await b.at_rest() == 100


@pytest.mark.sheet("DS-TMC4210", "1.4")
async def test_step_direction_output_off_is_a_warning() -> None:
    async with bench("tmc4210") as b:
        await b.device.registers.write("en_sd", value=0)
        assert "en_sd" in (await b.device.motion.move(0, 100)).warnings[0]


@BOTH
async def test_rotation_in_any_unit_and_back(model: str) -> None:
    async with bench(model) as b:
        turning = await b.device.motion.rotate(0, -5000)
        assert turning.velocity_chip == round(-5000 / PPS_PER_UNIT)
        await b.clock.advance(1.0)
        assert (await b.device.monitor.axis_state(0)).velocity_pps == pytest.approx(turning.velocity_pps)
        assert (await b.device.motion.rotate(0, 700, "chip")).velocity_chip == 700
        per_turn = 200 * (16 if model == "tmc4210" else 64)
        rpm = await b.device.motion.rotate(0, 30.0, "rpm")
        assert rpm.velocity_pps == pytest.approx(0.5 * per_turn, rel=0.02)
        assert (await b.device.motion.rotate(0, 0.5 * per_turn / 64, "fullsteps_per_s")).velocity_chip != 0
        await b.device.motion.rotate(0, 0)
        await b.at_rest()


async def test_rotation_is_never_clipped() -> None:
    async with bench() as b:
        limit = 1500 * PPS_PER_UNIT
        assert (await b.device.motion.rotate(0, limit)).velocity_chip == 1500
        assert (await b.device.motion.rotate(0, -round(limit, 6))).velocity_chip == -1500
        with pytest.raises(OutOfRange) as caught:
            await b.device.motion.rotate(0, limit * 1.001)
        assert caught.value.maximum == pytest.approx(limit)
        with pytest.raises(OutOfRange) as turns:
            await b.device.motion.rotate(0, 1e6, "rpm")
        assert turns.value.maximum == pytest.approx(limit * 60 / 12_800)
        with pytest.raises(OutOfRange, match="standstill"):
            await b.device.motion.rotate(0, 1.0)
        assert "rounded" in (await b.device.motion.rotate(0, 20.0)).warnings[0]
        with pytest.raises(UsageError, match="knots"):
            await b.device.motion.rotate(0, 1.0, "knots")
        with pytest.raises(UnknownThing):
            await b.device.motion.rotate(3, 1.0)


async def test_an_old_v_target_does_not_run_off_when_hold_mode_ends() -> None:
    async with bench() as b:
        await b.device.motion.rotate(0, 1000, "chip")
        await b.clock.advance(0.2)
        await b.device.stop(0, "immediate")
        exchange, seen = b.wire.exchange, []

        def listen(frame: bytes, at_s: float | None = None) -> bytes:
            reply = exchange(frame, at_s)
            if frame[0] == 0x14:  # lp_ref_conf_rm of axis 0: from here on v_target counts
                seen.append(exchange(datagram32.read(0x04))[1:])
            return reply

        b.wire.exchange = listen  # type: ignore[method-assign]
        await b.device.motion.rotate(0, -100, "chip")
        assert seen == [(-100 & 0xFFF).to_bytes(3, "big")]


@BOTH
async def test_the_position_is_set_at_rest_without_motion(model: str) -> None:
    async with bench(model) as b:
        await b.device.motion.move(0, 1000)
        await b.clock.advance(0.05)
        with pytest.raises(WrongState, match="moves"):
            await b.device.need(PositionSetting).set_position(0, 0)
        await b.at_rest()
        assert await b.device.need(PositionSetting).set_position(0, -300) == 1300
        await b.clock.advance(0.5)
        state = await b.device.monitor.axis_state(0)
        assert (state.position, state.target_position, state.moving) == (-300, -300, False)
        assert (await b.device.registers.read("v_max", 0)).value == 1500
