"""Profiles of modules of which names are known: what they were seen to take, as one transaction, on all axes."""

from __future__ import annotations

import json

import pytest

from app.errors import WrongState
from app.links.tmcl import Reply, Request
from app.profiles.apply import Transaction
from app.profiles.capture import capture
from app.profiles.diff import diff
from app.profiles.document import parse, text_of
from app.profiles.errors import ProfileTakenBack
from app.profiles.items import items_of
from app.profiles.scripts.plan import plan_of
from app.profiles.scripts.tmcl import render
from app.profiles.trial import try_writes
from app.registers.catalog import find_model
from app.registers.listed.modules import role_of
from app.registers.model import Register, Space
from app.registers.tmcl.commands import Opcode, Status
from tests.devices.listed.harness import NAMES, SEVERAL, Bench, bench


def some(made: Bench, axis: int = 0) -> list[Register]:
    """Parameters of an axis that may be configuration, but for those that move it."""
    rows = [item.row for item in items_of(made.device.model)]
    return [row for row in rows if row.axis == axis and row.space is Space.AXIS and role_of(row) is None]


def test_state_is_none() -> None:
    for name in NAMES:
        rows = [item.row for item in items_of(name)]
        assert {role_of(row) for row in rows} == {"max_speed", "max_acceleration", None}
        assert not [row.name for row in rows if row.read_clears or row.name.startswith(("Actual", "TargetP"))]
        assert not {(row.space, row.address) for row in rows} & {(Space.GLOBAL_0, number) for number in (65, 66, 255)}
        assert len({item.key for item in items_of(name)}) == len(rows) > 30


async def test_nothing_is_configuration_before_it_was_seen() -> None:
    async with bench() as made:
        with pytest.raises(WrongState, match="it is known yet whether it can be set"):
            await capture(made.device)
        row = some(made)[0]
        await made.device.registers.write(row.name, 0, 5)
        document = await capture(made.device)
        assert [(part.name, part.value) for part in document.parameters] == [(row.name, 5)]
        assert document.unknown == []


@pytest.mark.parametrize("name", [NAMES[0], SEVERAL, NAMES[-1]])
async def test_what_was_captured_comes_back_on_every_axis(name: str) -> None:
    async with bench(name) as made:
        device = made.device
        tried = await try_writes(device)
        assert (tried.settable, tried.refused) == (len(items_of(name)), [])
        for axis in range(len(device.axes)):
            for row in some(made, axis)[:20]:
                await device.registers.write(row.name, axis, 10 * axis + row.address)
        first = parse(json.loads(text_of(await capture(device, unix_s=1.0))))
        assert len(first.parameters) == tried.settable
        for axis in range(len(device.axes)):
            for row in some(made, axis)[5:25]:
                await device.registers.write(row.name, axis, 3)
        assert len((await diff(device, first)).differences) >= 15 * len(device.axes)
        applied = await Transaction(device, first).run()
        assert len(applied.written) >= 15 * len(device.axes)
        assert await capture(device, unix_s=1.0) == first
        program = render(plan_of(first)).splitlines()
        aliases = [part.alias for part in first.parameters]
        assert sum(line.startswith("SAP") for line in program) == sum(alias.startswith("ap") for alias in aliases)


async def test_a_profile_goes_into_another_module_of_which_nothing_was_seen_yet() -> None:
    async with bench(SEVERAL) as made:
        await made.device.registers.write(some(made)[3].name, 1, 77)
        document = await capture(made.device)
    async with bench(SEVERAL) as other:
        applied = await Transaction(other.device, document).run()
        assert [(change.name, change.axis, change.now) for change in applied.written] == [(some(other)[3].name, 1, 77)]


async def test_a_parameter_that_is_refused_takes_all_back() -> None:
    async with bench() as made:
        await try_writes(made.device)
        rows = some(made)[:6]
        document = await capture(made.device)
        values = {row.name: 9 for row in rows}
        document = document.model_copy(
            update={
                "parameters": [
                    part.model_copy(update={"value": values.get(part.name, part.value)}) for part in document.parameters
                ]
            }
        )
        heard = made.module.receive

        def receive(frame: bytes, at_s: float | None = None) -> bytes | None:
            request = Request.decode(frame)
            if request.opcode == Opcode.SAP and request.type == rows[4].address:
                return Reply(2, 1, Status.NOT_AVAILABLE, request.opcode, 0).encode()
            return heard(frame, at_s)

        made.module.receive = receive  # type: ignore[method-assign]
        with pytest.raises(ProfileTakenBack, match=rows[4].name):
            await Transaction(made.device, document).run()
        held = [(await made.device.registers.read(row.name, 0)).value for row in rows]
        assert held == [0] * 6


async def test_what_a_module_refuses_or_lacks_is_no_configuration() -> None:
    async with bench(unknown_parameters=[6]) as made:
        rows = some(made)
        heard = made.module.receive

        def receive(frame: bytes, at_s: float | None = None) -> bytes | None:
            request = Request.decode(frame)
            if request.opcode == Opcode.SAP and request.type == rows[4].address:
                return Reply(2, 1, Status.NOT_AVAILABLE, request.opcode, 0).encode()
            return heard(frame, at_s)

        made.module.receive = receive  # type: ignore[method-assign]
        tried = await try_writes(made.device)
        lacking = find_model(made.device.model).table.find("ap6", 0)
        assert lacking is not None
        assert {name for name, _ in tried.refused} == {rows[4].name, lacking[0].name}
        document = await capture(made.device)
        assert {rows[4].name, lacking[0].name} & {part.name for part in document.parameters} == set()
        assert tried.settable == len(document.parameters)


async def test_trying_waits_for_rest_and_moves_nothing() -> None:
    async with bench() as made:
        await made.device.motion.rotate(0, 500, "chip")
        with pytest.raises(WrongState, match="moves"):
            await try_writes(made.device)
