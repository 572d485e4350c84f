"""Download mode: the module stores what it is told, so nothing goes out but what its user sends, and stops."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable, Coroutine
from contextlib import asynccontextmanager
from typing import Any, cast

import pytest

from app.clock import VirtualClock, WallClock
from app.devices.core.axis_limits import AxisLimits
from app.devices.core.capabilities import ParameterStore, TmclCommands
from app.devices.core.config import AxisSettings, DeviceConfig
from app.devices.core.device import Device
from app.devices.core.results import WriteItem
from app.devices.manager import DeviceChange, DeviceManager
from app.devices.tmcl.searches import Searches
from app.emulators.tmcl.module import EmulatedModule
from app.emulators.tmcl.options import TmclOptions
from app.errors import BenchError, DownloadMode, WrongState
from app.links.registry import serial_factory
from app.links.serial_line import LinePort
from app.links.tmcl import Request
from app.registers.tmcl.commands import CONTROL_FIRST, PROGRAM_COMMANDS, Opcode
from app.telemetry.hub import TelemetryHub
from tests.devices.tmcl.harness import Bench, bench, state_of
from tests.links.pty_module import PtyModule, pty_module

OURS: dict[str, Callable[[Bench], Coroutine[Any, Any, object]]] = {
    "state": lambda made: made.device.monitor.axis_state(0),
    "read": lambda made: made.device.registers.read("ap1"),
    "read all": lambda made: made.device.registers.read_all(),
    "refresh": lambda made: made.device.identity.refresh(),
    "probe": lambda made: made.device.identity.probe(),
    "look": lambda made: made.device.counter.poll(0),
    "write": lambda made: made.device.registers.write("ap4", 0, 1000),
    "write moving": lambda made: made.device.registers.write("ap0", 0, 1000),
    "batch": lambda made: raising(made.device.registers.write_many([WriteItem("ap4", 0, 1000)])),
    "move": lambda made: made.device.motion.move(0, 1000),
    "rotate": lambda made: made.device.motion.rotate(0, 1000),
    "search": lambda made: made.part(Searches).start(),
    "store": lambda made: made.device.need(ParameterStore).store("user_variable_1"),
    "restore": lambda made: made.device.need(ParameterStore).restore("user_variable_1"),
    "sample": lambda made: made.device.telemetry.take_samples(made.device.telemetry.sample_plan(["position.0"])),
}


async def raising(batch: Coroutine[Any, Any, Any]) -> None:
    done = await batch
    if done.failed is not None:
        raise done.failed


def stored(made: Bench) -> dict[int, bytes]:
    return made.module._firmware.eeprom.program


def downloading(made: Bench) -> bool:
    return made.module._firmware.application.downloading


async def test_nothing_of_ours_becomes_part_of_a_program() -> None:
    """Watch, telemetry, a recorder's rows, soft limits: all of them run, and only the three commands are stored."""
    async with bench() as made:
        ranged = AxisSettings("x", limits=AxisLimits(position_min=-(10**6), position_max=10**6))
        device = made.device
        await made.manager.edit(device.id, DeviceChange(axes=(ranged,)))
        hub = TelemetryHub(made.clock, 1.0)
        hub.sync(made.manager.devices)
        hub.join(device.id, ("position.0", "velocity.0"), 500.0)
        await made.clock.advance(1.0)
        sent = made.tap.frames
        sent.clear()

        assert (await device.need(TmclCommands).tmcl(Opcode.ENTER_DOWNLOAD)).status == 100
        for command, value in (("ROR", 500), ("WAIT", 100), ("MST", 0)):
            await made.clock.advance(1.0)
            assert (await device.need(TmclCommands).tmcl(command, 0, 0, value)).status == 101
        await made.clock.advance(3.0)

        assert [request.opcode for request in sent] == [Opcode.ENTER_DOWNLOAD, Opcode.ROR, Opcode.WAIT, Opcode.MST]
        assert sorted(stored(made)) == [0, 1, 2]
        assert state_of(device) == "failed"
        assert isinstance(device.problem, DownloadMode)
        assert "download mode: polling paused" in str(device.problem)
        assert "133" in device.problem.way_out

        assert (await device.need(TmclCommands).tmcl(Opcode.EXIT_DOWNLOAD)).status == 100
        await made.clock.advance(2.0)
        assert state_of(device) == "connected", device.problem
        assert sorted(stored(made)) == [0, 1, 2]
        assert (await device.monitor.axis_state(0)).position == 0
        await hub.close()


@pytest.mark.parametrize("what", OURS)
async def test_whatever_asks_is_told_why_and_sends_nothing(what: str) -> None:
    async with bench() as made:
        commands = made.device.session.motion_commands[0]
        await made.device.need(TmclCommands).tmcl(Opcode.ENTER_DOWNLOAD)
        made.tap.frames.clear()
        with pytest.raises(DownloadMode, match="133"):
            await OURS[what](made)
        assert made.tap.frames == []
        assert made.device.session.motion_commands[0] == commands


async def test_what_waited_for_the_line_does_not_slip_through() -> None:
    """A question that was in the queue when command 132 went out is judged again when its turn comes."""
    async with bench() as made:
        queue, device = made.device.session.queue, made.device
        async with queue.turn():
            entering = asyncio.ensure_future(device.need(TmclCommands).tmcl(Opcode.ENTER_DOWNLOAD))
            await asyncio.sleep(0)
            asking = asyncio.ensure_future(device.registers.read_all())
            await asyncio.sleep(0)
        await entering
        with pytest.raises(DownloadMode):
            await asking
        assert stored(made) == {}


@pytest.mark.parametrize("mode", ["ramp", "immediate"])
async def test_a_stop_leaves_download_mode_and_stops(mode: Any) -> None:
    async with bench() as made:
        device = made.device
        await device.motion.rotate(0, 20_000)
        await made.clock.advance(0.5)
        made.module.receive(Request(1, Opcode.ENTER_DOWNLOAD).encode())  # another master's hand
        outcome = (await device.stop_axes([0], mode))[0]
        assert outcome.problem is None
        assert not downloading(made)
        assert len(stored(made)) <= 2  # the stops that told us
        await made.clock.advance(5.0)
        assert (await device.monitor.axis_state(0)).velocity_pps == 0


async def test_a_stop_in_a_known_download_stores_nothing() -> None:
    async with bench() as made:
        await made.device.need(TmclCommands).tmcl(Opcode.ENTER_DOWNLOAD)
        await made.device.need(TmclCommands).tmcl("ROR", 0, 0, 500)
        assert [outcome.problem for outcome in await made.manager.stop_all()] == [None]
        assert not downloading(made)
        assert sorted(stored(made)) == [0]


async def test_a_stop_whose_way_out_is_lost_says_that_it_was_stored() -> None:
    """Answers to 133 and the command itself get lost: MST is stored, and nobody says that the motor stops."""
    async with bench() as made:
        await made.device.need(TmclCommands).tmcl(Opcode.ENTER_DOWNLOAD)
        module = made.module
        real = module.receive

        def deaf(frame: bytes, at_s: float | None = None) -> bytes | None:
            return None if frame[1] == Opcode.EXIT_DOWNLOAD else real(frame, at_s)

        module.receive = deaf  # type: ignore[method-assign]
        outcome = (await made.manager.stop_all())[0]
        assert isinstance(outcome.problem, DownloadMode)


async def test_a_moving_motor_is_not_left_alone_for_a_download() -> None:
    async with bench() as made:
        await made.device.motion.rotate(0, 20_000)
        for send in (
            made.device.need(TmclCommands).tmcl(Opcode.ENTER_DOWNLOAD),
            made.device.raw.exchange(Request(1, 132).encode()),
        ):
            with pytest.raises(WrongState, match="stop it"):
                await send
        assert not downloading(made)


async def test_found_in_download_mode_when_connecting() -> None:
    """One question tells: it is answered as stored, and it is the only one."""
    async with bench() as made:
        await made.manager.disconnect(made.device.id)
        made.module.receive(Request(1, Opcode.ENTER_DOWNLOAD).encode())
        await made.manager.connect(made.device.id)
        await made.clock.advance(10.0)
        assert state_of(made.device) == "failed"
        assert isinstance(made.device.problem, DownloadMode)
        assert len(stored(made)) == 1
        assert (await made.device.need(TmclCommands).tmcl(Opcode.EXIT_DOWNLOAD)).status == 100
        await made.clock.advance(2.0)
        assert state_of(made.device) == "connected"


@pytest.mark.parametrize("spoil", ["status", "silence"])
async def test_whether_the_module_took_command_132(spoil: str) -> None:
    """An error status leaves all as it was; a lost answer does not tell, so nothing is asked."""
    async with bench() as made:
        if spoil == "status":
            assert (
                await made.device.need(TmclCommands).tmcl(Opcode.ENTER_DOWNLOAD, 0, 0, PROGRAM_COMMANDS)
            ).status == 4
            assert (await made.device.monitor.axis_state(0)).position == 0
            return
        made.patch(faults={"silence": True})
        with pytest.raises(BenchError):
            await made.device.need(TmclCommands).tmcl(Opcode.ENTER_DOWNLOAD)
        made.patch(faults={"silence": False})
        await made.clock.advance(5.0)
        assert isinstance(made.device.problem, DownloadMode)
        assert stored(made) == {}


@pytest.mark.parametrize("opcode", [200, 205, 208, Opcode.BOOT])
async def test_the_boot_loader_is_refused(opcode: int) -> None:
    async with bench() as made:
        made.tap.frames.clear()
        for send in (
            made.device.need(TmclCommands).tmcl(opcode),
            made.device.raw.exchange(Request(1, opcode, 0x81, 0x92).encode()),
        ):
            with pytest.raises(WrongState, match="boot loader"):
                await send
        assert made.tap.frames == []


async def test_a_secondary_address_may_be_this_modules() -> None:
    """Commands to it are obeyed and never answered (parameter 87): so whoever it may be is asked nothing."""
    async with bench() as made:
        await made.device.need(TmclCommands).tmcl("SGP", 87, 0, 42)
        assert (await made.device.raw.exchange(Request(42, Opcode.ENTER_DOWNLOAD).encode())).reply == b""
        with pytest.raises(DownloadMode, match="secondary"):
            await made.device.monitor.axis_state(0)
        assert (await made.device.need(TmclCommands).tmcl(Opcode.EXIT_DOWNLOAD)).status == 100
        assert (await made.device.monitor.axis_state(0)).position == 0
        assert stored(made) == {}


# --- a line with several modules ----------------------------------------------------------------


@asynccontextmanager
async def line(*modules: EmulatedModule) -> AsyncIterator[tuple[PtyModule, list[Device]]]:
    """Devices of several modules on one real serial line; on the wall clock, for the line has a thread."""

    def behave(_: PtyModule, frame: bytes) -> bytes:
        return next((reply for module in modules if (reply := module.receive(frame)) is not None), b"")

    manager = DeviceManager({"serial": serial_factory}, WallClock())
    with pty_module(behave) as far:
        try:
            devices = []
            for address in (module.options.address for module in modules):
                link = {"kind": "serial", "port": far.path, "baud": 115_200, "address": address, "timeout_s": 5.0}
                device = await manager.add(DeviceConfig(f"m{address}", "pd42-1241", link))
                assert device.state == "connected", device.problem
                devices.append(device)
            yield far, devices
        finally:
            await manager.close()


def module_at(address: int) -> EmulatedModule:
    return EmulatedModule("pd42-1241", VirtualClock(), TmclOptions(address=address))


def program_of(module: EmulatedModule) -> dict[int, bytes]:
    return module._firmware.eeprom.program


async def test_another_device_on_the_line_sends_the_module_into_download_mode() -> None:
    one, two = module_at(1), module_at(2)
    async with line(one, two) as (_, (first, second)):
        await first.raw.exchange(Request(2, Opcode.ENTER_DOWNLOAD).encode())
        assert isinstance(second.problem, DownloadMode)
        with pytest.raises(DownloadMode):
            await second.registers.read_all()
        assert (await first.monitor.axis_state(0)).position == 0
        await first.raw.exchange(Request(2, Opcode.EXIT_DOWNLOAD).encode())
        assert second.session.held_back is None
        assert program_of(one) == program_of(two) == {}


async def test_somebody_else_on_the_line_sends_the_module_into_download_mode() -> None:
    """The first answer with status 101 ends the asking, also within a batch that a thread sends."""
    one = module_at(1)
    async with line(one) as (_, (device,)):
        one.receive(Request(1, Opcode.ENTER_DOWNLOAD).encode())
        with pytest.raises(DownloadMode):
            await device.registers.read_all()
        assert len(program_of(one)) == 1
        assert (await device.need(TmclCommands).tmcl(Opcode.EXIT_DOWNLOAD)).status == 100
        assert len(await device.registers.read_all()) > 100


async def test_what_puts_a_line_in_step_is_not_stored_either() -> None:
    """After lost answers the line asks something harmless first: in download mode only a control command is."""
    one = module_at(1)
    async with line(one) as (far, (device,)):
        await device.need(TmclCommands).tmcl(Opcode.ENTER_DOWNLOAD)
        port = cast("LinePort", device.session.port)
        port.timeout_s = 0.05
        answer, far.behave = far.behave, lambda _, frame: (one.receive(frame), b"")[1]
        far.seen.clear()
        for _ in range(4):
            with pytest.raises(BenchError):
                await device.need(TmclCommands).tmcl("SAP", 4, 0, 1)
        assert [frame for frame in far.seen if frame[1] < CONTROL_FIRST and frame[1] != Opcode.SAP] == []
        far.behave, port.timeout_s = answer, 5.0
        assert (await device.need(TmclCommands).tmcl(Opcode.EXIT_DOWNLOAD)).status == 100
        assert {command[0] for command in program_of(one).values()} == {Opcode.SAP}
