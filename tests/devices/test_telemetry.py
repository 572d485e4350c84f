"""Sample plans: as few frames as possible, columns true to the chip, predictions beside them."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from app.devices.core.capabilities import PositionSetting
from app.devices.core.events import DeviceEvent, MotionStarted
from app.devices.core.sample_plan import SamplePlan
from app.errors import UnknownThing, UsageError
from app.registers.catalog import CHIPS_32
from tests.devices.harness import Bench, bench

BOTH = pytest.mark.parametrize("model", list(CHIPS_32))


class Recorder:
    """Samples channels of a bench at 1 kHz from now on."""

    def __init__(self, b: Bench, *channels: str) -> None:
        self._bench = b
        self.plan: SamplePlan = b.device.telemetry.sample_plan(channels)
        self._times: list[float] = []
        self._replies: list[bytes] = []
        assert b.device.session.sampling_port is not None
        b.device.session.sampling_port.start_sampling(self.plan.frames, 0.001, self._sink)

    def _sink(self, time_s: float, replies: bytes) -> None:
        self._times.append(time_s)
        self._replies.append(replies)

    async def run(self, seconds: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Let time pass; times [rows] and samples [rows, channels] of all of it."""
        await self._bench.clock.advance(seconds)
        assert self._bench.device.session.sampling_port is not None
        self._bench.device.session.sampling_port.run_due_samples()
        times = np.array(self._times)
        return times, self.plan.decode(times, b"".join(self._replies))


async def test_each_register_is_asked_once_and_the_status_never() -> None:
    async with bench() as b:
        plan = b.device.telemetry.sample_plan(
            ["position.0", "residual.0", "predicted_position.0", "switch_reference.0", "position_reached.2"]
        )
        assert len(plan.frames) == 2  # x_actual, and v_actual to see that a switch ended what was predicted
        assert len(b.device.telemetry.sample_plan(["position_reached.0", "switch_reference.1"]).frames) == 1
        every = b.device.telemetry.sample_plan([channel.name for channel in b.device.telemetry.channels()])
        # x_actual, x_target, v_actual, v_target, a_actual of three axes, and one register of switches
        assert len(every.frames) == 16
        assert len(set(every.frames)) == 16


@BOTH
async def test_every_channel_agrees_with_the_axis_state(model: str) -> None:
    async with bench(model) as b:
        names = [channel.name for channel in b.device.telemetry.channels() if channel.axis == 0]
        recorder = Recorder(b, *names)
        await b.device.motion.move(0, -40_000)
        _, samples = await recorder.run(0.3)
        state = await b.device.monitor.axis_state(0)
        row = dict(zip(names, samples[-1], strict=True))
        assert row["position.0"] == state.position < -1000
        assert row["target_position.0"] == -40_000
        assert row["velocity.0"] == pytest.approx(state.velocity_pps)
        assert row["target_velocity.0"] == pytest.approx(state.target_velocity_pps)
        assert row["acceleration.0"] == pytest.approx(state.acceleration_pps2)
        assert row["position_reached.0"] == 0
        for side, active in (("left", state.switches.left), ("right", state.switches.right)):
            assert row[f"switch_{side}.0"] == float(bool(active))
        assert [channel.unit for channel in recorder.plan.channels] == list(recorder.plan.units)


@BOTH
async def test_a_measured_move_is_the_predicted_one_to_a_step_or_two(model: str) -> None:
    async with bench(model) as b:
        recorder = Recorder(b, "position.0", "predicted_position.0", "residual.0", "velocity.0", "predicted_velocity.0")
        started = await b.device.motion.move(0, 30_000)
        assert started.predicted_duration_s is not None
        times, samples = await recorder.run(started.predicted_duration_s + 0.5)
        position, predicted, residual, velocity, predicted_velocity = samples.T
        assert not np.isnan(samples[times >= started.started_at_s]).any()
        assert np.abs(residual).max() <= 2
        np.testing.assert_allclose(residual, position - predicted, atol=1e-6)
        assert np.abs(velocity - predicted_velocity).max() < 0.01 * velocity.max()
        assert (position[-1], predicted[-1], predicted_velocity[-1]) == (30_000, 30_000, 0)


async def test_a_change_on_the_way_is_predicted_anew() -> None:
    async with bench() as b:
        recorder = Recorder(b, "residual.0")
        await b.device.motion.move(0, 60_000)
        await recorder.run(1.0)
        await b.device.motion.move(0, -10_000)  # turns round
        await recorder.run(1.5)
        await b.device.registers.write("v_max", 0, value=500)
        await recorder.run(0.5)
        await b.device.registers.write("x_target", 0, value=20_000)
        _, samples = await recorder.run(12.0)
        # What a command finds moving it knows to a chip unit of velocity only: v_actual hides 8 bits.
        assert np.nanmax(np.abs(samples)) < 60
        assert np.isnan(samples).sum() <= 1


async def test_a_rotation_is_predicted_as_long_as_it_turns() -> None:
    async with bench() as b:
        recorder = Recorder(b, "residual.0", "predicted_velocity.0")
        turning = await b.device.motion.rotate(0, -9000)
        _, samples = await recorder.run(30.0)
        assert np.nanmax(np.abs(samples[:, 0])) <= 2
        assert samples[-1, 1] == pytest.approx(turning.velocity_pps)


async def test_positions_wrap_at_24_bits_and_the_residual_does_not_jump() -> None:
    async with bench() as b:
        await b.device.need(PositionSetting).set_position(0, (1 << 23) - 2000)
        recorder = Recorder(b, "position.0", "residual.0")
        await b.device.motion.rotate(0, 9000)
        _, samples = await recorder.run(2.0)
        assert samples[-1, 0] < 0
        assert np.nanmax(np.abs(samples[:, 1])) <= 2


async def test_a_stop_ends_the_prediction() -> None:
    async with bench() as b:
        recorder = Recorder(b, "predicted_position.0")
        await b.device.motion.move(0, 50_000)
        await recorder.run(0.5)
        assert b.device.motion.prediction(0) is not None
        await b.device.stop(0)
        assert b.device.motion.prediction(0) is None
        times, samples = await recorder.run(0.5)
        assert not np.isnan(samples[times < 0.5]).any()
        assert np.isnan(samples[times >= 0.5 + 1e-9]).all()


async def test_a_switch_that_stops_the_motor_ends_the_prediction() -> None:
    async with bench(stops=True, stages=[{"start_fullsteps": 20.0}]) as b:
        recorder = Recorder(b, "residual.0", "velocity.0")
        await b.device.motion.move(0, -50_000)
        _, samples = await recorder.run(1.0)
        assert samples[-1, 1] == 0
        assert np.isnan(samples[-1, 0])
        assert b.device.motion.prediction(0) is None


async def test_a_prediction_as_a_curve() -> None:
    async with bench() as b:
        assert b.device.motion.prediction(0) is None
        await b.device.need(PositionSetting).set_position(0, 100)
        started = await b.device.motion.move(0, 30_100)
        prediction = b.device.motion.prediction(0)
        assert prediction is not None
        assert prediction.duration_s == started.predicted_duration_s
        assert (prediction.position[0], prediction.position[-1]) == (100, 30_100)
        assert [phase.name for phase in prediction.phases][:3] == ["acceleration", "constant velocity", "deceleration"]
        assert prediction.phases[-1].end_s == pytest.approx(prediction.duration_s)
        assert len(prediction.time_s) == len(prediction.velocity_pps) == len(prediction.position)


async def test_a_long_oscillation_is_predicted_too() -> None:
    async with bench() as b:
        await b.device.registers.write("pmul_pdiv", 0, fields={"pmul": 127, "pdiv": 3})
        recorder = Recorder(b, "position.0", "residual.0")
        started = await b.device.motion.move(0, 5000)
        assert "overshoot" in started.warnings[0]
        _, samples = await recorder.run(2.0)
        assert samples[:, 0].max() > 5010
        assert np.nanmax(np.abs(samples[:, 1])) < 20


@pytest.mark.sheet("DS-TMC428", "8.3")
async def test_a_move_that_never_ends_is_predicted_as_far_as_it_goes() -> None:
    async with bench() as b:
        await b.device.registers.write("v_min", 0, value=0)
        await b.device.registers.write("rm", 0, fields={"rm": "SOFT_MODE"})
        recorder = Recorder(b, "position.0", "residual.0")
        started = await b.device.motion.move(0, 2000)
        assert started.predicted_duration_s is None
        _, samples = await recorder.run(15.0)
        assert 1900 < samples[-1, 0] < 2000
        assert np.nanmax(np.abs(samples[:, 1])) <= 2


async def test_the_divider_of_a_velocity_is_followed() -> None:
    async with bench() as b:
        recorder = Recorder(b, "velocity.0")
        await b.device.motion.rotate(0, 512, "chip")
        await recorder.run(1.0)
        before = recorder.plan.decode(np.zeros(1), bytes.fromhex("00000200"))[0, 0]
        await b.device.registers.write("pulse_div", 0, value=6)
        after = recorder.plan.decode(np.zeros(1), bytes.fromhex("00000200"))[0, 0]
        assert before == pytest.approx(4 * after)
        b.wire.exchange(bytes.fromhex("18005600"))  # somebody else: pulse_div 5, behind the driver's back
        await b.clock.advance(3.0)
        assert recorder.plan.decode(np.zeros(1), bytes.fromhex("00000200"))[0, 0] == pytest.approx(2 * after)


async def test_negative_numbers() -> None:
    async with bench() as b:
        plan = b.device.telemetry.sample_plan(["position.0", "velocity.0"])
        columns = plan.decode(np.zeros(2), bytes.fromhex("00ffffff 00000fff 00800000 00000801"))
        unit = 16e6 / 2**20
        np.testing.assert_allclose(columns, [[-1, -unit], [-(1 << 23), -2047 * unit]])


async def test_replies_that_do_not_fit_and_channels_that_do_not_exist() -> None:
    async with bench() as b:
        plan = b.device.telemetry.sample_plan(["position.0"])
        with pytest.raises(ValueError, match="8 bytes, not 7"):
            plan.decode(np.zeros(2), bytes(7))
        assert plan.decode(np.zeros(0), b"").shape == (0, 1)
        with pytest.raises(UnknownThing, match=r"position\.3"):
            b.device.telemetry.sample_plan(["position.0", "position.3"])
        with pytest.raises(UsageError):
            b.device.telemetry.sample_plan([])


@pytest.mark.sheet("DS-TMC428", "9.7")
async def test_a_switch_that_the_wiring_does_not_have_is_nan() -> None:
    async with bench() as b:
        await b.device.registers.write("refmux", value=0)
        recorder = Recorder(b, "switch_left.2", "switch_right.0", "switch_right.2")
        await b.device.registers.write("mot1r", value=1)
        _, samples = await recorder.run(0.01)
        assert samples[-1, 1] == 0
        assert np.isnan(samples[-1, [0, 2]]).all()


@pytest.mark.sheet("DS-TMC4210", "1.5.4")
async def test_the_right_switch_of_a_tmc4210_needs_mot1r() -> None:
    async with bench("tmc4210", stages=[{"start_fullsteps": 7600.0}]) as b:
        recorder = Recorder(b, "switch_right.0")
        _, samples = await recorder.run(0.01)
        assert samples[-1, 0] == 1
        assert (await b.device.monitor.axis_state(0)).switches.right is True
        await b.device.registers.write("mot1r", value=0)
        assert np.isnan((await recorder.run(0.01))[1][-1, 0])
        assert (await b.device.monitor.axis_state(0)).switches.right is None


async def test_a_trigger_hears_every_start_once() -> None:
    async with bench() as b:
        heard: list[DeviceEvent] = []
        end = b.device.listen(lambda event: heard.append(event) if isinstance(event, MotionStarted) else None)
        await b.device.motion.move(0, 1000)
        await b.clock.advance(1.0)
        await b.device.registers.write("x_target", 0, value=0)
        await b.clock.advance(1.0)
        await b.device.motion.rotate(1, 5000)
        end()
        await b.device.motion.move(0, 500)
        assert [(event.axis, round(event.started_at_s, 6)) for event in heard if isinstance(event, MotionStarted)] == [
            (0, 0.0),
            (0, 1.0),
            (1, 2.0),
        ]


@BOTH
@pytest.mark.parametrize("start_s", [0.0, 0.00021, 0.00077])
async def test_the_first_move_watched_tells_when_ramp_ticks_fall(model: str, start_s: float) -> None:
    """At ramp_div 9 ticks come every 1.024 ms: at 22.9 kpps a start between two is worth up to 23 microsteps."""
    async with bench(model) as b:
        for name, value in {"ramp_div": 9, "a_max": 800, "pdiv": 7}.items():
            await b.device.registers.write(name, 0, value)
        await b.device.registers.write("pmul", 0, 62 + (128 if model == "tmc4210" else 0))
        await b.clock.advance(start_s)
        recorder = Recorder(b, "residual.0", "position.0")
        await b.device.motion.move(0, 20_000)
        _, first = await recorder.run(3.0)
        assert first[-1, 1] == 20_000
        again = Recorder(b, "residual.0", "position.0")
        await b.clock.advance(0.000433)
        await b.device.motion.move(0, 0)
        _, second = await again.run(3.0)
        assert second[-1, 1] == 0
        assert np.nanmax(np.abs(second[:, 0])) <= 2.5
