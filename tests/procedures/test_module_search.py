"""A search that the module does itself: told how, followed, asked what it found, and ended."""

from __future__ import annotations

import pytest

from app.errors import OutOfRange, WrongState
from app.procedures.procedures import Procedures
from app.procedures.search import ReferenceSearchState
from app.registers.tmcl.commands import Opcode
from tests.devices.tmcl.harness import Bench, bench

STAGE = {
    "left_at_fullsteps": -100,
    "right_at_fullsteps": 100,
    "home_from_fullsteps": 30,
    "home_to_fullsteps": 40,
}
FAST, SLOW = 40_000.0, 4_000.0


async def _over(b: Bench, procedures: Procedures, within_s: float = 60.0) -> tuple[ReferenceSearchState, list[str]]:
    """The state at the end, and the phases on the way."""
    phases: list[str] = []
    for _ in range(int(within_s / 0.05)):
        await b.clock.advance(0.05)
        state = procedures.search_state(b.device, 0)
        if not phases or phases[-1] != state.phase:
            phases.append(state.phase)
        if state.state != "running":
            return state, phases
    raise AssertionError(f"the search did not end within {within_s} s: {phases}")


@pytest.mark.parametrize(
    ("mode", "zero_at_fullsteps"),
    [(1, -100), (65, 100), (2, -100), (66, 100), (3, -100), (4, -100), (5, 35), (6, 35), (7, 35)],
)
@pytest.mark.sheet("FM-PD42-1241", "7.1")
async def test_every_mode_finds_its_switch(mode: int, zero_at_fullsteps: int) -> None:
    async with bench(stage=STAGE) as b:
        procedures = Procedures(b.clock)
        begun = procedures.start_search(b.device, 0, mode=mode, search_speed_pps=FAST, switch_speed_pps=SLOW)
        assert begun.state == "running"
        state, phases = await _over(b, procedures)
        assert (state.state, state.mode, state.progress) == ("done", mode, 1.0), state.message
        assert any(phase.startswith("search") for phase in phases)
        assert (await b.device.monitor.axis_state(0)).position == pytest.approx(0, abs=2)
        assert b.module.state().stage.position_fullsteps == pytest.approx(zero_at_fullsteps, abs=2)
        # AP 196 is between the stop switches, at places that closing and opening tell a little apart.
        assert state.distance == (None if mode % 64 not in (2, 3) else pytest.approx(200 * 256, abs=1000))
        assert b.tap.count(Opcode.RFS) > 1
        assert sum((frame.opcode, frame.type) == (Opcode.RFS, 0) for frame in b.tap.frames) == 1


async def test_mode_and_speeds_are_written_and_stay() -> None:
    async with bench(stage=STAGE) as b:
        procedures = Procedures(b.clock)
        procedures.start_search(b.device, 0, mode=4, search_speed_pps=30_000, switch_speed_pps=3_000)
        await _over(b, procedures)
        values = [(await b.device.registers.read(name)).value for name in ("ap193", "ap194", "ap195")]
        assert values == [4, 30_000, 3_000]
        assert procedures.start_search(b.device, 0).state == "running"
        assert (await _over(b, procedures))[0].mode == 4, "as the module is set"


@pytest.mark.parametrize("how", ["abort", "stop", "move"])
async def test_whoever_ends_it_has_the_motor(how: str) -> None:
    async with bench(stage=STAGE | {"left_at_fullsteps": -2000}) as b:
        procedures = Procedures(b.clock)
        procedures.start_search(b.device, 0, mode=1, search_speed_pps=FAST, switch_speed_pps=SLOW)
        await b.clock.advance(1.0)
        if how == "abort":
            await procedures.abort_search(b.device, 0)
        elif how == "stop":
            await b.device.stop(0)
        else:
            await b.device.stop(0)
            await b.device.motion.move(0, 0)
        await b.clock.advance(5.0)
        assert procedures.search_state(b.device, 0).state == "aborted"
        state = await b.device.monitor.axis_state(0)
        assert (state.moving, state.mode == "reference search") == (False, False)
        assert state.position == 0 if how == "move" else state.position < -1000
        sent = [(frame.opcode, frame.type) for frame in b.tap.frames]
        assert sent.index((Opcode.RFS, 1)) < sent.index((Opcode.MST, 0))


async def test_a_switch_that_is_not_there_is_not_searched_for_ever() -> None:
    async with bench(stage=STAGE | {"home_from_fullsteps": 5000, "home_to_fullsteps": 5010}) as b:
        procedures = Procedures(b.clock)
        procedures.start_search(b.device, 0, mode=5, search_speed_pps=FAST, switch_speed_pps=SLOW)
        state, _ = await _over(b, procedures)
        assert state.state == "failed"
        assert "stop switch is active" in state.message
        assert (await b.device.monitor.axis_state(0)).mode == "hold"


async def test_it_gives_up_where_it_gets_too_far() -> None:
    async with bench(stage=STAGE | {"left_at_fullsteps": -5000}) as b:
        procedures = Procedures(b.clock)
        procedures.start_search(b.device, 0, mode=1, search_speed_pps=FAST, switch_speed_pps=SLOW, max_travel=20_000)
        state, _ = await _over(b, procedures)
        assert (state.state, state.message) == ("failed", "nothing was found within 20000 microsteps")
        await b.clock.advance(2.0)
        assert not (await b.device.monitor.axis_state(0)).moving


async def test_what_cannot_be_is_refused() -> None:
    async with bench() as b:
        procedures = Procedures(b.clock)
        with pytest.raises(OutOfRange, match="mode"):
            procedures.start_search(b.device, 0, mode=9)
        with pytest.raises(OutOfRange, match="search_speed_pps"):
            procedures.start_search(b.device, 0, mode=1, search_speed_pps=-5)
        procedures.start_search(b.device, 0, mode=1)
        with pytest.raises(WrongState, match="runs on axis 0"):
            procedures.start_search(b.device, 0, mode=1)
        await procedures.close()


async def test_a_shuttle_and_a_held_rotation_work_on_a_module_too() -> None:
    async with bench() as b:
        procedures = Procedures(b.clock)
        procedures.start_shuttle(b.device, 0, -2000, 3000, dwell_s=0.2)
        await b.clock.advance(8.0)
        assert procedures.shuttle_state(b.device, 0).cycles >= 3
        await procedures.rotate_held(b.device, 0, 10_000, "pps", 1.0)
        assert not procedures.shuttle_state(b.device, 0).running
        await b.clock.advance(0.9)
        assert (await b.device.monitor.axis_state(0)).velocity_pps == pytest.approx(10_000, abs=2)
        await b.clock.advance(1.0)
        state = await b.device.monitor.axis_state(0)
        assert (state.moving, state.mode) == (False, "hold")
