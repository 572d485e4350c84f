"""Register writes as events: of every family, however the write was asked for, and only then."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import pytest

from app.calc.microsteps.mslut import MslutRegisters
from app.clock import VirtualClock
from app.devices.core.actor import Actor, actor
from app.devices.core.capabilities import MicrostepRam, MslutTable, TmclCommands
from app.devices.core.changes import RegisterChanged
from app.devices.core.config import DeviceConfig
from app.devices.core.device import Device
from app.devices.core.events import DeviceEvent
from app.devices.core.results import WriteItem
from app.devices.manager import DeviceManager
from app.devices.tmc5xxx import start_up as start_up_5xxx
from app.devices.tmc428 import start_up
from app.devices.tmc4361 import start_up as start_up_4361
from app.errors import BenchError, LinkTimeout, WriteRefused
from app.links import datagram32, datagram40, tmcl
from app.main import emulator_port
from app.registers.catalog import MODELS
from app.registers.tmcl.commands import Opcode
from app.registers.tmcl.modules import MODULES

ANN = Actor("Ann", "browser", None, "127.0.0.1")


class Heard(list[RegisterChanged]):
    """Changes of one device."""

    def hear(self, event: DeviceEvent) -> None:
        if isinstance(event, RegisterChanged):
            self.append(event)

    def told(self) -> list[tuple[str, int | None, int | None, int | None]]:
        found = [(change.register, change.axis, change.old, change.new) for change in self]
        self.clear()
        return found


@asynccontextmanager
async def device_of(model: str) -> AsyncIterator[tuple[Device, Heard]]:
    manager = DeviceManager({"emulator": emulator_port}, VirtualClock(100.0))
    device = await manager.add(DeviceConfig("it", model, {"kind": "emulator"}))
    assert device.state == "connected"
    heard = Heard()
    device.listen(heard.hear)
    try:
        yield device, heard
    finally:
        await manager.close()


VALUES = {  # of each model a value, a packed register with one of its fields, and what cannot be read
    "tmc428": ("v_max", 0, "lp_ref_conf_rm", "SOFT_STOP"),
    "tmc429": ("v_max", 0, "lp_ref_conf_rm", "SOFT_STOP"),
    "tmc4210": ("V_MAX", 0, "lp_REF_CONF_RAMP_MODE", "soft_stop"),
    "tmc4361": ("VMAX", 0, "GENERAL_CONF", "use_astart_and_vstart"),
    "tmc5160": ("XTARGET", 0, "CHOPCONF", "toff"),
    "tmc5072": ("XTARGET", 1, "CHOPCONF", "toff"),
}


@pytest.mark.parametrize("model", VALUES)
async def test_a_write_tells_what_was_and_what_is(model: str) -> None:
    value, axis, packed, field = VALUES[model]
    async with device_of(model) as (device, heard):
        before = (await device.registers.read(value, axis)).value
        before_actor = actor.set(ANN)
        await device.registers.write(value, axis, before + 3)
        await device.registers.write(value, axis, before + 4)
        actor.reset(before_actor)
        assert [change.outcome for change in heard] == ["done", "done"]
        assert {change.by for change in heard} == {ANN}
        name = heard[0].register
        assert heard[0].text == f"{name}.{axis} {before} -> {before + 3} by Ann"
        assert heard.told() == [(name, axis, before, before + 3), (name, axis, before + 3, before + 4)]

        old = (await device.registers.read(packed, axis)).fields[field]
        await device.registers.write(packed, axis, fields={field: 1 - old if old < 2 else old - 1})
        (change,) = heard
        assert dict(change.fields) == {field: (old, 1 - old if old < 2 else old - 1)}
        assert change.field_text == f"{field} {old} -> {1 - old if old < 2 else old - 1}"
        heard.clear()

        done = await device.registers.write_many(
            [WriteItem(value, axis, 1, None), WriteItem(value, axis, 1 << 40, None)]
        )
        assert done.failed is not None
        assert heard.told() == [(name, axis, before + 4, 1)]


@pytest.mark.parametrize("model", ["tmc5160", "tmc5072"])
async def test_of_what_cannot_be_read_the_driver_knows_the_old(model: str) -> None:
    async with device_of(model) as (device, heard):
        await device.registers.write("AMAX", 0, 1000)
        await device.registers.write("AMAX", 0, 2000)
        assert heard.told()[1] == ("AMAX", 0, 1000, 2000)


@pytest.mark.parametrize("model", [name for name in MODELS if name not in MODULES])
async def test_moves_rotations_and_stops_are_no_changes_of_registers(model: str) -> None:
    async with device_of(model) as (device, heard):
        await _make_it_move(device)
        heard.clear()
        if device.family.counts_position:
            await device.motion.move(0, 200)
        if device.family.counts_position or device.family.can("own_velocity"):
            await device.motion.rotate(0, 300)
        await device.stop(0)
        assert heard == []


async def _make_it_move(device: Device) -> None:
    if device.family.family == "tmc428":
        start = start_up.AxisStart(v_max=1500, a_max=200, pulse_div=4, ramp_div=6)
        await start_up.start_up(device, [start] * len(device.axes))
    elif device.model == "tmc4361":
        await start_up_4361.start_up(device, start_up_4361.Start(vmax=50_000, amax=200_000))
    elif device.family.counts_position:
        await start_up_5xxx.start_up(device, [start_up_5xxx.Start(vmax=50_000, amax=200_000)] * len(device.axes))


async def test_raw_frames_are_told_by_what_they_write() -> None:
    async with device_of("tmc428") as (device, heard):
        await device.registers.write("v_max", 0, 700)
        heard.clear()
        await device.raw.exchange(datagram32.write(0x03, 900))
        assert heard[0].outcome.startswith("not proven")
        assert heard.told() == [("v_max", 0, 700, 900)]
        await device.raw.exchange(datagram32.read(0x03))
        assert heard == []
    async with device_of("tmc5160") as (device, heard):
        await device.raw.exchange(datagram40.write(0x26, 555))
        assert heard.told() == [("AMAX", 0, 0, 555)]


async def test_tables_tell_each_word_that_is_another_one() -> None:
    async with device_of("tmc428") as (device, heard):
        held = await device.need(MicrostepRam).read_microstep_table()
        await device.need(MicrostepRam).write_microstep_table(held)
        assert heard == []
        changed = [*held[:10], (held[10] + 1) % 64, *held[11:]]
        await device.need(MicrostepRam).write_microstep_table(changed)
        assert [change.register for change in heard] == ["lut_05"]
        assert heard[0].part_of == "the microstep table"
        assert dict(heard[0].fields) == {"y_even": (held[10], changed[10])}
    async with device_of("tmc5160") as (device, heard):
        table = (await device.need(MslutTable).read_mslut()).registers
        await device.need(MslutTable).write_mslut(table)
        heard.clear()
        await device.need(MslutTable).write_mslut(
            MslutRegisters((table.words[0] ^ 1, *table.words[1:]), table.select, table.start)
        )
        assert heard.told() == [("MSLUT[0]", 0, table.words[0], table.words[0] ^ 1)]


async def test_a_module_tells_its_parameters() -> None:
    async with device_of("pd42-1241") as (device, heard):
        old = (await device.registers.read("ap6", 0)).value
        await device.registers.write("ap6", 0, old - 1)
        await device.registers.write("ap1", 0, 77)  # one of those that may move it
        assert heard.told() == [("maximum_current", 0, old, old - 1), ("actual_position", 0, 0, 77)]
        await device.need(TmclCommands).tmcl(Opcode.SAP, 6, 0, old - 2)
        assert heard[0].outcome.startswith("not proven")
        assert heard.told() == [("maximum_current", 0, old - 1, old - 2)]
        await device.raw.exchange(tmcl.Request(1, Opcode.GAP, 6, 0).encode())
        await device.need(TmclCommands).tmcl(Opcode.SAP, 6, 0, 70_000)  # it says no
        await device.motion.move(0, 500)
        assert heard == []


async def test_what_may_have_happened_is_told_and_what_was_refused_before_is_not(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    async with device_of("tmc428") as (device, heard):
        exchange = device.session.port.exchange

        async def no_answer_to_writes(frame: bytes, *given: object) -> bytes:
            reply = await exchange(frame, *given)  # type: ignore[arg-type]
            if frame == datagram32.write(0x03, 900):
                raise LinkTimeout("emulator", 0.1, "a write")
            return reply

        monkeypatch.setattr(device.session.port, "exchange", no_answer_to_writes)
        with pytest.raises(LinkTimeout):
            await device.registers.write("v_max", 0, 900)
        (change,) = heard
        assert (change.old, change.new) == (0, 900)
        assert change.outcome.startswith("not proven: ")
        heard.clear()

        async def stuck(frame: bytes, *given: object) -> bytes:
            wanted = datagram32.write(0x03, 901)
            return await exchange(datagram32.read(0x03) if frame == wanted else frame, *given)  # type: ignore[arg-type]

        monkeypatch.setattr(device.session.port, "exchange", stuck)
        with pytest.raises(WriteRefused):
            await device.registers.write("v_max", 0, 901)
        (change,) = heard
        assert change.outcome.startswith("refused: ")
        heard.clear()
        with pytest.raises(BenchError):
            await device.registers.write("v_max", 0, 1 << 20)
        assert heard == []
