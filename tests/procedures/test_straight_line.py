"""Straight lines of several axes: planned by each family's ramp, and the emulated motors keep to it."""

from __future__ import annotations

import asyncio
from typing import Any, cast

import numpy as np
import pytest

from app.devices.core.capabilities import LinePace
from app.devices.core.config import DeviceConfig
from app.errors import BenchError, CannotMove, LinkTimeout, OutOfRange, UsageError, WrongState
from app.procedures.straight_line import LOST_MAX, LineAxis, LineState, plan_line
from app.registers.catalog import MODELS
from tests.procedures.test_start_together import Bench, bench

CHIPS = [
    ("tmc4361", "tmc4361", "tmc4361"),
    ("tmc5160", "tmc5072", "tmc4361"),
    ("tmc429", "tmc4361", "tmc4210"),
    ("tmc428", "tmc428", "tmc5160"),
]


def axes_of(b: Bench, names: str) -> list[LineAxis]:
    return [LineAxis(b.device(name), 0) for name in names]


RAMPS = {"a": ("VMAX", "AMAX", "RAMPMODE", "VSTART"), "b": ("VMAX", "AMAX", "V1", "VSTOP", "RAMPMODE")}


async def ramp_of(b: Bench, name: str) -> dict[str, int]:
    """The chip's ramp, past everything that the driver keeps in mind."""
    chip = cast("Any", b.port(name).wire)._chip
    table = MODELS[b.device(name).model].table
    held = chip.r if name == "a" else chip._words
    return {register: int(held[table.get(register, 0).address]) for register in RAMPS[name]}


async def gone(b: Bench, within_s: float = 30.0) -> LineState:
    for _ in range(int(within_s / 0.01)):
        await b.clock.advance(0.01)
        if b.procedures.line_state.state != "running":
            return b.procedures.line_state
    raise AssertionError(b.procedures.line_state)


@pytest.mark.parametrize("models", CHIPS)
async def test_all_keep_to_the_line_and_arrive_together(models: tuple[str, ...]) -> None:
    async with bench(*models, wired=True) as b:
        axes, point = axes_of(b, "abc"), [6000, -3500, 900]
        plan, _ = await plan_line(axes, [point])
        leg = plan.legs[0]
        assert leg.arrival_spread_s < 0.005 * leg.duration_s
        assert max(axis.off_line for axis in leg.axes) < 20
        await b.procedures.start_line(axes, [point], b.nets)
        seen = []
        for _ in range(int(leg.duration_s / 0.004) + 50):
            await b.clock.advance(0.004)
            states = [await b.device(name).monitor.axis_state(0) for name in "abc"]
            seen.append([state.position for state in states])
        way = np.array(seen) / np.array(point)
        spread = np.abs(way - way[:, :1]).max()
        assert spread < 0.01, f"the axes are {spread:.4f} of the way apart"
        state = await gone(b)
        assert state.state == "done", state
        assert [(await b.device(name).monitor.axis_state(0)).position for name in "abc"] == point
        arrivals = [arrival.after_s for arrival in state.arrivals]
        assert len(arrivals) == 3
        assert max(arrivals) - min(arrivals) <= 0.03
        assert max(arrivals) == pytest.approx(leg.duration_s, abs=0.05)


async def test_a_stop_while_it_is_planned_keeps_it_from_beginning() -> None:
    async with bench("tmc4361", "tmc5160") as b:
        async with b.device("a").session.queue.turn():
            begun = asyncio.create_task(b.procedures.start_line(axes_of(b, "ab"), [[8000, 5000]], []))
            await b.clock.advance(0.001)
            stopped = asyncio.create_task(b.device("b").stop(0))
            await b.clock.advance(0.001)
        with pytest.raises(WrongState, match="a stop of axis 0 overtook"):
            await begun
        await stopped
        await b.clock.advance(0.2)
        assert [(await b.device(name).monitor.axis_state(0)).position for name in "ab"] == [0, 0]


async def test_predicted_and_measured_path_agree() -> None:
    async with bench("tmc4361", "tmc5160") as b:
        axes, point = axes_of(b, "ab"), [8000, 5000]
        plan, _ = await plan_line(axes, [point])
        leg = plan.legs[0]
        await b.procedures.start_line(axes, [point], [])
        while b.procedures.line_state.started is None:
            await b.clock.advance(0)
        start_s, worst = b.clock.now(), 0.0
        for _ in range(int(leg.duration_s / 0.01)):
            await b.clock.advance(0.01)
            for name, axis in zip("ab", leg.axes, strict=True):
                measured = (await b.device(name).monitor.axis_state(0)).position
                expected = np.interp(b.clock.now() - start_s, leg.time_s, axis.position)
                worst = max(worst, abs(measured - expected))
        assert worst < 0.002 * 8000
        assert (await gone(b)).state == "done"


async def test_the_measured_path_is_told_beside_the_plan() -> None:
    async with bench("tmc4361", "tmc5160") as b:
        axes = axes_of(b, "ab")
        plan, _ = await plan_line(axes, [[4000, -2500], [0, 0]])
        await b.procedures.start_line(axes, [[4000, -2500], [0, 0]], [])
        state = await gone(b)
        assert state.state == "done"
        path = b.procedures.line_path
        assert path is not None
        assert path.plan == plan
        paths = path.legs
        assert [len(leg) for leg in paths] == [2, 2]
        for leg, planned in zip(paths, plan.legs, strict=True):
            for axis, expected in zip(leg, planned.axes, strict=True):
                assert len(axis.time_s) > planned.duration_s / 0.012
                wanted = np.interp(axis.time_s, planned.time_s, expected.position)
                assert np.abs(np.array(axis.position, float) - wanted).max() < 0.002 * 4000
        planned_off = max(axis.off_line for leg in plan.legs for axis in leg.axes)
        assert state.off_line is not None
        assert state.off_line_uncertainty is not None
        assert state.off_line <= planned_off + state.off_line_uncertainty + 1, "positions are whole microsteps"
        assert state.off_line_uncertainty < 20


@pytest.mark.parametrize(("lost", "how"), [(3, "done"), (20, "failed")])
async def test_a_reading_that_is_lost_is_a_gap_and_more_of_them_end_it(lost: int, how: str) -> None:
    async with bench("tmc4361", "tmc5160") as b:
        await b.procedures.start_line(axes_of(b, "ab"), [[8000, 4000]], [])
        await b.clock.advance(0.4)
        left = [lost]

        def silent(_: bytes) -> None:
            if left[0]:
                left[0] -= 1
                raise LinkTimeout("wire", 0.0, "a position")

        b.port("b").before_frame = silent
        state = await gone(b)
        assert state.state == how, state
        path = b.procedures.line_path
        assert path is not None
        _, second = path.legs[0]
        assert 1 <= second.position.count(None) <= LOST_MAX + 1
        assert not (await b.device("a").monitor.axis_state(0)).moving


async def test_further_points_follow_and_ramps_are_given_back() -> None:
    async with bench("tmc4361", "tmc5160") as b:
        axes = axes_of(b, "ab")
        before = {name: await ramp_of(b, name) for name in "ab"}
        await b.procedures.start_line(axes, [[2000, 1000], [2000, 3000], [0, 0]], [], pace=0.5)
        with pytest.raises(WrongState, match="under way"):
            await b.procedures.start_line(axes, [[1, 1]], [])
        state = await gone(b)
        assert (state.state, state.leg, state.legs) == ("done", 2, 3), state
        assert {name: await ramp_of(b, name) for name in "ab"} == before


async def test_pace_and_duration_make_it_slower() -> None:
    async with bench("tmc4361", "tmc5160") as b:
        axes = axes_of(b, "ab")
        fast, _ = await plan_line(axes, [[20_000, 10_000]])
        half, _ = await plan_line(axes, [[20_000, 10_000]], 0.5)
        timed, _ = await plan_line(axes, [[20_000, 10_000]], 1.0, 5.0)
        assert half.duration_s > 1.5 * fast.duration_s
        assert timed.duration_s == pytest.approx(5.0, rel=0.01)
        again, _ = await plan_line(axes, [[20_000, 10_000]], 1.0, fast.duration_s / 3)
        assert again.duration_s == fast.duration_s, "no faster than they can"


@pytest.mark.parametrize("stopped", ["a", "b"])
async def test_a_stop_of_one_stops_all(stopped: str) -> None:
    async with bench("tmc4361", "tmc5160") as b:
        before = {name: await ramp_of(b, name) for name in "ab"}
        await b.procedures.start_line(axes_of(b, "ab"), [[40_000, 20_000]], [])
        await b.clock.advance(0.5)
        stop = asyncio.create_task(b.manager.stop_axis(b.device(stopped), 0))
        state = await gone(b)
        assert stop.result().ok
        assert state.state == "aborted"
        assert "stop" in state.message
        at = [(await b.device(name).monitor.axis_state(0)) for name in "ab"]
        assert not any(axis.moving for axis in at)
        assert 0 < at[0].position < 40_000
        await b.clock.advance(2.0)
        again = [(await b.device(name).monitor.axis_state(0)).position for name in "ab"]
        assert again == [axis.position for axis in at], "giving the ramps back moves nothing"
        await b.start({("a", 0): 0, ("b", 0): 0})
        assert set((await b.at_rest()).values()) == {0}
        assert {name: await ramp_of(b, name) for name in "ab"} == before, "and the next move has the user's speed"


async def test_what_makes_no_line_is_refused_before_anything_is_written() -> None:
    async with bench("tmc4361", "tmc5160") as b:
        await b.manager.add(DeviceConfig("c", "tmc2209", {"kind": "emulator"}))
        two, sent = axes_of(b, "ab"), len(b.port("a").frames)
        for axes, points, error in (
            ([], [[1]], UsageError),
            (two, [], UsageError),
            (two, [[1]], UsageError),
            ([two[0], two[0]], [[1, 2]], UsageError),
            (axes_of(b, "ac"), [[1, 2]], WrongState),
            (two, [[2_000_000_000, 1]], OutOfRange),
        ):
            with pytest.raises(error):
                await plan_line(axes, points)
        writes = [frame for frame in b.port("a").frames[sent:] if frame[0] & 0x80]
        assert writes == []
        with pytest.raises(BenchError):
            await plan_line(two, [[5, 5]], pace=2.0)


async def test_a_plan_alone_keeps_nothing_in_mind() -> None:
    async with bench("tmc4361") as b:
        axes = axes_of(b, "a")
        await plan_line(axes, [[500]])
        await b.device("a").registers.write("VMAX", 0, 9000 * 256)
        before = await ramp_of(b, "a")
        await b.procedures.start_line(axes, [[500]], [])
        assert (await gone(b)).state == "done"
        assert await ramp_of(b, "a") == before


TICKED = ("pulse_div_ramp_div_usrs", "v_min", "v_max", "a_max", "pmul_pdiv", "lp_ref_conf_rm")


async def ticked_ramp(b: Bench, name: str, axis: int = 0) -> dict[str, int]:
    registers = b.device(name).registers
    return {register: (await registers.read(register, axis)).value for register in TICKED}


@pytest.mark.parametrize("soft", [False, True])
async def test_a_ramp_of_pmul_and_pdiv_is_borrowed_and_given_back(soft: bool) -> None:
    async with bench("tmc428", "tmc4361") as b:
        axes = [LineAxis(b.device("a"), 1), *axes_of(b, "b")]
        if soft:
            await b.device("a").registers.write("lp_ref_conf_rm", 1, None, {"rm": 1})
        before = await ticked_ramp(b, "a", 1)
        plan, _ = await plan_line(axes, [[5000, 3000], [400, -200]], 0.3)
        assert max(axis.off_line for leg in plan.legs for axis in leg.axes) < 8
        await b.procedures.start_line(axes, [[5000, 3000], [400, -200]], [], pace=0.3)
        await b.clock.advance(0.1)
        assert await ticked_ramp(b, "a", 1) != before
        state = await gone(b)
        assert state.state == "done", state
        assert state.off_line is not None
        assert state.off_line < 8 + (state.off_line_uncertainty or 0)
        assert await ticked_ramp(b, "a", 1) == before


async def test_a_stop_gives_back_a_ramp_of_pmul_and_pdiv_and_moves_nothing() -> None:
    async with bench("tmc429", "tmc4361") as b:
        before = await ticked_ramp(b, "a")
        await b.procedures.start_line(axes_of(b, "ab"), [[40_000, 20_000]], [])
        for _ in range(10):
            await b.clock.advance(0.05)
        stop = asyncio.create_task(b.manager.stop_axis(b.device("a"), 0))
        assert (await gone(b)).state == "aborted"
        assert stop.result().ok
        at = (await b.device("a").monitor.axis_state(0)).position
        assert 0 < at < 40_000
        await b.clock.advance(2.0)
        assert (await b.device("a").monitor.axis_state(0)).position == at
        held = await ticked_ramp(b, "a")
        assert {name: held[name] for name in TICKED[:-1]} == {name: before[name] for name in TICKED[:-1]}
        await b.procedures.start_line(
            axes_of(b, "ab"), [[at + 3000, 0]], []
        )  # from velocity mode, where the stop left it
        assert (await gone(b)).state == "done"


async def test_what_keeps_a_chip_from_the_line_is_told_with_its_figure() -> None:
    async with bench("tmc4361", "tmc428") as b:
        await b.device("b").registers.write("v_min", 0, 600)
        plan, _ = await plan_line(axes_of(b, "ab"), [[4000, 4000]], 0.5)
        first, second = plan.legs[0].axes
        assert not first.warnings
        (said,) = second.warnings
        assert "microsteps off the line at the most: " in said
        assert "it starts and stops at v_min" in said
        assert second.off_line > 8
        with pytest.raises(UsageError, match=r"0\.001 pps is below 0\.0298023 pps, v_max 1 with pulse_div 13"):
            b.device("b").need(LinePace).paced(0, 100, 1e-3, 1.0)
        await b.device("b").registers.write("v_max", 0, 0)
        with pytest.raises(CannotMove, match="v_max is 0"):
            await plan_line(axes_of(b, "ab"), [[4000, 4000]])
