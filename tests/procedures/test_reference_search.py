"""Reference search on both chips: from every side of every switch, to the middle, or aborted with the reason."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Any

import pytest

from app.emulators.tmc428.options import EmulatorPatch, SwitchChange
from app.errors import OutOfRange, UnknownThing, WrongState
from app.procedures.procedures import Procedures
from app.procedures.search import ReferenceSearchState, Switch
from app.registers.catalog import CHIPS_32
from tests.devices.harness import Bench, bench

BOTH = pytest.mark.parametrize("model", list(CHIPS_32))
STAGE = {"left_at_fullsteps": 0.0, "right_at_fullsteps": 700.0, "ref_from_fullsteps": 250.0, "ref_to_fullsteps": 350.0}
"""Short, so that a search takes seconds; the reference switch's middle is at full step 300."""


class Rig:
    """A bench on a short stage, and the procedures of its server."""

    def __init__(self, b: Bench) -> None:
        self.bench = b
        self.procedures = Procedures(b.clock)

    async def search(self, switch: Switch = "reference", within_s: float = 120.0) -> ReferenceSearchState:
        """Search and let time pass until it is over."""
        assert self.procedures.start_search(self.bench.device, 0, switch).state == "running"
        return await self.over(within_s)

    async def over(self, within_s: float = 120.0) -> ReferenceSearchState:
        for _ in range(int(within_s / 0.1)):
            await self.bench.clock.advance(0.1)
            state = self.procedures.search_state(self.bench.device, 0)
            if state.state != "running":
                return state
        raise AssertionError(f"still {state} after {within_s} s")

    def carriage(self) -> float:
        """Where the carriage stands [full steps]: what the chip itself does not know."""
        return self.bench.wire.state().axes[0].position_fullsteps


@asynccontextmanager
async def rig(model: str, start: float, **options: Any) -> AsyncIterator[Rig]:
    options["stages"] = [STAGE | {"start_fullsteps": start}]
    async with bench(model, started=True, stops=True, **options) as b:
        yield Rig(b)


@BOTH
@pytest.mark.sheet("DS-TMC428", "9.9")
@pytest.mark.parametrize("start", [-3.0, 100.0, 251.0, 300.0, 349.0, 351.0, 600.0, 701.0])
async def test_the_reference_switch_is_found_from_everywhere(model: str, start: float) -> None:
    async with rig(model, start) as r:
        state = await r.search()
        assert state.state == "done", state
        microsteps = 16 if model == "tmc4210" else 64
        edges = [start + edge / microsteps for edge in sorted(state.edges)]
        assert edges == pytest.approx([250, 350], abs=2 / microsteps)
        assert r.carriage() == pytest.approx(300, abs=1.5 / microsteps)
        axis = await r.bench.device.monitor.axis_state(0)
        assert (axis.position, axis.target_position, axis.moving) == (0, 0, False)
        assert state.centre is not None
        assert state.offset == state.centre == pytest.approx((300 - start) * microsteps, abs=2)
        assert state.progress == 1.0
        # The switch stops the motor no more, the end switches still do.
        tolerance = (await r.bench.device.registers.read("dx_ref_tolerance", 0)).value
        assert tolerance == pytest.approx(50 * microsteps, abs=12)
        await r.bench.device.motion.move(0, -100 * microsteps)
        assert await r.bench.at_rest() == -100 * microsteps
        await r.bench.device.motion.move(0, -400 * microsteps)
        assert await r.bench.at_rest() == pytest.approx(-300 * microsteps, abs=2)


@BOTH
@pytest.mark.parametrize("start", [-3.0, 30.0, 200.0])
async def test_the_left_end_switch(model: str, start: float) -> None:
    async with rig(model, start) as r:
        state = await r.search("left")
        assert state.state == "done", state
        microsteps = 16 if model == "tmc4210" else 64
        assert r.carriage() == pytest.approx(0, abs=2 / microsteps)
        assert abs(state.edges[0] - state.edges[1]) <= 2
        assert (await r.bench.device.monitor.axis_state(0)).position == 0


@BOTH
@pytest.mark.parametrize("start", [703.0, 600.0, 100.0])
async def test_the_right_end_switch(model: str, start: float) -> None:
    async with rig(model, start) as r:
        state = await r.search("right")
        assert state.state == "done", state
        assert r.carriage() == pytest.approx(700, abs=2 / 16)
        reading = await r.bench.device.registers.read("ref_RnL", 0)
        assert reading.value == 0  # borrowed, and given back


@BOTH
async def test_after_the_reference_the_left_end_is_found_across_it(model: str) -> None:
    async with rig(model, 500.0) as r:
        assert (await r.search()).state == "done"
        state = await r.search("left")
        assert state.state == "done", state
        assert r.carriage() == pytest.approx(0, abs=2 / 16)


async def test_settings_are_given_back() -> None:
    async with rig("tmc428", 400.0) as r:
        device = r.bench.device
        await device.registers.write("lp_ref_conf_rm", 0, fields={"DISABLE_STOP_L": 1, "SOFT_STOP": 1, "REF_RnL": 1})
        assert (await r.search()).state == "done"
        fields = (await device.registers.read("lp_ref_conf_rm", 0)).fields
        assert (fields["DISABLE_STOP_L"], fields["DISABLE_STOP_R"], fields["SOFT_STOP"], fields["REF_RnL"]) == (
            1,
            0,
            1,
            1,
        )


@pytest.mark.sheet("DS-TMC428", "9.9")
async def test_without_a_right_switch_it_goes_left_as_in_the_sheet() -> None:
    async with rig("tmc428", 500.0, wiring="left-only") as r:
        await r.bench.device.registers.write("refmux", value=0)
        assert (await r.bench.device.monitor.axis_state(0)).switches.right is None
        state = await r.search()
        assert state.state == "done", state
        assert r.carriage() == pytest.approx(300, abs=1.5 / 64)


async def test_a_switch_wider_than_the_tolerance_is_crossed_in_pieces() -> None:
    wide = STAGE | {"ref_from_fullsteps": 100.0, "ref_to_fullsteps": 400.0, "start_fullsteps": 600.0}
    async with bench("tmc428", stops=True, stages=[wide]) as b:
        r = Rig(b)
        state = await r.search()
        assert state.state == "done", state
        assert r.carriage() == pytest.approx(250, abs=1.5 / 64)
        assert "does not cover" in state.message
        assert (await b.device.registers.read("dx_ref_tolerance", 0)).value == 4095


@BOTH
async def test_the_phases_are_seen(model: str) -> None:
    async with rig(model, 300.0) as r:
        r.procedures.start_search(r.bench.device, 0)
        seen = [r.procedures.search_state(r.bench.device, 0).phase]
        progress = [0.0]
        for _ in range(3000):
            await r.bench.clock.advance(0.02)
            state = r.procedures.search_state(r.bench.device, 0)
            if seen[-1] != state.phase:
                seen.append(state.phase)
            progress.append(state.progress)
            if state.state != "running":
                break
        assert seen == ["prepare", "leave", "first edge", "second edge", "to the centre"]
        assert progress == sorted(progress)


async def test_no_switch_within_the_way() -> None:
    async with rig("tmc428", 500.0) as r:
        forced = [SwitchChange(axis=0, left=False, right=False, reference=False)]
        r.bench.wire.patch(EmulatorPatch(switches=forced))
        r.procedures.start_search(r.bench.device, 0, max_travel=2000)
        state = await r.over()
        assert state.state == "failed"
        assert "no edge" in state.message
        assert 2000 < await r.bench.at_rest() < 4000


async def test_a_switch_that_stays_active() -> None:
    async with rig("tmc428", 500.0) as r:
        r.bench.wire.patch(EmulatorPatch(switches=[SwitchChange(axis=0, left=True)]))
        r.procedures.start_search(r.bench.device, 0, max_travel=2000)
        state = await r.over()
        assert state.state == "failed"
        assert "still active" in state.message


async def test_both_end_switches_at_once() -> None:
    async with rig("tmc428", 500.0) as r:
        forced = [SwitchChange(axis=0, left=True, right=True)]
        r.bench.wire.patch(EmulatorPatch(switches=forced))
        state = await r.search()
        assert state.state == "failed"
        assert "left and right switch" in state.message


@BOTH
async def test_aborted_it_stops_the_motor(model: str) -> None:
    async with rig(model, 600.0) as r:
        r.procedures.start_search(r.bench.device, 0)
        await r.bench.clock.advance(0.5)
        assert (await r.bench.device.monitor.axis_state(0)).moving
        state = await r.procedures.abort_search(r.bench.device, 0)
        assert (state.state, state.message) == ("aborted", "aborted on request")
        await r.bench.at_rest()
        assert (await r.procedures.abort_search(r.bench.device, 0)).state == "aborted"


@pytest.mark.parametrize("command", ["stop", "move", "write", "stop all"])
async def test_any_other_command_to_the_axis_ends_it(command: str) -> None:
    async with rig("tmc428", 600.0) as r:
        device = r.bench.device
        r.procedures.start_search(device, 0)
        await r.bench.clock.advance(0.5)
        await device.registers.write("v_max", 1, value=100)  # another axis is none of its business
        await r.bench.clock.advance(0.1)
        assert r.procedures.search_state(device, 0).state == "running"
        if command == "stop":
            await device.stop(0)
        elif command == "stop all":
            await r.bench.manager.stop_all()
        elif command == "move":
            await device.motion.move(0, -500)
        else:
            await device.registers.write("v_max", 0, value=700)
        await r.bench.clock.advance(0.1)
        state = r.procedures.search_state(device, 0)
        assert state.state == "aborted"
        assert "another command" in state.message
        if command == "move":
            assert await r.bench.at_rest() == -500  # it did not stop what took over


async def test_a_device_that_vanishes_fails_it() -> None:
    async with rig("tmc428", 600.0) as r:
        r.procedures.start_search(r.bench.device, 0)
        await r.bench.clock.advance(0.5)
        r.bench.fault(unplugged=True)
        state = await r.over()
        assert state.state == "failed"
        assert "unplugged" in state.message


async def test_what_is_missing_is_said_before_anything_moves() -> None:
    async with rig("tmc428", 600.0) as r:
        device = r.bench.device
        with pytest.raises(OutOfRange):
            r.procedures.start_search(device, 0, velocity_pps=0.0)
        with pytest.raises(OutOfRange):
            r.procedures.start_search(device, 0, max_travel=1 << 23)
        with pytest.raises(UnknownThing):
            r.procedures.start_search(device, 3)
        with pytest.raises(UnknownThing):
            r.procedures.search_state(device, 3)
        assert r.procedures.search_state(device, 0).state == "idle"
        for name, value, text in (
            ("continuous_update", 0, "not sampled at rest"),
            ("refmux", 0, "no right switch"),
        ):
            await device.registers.write(name, value=value)
            state = await r.search("right")
            assert state.state == "failed"
            assert text in state.message
            await device.registers.write(name, value=1)
        r.procedures.start_search(device, 0, velocity_pps=1e6)
        assert "allowed is" in (await r.over()).message
        await device.registers.write("v_max", 0, value=0)
        assert "v_max is 0" in (await r.search()).message
        assert (await device.monitor.axis_state(0)).position == 0


async def test_one_procedure_an_axis() -> None:
    async with rig("tmc428", 600.0) as r:
        device = r.bench.device
        r.procedures.start_search(device, 0)
        with pytest.raises(WrongState, match="reference search runs on axis 0"):
            r.procedures.start_shuttle(device, 0, 0, 1000)
        r.procedures.start_shuttle(device, 1, 0, 1000)
        assert len(r.procedures.running(device)) == 2
        await r.procedures.close()
        assert r.procedures.running(device) == []
        await r.bench.manager.disconnect("bench")
        with pytest.raises(WrongState, match="not connected"):
            r.procedures.start_search(device, 0)
