"""Reference search of emulated TMC5xxx by their stop switches, shuttle and held jog on either axis."""

from __future__ import annotations

import pytest

from app.errors import WrongState
from app.procedures.procedures import Procedures
from app.procedures.search import ReferenceSearchState, Switch
from app.registers.tmc5xxx.table import AXES
from tests.devices.tmc5xxx.harness import MODELS, Bench, bench

STAGE = {"left_at_fullsteps": -60, "right_at_fullsteps": 50}
PLACES: dict[Switch, float] = {"left": -60, "right": 50}


async def search(
    b: Bench, procedures: Procedures, switch: Switch, axis: int = 0, **options: object
) -> ReferenceSearchState:
    await b.clock.advance(0.1)
    procedures.start_search(b.device, axis, switch, **options)  # type: ignore[arg-type]
    for _ in range(2000):
        await b.clock.advance(0.05)
        state = procedures.search_state(b.device, axis)
        if state.state != "running":
            return state
    raise AssertionError("the search does not end")


@pytest.mark.parametrize("switch", PLACES)
@pytest.mark.parametrize("model", MODELS)
async def test_zero_is_in_the_middle_of_the_switch_and_the_motor_stands_there(model: str, switch: Switch) -> None:
    async with bench(model, stage=STAGE) as b:
        axis = AXES[model] - 1
        before = (await b.device.registers.read("SW_MODE", axis)).raw
        state = await search(b, Procedures(b.clock), switch, axis)
        assert state.state == "done", state.message
        assert len(state.edges) == 2
        now = await b.state(axis)
        assert (now.position, now.moving) == (0, False)
        assert b.wire.state().axes[axis].truth.rotor_fullsteps == pytest.approx(PLACES[switch], abs=0.2)
        assert (await b.device.registers.read("SW_MODE", axis)).raw == before
        assert (await b.state(0)).position == 0  # the other axis has not moved


async def test_a_search_that_begins_on_the_switch_leaves_it_first() -> None:
    async with bench("tmc5130", stage=STAGE, start_fullsteps=-64.0) as b:
        state = await search(b, Procedures(b.clock), "left")
        assert state.state == "done", state.message
        assert b.wire.state().axes[0].truth.rotor_fullsteps == pytest.approx(-60, abs=0.2)


async def test_a_switch_that_is_not_there_is_given_up() -> None:
    async with bench("tmc5160", stage=STAGE | {"left_at_fullsteps": -5000}) as b:
        state = await search(b, Procedures(b.clock), "left", max_travel=20_000)
        assert state.state == "failed"
        assert "left switch" in state.message
        assert not (await b.at_rest()).moving


async def test_searches_run_on_both_axes_at_once() -> None:
    async with bench("tmc5072", stage=STAGE) as b:
        procedures = Procedures(b.clock)
        procedures.start_search(b.device, 0, "left")
        state = await search(b, procedures, "right", 1)
        assert state.state == "done", state.message
        for _ in range(100):
            await b.clock.advance(0.05)
        assert procedures.search_state(b.device, 0).state == "done"
        truths = [axis.truth.rotor_fullsteps for axis in b.wire.state().axes]
        assert truths == [pytest.approx(-60, abs=0.2), pytest.approx(50, abs=0.2)]


async def test_what_cannot_be_searched_says_why() -> None:
    async with bench("tmc5062", None) as b:
        procedures = Procedures(b.clock)
        with pytest.raises(WrongState, match="no reference switch"):
            procedures.start_search(b.device, 0, "reference")
        await b.device.registers.write("GCONF", fields={"enc2_enable": 1})
        with pytest.raises(WrongState, match="encoder 2 has the pins"):
            procedures.start_search(b.device, 0, "right")
        state = await search(b, procedures, "left")
        assert (state.state, "VMAX is 0" in state.message) == ("failed", True)


async def test_a_shuttle_goes_back_and_forth_on_either_axis() -> None:
    async with bench("tmc5072") as b:
        procedures = Procedures(b.clock)
        procedures.start_shuttle(b.device, 1, 0, 4_000, 0.1)
        for _ in range(60):
            await b.clock.advance(0.05)
        state = procedures.shuttle_state(b.device, 1)
        assert state.cycles >= 2, state.message
        await procedures.stop_shuttle(b.device, 1)
        assert (await b.state(0)).position == 0


async def test_a_held_jog_ends_by_itself() -> None:
    async with bench("tmc5031") as b:
        procedures = Procedures(b.clock)
        await procedures.rotate_held(b.device, 1, 5_000, "pps", 0.3)
        await b.clock.advance(0.2)
        procedures.keep_rotating(b.device, 1, 0.3)
        await b.clock.advance(0.2)
        assert (await b.state(1)).velocity_pps > 4_000
        for _ in range(10):
            await b.clock.advance(0.05)
        assert (await b.state(1)).velocity_pps == 0
