"""The TMC4361 family: what the layer of drivers knows of it, and how its driver is composed."""

from __future__ import annotations

from collections.abc import Sequence

from ...clock import Clock
from ...links.port import FramePort
from ...links.queue import LinkQueue
from ...links.register_access import access_of
from ..core.axis_limits import AxisLimits
from ..core.background_tasks import BackgroundTasks
from ..core.config import DeviceConfig
from ..core.device import Device, Parts
from ..core.family import DeviceFamily
from ..core.raw_datagrams import RawDatagrams
from ..core.register_file import READ_AT_ONCE, RegisterFile
from ..core.register_link import RegisterLink
from ..core.session import Session
from .chip_identity import ChipIdentity
from .configuration import Configuration
from .counter import COUNTER_WRITES, Counter
from .cruise import Cruise
from .departure import Departure
from .driver_behind import DriverBehind
from .encoder import Encoder, Index
from .events import Events
from .expected_motion import ExpectedMotion
from .identity import found_by
from .limits import SRampRules
from .memory import ChipMemory
from .monitor import Monitor
from .motion import ChipMotion
from .moves import Moves
from .pace import Pace
from .position import Position
from .raw import DatagramsByHand
from .rotation import Rotation
from .start_up import plan
from .start_wire import StartPin
from .stops import Stops
from .tables import MicrostepTable
from .telemetry import ChipTelemetry
from .writes import Writes


def compose(
    device_id: str, config: DeviceConfig, port: FramePort, clock: Clock, queue: LinkQueue | None = None
) -> Device:
    """A device of this family, of its parts."""
    session = Session(device_id, config, port, clock, COUNTER_WRITES.__contains__, queue)
    link = RegisterLink(session, access_of(config.link, config.model), session.family.table)
    tasks = BackgroundTasks()
    cruise = Cruise()
    # Each of these acts on a state that is set, in this order: words, expectation, events, and last the poller.
    memory = ChipMemory(link, cruise)
    expected = ExpectedMotion(session)
    memory.reset_hooks.append(expected.end_at_reset)
    events = Events(link, memory)
    monitor = Monitor(link, memory, cruise, events, expected, tasks)
    writes = Writes(link, memory, events, expected)
    registers = RegisterFile(link, writes, session.family.axes, READ_AT_ONCE)
    departure = Departure(link, memory, cruise, events, expected)
    moves = Moves(link, memory, cruise, departure, expected)
    rotation = Rotation(link, memory, cruise, departure, expected)
    stops = Stops(link, memory, cruise, expected)
    position = Position(link, memory, cruise, expected, registers)
    parts = Parts(
        identity=ChipIdentity(link, events, tasks),
        registers=registers,
        raw=RawDatagrams(link, writes, DatagramsByHand(memory, writes)),
        motion=ChipMotion(session, moves, rotation, stops, expected),
        monitor=monitor,
        counter=Counter(link, memory, events),
        telemetry=ChipTelemetry(link, memory, events, expected),
        configuration=Configuration(session, memory, registers, moves),
        others=(
            memory,
            cruise,
            events,
            moves,
            position,
            DriverBehind(link, memory, cruise, position),
            Encoder(session, memory),
            Index(session, registers),
            StartPin(link, memory, moves),
            Pace(link, registers, cruise),
            MicrostepTable(link, memory, writes),
        ),
    )
    return Device(session, parts)


def limit_rules(device: Device, limits: Sequence[AxisLimits], clock_hz: float) -> SRampRules:
    """What its registers mean for soft limits."""
    registers, memory, cruise = device.part(RegisterFile), device.part(ChipMemory), device.part(Cruise)
    assert registers is not None  # it was composed here
    assert memory is not None
    assert cruise is not None
    return SRampRules(registers, memory, cruise, limits, clock_hz)


FAMILY = DeviceFamily("tmc4361", ("tmc4361",), compose, limit_rules, plan, found_by)
