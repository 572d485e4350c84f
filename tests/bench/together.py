"""Six axes that start together: by wired START without a clock of skew, else with the true skew told.

Six axes on six TMC4361 start by one edge. No chip of several axes has a START pin (docs/limits.md), so of six axes on
four chips, which are three TMC4361 and a TMC429, three share the edge, and those of the TMC429 start by commands. Time
is the emulators', so a busy machine changes no figure.
"""

from __future__ import annotations

import asyncio
from collections.abc import Sequence

from app.devices.core.results import AxisMove
from app.procedures.start_together import TogetherMove, TogetherStart
from tests.bench.table import Row
from tests.procedures.test_start_together import LOOK_S, Bench, bench

CHIPS = ("tmc4361", "tmc4361", "tmc4361", "tmc429")
SIX_CHIPS = ("tmc4361",) * 6
AXES = [("a", 0), ("b", 0), ("c", 0), ("d", 0), ("d", 1), ("d", 2)]
LINKS_S = (1e-3, 4e-3, 2.5e-3, 0.5e-3, 2e-3, 3e-3)
CLOCK_HZ, PPS = 16e6, 2000.0
TICKS_S = 2 * 64 / CLOCK_HZ


def measure(quick: bool) -> Sequence[Row]:
    """All rows."""
    looks = 50 if quick else 1000
    return [
        asyncio.run(_wired(SIX_CHIPS, [(name, 0) for name in "abcdef"], "abcdef", looks)),
        asyncio.run(_wired(CHIPS, AXES, "abc", looks)),
        asyncio.run(_unwired()),
    ]


async def _started(b: Bench, axes: Sequence[tuple[str, int]], chips: str) -> tuple[TogetherStart, dict[str, float]]:
    """What was told, and the truth of `chips`, which are TMC4361: when each made its first step [s]."""
    moves = [TogetherMove(b.device(name), AxisMove(axis, 4000)) for name, axis in axes]
    task, found = asyncio.create_task(b.procedures.start_together(moves, b.nets)), dict[str, float]()
    for _ in range(20_000):
        await b.clock.advance(LOOK_S)
        for name in set(chips) - found.keys():
            if b.chip(name).state().step_output.steps_sent:
                found[name] = b.clock.now()
        if task.done() and len(found) == len(chips):
            return task.result(), found
    raise AssertionError(f"only {found} move")


async def _wired(models: Sequence[str], axes: Sequence[tuple[str, int]], chips: str, looks: int) -> Row:
    """How far apart the wired axes are at many moments while they speed up from `PPS`, in clocks."""
    async with bench(*models, takes_s=LINKS_S[: len(models)], wired=True) as b:
        told, _ = await _started(b, axes, chips)
        apart = 0.0
        for _ in range(looks):
            await b.clock.advance(1e-4)
            at = [b.chip(name).state().ramp.position for name in chips]
            apart = max(apart, max(at) - min(at))
        ends = await b.at_rest()
    clocks = apart / PPS * CLOCK_HZ
    by_wire = [axis for axis in told.axes if axis.how == "START wire"]
    told_s = max(axis.skew_s for axis in by_wire) - min(axis.skew_s for axis in by_wire)
    whole = len(by_wire) == len(chips) and all(ends[at] == 4000 for at in axes)
    alone = len(axes) - len(chips)
    return Row(
        what=f"simultaneous start, 6 axes on {len(models)} chips, {len(chips)} with wired START: their skew",
        measured=f"{clocks:.2g} clocks, told {told_s:g} s",
        peer="limit 0 clocks",
        ratio=clocks,
        required="0 but for rounding of a position (1e-6 clocks)",
        ok=whole and clocks < 1e-6 and told_s == 0.0,
        notes=(f"a chip of several axes has no START: {alone} start by commands, whose skew is told",) if alone else (),
    )


async def _unwired() -> Row:
    """How far what is told is from the truth, over links that take 0.5 to 4 ms."""
    async with bench(*CHIPS, takes_s=LINKS_S[:4]) as b:
        told, truth = await _started(b, AXES, "abc")
    of_three = [axis for axis in told.axes if axis.device in truth]
    first_told, first_s = min(axis.skew_s for axis in of_three), min(truth.values())
    off_s = max(abs(axis.skew_s - first_told - (truth[axis.device] - first_s)) for axis in of_three)
    limit_s = TICKS_S + LOOK_S
    return Row(
        what="the same unwired, links of 0.5 to 4 ms: told skew against the emulators' truth",
        measured=f"{off_s * 1e6:.0f} us off, of {told.spread_s * 1e3:.2f} ms",
        peer=f"limit {limit_s * 1e6:.0f} us",
        ratio=off_s / limit_s,
        required="< 1: two ticks, and how finely the truth is looked at",
        ok=off_s < limit_s and told.spread_s > 0.5e-3,
    )
