"""Axes that turn for ever: angles after many wraps, ways, gears, encoders, snapshots, compare registers, history."""

from __future__ import annotations

from fractions import Fraction

import pytest

from app.calc.positions.extended import Counter
from app.calc.positions.rotary import Way
from app.devices.core.results import RegisterWritten
from app.errors import UsageError, WrongState
from tests.calc.turn_offset import TurnOffset
from tests.positions.harness import FAMILIES, Bench, bench

TURN = Fraction(358_400, 3)
"""Behind a gear of 3 to 7 teeth: no whole number of microsteps."""


async def geared(b: Bench) -> None:
    await b.service.set_gear(b.device, 0, (51_200, 3, 7))


@pytest.mark.sheet("AN-001", "3.2")
@pytest.mark.parametrize("model", ["tmc428", "tmc5160"])
async def test_the_angle_is_exact_after_many_wraps_and_a_move_to_an_angle_is_too(model: str) -> None:
    async with bench(model) as b:
        await b.stand(b.half - 1000)
        await geared(b)
        await b.device.motion.rotate(0, b.device.motion.speed_limit_pps(0) * 0.9)
        note = TurnOffset(TURN, Counter(b.whole.bit_length() - 1), b.half - 1000)
        for _ in range(25 if b.whole < 1 << 30 else 4):
            await b.clock.advance(4)
            state = await b.state()
            assert state.rotary is not None
            assert state.actual is not None
            assert state.counter is not None
            assert state.rotary.turns * TURN + state.rotary.place == state.actual
            assert (
                (state.counter % b.whole + state.rotary.offset) % TURN
                == state.rotary.place
                == note.update(state.counter)
            )
            assert state.rotary.displacement_const == b.whole % TURN == note.displacement_const
        before = state.actual or 0
        assert before > b.half
        await b.service.go_to_angle(b.device, 0, 123.4, "positive")
        slowing = b.seen()
        assert (slowing.state, slowing.target) == ("moving", None)
        arrived = await b.arrived(60)
        assert arrived.actual is not None
        assert arrived.rotary is not None
        assert arrived.actual > before
        assert abs(arrived.rotary.place - Fraction("123.4") * TURN / 360) <= Fraction(1, 2)
        assert arrived.rotary.angle_deg == pytest.approx(123.4, abs=360 / float(TURN))


@pytest.mark.parametrize(("way", "turned"), [("shortest", -90), ("positive", 270), ("negative", -90)])
@pytest.mark.parametrize("model", FAMILIES)
async def test_the_way_to_an_angle(model: str, way: Way, turned: int) -> None:
    async with bench(model) as b:
        await b.service.set_turn(b.device, 0, Fraction(3600))
        await b.service.go_to_angle(b.device, 0, 270, way)
        arrived = await b.arrived(30)
        assert arrived.actual == turned * 10
        assert arrived.rotary is not None
        assert (arrived.rotary.turns, arrived.rotary.place) == (turned // 360, Fraction(2700))


async def test_turns_places_and_zero() -> None:
    async with bench("tmc428") as b:
        with pytest.raises(WrongState, match="has no turn"):
            await b.service.go_turns(b.device, 0, 1)
        await b.service.set_turn(b.device, 0, Fraction(10_000, 3))
        await b.service.go_turns(b.device, 0, 30)
        assert (await b.arrived(30)).actual == 100_000
        await b.service.go_turns(b.device, 0, -1)
        assert (await b.arrived(30)).actual == 100_000 - 3333
        await b.service.go_to_place(b.device, 0, Fraction(0), "negative")
        assert (await b.arrived(30)).actual == 96_667  # 29 turns are 96666 2/3
        await b.service.set_zero(b.device, 0, 96_667)
        state = b.seen()
        assert state.rotary is not None
        assert (state.rotary.turns, state.rotary.place, state.rotary.angle_deg) == (0, Fraction(0), 0.0)
        await b.service.set_turn(b.device, 0, None)
        assert b.seen().rotary is None


async def test_a_turn_that_cannot_be_is_refused() -> None:
    async with bench("tmc428") as b:
        with pytest.raises(UsageError, match="a turn is above 0"):
            await b.service.set_turn(b.device, 0, Fraction(0))
        with pytest.raises(UsageError, match="teeth"):
            await b.service.set_gear(b.device, 0, (100, 0, 1))


async def test_a_rotation_that_was_stopped_for_an_angle_and_then_by_somebody_goes_nowhere() -> None:
    async with bench("tmc428") as b:
        await geared(b)
        await b.device.motion.rotate(0, 400_000)
        await b.clock.advance(3)
        await b.service.go_to_angle(b.device, 0, 10, "shortest")
        await b.device.stop(0, "immediate")
        await b.clock.advance(10)
        state = b.seen()
        assert (state.state, state.target) == ("idle", None)
        assert "another command to this axis: stop" in state.message
        assert not (await b.device.monitor.axis_state(0)).moving


@pytest.mark.parametrize("model", ["tmc4361", "pd42-1241"])
async def test_the_encoder_s_angle_goes_on_over_its_own_counter_s_end(model: str) -> None:
    async with bench(model) as b:
        await b.service.set_turn(b.device, 0, Fraction(51_200))
        await b.service.go_to(b.device, 0, 20_000)
        await b.arrived(20)
        await b.clock.advance(1)
        state = await b.state()
        assert state.rotary is not None
        assert state.encoder_position is not None
        assert state.actual == 20_000
        assert abs(state.encoder_position - 20_000) < 300
        assert state.rotary.encoder_angle_deg == pytest.approx(20_000 * 360 / 51_200, abs=3)
        await b.service.set_actual(b.device, 0, 1 << 45)
        state = await b.state()
        assert state.encoder_position is not None
        assert abs(state.encoder_position - (1 << 45)) < 300
        history = b.service.history(b.device, 0, 60)
        assert any(angle is not None for angle in history.encoder_angle_deg)


async def test_an_axis_without_an_encoder_has_no_encoder_s_angle() -> None:
    async with bench("tmc428") as b:
        await b.service.set_turn(b.device, 0, Fraction(51_200))
        state = await b.state()
        assert state.rotary is not None
        assert (state.encoder_position, state.rotary.encoder_angle_deg) == (None, None)


async def test_the_history_keeps_what_changed_and_its_angles() -> None:
    async with bench("tmc428") as b:
        await b.service.watch(b.device, 0)
        await b.clock.advance(300)
        assert len(b.service.history(b.device, 0, 1000).time_s) <= 3  # at rest the first and the last look
        await b.service.go_to(b.device, 0, 30_000_000)
        for _ in range(80):
            await b.clock.advance(1)
            await b.state()
        await b.service.set_turn(b.device, 0, Fraction(40_000))
        history = b.service.history(b.device, 0, 1000)
        assert history.time_s == sorted(history.time_s)
        assert history.position[0] == 0
        assert history.position[-1] == 30_000_000
        assert len(history.time_s) > 60
        assert history.angle_deg[-1] == pytest.approx(0)
        recent = b.service.history(b.device, 0, 2)
        assert recent.position[-1] == 30_000_000
        assert len(recent.time_s) < 6


@pytest.mark.sheet("AN-001", "2.1")
@pytest.mark.parametrize(
    ("model", "register"), [("tmc4210", "POS_COMP_4210"), ("tmc4361", "POS_COMP"), ("tmc5160", "X_COMPARE")]
)
async def test_the_compare_register_is_kept_away_until_its_position_is_near(model: str, register: str) -> None:
    """While it is further than a piece away the counter would show the same number a range before."""
    async with bench(model) as b:
        written: list[int] = []
        write = b.device.registers.write

        async def noting(
            name: str, axis: int | None = None, value: int | None = None, fields: dict[str, int | str] | None = None
        ) -> RegisterWritten:
            assert (name, axis) == (register, 0)
            written.append(value or 0)
            return await write(name, axis, value, fields)

        b.device.registers.write = noting  # type: ignore[method-assign]
        await b.service.watch(b.device, 0)
        position = b.whole + 500  # the counter shows 500 right now, a range too early
        await b.service.set_compare(b.device, 0, position)
        await b.clock.advance(1)
        state = b.seen()
        assert state.compare is not None
        assert (state.compare.register, state.compare.armed) == (register, False)
        assert abs(Counter(b.whole.bit_length() - 1).way(written[-1], 0)) > b.half // 2
        # A range further on, by the number that the place is given: now it is near.
        await b.service.set_actual(b.device, 0, b.whole)
        await b.clock.advance(1)
        state = b.seen()
        assert state.compare is not None
        assert state.compare.armed
        assert written[-1] == 500
        await b.service.set_compare(b.device, 0, None)
        await b.clock.advance(20)
        assert written[-1] == 500
        assert b.seen().compare is None


async def test_the_compare_register_is_armed_on_the_way() -> None:
    async with bench("tmc4210") as b:
        await b.service.set_compare(b.device, 0, b.whole)
        await b.service.go_to(b.device, 0, b.whole + 100_000)
        armed = []
        while (state := await b.arrived_within(0.5)).state == "moving":
            assert state.compare is not None
            armed.append(state.compare.armed)
            assert state.compare.armed or (await b.device.registers.read("POS_COMP_4210", 0)).value != 0
        assert armed == sorted(armed)
        assert {*armed} == {False, True}


async def test_a_chip_without_a_compare_register_says_so() -> None:
    async with bench("tmc428") as b:
        with pytest.raises(WrongState, match="no position compare"):
            await b.service.set_compare(b.device, 0, 5)


@pytest.mark.sheet("AN-001", "2.1")
@pytest.mark.parametrize("way", [1, -1])
async def test_a_latched_position_is_extended(way: int) -> None:
    """Also where the counter wrapped between the snapshot and the look."""
    async with bench("tmc428") as b:
        start = await b.stand(way * (b.half - 3000))
        await b.service.watch(b.device, 0)
        await b.service.set_actual(b.device, 0, start + 7 * b.whole)
        await b.device.registers.write("x_latched", 0, 0)  # arms it
        b.patch(switches=[{"axis": 0, "left": True}])
        await b.clock.advance(0.1)
        b.patch(switches=[{"axis": 0, "left": False}])
        await b.service.go_to(b.device, 0, start + 7 * b.whole + way * 9000)
        await b.arrived(30)
        latched = await b.service.latched(b.device, 0)
        assert latched.register == "x_latched"
        assert abs(latched.count - start) <= 1  # the chip takes it at its next step
        assert latched.position == latched.count + 7 * b.whole


async def test_a_module_has_no_latch() -> None:
    async with bench("pd42-1241") as b:
        await b.service.watch(b.device, 0)
        with pytest.raises(WrongState, match="no position latch"):
            await b.service.latched(b.device, 0)
