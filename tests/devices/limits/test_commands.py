"""TMCL commands, links of every kind, and what the check does when the link fails."""

from __future__ import annotations

import pytest

from app.devices.core.axis_limits import AxisLimits
from app.devices.core.capabilities import TmclCommands
from app.devices.core.config import AxisSettings, DeviceConfig
from app.devices.core.device import Device
from app.devices.core.limit_rules.frames import decoder_of, refuse_board
from app.devices.core.tmcl_frames import request_of
from app.devices.limits.apply import limiter_of
from app.emulators.drive.documents import ChipFaultsChange
from app.emulators.tmc428.options import EmulatorPatch
from app.errors import LinkError, OutOfRange, SoftLimit, UsageError, WrongState
from app.links import datagram32
from app.links.datagram_uart import UartForm
from app.links.register_access import BoardAccess, UartAccess
from app.links.tmcl import Request
from app.registers.evaluation_board import BoardOpcode
from app.registers.tmcl.commands import Opcode
from tests.devices.harness import emulator_of
from tests.devices.limits.harness import Bench, bench
from tests.devices.limits.setup import set_up

LIMITS = AxisLimits(position_min=-5_000, position_max=8_000, velocity_max_pps=20_000.0)


async def module(made: Bench) -> Device:
    await set_up(made.device)
    await made.limit(LIMITS)
    return made.device


def movers(made: Bench) -> list[Request]:
    """Commands that have reached the module and move or set something."""
    reads = (Opcode.GAP, Opcode.GGP, Opcode.GCO, Opcode.GIO, Opcode.GET_VERSION)
    found = [Request.decode(frame) for frame in made.port.frames]
    return [request for request in found if request.opcode not in reads and (request.opcode, request.type) != (13, 2)]


REFUSED = [
    ("MVP", "ABS", 0, 8_001, "position"),
    ("MVP", "ABS", 0, -5_001, "position"),
    ("MVP", "REL", 0, 8_001, "position"),
    ("MVP", "COORD", 0, 3, "position"),
    ("ROR", 0, 0, 20_001, "velocity"),
    ("ROL", 0, 0, 20_001, "velocity"),
    ("ROL", 0, 0, -20_001, "velocity"),
    ("SAP", 0, 0, 9_000, "position"),
    ("SAP", 1, 0, 9_000, "position"),
    ("SAP", 2, 0, -30_000, "velocity"),
    ("SAP", 4, 0, 20_001, "velocity"),
    ("SAP", 194, 0, 20_001, "velocity"),
]


@pytest.mark.parametrize("raw", [False, True])
@pytest.mark.parametrize(("command", "kind", "motor", "value", "quantity"), REFUSED)
async def test_a_command_beyond_a_limit_does_not_reach_the_module(
    command: str, kind: int | str, motor: int, value: int, quantity: str, raw: bool
) -> None:
    async with bench("pd42-1241") as made:
        device = await module(made)
        await device.registers.write("coordinate_3", None, 9_999)
        commands = device.session.motion_commands[0]
        made.port.frames.clear()
        frame = request_of(1, command, kind, motor, value).encode()
        with pytest.raises(SoftLimit) as refusal:
            await (device.raw.exchange(frame) if raw else device.need(TmclCommands).tmcl(command, kind, motor, value))
        assert refusal.value.quantity == quantity
        assert movers(made) == []
        assert device.session.motion_commands[0] == commands


async def test_commands_within_go_and_the_accumulator_does_not() -> None:
    async with bench("pd42-1241") as made:
        device = await module(made)
        await device.registers.write("coordinate_3", None, 700)
        for command, kind, value in (("MVP", "COORD", 3), ("MVP", "REL", 200), ("ROR", 0, 20_000), ("MST", 0, 0)):
            assert (await device.need(TmclCommands).tmcl(command, kind, 0, value)).status == 100
        with pytest.raises(WrongState, match="accumulator"):
            await device.need(TmclCommands).tmcl("AAP", 4)
        assert (await device.need(TmclCommands).tmcl("AAP", 140)).status != 1  # what no limit is about


async def test_a_program_that_is_downloaded_is_judged_command_by_command() -> None:
    async with bench("pd42-1241") as made:
        device = await module(made)
        await device.need(TmclCommands).tmcl(Opcode.ENTER_DOWNLOAD)
        with pytest.raises(SoftLimit):
            await device.need(TmclCommands).tmcl("ROR", 0, 0, 25_000)
        assert (await device.need(TmclCommands).tmcl("ROR", 0, 0, 15_000)).status == 101
        assert (await device.need(TmclCommands).tmcl("SAP", 4, 0, 10)).status == 101
        await device.need(TmclCommands).tmcl(Opcode.EXIT_DOWNLOAD)
        await made.clock.advance(2.0)
        # What was stored was not done: positioning is as fast as before.
        assert device.limit_warnings(0) == []
        limiter = limiter_of(device)
        assert limiter is not None
        assert limiter.view()(4) == 20_000


async def test_speeds_count_in_the_unit_that_the_module_is_set_to() -> None:
    async with bench("pd42-1241") as made:
        device = await module(made)
        await device.registers.write("ap255", 0, 0)
        with pytest.raises(SoftLimit):
            await device.registers.write("ap4", 0, 20_990)  # 20,017 pps in units of the driver chip
        await device.registers.write("ap4", 0, 20_971)


async def test_a_word_that_may_have_arrived_is_not_relied_on() -> None:
    """A divider was to be raised and the answer was lost: speeds are judged as if it had not been."""
    async with bench("tmc428") as made:
        await set_up(made.device)
        await made.limit(AxisLimits(velocity_max_pps=20_000.0))
        wire = emulator_of(made.device)
        wire.patch(EmulatorPatch(faults=ChipFaultsChange(silence=True)))
        queue = made.device.session.queue
        with pytest.raises(LinkError):
            await queue.exchange(datagram32.write(0x0C, 0x7600))  # pulse_div 7
        wire.patch(EmulatorPatch(faults=ChipFaultsChange(silence=False)))
        with pytest.raises(SoftLimit):
            await queue.exchange(datagram32.write(0x03, 1311))  # slow enough with a pulse_div of 5 and more
        await made.device.registers.write("pulse_div", 0, 7)
        await queue.exchange(datagram32.write(0x03, 1311))


async def test_registers_are_told_through_a_uart_and_an_evaluation_board() -> None:
    for form in (UartForm(3), UartForm(None)):
        access = UartAccess("uart", form)
        assert _told(access, form.write(0x27, 20_000)) == [(0x27, 20_000)]
        assert _told(access, form.read(0x27)) == []
    board = BoardAccess()
    assert _told(board, board.write_frame(0x127, 0xFFFF_FFFF)) == [(0x127, 0xFFFF_FFFF)]
    assert _told(board, board.read_frames((0x27,))[0]) == []
    with pytest.raises(WrongState, match="past the soft limits"):
        refuse_board(Request(1, Opcode.ROR, 0, 0, 100).encode())
    for harmless in (Opcode.MST, BoardOpcode.WRITE_MC, Opcode.GAP):
        refuse_board(Request(1, harmless).encode())


def _told(access: UartAccess | BoardAccess, frame: bytes) -> list[tuple[int, int]]:
    return list(decoder_of(access)(frame))


async def test_limits_that_cannot_be_are_refused_and_kept_ones_come_back() -> None:
    with pytest.raises(OutOfRange):
        AxisLimits(position_min=5, position_max=4)
    for velocity, acceleration, current in ((0.0, 1.0, 1.0), (1.0, -1.0, 1.0), (1.0, 1.0, float("nan"))):
        with pytest.raises(OutOfRange):
            AxisLimits(None, None, velocity, acceleration, current)
    for model, needs in (("tmc5160", "sense_resistor_ohm"), ("tmc428", "current_full_scale_a"), ("tmc4210", "driver")):
        with pytest.raises(UsageError, match=needs):
            DeviceConfig("x", model, {"kind": "emulator"}, axes=(AxisSettings(limits=AxisLimits(current_max_a=1.0)),))
    kept = AxisSettings.of({"name": "X", "limits": {"position_max": 7, "velocity_max_pps": 5.0}})
    assert kept.limits == AxisLimits(position_max=7, velocity_max_pps=5.0)
    assert AxisSettings.of({"name": "X"}).limits == AxisLimits()


async def test_without_limits_nothing_is_in_the_way_of_a_frame() -> None:
    async with bench("tmc5160") as made:
        device: Device = made.device
        assert device.limiter is None
        assert device.session.queue.gate is None
        await made.limit(LIMITS)
        assert device.session.queue.gate is device.limiter
        await made.limit(None)
        assert device.session.queue.gate is None
