"""Calibration, step response and disturbance of an emulated closed loop: physics, not promises."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from dataclasses import dataclass, replace

import numpy as np
import pytest

from app.api.devices.views import load_of
from app.clock import Clock
from app.emulators.tmc4361.options import Tmc4361Patch
from app.errors import OutOfRange, WrongState
from app.procedures.closed_loop import CalibrationState, ResponseState
from app.procedures.procedures import Procedures
from app.procedures.step_response import Shape, Window
from tests.devices.tmc4361.harness import START, Bench, bench

FULL_STEP = 256


@dataclass
class Tuned:
    b: Bench
    procedures: Procedures

    async def finish(self, state: Callable[[], CalibrationState | ResponseState], within_s: float = 20.0) -> None:
        for _ in range(int(within_s / 0.05)):
            await self.b.clock.advance(0.05)
            if state().state != "running":
                return
        raise AssertionError(f"still running after {within_s} s")

    async def calibrate(self, *, switch_on: bool = True) -> CalibrationState:
        self.procedures.start_calibration(self.b.device, 0, switch_on=switch_on)
        await self.finish(lambda: self.procedures.calibration_state(self.b.device, 0))
        return self.procedures.calibration_state(self.b.device, 0)

    async def step(self, distance: int, shape: Shape = "ramp", seconds: float = 1.0) -> ResponseState:
        self.procedures.start_step_response(self.b.device, 0, distance, shape, Window(seconds))
        await self.finish(lambda: self.procedures.step_response_state(self.b.device, 0))
        return self.procedures.step_response_state(self.b.device, 0)

    async def disturb(self, torque_nm: float) -> ResponseState:
        device = self.b.device
        self.procedures.start_disturbance(device, 0, load_of(device, 0, torque_nm))
        await self.finish(lambda: self.procedures.disturbance_state(device, 0))
        return self.procedures.disturbance_state(device, 0)


@asynccontextmanager
async def tuned(**options: object) -> AsyncIterator[Tuned]:
    async with bench(replace(START, stops=False), **options) as b:
        clock: Clock = b.clock
        procedures = Procedures(clock)
        try:
            yield Tuned(b, procedures)
        finally:
            await procedures.close()


# --- calibration --------------------------------------------------------------------------------


@pytest.mark.parametrize("start", [0.0, 0.3, -1.7], ids=str)
async def test_a_calibrated_loop_holds_the_rotor_under_a_load_that_throws_it_off_without(start: float) -> None:
    async with tuned(start_fullsteps=start) as t:
        done = await t.calibrate()
        assert (done.state, done.regulation) == ("done", "closed_loop"), done.message
        assert done.offset == (await t.b.device.registers.read("CL_OFFSET", 0)).value
        assert -512 <= done.offset <= 511
        await t.b.device.motion.move(0, 12_345)
        await t.b.clock.advance(2)
        t.b.patch(Tmc4361Patch(load_torque_nm=0.2))
        await t.b.clock.advance(1)
        state = await t.b.state()
        truth = t.b.wire.state().truth
        assert truth.lost_fullsteps == 0
        assert state.deviation is not None
        assert state.load_angle_deg is not None
        assert abs(state.deviation) < FULL_STEP
        assert state.load_angle_deg == pytest.approx(truth.load_angle_deg, abs=4)


async def test_the_user_s_ramps_come_back_after_a_calibration() -> None:
    async with tuned() as t:
        await t.calibrate()
        held = {name: (await t.b.device.registers.read(name, 0)).value for name in ("RAMPMODE", "VMAX")}
        assert held == {"RAMPMODE": 6, "VMAX": 50_000 * 256}
        state = await t.b.state()
        assert not state.moving
        assert state.position == state.target_position


async def test_a_calibration_without_switching_on_leaves_regulation_off() -> None:
    async with tuned() as t:
        done = await t.calibrate(switch_on=False)
        assert (done.state, done.regulation) == ("done", "off")
        assert (await t.b.device.registers.read("ENC_IN_CONF", 0)).fields["regulation_modus"] == 0


async def test_an_encoder_that_counts_the_other_way_is_found_before_the_loop_is_closed() -> None:
    async with tuned(encoder={"reversed": True}) as t:
        failed = await t.calibrate()
        assert failed.state == "failed"
        assert "invert_enc_dir" in failed.message
        assert failed.regulation == "off"
        await t.b.device.registers.write("ENC_IN_CONF", 0, fields={"invert_enc_dir": 1})
        assert (await t.calibrate()).state == "done"


@pytest.mark.parametrize("counts", [400, 1000, 16_384], ids=str)
@pytest.mark.parametrize("reversed_", [False, True], ids=["with", "against"])
async def test_an_encoder_of_another_resolution_is_measured_and_its_writes_put_it_right(
    counts: int, reversed_: bool
) -> None:
    async with tuned(encoder={"reversed": reversed_}) as t:
        right = (await t.b.device.registers.read("ENC_CONST", 0)).value
        await t.b.device.registers.write("ENC_IN_RES", 0, fields={"ENC_IN_RES": counts, "MANUAL_ENC_CONST": 0})
        failed = await t.calibrate()
        assert failed.state == "failed"
        found = failed.encoder
        assert found is not None
        assert found.set_counts == pytest.approx(counts, rel=1e-3)
        assert (found.counts_per_turn < 0) is reversed_
        assert str(round(found.set_counts)) in failed.message
        for register, fields in found.writes.items():
            await t.b.device.registers.write(register, 0, fields=dict(fields))
        assert (await t.b.device.registers.read("ENC_CONST", 0)).value == right
        done = await t.calibrate()
        assert done.state == "done"
        assert done.encoder is None


async def test_a_motor_that_does_not_turn_is_told() -> None:
    async with tuned() as t:
        t.b.patch(Tmc4361Patch(blocked=True))
        failed = await t.calibrate()
        assert failed.state == "failed"
        assert "current on" in failed.message
        assert failed.encoder is None


async def test_closed_loop_needs_256_microsteps() -> None:
    async with tuned() as t:
        await t.b.device.registers.write("STEP_CONF", 0, fields={"mstep_per_fs": 4})
        failed = await t.calibrate()
        assert failed.state == "failed"
        assert "256 microsteps" in failed.message


async def test_a_stop_ends_a_calibration_with_regulation_off() -> None:
    async with tuned() as t:
        t.procedures.start_calibration(t.b.device, 0)
        await t.b.clock.advance(0.15)
        await t.b.device.stop(0)
        await t.b.clock.advance(0.5)
        state = t.procedures.calibration_state(t.b.device, 0)
        assert (state.state, state.regulation) == ("aborted", "off")
        await t.b.device.motion.move(0, 5_000)
        assert (await t.b.state()).mode == "positioning, S-ramp"


async def test_one_procedure_at_a_time_and_only_where_there_is_a_loop() -> None:
    async with tuned() as t:
        t.procedures.start_calibration(t.b.device, 0)
        with pytest.raises(WrongState, match="closed-loop calibration runs"):
            t.procedures.start_step_response(t.b.device, 0, 100)
        await t.procedures.abort_calibration(t.b.device, 0)
        with pytest.raises(OutOfRange):
            t.procedures.start_step_response(t.b.device, 0, 0)
        with pytest.raises(OutOfRange, match="velocity_pps"):
            t.procedures.start_calibration(t.b.device, 0, -1.0)


# --- responses ----------------------------------------------------------------------------------


async def test_a_step_response_is_recorded_and_scored() -> None:
    async with tuned() as t:
        await t.calibrate()
        done = await t.step(20_000, seconds=1.2)
        assert done.state == "done", done.message
        recording, score = done.recording, done.score
        assert recording is not None
        assert score is not None
        assert len({len(column) for column in (recording.time_s, recording.encoder, recording.load_torque_nm)}) == 1
        assert np.all(np.diff(recording.time_s) > 0)
        assert recording.time_s[0] == pytest.approx(-0.05, abs=0.02)
        assert recording.time_s[-1] >= 1.15
        assert np.allclose(recording.deviation, recording.encoder - recording.commanded, atol=2)
        assert score.settling_s is not None
        assert score.arrival_s is not None
        assert 0.5 < score.arrival_s < 0.9  # 0.35 + 0.05 + 0.35 s
        assert score.peak == pytest.approx(np.abs(recording.deviation).max(), abs=1)
        assert score.overshoot < FULL_STEP
        assert abs(score.final_error) < 50


async def test_a_step_without_a_ramp_jumps_and_the_ramps_come_back() -> None:
    async with tuned() as t:
        await t.calibrate()
        done = await t.step(2_000, shape="step", seconds=0.6)
        assert done.score is not None
        assert done.score.arrival_s == pytest.approx(0.04, abs=0.003)  # at 50,000 pps from the first step on
        assert (await t.b.device.registers.read("RAMPMODE", 0)).value == 6


async def test_a_load_is_applied_recorded_and_taken_away() -> None:
    async with tuned() as t:
        await t.calibrate()
        done = await t.disturb(0.15)
        assert done.state == "done", done.message
        assert done.recording is not None
        assert done.score is not None
        loaded = done.recording.load_torque_nm > 0
        assert 0.4 < loaded.mean() < 0.55
        assert done.recording.encoder[loaded].min() < done.recording.encoder[0] - 20  # a weight pulls to negative
        assert done.score.peak > 20
        assert done.score.settling_s is not None
        assert t.b.wire.state().load_torque_nm == 0


async def test_closed_loop_brings_back_what_an_open_loop_loses() -> None:
    """The same pull, beyond what the motor can hold, for the same while."""
    async with tuned() as t:
        open_loop = await t.disturb(0.45)
        assert open_loop.score is not None
        assert open_loop.score.settling_s is None  # steps are lost for good
    async with tuned() as t:
        await t.calibrate()
        closed = await t.disturb(0.45)
        assert closed.score is not None
        assert abs(closed.score.final_error) < FULL_STEP


async def test_an_aborted_disturbance_takes_its_load_away() -> None:
    async with tuned() as t:
        t.procedures.start_disturbance(t.b.device, 0, load_of(t.b.device, 0, 0.1), window=Window(5.0))
        await t.b.clock.advance(0.5)
        assert t.b.wire.state().load_torque_nm == pytest.approx(0.1)
        stops = len(t.b.port.written(0x20))
        aborted = await t.procedures.abort_disturbance(t.b.device, 0)
        assert aborted.state == "aborted"
        assert t.b.wire.state().load_torque_nm == 0
        assert len(t.b.port.written(0x20)) == stops  # an axis that holds its place goes on doing so


async def test_an_axis_that_moves_is_not_recorded() -> None:
    async with tuned() as t:
        await t.b.device.motion.rotate(0, 1_000)
        await t.b.clock.advance(0.3)
        failed = await t.step(100)
        assert failed.state == "failed"
        assert "moves" in failed.message


async def test_a_link_that_fails_ends_a_recording() -> None:
    async with tuned() as t:
        t.procedures.start_step_response(t.b.device, 0, 5_000, window=Window(3.0))
        await t.b.clock.advance(0.5)
        t.b.fault(unplugged=True)
        await t.b.clock.advance(0.3)
        await asyncio.sleep(0)
        state = t.procedures.step_response_state(t.b.device, 0)
        assert state.state == "failed"
        assert "unplugged" in state.message
