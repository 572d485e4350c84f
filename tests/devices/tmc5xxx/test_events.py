"""GSTAT and RAMP_STAT: told as a timeline, and not taken from whoever reads them by their names."""

from __future__ import annotations

import numpy as np
import pytest

from app.devices.core.results import ChipEvents
from app.emulators.drive.options import MotorOptions
from app.emulators.tmc5xxx import Tmc5xxxPatch
from app.emulators.tmc5xxx.options import AxisChange
from app.errors import WrongState
from app.registers.tmc5xxx.table import AXES
from tests.devices.tmc5xxx.harness import MODELS, Bench, bench

CLEARS_ON_READ = ("tmc5031", "tmc5062", "tmc5072", "tmc5130")
STALLING = {"sg_stop": 1, "stop_l_enable": 0, "stop_r_enable": 0}


@pytest.mark.parametrize("model", MODELS)
async def test_a_reset_at_power_on_is_told_once_and_left_for_its_user(model: str) -> None:
    async with bench(model) as b:
        await passes(b, 3)
        for axis in range(AXES[model]):
            assert b.event_names(axis) == ["reset"]
        assert (await b.device.registers.read("GSTAT")).fields["reset"] == 1
        if model in ("tmc5160", "tmc5240"):  # it stays until somebody writes the 1
            assert (await b.device.registers.read("GSTAT")).fields["reset"] == 1
            await b.device.registers.write("GSTAT", fields={"reset": 1})
        assert (await b.device.registers.read("GSTAT")).fields["reset"] == 0


@pytest.mark.parametrize("model", MODELS)
async def test_an_arrival_is_told_each_time_and_stays_for_its_user(model: str) -> None:
    async with bench(model) as b:
        for target in (1_000, 2_000):
            await b.device.motion.move(0, target)
            await passes(b, 1)
        assert b.event_names().count("event_pos_reached") == 2
        for _ in range(3):
            await b.device.monitor.axis_state(0)
        first = await b.device.registers.read("RAMP_STAT", 0)
        assert first.fields["event_pos_reached"] == 1
        if model in ("tmc5160", "tmc5240"):
            await b.device.registers.write("RAMP_STAT", 0, fields={"event_pos_reached": 1})
        assert (await b.device.registers.read("RAMP_STAT", 0)).fields["event_pos_reached"] == 0


async def test_what_telemetry_has_seen_to_end_is_looked_at_soon() -> None:
    async with bench("tmc5130") as b:
        plan = b.device.telemetry.sample_plan(["position.0", "target_position.0", "velocity.0"])
        times: list[float] = []
        rows: list[bytes] = []

        def sink(time_s: float, replies: bytes) -> None:
            times.append(time_s)
            rows.append(replies)

        b.port.start_sampling(plan.frames, 0.01, sink)
        await b.device.motion.move(0, 2_000)
        await b.clock.advance(0.001)
        for _ in range(60):
            await b.clock.advance(0.01)
            b.port.run_due_samples()
            plan.decode(np.array(times), b"".join(rows))
            times.clear()
            rows.clear()
            if b.device.monitor.motion_ends(0):
                break
        await b.clock.advance(0.11)
        assert "event_pos_reached" in b.event_names()


@pytest.mark.parametrize("model", MODELS)
async def test_reading_by_name_tells_the_timeline_too(model: str) -> None:
    async with bench(model) as b:
        await passes(b, 1)
        await b.device.motion.move(0, 50)
        await b.clock.advance(0.04)  # there before anybody has looked
        assert "event_pos_reached" not in b.event_names()
        read = await b.device.registers.read("RAMP_STAT", 0)
        await passes(b, 1)
        assert read.fields["event_pos_reached"] == 1
        assert b.event_names().count("event_pos_reached") == 1


async def test_a_whole_listing_clears_nothing() -> None:
    for model in ("tmc5130", "tmc5160"):
        async with bench(model) as b:
            await b.device.motion.move(0, 100)
            await passes(b, 1)
            listed = {reading.name: reading for reading in await b.device.registers.read_all()}
            assert ("RAMP_STAT" in listed) == (model == "tmc5160")
            if model == "tmc5160":
                assert listed["RAMP_STAT"].fields["event_pos_reached"] == 1
            assert (await b.device.registers.read("RAMP_STAT", 0)).fields["event_pos_reached"] == 1


@pytest.mark.parametrize("model", MODELS)
async def test_latches_and_stops_are_told(model: str) -> None:
    async with bench(model) as b:
        await b.device.registers.write("SW_MODE", 0, fields={"latch_r_active": 1})
        await b.device.motion.rotate(0, 10_000)
        await passes(b, 0.5)
        b.switches(right=True)
        await passes(b, 0.5)
        names = b.event_names()
        assert names.count("status_latch_r") == 1
        assert names.count("event_stop_r") == 1
        end = b.device.monitor.motion_ends(0)[-1]
        assert (end.reason, end.detail) == ("right_switch", "the right switch is active")
        b.switches(right=False)
        await passes(b, 0.5)
        await b.device.motion.rotate(0, -10_000)
        await passes(b, 0.3)
        b.switches(left=True)
        await passes(b, 0.5)
        assert b.device.monitor.motion_ends(0)[-1].reason == "left_switch"
        assert "event_stop_l" in b.event_names()


async def test_the_events_of_two_axes_are_their_own() -> None:
    async with bench("tmc5072") as b:
        await b.device.motion.move(1, 2_000)
        await passes(b, 1)
        assert b.event_names(0) == ["reset"]
        assert b.event_names(1) == ["reset", "event_pos_reached"]
        heard = [told for told in b.told if isinstance(told, ChipEvents)]
        assert [(told.axis, told.names) for told in heard] == [(1, ("event_pos_reached",))]


@pytest.mark.parametrize("model", MODELS)
async def test_a_reset_while_we_know_the_chip_is_seen_and_forgets_its_setting(model: str) -> None:
    async with bench(model) as b:
        await b.device.motion.move(0, 50_000)
        await passes(b, 0.5)
        assert (await b.device.counter.poll(0)).reset_seen is True  # that of power-on
        assert (await b.device.counter.poll(0)).reset_seen is False
        b.patch(Tmc5xxxPatch(power_cycle=True))
        await passes(b, 0.5)
        assert b.event_names().count("reset") == 2
        assert b.device.motion.prediction(0) is None
        end = b.device.monitor.motion_ends(0)[-1]
        assert (end.reason, end.detail) == ("unknown", "the chip was reset while it moved")
        look = await b.device.counter.poll(0)
        assert (look.count, look.reset_seen) == (0, True)
        assert (await b.device.counter.poll(0)).reset_seen is False
        assert b.ramp(0).words["VMAX"] == 0
        await b.device.registers.write("VMAX", 0, 50_000)
        for name in ("AMAX", "DMAX", "D1"):
            await b.device.registers.write(name, 0, 1_000)
        started = await b.device.motion.move(0, 100)
        assert any("was reset" in warning for warning in started.warnings)
        assert any("toff is 0" in warning for warning in started.warnings)
        await b.device.registers.read("GSTAT")
        assert not any("was reset" in warning for warning in (await b.device.motion.move(0, 200)).warnings)


@pytest.mark.parametrize("model", MODELS)
async def test_what_is_written_after_a_reset_is_forgotten_at_the_next_one_alone(model: str) -> None:
    """However many looks there are at the chip before it is polled."""
    async with bench(model) as b:
        b.patch(Tmc5xxxPatch(power_cycle=True))
        await b.state()
        for _ in range(2):
            await b.device.registers.write("VMAX", 0, 50_000)
            await b.state()
            assert b.ramp(0).words["VMAX"] == 50_000
            b.patch(Tmc5xxxPatch(power_cycle=True))
            await b.state()
            assert b.ramp(0).words["VMAX"] == 0


async def test_a_look_at_one_axis_does_not_take_the_reset_from_the_other() -> None:
    async with bench("tmc5062") as b:
        assert (await b.device.counter.poll(0)).reset_seen is True
        assert (await b.device.counter.poll(1)).reset_seen is True
        b.patch(Tmc5xxxPatch(power_cycle=True))
        assert (await b.device.counter.poll(1)).reset_seen is True
        assert (await b.device.counter.poll(0)).reset_seen is True
        assert (await b.device.counter.poll(0)).reset_seen is False


async def test_what_was_set_before_a_connection_is_not_known_and_said_so() -> None:
    async with bench("tmc5130", start=None) as b:
        await b.device.registers.read("GSTAT")
        for name, value in (("VMAX", 50_000), ("AMAX", 1_000), ("DMAX", 1_000), ("D1", 1_000), ("VSTOP", 10)):
            b.wire.write(b.address(name), value)
        b.memory.fresh = False  # as for a server that starts when somebody else has set the chip up
        started = await b.device.motion.move(0, 5_000)
        assert started.predicted_duration_s is None
        unknown = "VSTART, A1, V1, AMAX, VMAX, DMAX, D1, VSTOP, TZEROWAIT cannot be read"
        assert any(unknown in warning for warning in started.warnings)
        await passes(b, 2)
        assert (await b.state()).position == 5_000
        await b.device.stop(0)
        with pytest.raises(WrongState, match="VMAX cannot be read, and a stop or a rotation has written over"):
            await b.device.motion.move(0, 0)
        await b.device.registers.write("VMAX", 0, 50_000)
        await b.device.motion.move(0, 0)


@pytest.mark.parametrize("model", MODELS)
async def test_no_look_lets_a_motor_go_on_that_stallguard_has_stopped(model: str) -> None:
    """Clearing event_stop_sg does, and of most chips reading RAMP_STAT clears it."""
    async with bench(model, motor=MotorOptions().model_dump()) as b:
        await b.device.registers.write("SW_MODE", 0, fields=dict(STALLING))
        await let_stallguard_see(b)
        await b.device.motion.rotate(0, 40_000)
        await passes(b, 0.5)
        assert (await b.state()).velocity_pps > 39_000
        b.patch(Tmc5xxxPatch(axes=[AxisChange(axis=0, blocked=True)]))
        await passes(b, 1.0)
        first = await b.state()
        assert first.velocity_pps == 0
        for _ in range(10):
            assert (await b.state()).velocity_pps == 0
            await b.clock.advance(0.05)
        assert (await b.state()).position == first.position
        end = b.device.monitor.motion_ends(0)[-1]
        assert (end.reason, end.detail) == ("stall", "StallGuard stopped it (event_stop_sg)")
        assert b.event_names().count("event_stop_sg") == 1
        assert (await b.device.registers.read("RAMP_STAT", 0)).fields["event_stop_sg"] == 1
        # A command to move is what lets it go on.
        b.patch(Tmc5xxxPatch(axes=[AxisChange(axis=0, blocked=False)]))
        await b.device.registers.write("SW_MODE", 0, fields={"sg_stop": 0})
        await b.device.motion.move(0, 1_000, relative=True)
        assert (await b.at_rest()).position == first.position + 1_000


async def let_stallguard_see(b: Bench) -> None:
    """Speed thresholds and a filter with which a blocked motor stalls."""
    if b.memory.rows(0).tstep is None:
        await b.device.registers.write("VCOOLTHRS", 0, 10_000)
        await b.device.registers.write("VHIGH", 0, (1 << 23) - 1)
    else:
        await b.device.registers.write("TCOOLTHRS", 0, 2_000)


async def passes(b: Bench, seconds: float) -> None:
    for _ in range(round(seconds / 0.05)):
        await b.clock.advance(0.05)
