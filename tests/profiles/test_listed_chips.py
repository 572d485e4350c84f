"""Profiles of chips of which a table is known: what can be set, nothing that moves a motor or cannot be taken back."""

from __future__ import annotations

import json

import pytest

from app.profiles.apply import Transaction
from app.profiles.capture import capture
from app.profiles.diff import diff
from app.profiles.document import parse, text_of
from app.profiles.items import items_of
from app.profiles.trial import try_writes
from app.registers.catalog import find_model
from app.registers.listed.ramp import ramps_of, role_by_name
from app.registers.model import Access
from tests.devices.listed.chip_harness import bench
from tests.devices.listed.test_every_chip import NAMES

MOVING = [name for name in NAMES if find_model(name).can("motion")]
TOLD = [name for name in MOVING if any(row.access is Access.RW and row.fields for row in find_model(name).table)]
UNTOLD = [name for name in MOVING if name not in TOLD]


@pytest.mark.parametrize("name", NAMES)
def test_commands_state_and_what_cannot_be_taken_back_are_none(name: str) -> None:
    rows = [item.row for item in items_of(name)]
    assert not {role_by_name(row) for row in rows} & {"mode", "target", "position"}
    assert not [row.name for row in rows if row.read_clears or "OTP" in row.name or row.name == "CONF"]


@pytest.mark.parametrize("name", [TOLD[0], TOLD[-1], UNTOLD[0], UNTOLD[-1]])
async def test_what_was_captured_comes_back_while_the_motor_stands(name: str) -> None:
    async with bench(name) as made:
        device = made.device
        rows = [item.row for item in items_of(name) if role_by_name(item.row) is None and not item.row.fields][:6]
        assert rows
        for row in rows:
            await device.registers.write(row.name, row.axis, 1)
        await device.registers.write(ramps_of(device.family.table)[0].max_speed.name, 0, 555)
        await device.motion.rotate(0, 300, "chip")
        await made.clock.advance(2.0)
        await device.motion.stop_axes([0], "ramp")
        await made.clock.advance(2.0)
        first = parse(json.loads(text_of(await capture(device, unix_s=1.0))))
        speed = next(
            part for part in first.registers if role_by_name(device.family.table.get(part.name, 0)) == "max_speed"
        )
        assert speed.value == 555  # as it was set, whatever the rotation and the stop have written over it
        for row in rows:
            await device.registers.write(row.name, row.axis, 0)
        assert len((await diff(device, first)).differences) >= len(rows)
        await Transaction(device, first).run()
        await made.clock.advance(5.0)
        state = await device.monitor.axis_state(0)
        assert (state.velocity_pps, state.moving) == (0, False)
        for row in rows:
            assert (await device.registers.read(row.name, row.axis)).value == 1


@pytest.mark.parametrize("name", UNTOLD[:1])
async def test_nothing_of_which_no_source_tells_the_access_is_tried(name: str) -> None:
    async with bench(name) as made:
        writes: list[int] = []
        made.chip._write = lambda address, data: writes.append(address)  # type: ignore[method-assign]
        await try_writes(made.device)
        known = {row.address for row in made.device.family.table if row.access is not Access.UNKNOWN}
        assert set(writes) <= known
