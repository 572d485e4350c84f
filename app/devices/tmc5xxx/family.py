"""The TMC5xxx family: what the layer of drivers knows of it, and how its drivers are composed."""

from __future__ import annotations

from collections.abc import Sequence

from ...clock import Clock
from ...links.port import FramePort
from ...links.queue import LinkQueue
from ...links.register_access import access_of
from ...registers.tmc5xxx.table import TABLES
from ..core.axis_limits import AxisLimits
from ..core.background_tasks import BackgroundTasks
from ..core.config import DeviceConfig
from ..core.device import Device, Parts
from ..core.family import DeviceFamily
from ..core.polling import Poller
from ..core.raw_datagrams import RawDatagrams
from ..core.register_file import READ_AT_ONCE, RegisterFile
from ..core.register_link import RegisterLink
from ..core.session import COUNTER_WRITES, Session
from .chip_identity import ChipIdentity
from .clearing import FlagClearing
from .configuration import Configuration
from .counter import Counter
from .decoded_registers import DecodedRegisters
from .encoder import SixPointEncoderIndex, SixPointEncoders
from .events import Events
from .identity import found_by
from .limits import SixPointRules, full_scale_a
from .memory import ChipMemory
from .monitor import Monitor
from .motions import Motions
from .moves import SixPointMotion
from .mslut import MicrostepTables
from .pace import Pace
from .position import PositionCalls
from .predictions import Predictions
from .preparation import Preparation
from .raw import DatagramsByHand
from .reader import ChipReader
from .roles import roles_of
from .stall import ChipStall
from .standstill import Standstill
from .start_up import plan
from .stops import Stops
from .telemetry import SixPointTelemetry
from .writes import Writes
from .written_motion import WrittenMotion


def compose(
    device_id: str, config: DeviceConfig, port: FramePort, clock: Clock, queue: LinkQueue | None = None
) -> Device:
    """A device of this family, of its parts."""
    session = Session(device_id, config, port, clock, COUNTER_WRITES.__contains__, queue)
    link = RegisterLink(session, access_of(config.link, config.model), session.family.table)
    tasks = BackgroundTasks()
    # What is known, and what is expected.
    memory = ChipMemory(link, roles_of(config.model))
    decoded = DecodedRegisters(session, memory)
    predictions = Predictions(session)
    log = Events(session, memory.chip, (memory.was_reset, predictions.was_reset))
    motions = Motions(session, predictions)
    # Reading and writing.
    reader = ChipReader(link, memory, decoded, log)
    standstill = Standstill(session, memory)
    written_motion = WrittenMotion(session, link, memory, decoded, predictions, motions)
    writes = Writes(session, memory, log, reader, written_motion)
    registers = RegisterFile(link, writes, session.family.axes, READ_AT_ONCE)
    # Motion, and what becomes of it.
    stops = Stops(session, link, memory, decoded, predictions, motions)
    preparation = Preparation(memory, decoded, log, reader, standstill)
    monitor = Monitor(session, link, memory, decoded, log, reader, standstill, motions)
    motions.wake = Poller(session, tasks, monitor.poll, motions.to_poll).begin
    # Each acts on a state that is set, in this order.
    session.state_hooks += [memory.heard_state, predictions.heard_state, log.heard_state, motions.heard_state]
    calls = PositionCalls(session, link, memory, decoded, standstill, predictions, registers)
    parts = Parts(
        identity=ChipIdentity(session, link, memory, reader, tasks),
        registers=registers,
        raw=RawDatagrams(link, writes, DatagramsByHand(config.model, memory, log, written_motion)),
        motion=SixPointMotion(session, link, memory, decoded, preparation, predictions, motions, stops),
        monitor=monitor,
        counter=Counter(session, link, memory, log, reader),
        telemetry=SixPointTelemetry(link, memory, decoded, log, predictions, motions),
        configuration=Configuration(memory, registers),
        others=(
            memory,
            decoded,
            log,
            SixPointEncoders(session, memory, decoded),
            SixPointEncoderIndex(session, registers),
            calls,
            ChipStall(session, memory, decoded, registers, calls),
            FlagClearing(session, link, memory, log, reader, standstill, registers),
            MicrostepTables(session, link, memory, writes),
            Pace(session, link, memory, decoded, registers),
        ),
    )
    return Device(session, parts)


def limit_rules(device: Device, limits: Sequence[AxisLimits], clock_hz: float) -> SixPointRules:
    """What its registers mean for soft limits."""
    registers, memory = device.part(RegisterFile), device.part(ChipMemory)
    assert registers is not None  # it was composed here
    assert memory is not None
    return SixPointRules(registers, memory, limits, clock_hz)


FAMILY = DeviceFamily("tmc5xxx", tuple(TABLES), compose, limit_rules, plan, found_by, full_scale_a)
