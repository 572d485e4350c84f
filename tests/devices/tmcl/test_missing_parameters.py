"""A module whose firmware lacks parameters: only what needs them degrades, and says so."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from app.devices.core.capabilities import TmclCommands
from app.errors import UnknownParameter
from app.profiles.capture import capture
from app.registers.model import Space
from app.registers.tmcl.pd42 import PD42
from tests.devices.tmcl.harness import Bench, bench, state_of

PARAMETERS = {row.address: row for row in PD42 if row.space is Space.AXIS}
STATE_NEEDS = frozenset({1})
"""Where nobody tells the position there is no state of an axis."""
MOVE_NEEDS = STATE_NEEDS
SPEEDS = frozenset({3, 29})
"""Either of them tells the speed."""
TARGET = 30_000


async def _or_refused(what: Awaitable[object], lacking: frozenset[int], need: frozenset[int]) -> object:
    """What came of it; None where it was refused, which only a parameter of `need` that is lacking may cause."""
    excused = lacking & need or (SPEEDS if lacking >= SPEEDS else frozenset())
    if not excused:
        return await what
    with pytest.raises(UnknownParameter) as refusal:
        await what
    assert any(PARAMETERS[number].alias in str(refusal.value) for number in excused)
    assert refusal.value.way_out
    return None


async def drive_without(made: Bench, lacking: frozenset[int]) -> None:
    device, clock = made.device, made.clock
    rows = [PARAMETERS[number] for number in lacking]
    module = made.module._firmware.axis
    assert state_of(device) == "connected", device.problem

    await _or_refused(device.monitor.axis_state(0), lacking, STATE_NEEDS)

    moved = await _or_refused(device.motion.move(0, TARGET), lacking, MOVE_NEEDS)
    if moved is not None:
        for _ in range(200):
            await clock.advance(0.05)
            if module.position == TARGET and module.standing:
                break
        await clock.advance(1.0)
        assert module.position == TARGET
        assert [end.reason for end in device.monitor.motion_ends(0)] == ["target_reached"]
        reached = await device.monitor.axis_state(0)
        assert not reached.moving
        assert reached.position == TARGET

    for mode in ("ramp", "immediate"):
        turning = await _or_refused(device.motion.rotate(0, 20_000), lacking, MOVE_NEEDS)
        if turning is None:  # by another hand then: a stop has to work all the same
            await device.need(TmclCommands).tmcl("ROR", 0, 0, 20_000)
        await clock.advance(0.3)
        assert module.drive.read("VACTUAL") != 0
        outcome = (await device.stop_axes([0], mode))[0]
        assert outcome.problem is None
        await clock.advance(3.0)
        assert module.drive.read("VACTUAL") == 0

    await device.identity.refresh()
    readings = {reading.name for reading in await device.registers.read_all()}
    assert not readings & {row.name for row in rows}
    held = await _or_refused(capture(device), lacking, STATE_NEEDS)
    if held is not None:
        unknown = {part.name for part in held.unknown}  # type: ignore[attr-defined]
        configured = {item.name for item in rows if item.access.writable} - {"actual_position"}
        assert unknown >= {name for name in configured if name in await _captured()}
    assert state_of(device) == "connected"
    for row in rows:
        if not row.read_clears:
            assert any(row.alias in note for note in device.identity.shortcomings)


_names: set[str] = set()


async def _captured() -> set[str]:
    """Names of parameters that a profile of a whole module has."""
    if not _names:
        async with bench() as made:
            document = await capture(made.device)
            _names.update(part.name for part in document.parameters)
    return _names


@pytest.mark.parametrize("number", sorted(PARAMETERS))
async def test_without_one_parameter(number: int) -> None:
    async with bench(unknown_parameters=[number]) as made:
        await drive_without(made, frozenset({number}))


@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(st.sets(st.sampled_from(sorted(PARAMETERS)), min_size=2, max_size=4))
def test_without_several_parameters(numbers: set[int]) -> None:
    async def run() -> None:
        async with bench(unknown_parameters=sorted(numbers)) as made:
            await drive_without(made, frozenset(numbers))

    asyncio.run(run())
