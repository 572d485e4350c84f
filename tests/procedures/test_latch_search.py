"""Reference search of an emulated TMC4361: edges as the chip latches them, zero where the switch really is."""

from __future__ import annotations

import pytest

from app.errors import WrongState
from app.procedures.procedures import Procedures
from app.procedures.search import ReferenceSearchState, Switch
from tests.devices.tmc4361.harness import Bench, bench

STAGE = {
    "left_at_fullsteps": -60,
    "right_at_fullsteps": 50,
    "home_from_fullsteps": -28,
    "home_to_fullsteps": -20,
}
PLACES: dict[Switch, float] = {"left": -60, "right": 50, "reference": -24}


async def search(b: Bench, procedures: Procedures, switch: Switch, **options: object) -> ReferenceSearchState:
    await b.clock.advance(0.1)  # the input filters have to see the switches once
    procedures.start_search(b.device, 0, switch, **options)  # type: ignore[arg-type]
    for _ in range(2000):
        await b.clock.advance(0.05)
        state = procedures.search_state(b.device, 0)
        if state.state != "running":
            return state
    raise AssertionError("the search does not end")


@pytest.mark.sheet("DS-TMC4361", "9")
@pytest.mark.parametrize("switch", PLACES)
async def test_zero_is_in_the_middle_of_the_switch_and_the_motor_stands_there(switch: Switch) -> None:
    async with bench(stage=STAGE) as b:
        before = (await b.device.registers.read("REFERENCE_CONF", 0)).raw
        state = await search(b, Procedures(b.clock), switch)
        assert state.state == "done", state.message
        assert len(state.edges) == 2
        axis = await b.state()
        assert (axis.position, axis.moving) == (0, False)
        assert b.wire.state().truth.rotor_fullsteps == pytest.approx(PLACES[switch], abs=0.2)
        assert axis.deviation == pytest.approx(0, abs=20)  # the encoder has got the same zero
        assert (await b.device.registers.read("REFERENCE_CONF", 0)).raw == before


@pytest.mark.parametrize("start", [-24.0, -52.0], ids=["inside", "beyond"])
async def test_home_is_found_from_inside_and_from_the_other_side(start: float) -> None:
    async with bench(stage=STAGE, start_fullsteps=start) as b:
        state = await search(b, Procedures(b.clock), "reference")
        assert state.state == "done", state.message
        assert b.wire.state().truth.rotor_fullsteps == pytest.approx(-24, abs=0.2)


async def test_a_search_that_begins_on_the_switch_leaves_it_first() -> None:
    async with bench(stage=STAGE, start_fullsteps=-64) as b:
        state = await search(b, Procedures(b.clock), "left")
        assert state.state == "done", state.message
        assert b.wire.state().truth.rotor_fullsteps == pytest.approx(-60, abs=0.2)


async def test_a_switch_that_is_not_there_is_given_up() -> None:
    async with bench(stage=STAGE | {"left_at_fullsteps": -5000}) as b:
        state = await search(b, Procedures(b.clock), "left", max_travel=20_000)
        assert state.state == "failed"
        assert "left switch" in state.message
        assert not (await b.at_rest()).moving


async def test_home_that_is_nowhere_between_the_ends_is_told() -> None:
    far = {"home_from_fullsteps": 900, "home_to_fullsteps": 901}
    async with bench(stage=STAGE | far) as b:
        state = await search(b, Procedures(b.clock), "reference")
        assert state.state == "failed"
        assert "home" in state.message


async def test_without_a_speed_limit_nothing_is_searched() -> None:
    async with bench(None) as b:
        state = await search(b, Procedures(b.clock), "left")
        assert state.state == "failed"
        assert "VMAX" in state.message
        with pytest.raises(WrongState, match="nothing is held"):
            Procedures(b.clock).keep_rotating(b.device, 0, 1.0)
