"""Figures of a move that was measured."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable, Coroutine
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.emulators.tmc5xxx.options import AxisChange, Tmc5xxxPatch
from app.links.tmcl import Reply, Request
from app.procedures.procedure import Failed
from app.registers.tmcl.commands import Opcode, Status
from app.studies.moves import MeasuredMoves, Sampled, figures_of
from tests.devices.tmcl.harness import Bench, bench
from tests.studies.harness import studied


def test_a_move_of_which_hardly_a_sample_came_has_no_figures_and_says_so() -> None:
    """A machine that is busy, or a slow link: seen as one sample behind the command."""
    times, rows = np.array([-0.1, 0.0]), np.zeros(2)
    found = Sampled(0.0, times, rows, rows, 0, 0.0, np.empty((2, 0)))
    with pytest.raises(Failed, match="hardly a sample came"):
        figures_of(found, 1000, 0.0, 256, 64.0)


TARGET_POSITION, SPEED, REACHED = 0, 3, 8
"""Axis parameters. A look at the axis asks for them in this order, but the speed before the target."""
TARGET = 12_800
UNDER_WAY_S = 0.3


def show_one_rest(b: Bench) -> None:
    """Let the module look at rest once under way: as where the last step is done behind the answer of the position."""
    looks_at_axis = shown = False

    def spoil(request: Request, reply: bytes) -> bytes:
        nonlocal looks_at_axis, shown
        if request.opcode != Opcode.GAP or b.clock.now() < UNDER_WAY_S or shown:
            return reply
        shown = looks_at_axis and request.type == REACHED
        looks_at_axis = looks_at_axis or request.type == TARGET_POSITION
        at_rest = {SPEED: 0, REACHED: 1}.get(request.type)
        return reply if at_rest is None else Reply(2, request.address, Status.OK, Opcode.GAP, at_rest).encode()

    b.tap.spoil = spoil


async def passing(b: Bench, work: Coroutine[Any, Any, None], meanwhile: Callable[[], Awaitable[object]]) -> None:
    """Let time pass until `work` is done; once under way, do `meanwhile`."""
    task, done = asyncio.create_task(work), False
    while not task.done():
        await b.clock.advance(0.05)
        if not done and b.clock.now() > UNDER_WAY_S:
            done = True
            await meanwhile()
    await task


async def nothing() -> None:
    """Do so."""


async def test_one_look_that_shows_rest_under_way_is_not_believed() -> None:
    async with bench() as b:
        moves = MeasuredMoves(b.device, 0, b.clock, 256, 1.0)
        show_one_rest(b)
        await passing(b, moves.go(TARGET), nothing)
        assert (await moves.state()).position == TARGET


async def test_a_motor_that_was_stopped_is_told_to_stand_elsewhere() -> None:
    async with bench() as b:
        moves = MeasuredMoves(b.device, 0, b.clock, 256, 1.0)
        with pytest.raises(Failed, match=f"not {TARGET}"):
            await passing(b, moves.go(TARGET), lambda: b.device.stop(0))


async def test_a_shaft_that_rings_for_seconds_is_waited_for(tmp_path: Path) -> None:
    """A heavy load with next to no friction, let go beside its place."""
    motor = {"viscous_nms": 1e-4, "friction_nm": 0.0005, "detent_torque_nm": 0.0}
    async with studied(tmp_path, motor=motor, load={"inertia_kgm2": 6e-4}) as s:
        moves = MeasuredMoves(s.device, 0, s.clock, 256, 1.0)

        async def let_go() -> None:
            s.b.patch(Tmc5xxxPatch(axes=[AxisChange(axis=0, blocked=True)]))
            await s.device.motion.move(0, 384)
            await s.clock.sleep(1.0)
            s.b.patch(Tmc5xxxPatch(axes=[AxisChange(axis=0, blocked=False)]))
            assert abs(await moves.deviation()) < 128

        began_s = s.clock.now()
        await s.passing(let_go())
        assert s.clock.now() - began_s > 3.0
