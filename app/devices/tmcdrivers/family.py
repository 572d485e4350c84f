"""The family: what the layer of drivers knows of it, and how its drivers are composed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar

from ...clock import Clock
from ...links.port import FramePort
from ...links.queue import LinkQueue
from ...links.register_access import access_of
from ...registers.catalog import find_model
from ...registers.spi_format import TaggedFormat
from ...registers.tmcdrivers.models import FAMILY as NAME
from ...registers.tmcdrivers.models import MODELS
from ..core.axis_limits import AxisLimits
from ..core.config import DeviceConfig
from ..core.device import Device, Parts
from ..core.family import DeviceFamily
from ..core.limit_rules.chip_rules import ChipRules
from ..core.raw_datagrams import RawDatagrams
from ..core.register_file import READ_AT_ONCE, RegisterFile
from ..core.register_link import RegisterLink
from ..core.session import Session
from ..core.start_up import AxisStartUp, StartPlan
from .configuration import Configuration
from .identity import DriverIdentity, found_by
from .limits import DriverRules, full_scale_a
from .memory import DriverMemory
from .monitor import FlagClearing, Monitor, PlaceInTable
from .motion import DriverMotion
from .mslut import MicrostepTables
from .reader import Reader
from .resets import Resets
from .roles import DriverRoles
from .start_up import plan as plan_of_registers
from .tagged import compose as tagged
from .tagged.start_up import plan as plan_of_tagged
from .telemetry import DriverTelemetry
from .writes import DatagramsByHand, Writes

P = TypeVar("P")


def compose(
    device_id: str, config: DeviceConfig, port: FramePort, clock: Clock, queue: LinkQueue | None = None
) -> Device:
    """A device of this family, of its parts."""
    if isinstance(find_model(config.model).spi, TaggedFormat):
        return tagged.compose(device_id, config, port, clock, queue)
    session = Session(device_id, config, port, clock, lambda what: False, queue)
    link = RegisterLink(session, access_of(config.link, config.model), session.family.table)
    memory = DriverMemory(link, DriverRoles(session.family))
    resets = Resets(memory)
    reader = Reader(link, memory, resets)
    writes = Writes(link, memory, resets)
    registers = RegisterFile(link, writes, session.family.axes, READ_AT_ONCE)
    session.state_hooks.append(memory.heard_state)
    tables = (MicrostepTables(session, link, memory, writes),) if memory.rows.mslut else ()
    parts = Parts(
        identity=DriverIdentity(reader),
        registers=registers,
        raw=RawDatagrams(link, writes, DatagramsByHand(memory, resets)),
        motion=DriverMotion(session, link, memory, reader),
        monitor=Monitor(session, memory, reader, resets),
        counter=PlaceInTable(session, memory, reader, resets),
        telemetry=DriverTelemetry(link, memory),
        configuration=Configuration(memory, registers),
        others=(memory, reader, FlagClearing(memory, registers), *tables),
    )
    return Device(session, parts)


def limit_rules(device: Device, limits: Sequence[AxisLimits], clock_hz: float) -> ChipRules:
    """What its registers mean for soft limits."""
    if isinstance(device.family.spi, TaggedFormat):
        return tagged.limit_rules(device, limits, clock_hz)
    return DriverRules(_own(device, RegisterFile), _own(device, DriverMemory), _own(device, Reader), limits, clock_hz)


async def plan(device: Device, wanted: Sequence[AxisStartUp]) -> StartPlan:
    """What the axis needs after power-on. Raises UsageError, OutOfRange."""
    return await (plan_of_tagged if isinstance(device.family.spi, TaggedFormat) else plan_of_registers)(device, wanted)


def _own(device: Device, kind: type[P]) -> P:
    part = device.part(kind)
    assert part is not None  # it was composed here
    return part


FAMILY = DeviceFamily(NAME, tuple(model.name for model in MODELS), compose, limit_rules, plan, found_by, full_scale_a)
