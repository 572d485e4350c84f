"""The emulated module on a CAN bus of python-can, with our own link and driver at its other end.

The module's time is the test's; the bus and its threads are real.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import threading
from collections.abc import AsyncIterator, Iterator, Sequence
from contextlib import asynccontextmanager, contextmanager
from dataclasses import dataclass

import can
import pytest

from app.calc.tmcl.instructions import Command
from app.clock import Clock, VirtualClock, WallClock
from app.devices.core.capabilities import ProgramMemory
from app.devices.core.config import DeviceConfig
from app.devices.core.device import Device
from app.devices.core.motion_watch import POLL_S
from app.devices.core.results import MotionEnd
from app.devices.manager import DeviceManager
from app.devices.tmcl.arrivals import Arrivals
from app.devices.tmcl.ongoing import OngoingMotion
from app.emulators.line.can_end import CanEnd
from app.emulators.line.can_message import CanMessage
from app.emulators.line.line import Line
from app.emulators.line.server import LineServer
from app.emulators.tmcl.module import EmulatedModule
from app.emulators.tmcl.options import TmclOptions, TmclPatch
from app.errors import WrongState
from app.links.registry import can_factory
from app.links.tmcl import Reply, Request
from app.registers.tmcl.commands import Opcode, Status
from tests.links.pty_module import until
from tests.peers.emulator_process import emulator

SOON_S = 10.0
"""How long anything may take on a busy machine [s]; normally it is there in a millisecond."""
QUIET_S = 0.1
"""How long nothing has to come before there is nothing [s]."""


@dataclass
class Bus:
    """A bus with modules, and a bare client on it."""

    clock: VirtualClock
    modules: list[EmulatedModule]
    server: LineServer
    client: can.BusABC
    channel: str

    def say(self, data: bytes, identifier: int = 1) -> None:
        self.client.send(can.Message(arbitration_id=identifier, data=data, is_extended_id=False))

    def hear(self, within_s: float = SOON_S) -> CanMessage | None:
        message = self.client.recv(within_s)
        return None if message is None else CanMessage(message.arbitration_id, bytes(message.data))

    def ask(self, opcode: int, type_: int = 0, motor: int = 0, value: int = 0, identifier: int = 1) -> CanMessage:
        self.say(Request(0, opcode, type_, motor, value).encode()[1:8], identifier)
        heard = self.hear()
        assert heard is not None
        return heard


@contextmanager
def bus(channel: str, modules: Sequence[dict[str, object]] = ({},)) -> Iterator[Bus]:
    """Modules of the given options on python-can's virtual `channel`."""
    clock = VirtualClock(5.0)
    on_it = [EmulatedModule("pd42-1241", clock, TmclOptions.model_validate(options)) for options in modules]
    server = LineServer(Line(on_it, clock), [CanEnd("virtual", channel, 1_000_000)])
    with server:
        thread = threading.Thread(target=server.run, name="line")
        thread.start()
        client = can.Bus(interface="virtual", channel=channel)
        try:
            yield Bus(clock, on_it, server, client, channel)
        finally:
            client.shutdown()
            server.stop()
            thread.join(SOON_S)
            assert not thread.is_alive()


@pytest.fixture
def one(request: pytest.FixtureRequest) -> Iterator[Bus]:
    with bus(request.node.name) as made:
        yield made


def value_of(message: CanMessage) -> int:
    return int.from_bytes(message.data[3:7], "big", signed=True)


# --- messages -----------------------------------------------------------------------------------


@pytest.mark.sheet("FM-PD42-1241", "3.1")
def test_seven_bytes_there_and_back(one: Bus) -> None:
    """The examples of the frame table: ID 001h there, ID 002h back, the module's identifier in front."""
    assert one.ask(Opcode.SAP, 4, value=51_200) == CanMessage(2, bytes.fromhex("0164050000c800"))
    assert one.ask(Opcode.GAP, 4) == CanMessage(2, bytes.fromhex("0164060000c800"))
    assert one.ask(99) == CanMessage(2, bytes.fromhex("01026300000000"))


def test_the_version_as_a_string_takes_eight_bytes(one: Bus) -> None:
    one.say(bytes((Opcode.GET_VERSION, 0, 0, 0, 0, 0, 0, 0)))
    assert one.hear() == CanMessage(2, b"1241V144")
    assert one.ask(Opcode.GET_VERSION) == CanMessage(2, b"1241V14")


@pytest.mark.parametrize("data", [b"", b"\x06", b"\x06\x01\x00\x00\x00\x00"])
def test_messages_of_other_lengths_are_no_commands(one: Bus, data: bytes) -> None:
    one.say(data)
    one.say(bytes(7), identifier=0x300)
    assert one.hear(QUIET_S) is None
    assert one.ask(Opcode.GAP, 1).data[1] == Status.OK


def test_identifiers_change_with_the_next_command(one: Bus) -> None:
    assert one.ask(Opcode.SGP, 70, 0, 0x222).identifier == 2
    one.ask(Opcode.SGP, 71, 0, 0x111)
    assert one.ask(Opcode.GAP, 1, identifier=0x111) == CanMessage(0x222, bytes.fromhex("11640600000000"))


def test_the_second_identifier_is_obeyed_and_never_answered(one: Bus) -> None:
    one.ask(Opcode.SGP, 83, 0, 0x77)
    one.say(Request(0, Opcode.SAP, 4, 0, 1234).encode()[1:8], 0x77)
    assert value_of(one.ask(Opcode.GAP, 4)) == 1234


def test_several_modules_on_a_bus(request: pytest.FixtureRequest) -> None:
    with bus(request.node.name, ({}, {"can_receive_id": 3, "can_send_id": 4})) as two:
        two.ask(Opcode.SAP, 4, value=1000, identifier=1)
        two.ask(Opcode.SAP, 4, value=2000, identifier=3)
        assert two.ask(Opcode.GAP, 4, identifier=1) == CanMessage(2, bytes.fromhex("01640600") + b"\0\x03\xe8")
        assert two.ask(Opcode.GAP, 4, identifier=3) == CanMessage(4, bytes.fromhex("03640600") + b"\0\x07\xd0")


def test_faults_of_module_and_cable(one: Bus) -> None:
    def patch(**faults: object) -> None:
        one.server.call(lambda: one.modules[0].patch(TmclPatch.model_validate({"faults": faults})))

    patch(silence=True)
    one.say(Request(0, Opcode.SAP, 4, 0, 77).encode()[1:8])
    assert one.hear(QUIET_S) is None
    patch(silence=False, bit_error_rate=1.0)
    assert value_of(one.ask(Opcode.GAP, 4)) == 77, "it obeyed, and a bus with a CRC delivers whole messages or none"
    patch(bit_error_rate=0.0, unplugged=True)
    one.say(Request(0, Opcode.SAP, 4, 0, 88).encode()[1:8])
    assert one.hear(QUIET_S) is None
    patch(unplugged=False)
    assert value_of(one.ask(Opcode.GAP, 4)) == 77


def test_a_bus_that_is_not_there() -> None:
    clock = VirtualClock()
    line = Line([EmulatedModule("pd42-1241", clock)], clock)
    with (
        pytest.raises(OSError, match="socketcan stepscope-none"),
        LineServer(line, [CanEnd("socketcan", "stepscope-none", 1_000_000)]),
    ):
        pass


@pytest.fixture
def vcan() -> Iterator[str]:
    """A virtual bus of the kernel, where it has them and lets us make one."""
    name = f"vstep{os.getpid() % 100_000}"
    ip = shutil.which("ip") or "ip"
    made = [
        subprocess.run([ip, "link", *words], capture_output=True, check=False).returncode == 0
        for words in (("add", "dev", name, "type", "vcan"), ("set", "up", name))
    ]
    if not all(made):
        pytest.skip("no vcan in this kernel, or none may be made here")
    yield name
    subprocess.run([ip, "link", "delete", name], check=True)


async def test_over_a_bus_of_the_kernel_in_a_process_of_its_own(vcan: str) -> None:
    with emulator("--can", vcan, "--address", "1", "--address", "2"):
        for address in (1, 2):
            link = {"kind": "can", "interface": "socketcan", "channel": vcan, "timeout_s": SOON_S}
            link |= {"send_id": 2 * address - 1, "receive_id": 2 * address}
            port = can_factory("pd42-1241", link, WallClock())
            try:
                for value in (1, 2):
                    asked = Request(1, Opcode.SAP, 4, 0, value).encode()
                    assert Reply.decode(await port.exchange(asked)).value == value
            finally:
                await port.aclose()


def test_a_process_says_where_it_is_and_ends() -> None:
    with emulator("--can", "virtual:bench") as process:
        assert "can virtual bench" in process.said
        assert process.end() == 0


def test_a_model_without_can() -> None:
    module = EmulatedModule("tmcm-1161", VirtualClock())
    assert module.can_bit_rate is None
    with pytest.raises(WrongState, match="no CAN"):
        module.receive_message(CanMessage(1, bytes(7)))


def test_the_bit_rate_changes_at_power_on(one: Bus) -> None:
    assert one.modules[0].can_bit_rate == 1_000_000
    one.ask(Opcode.SGP, 69, 0, 5)
    assert one.modules[0].can_bit_rate == 1_000_000
    one.say(Request(0, Opcode.RESET_MODULE, 0, 0, 1234).encode()[1:8])
    assert one.ask(Opcode.GGP, 69).data[1] == Status.OK
    assert one.modules[0].can_bit_rate == 125_000


# --- second reply -------------------------------------------------------------------------------


def arrived(one: Bus, position: int) -> CanMessage | None:
    """Send the motor there; the message that says so, if one comes."""
    assert one.ask(Opcode.MVP, 0, value=position).data[1] == Status.OK
    for _ in range(100):
        one.clock.set(one.clock.now() + 0.1)
        if (heard := one.hear(0.01)) is not None:
            return heard
    return None


@pytest.mark.sheet("FM-PD42-1241", "3.6.35")
def test_the_second_reply_comes_on_the_bus_when_the_motor_has_arrived(one: Bus) -> None:
    assert one.ask(Opcode.REQUEST_EVENT, 1, value=1) == CanMessage(2, bytes.fromhex("01648a00000001"))
    for position in (5000, -5000):
        assert arrived(one, position) == CanMessage(2, bytes.fromhex("01808a00000001"))


def test_the_second_reply_of_the_next_move_only(one: Bus) -> None:
    one.ask(Opcode.REQUEST_EVENT, 0, value=1)
    assert arrived(one, 5000) == CanMessage(2, bytes.fromhex("01808a00000001"))
    one.ask(Opcode.MVP, 0, value=0)
    for _ in range(60):
        one.clock.set(one.clock.now() + 0.1)
    assert value_of(one.ask(Opcode.GAP, 8)) == 1
    assert one.hear(QUIET_S) is None


# --- heartbeat ----------------------------------------------------------------------------------


@pytest.mark.sheet("FM-PD42-1241", "5.1")
def test_the_motor_stops_when_no_message_came_for_so_long(one: Bus) -> None:
    one.ask(Opcode.SGP, 82, 0, 200)
    one.ask(Opcode.ROR, value=51_200)
    for _ in range(20):  # four seconds of questions, each in time
        one.clock.set(one.clock.now() + 0.19)
        assert one.ask(Opcode.GAP, 1).data[1] == Status.OK
    assert value_of(one.ask(Opcode.GAP, 3)) == 51_200
    one.clock.set(one.clock.now() + 3.0)
    assert value_of(one.ask(Opcode.GAP, 3)) == 0
    one.ask(Opcode.ROR, value=51_200)
    one.clock.set(one.clock.now() + 0.15)
    assert value_of(one.ask(Opcode.GAP, 3)) > 0, "the next command begins it anew"


def test_each_heartbeat_hears_its_own_interface(one: Bus) -> None:
    """Questions on the serial line do not feed that of CAN, nor the other way round."""
    serial = Request(1, Opcode.GAP, 1).encode()

    def both(seconds: float, *, over_can: bool) -> int:
        for _ in range(round(seconds / 0.1)):
            one.clock.set(one.clock.now() + 0.1)
            if over_can:
                one.ask(Opcode.GAP, 1)
            else:
                one.modules[0].receive(serial)
        return Reply.decode(one.modules[0].receive(Request(1, Opcode.GAP, 3).encode()) or b"").value

    one.ask(Opcode.SGP, 82, 0, 300)
    one.ask(Opcode.ROR, value=51_200)
    assert both(2.0, over_can=True) == 51_200
    assert both(3.0, over_can=False) == 0
    one.ask(Opcode.SGP, 82, 0, 0)
    one.ask(Opcode.SGP, 68, 0, 300)
    one.modules[0].receive(Request(1, Opcode.ROR, 0, 0, 51_200).encode())
    assert both(2.0, over_can=False) == 51_200
    assert both(3.0, over_can=True) == 0


# --- with the driver ----------------------------------------------------------------------------


@asynccontextmanager
async def driven(channel: str, clock: Clock | None = None) -> AsyncIterator[tuple[Bus, Device]]:
    """The driver, connected over the bus; `clock` is the server's, by which it polls."""
    with bus(channel) as made:
        manager = DeviceManager({"can": can_factory}, clock or WallClock())
        link = {"kind": "can", "interface": "virtual", "channel": channel, "timeout_s": SOON_S}
        device = await manager.add(DeviceConfig("Far", "pd42-1241", link))
        try:
            assert device.state == "connected", device.problem
            yield made, device
        finally:
            await manager.close()


async def test_the_driver_moves_a_module_over_can(request: pytest.FixtureRequest) -> None:
    async with driven(request.node.name) as (made, device):
        started = await device.motion.move(0, 5000)
        assert started.predicted_duration_s is not None
        made.clock.set(made.clock.now() + started.predicted_duration_s + 0.5)
        assert (await device.monitor.axis_state(0)).position == 5000
        await device.motion.rotate(0, 5000)
        made.clock.set(made.clock.now() + 2.0)
        assert (await device.stop(0)).ok


async def test_a_program_is_stored_and_read_back_over_can(request: pytest.FixtureRequest) -> None:
    """The answers of command 134 are the seven bytes of a command, whatever they look like."""
    async with driven(request.node.name) as (_, device):
        program = [Command(1, 100, 0, 5), Command(0x64, 0x06, 0, -1), Command(28, 0, 0, 0)]
        memory = device.need(ProgramMemory)
        assert (await memory.download(program)).commands == 3
        assert await memory.read_program(0, 3) == program


async def test_the_second_reply_ends_a_move_of_the_driver(request: pytest.FixtureRequest) -> None:
    """Before the next poll is due by the server's time: it is the event that has the axis looked at."""
    server_clock = VirtualClock()
    async with driven(request.node.name, server_clock) as (made, device):
        ends: list[MotionEnd] = []
        device.session.listen(lambda event: ends.append(event) if isinstance(event, MotionEnd) else None)
        arrivals = device.part(Arrivals)
        assert arrivals is not None
        for count, target in enumerate((5000, 0), 1):
            started = await device.motion.move(0, target)
            assert started.predicted_duration_s is not None
            await server_clock.advance(0.4 * POLL_S)
            made.clock.set(made.clock.now() + started.predicted_duration_s + 0.5)
            await until(lambda: bool(ends), SOON_S)
            end = ends.pop()
            assert (end.reason, end.position) == ("target_reached", target)
            assert arrivals.heard == count


async def test_what_the_driver_hears_from_a_module_that_knows_no_second_reply(request: pytest.FixtureRequest) -> None:
    """It is polled as over any other line."""
    async with driven(request.node.name) as (made, device):
        made.modules[0]._firmware._handlers[Opcode.REQUEST_EVENT] = made.modules[0]._firmware._handlers[99]
        started = await device.motion.move(0, 5000)
        assert started.predicted_duration_s is not None
        made.clock.set(made.clock.now() + started.predicted_duration_s + 0.5)
        ongoing, arrivals = device.part(OngoingMotion), device.part(Arrivals)
        assert ongoing is not None
        assert arrivals is not None
        await until(lambda: not ongoing.moves, SOON_S)
        assert arrivals.heard == 0
