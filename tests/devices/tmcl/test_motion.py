"""Moves, rotation and stops: once each, in the user's units, predicted to a step."""

from __future__ import annotations

from collections.abc import Awaitable, Callable

import numpy as np
import pytest

from app.devices.core.config import AxisSettings, DeviceConfig
from app.devices.core.events import DeviceEvent, MotionStarted
from app.devices.core.results import AxisMove
from app.devices.tmcl.searches import Searches
from app.errors import LinkTimeout, OutOfRange, UnknownThing, UsageError, WrongState
from app.links.tmcl import Request
from app.registers.tmcl.commands import Opcode
from tests.devices.tmcl.harness import MOVERS, Bench, bench

RAMPS = {
    "trapezoid": {},
    "sixpoint": {"ap15": 20_000, "ap16": 15_000, "ap18": 40_000, "ap17": 80_000, "ap19": 200, "ap20": 400},
    "triangle": {"ap4": 400_000, "ap17": 30_000},
}


async def _set(b: Bench, parameters: dict[str, int]) -> None:
    for name, value in parameters.items():
        await b.device.registers.write(name, 0, value)


@pytest.mark.parametrize("ramp", list(RAMPS))
@pytest.mark.parametrize("distance", [-120_000, 30_000, 500])
@pytest.mark.sheet("FM-PD42-1241", "3.6.4")
@pytest.mark.sheet("FM-PD42-1241", "7.5")
async def test_a_move_goes_as_predicted(ramp: str, distance: int) -> None:
    async with bench() as b:
        await _set(b, RAMPS[ramp])
        plan = b.device.telemetry.sample_plan(["position.0", "residual.0", "predicted_velocity.0", "velocity.0"])
        rows: list[tuple[float, bytes]] = []
        assert b.device.session.sampling_port is not None
        b.device.session.sampling_port.start_sampling(
            plan.frames, 0.002, lambda time_s, row: rows.append((time_s, row))
        )
        started = await b.device.motion.move(0, distance)
        assert (started.from_position, started.target_position) == (0, distance)
        assert started.predicted_duration_s is not None
        await b.clock.advance(started.predicted_duration_s + 0.2)
        b.device.session.sampling_port.run_due_samples()
        times = np.array([time_s for time_s, _ in rows])
        position, residual, expected_pps, _ = plan.decode(times, b"".join(row for _, row in rows)).T
        assert position[-1] == distance
        speed = np.abs(expected_pps).max()
        # The ramp generator counts in units of its own: an acceleration of 117 pps^2, a speed of 1 pps.
        assert np.nanmax(np.abs(residual)) < 3 + 2e-3 * speed
        end = b.device.monitor.motion_ends(0)[-1]
        assert (end.reason, end.position) == ("target_reached", distance)
        assert end.time_s == pytest.approx(started.started_at_s + started.predicted_duration_s, abs=0.12)


@pytest.mark.parametrize(
    ("unit", "target", "microsteps"),
    [("rev", 1, 51_200), ("deg", -90, -12_800), ("fullsteps", 3, 768), ("rad", np.pi, 25_600), ("microsteps", 7, 7)],
)
@pytest.mark.sheet("FM-PD42-1241", "6.1")
async def test_units_follow_the_module_s_own_resolution(unit: str, target: float, microsteps: int) -> None:
    async with bench() as b:
        assert (await b.device.motion.move(0, target, unit=unit)).target_position == microsteps


async def test_gear_and_travel_come_from_the_connection() -> None:
    async with bench() as b:
        axis = AxisSettings("spindle", gear_ratio=2.0, travel_mm_per_rev=5.0)
        b.device.session.reconfigure("bench", DeviceConfig("Bench", "pd42-1241", b.device.link, axes=(axis,)))
        await b.device.registers.write("ap140", 0, 4)
        assert (await b.device.motion.move(0, 5, unit="mm")).target_position == 2 * 3200
        await b.device.registers.write("ap202", 0, 400)
        assert (await b.device.motion.move(0, 1, unit="rev")).target_position == 2 * 6400


async def test_a_relative_move_counts_from_where_the_axis_is() -> None:
    async with bench() as b:
        await b.device.motion.move(0, 1000)
        await b.at_rest()
        started = await b.device.motion.move(0, -300, relative=True)
        assert started.target_position == 700
        assert await b.at_rest() == 700


async def test_a_move_while_it_turns_is_predicted_from_there() -> None:
    async with bench() as b:
        await b.device.motion.rotate(0, 30_000)
        await b.clock.advance(1.0)
        started = await b.device.motion.move(0, -5000)
        assert started.predicted_duration_s is not None
        await b.clock.advance(started.predicted_duration_s + 0.3)
        assert (await b.device.monitor.axis_state(0)).position == -5000
        assert b.device.monitor.motion_ends(0)[-1].reason == "target_reached"


@pytest.mark.parametrize(("velocity", "opcode"), [(20_000.0, Opcode.ROR), (-20_000.0, Opcode.ROL)])
@pytest.mark.sheet("FM-PD42-1241", "3.6.1")
@pytest.mark.sheet("FM-PD42-1241", "3.6.2")
async def test_a_rotation_goes_right_or_left(velocity: float, opcode: Opcode) -> None:
    async with bench() as b:
        rotating = await b.device.motion.rotate(0, velocity)
        assert rotating.velocity_pps == velocity
        assert b.tap.count(opcode) == b.tap.count(Opcode.ROR, Opcode.ROL) == 1
        await b.clock.advance(1.0)
        state = await b.device.monitor.axis_state(0)
        assert (state.mode, state.moving, state.target_position) == ("velocity", True, None)
        assert state.velocity_pps == pytest.approx(velocity, abs=2)
        assert state.target_velocity_pps == pytest.approx(velocity, abs=2)


async def test_a_rotation_in_rpm_is_told_its_limit_in_rpm() -> None:
    async with bench() as b:
        assert (await b.device.motion.rotate(0, 60, "rpm")).velocity_chip == 51_200
        with pytest.raises(OutOfRange) as refused:
            await b.device.motion.rotate(0, 10_000, "rpm")
        assert refused.value.maximum == pytest.approx(7_999_774 / 51_200 * 60)
        with pytest.raises(OutOfRange, match="standstill"):
            await b.device.motion.rotate(0, 0.1)
        with pytest.raises(UsageError, match="unit"):
            await b.device.motion.rotate(0, 1, "furlongs")


async def test_what_cannot_be_reached_is_refused_before_anything_is_sent() -> None:
    async with bench() as b:
        await b.device.registers.write("ap1", 0, 2_000_000_000)
        moved = b.tap.count(*MOVERS)
        with pytest.raises(OutOfRange, match="two moves"):
            await b.device.motion.move(0, -2_000_000_000)
        with pytest.raises(OutOfRange, match="target"):
            await b.device.motion.move(0, 3e9)
        with pytest.raises(UnknownThing):
            await b.device.motion.move(1, 0)
        with pytest.raises(UsageError, match="one axis"):
            await b.device.motion.move_together([AxisMove(0, 1), AxisMove(0, 2)])
        assert b.tap.count(*MOVERS) == moved


async def test_no_command_is_sent_to_a_module_that_follows_step_and_direction() -> None:
    async with bench() as b:
        await b.device.registers.write("step_direction_mode", 0, 1)
        moved = b.tap.count(Opcode.MVP, Opcode.MST)
        with pytest.raises(WrongState, match="step/direction"):
            await b.device.motion.move(0, 100)
        assert (await b.device.monitor.axis_state(0)).mode == "step/dir"
        outcome = (await b.device.stop_axes([0]))[0]
        assert "AP 254" in str(outcome.problem)
        assert b.tap.count(Opcode.MVP, Opcode.MST) == moved + 1


@pytest.mark.parametrize(
    ("parameters", "says"),
    [({"ap167": 0}, "driver is off"), ({}, "right switch is active")],
)
async def test_what_will_keep_the_motor_from_moving_is_told(parameters: dict[str, int], says: str) -> None:
    async with bench() as b:
        await _set(b, parameters)
        b.patch(switches={"right": True})
        await b.clock.advance(0.01)
        assert any(says in warning for warning in (await b.device.motion.move(0, 5000)).warnings)


@pytest.mark.sheet("FM-PD42-1241", "3.6.3")
async def test_a_stop_slows_down_and_is_predicted() -> None:
    async with bench() as b:
        await b.device.motion.rotate(0, 40_000)
        await b.clock.advance(2.0)
        outcome = await b.device.stop(0)
        assert outcome.ok
        expected = b.device.motion.prediction(0)
        assert expected is not None
        assert expected.duration_s == pytest.approx(40_000 / 51_200, rel=0.01)
        await b.clock.advance(0.2)
        assert (await b.device.monitor.axis_state(0)).moving
        rest = await b.at_rest()
        assert rest == pytest.approx(expected.position[-1], abs=80)
        state = await b.device.monitor.axis_state(0)
        assert (state.mode, state.velocity_pps) == ("hold", 0)
        assert b.tap.count(Opcode.MST) == 1


async def test_an_immediate_stop_borrows_the_highest_acceleration_and_gives_it_back() -> None:
    async with bench() as b:
        await b.device.motion.rotate(0, 50_000)
        await b.clock.advance(2.0)
        await b.device.stop(0, "immediate")
        assert (await b.device.registers.read("ap5")).value == 7_629_278
        await b.clock.advance(0.01)
        assert (await b.device.monitor.axis_state(0)).velocity_pps == 0
        await b.clock.advance(0.1)
        assert (await b.device.registers.read("ap5")).value == 51_200


async def test_a_move_right_after_an_immediate_stop_has_its_own_acceleration() -> None:
    async with bench() as b:
        await b.device.motion.rotate(0, 50_000)
        await b.clock.advance(2.0)
        await b.device.stop(0, "immediate")
        await b.device.motion.move(0, 0)
        assert (await b.device.registers.read("ap5")).value == 51_200


async def test_a_write_of_the_target_is_a_move() -> None:
    async with bench() as b:
        told: list[DeviceEvent] = []
        b.device.listen(told.append)
        await b.device.registers.write("target_position", 0, 10_000)
        assert b.device.session.motion_commands[0] == 1
        expected = b.device.motion.prediction(0)
        assert expected is not None
        assert await b.at_rest() == 10_000
        await b.device.registers.write("target_speed", 0, -5000)
        await b.clock.advance(1.0)
        assert (await b.device.monitor.axis_state(0)).velocity_pps == pytest.approx(-5000, abs=2)


async def test_a_stop_overtakes_a_move_that_is_being_prepared() -> None:
    """The stop comes between the looks before a move and the move: then the move is not sent any more."""
    async with bench() as b:

        def stop_between(request: Request, reply: bytes) -> bytes:
            if (request.opcode, request.type) == (Opcode.GAP, 11):
                b.device.session.stops[0] += 1  # what a stop does first of all, before it waits for the link
            return reply

        b.tap.spoil = stop_between
        with pytest.raises(WrongState, match="overtook"):
            await b.device.motion.move(0, 5000)
        assert b.tap.count(Opcode.MVP) == 0


async def test_a_start_is_told_to_whoever_waits_for_it() -> None:
    async with bench() as b:
        told: list[DeviceEvent] = []
        b.device.listen(told.append)
        started = await b.device.motion.move(0, 100)
        assert MotionStarted(0, started.started_at_s) in told


@pytest.mark.parametrize("what", ["move", "rotate", "stop", "write", "search"])
async def test_what_moves_is_sent_once_and_a_lost_answer_is_told_as_such(what: str) -> None:
    """The module obeys and only the answer is lost: sent again, a relative move would go twice as far."""

    def lose(request: Request, reply: bytes) -> bytes:
        if request.opcode in (*MOVERS, Opcode.SAP) and (request.opcode, request.type) != (Opcode.RFS, 2):
            raise TimeoutError
        return reply

    async with bench() as b:
        b.tap.spoil = lose
        if what == "stop":
            outcome = (await b.device.stop_axes([0]))[0]
            assert isinstance(outcome.problem, LinkTimeout)
            assert b.tap.count(Opcode.MST) == 1
            return
        sent: dict[str, Callable[[], Awaitable[object]]] = {
            "move": lambda: b.device.motion.move(0, 5000),
            "rotate": lambda: b.device.motion.rotate(0, 5000),
            "write": lambda: b.device.registers.write("ap0", 0, 5000),
            "search": b.part(Searches).start,
        }
        with pytest.raises(LinkTimeout, match="may or may not have been done"):
            await sent[what]()
        assert sum(frame.opcode in (*MOVERS, Opcode.SAP) for frame in b.tap.frames) == 1
        assert b.device.motion.prediction(0) is None
