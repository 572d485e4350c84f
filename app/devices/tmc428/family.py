"""The TMC428 family: what the layer of drivers knows of it, and how its drivers are composed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from ...clock import Clock
from ...links.access32 import SPI32
from ...links.port import FramePort
from ...links.queue import LinkQueue
from ...registers.model import RegisterTable
from ..core.axis_limits import AxisLimits
from ..core.background_tasks import BackgroundTasks
from ..core.config import DeviceConfig
from ..core.device import Device, Parts
from ..core.family import DeviceFamily
from ..core.register_file import RegisterFile
from ..core.register_link import RegisterLink
from ..core.session import Session
from . import tmc428, tmc429, tmc4210
from .axis_roles import AxisRoles
from .chain_status import ChainStatus
from .configuration import RampConfiguration
from .counter import COUNTER_WRITES, RampCounter
from .cover import ChainCover
from .identity import RampIdentity
from .interrupts import Compare, Interrupts
from .limits import RampRules
from .memory import RampMemory
from .monitor import RampMonitor
from .moves import RampMotion
from .pace import Pace
from .prediction import TickedBook
from .ram import Ram
from .raw import RawDatagrams32
from .resets import Resets
from .start_up import plan
from .stops import RampStops
from .stream import RampStream
from .switching import Switching
from .telemetry import RampTelemetry
from .writes import RampWrites


@dataclass(frozen=True, slots=True)
class Chip:
    """What of a driver is one chip's own. `besides` are the global registers that are remembered."""

    axis_roles: Callable[[RegisterTable, int], AxisRoles]
    besides: tuple[str, ...]
    identity: Callable[[RegisterLink, RampMemory, Resets, BackgroundTasks], RampIdentity]
    switching: Callable[[RegisterLink, RampMemory], Switching]
    writes: Callable[[RegisterLink, RampMemory, Sequence[TickedBook], Interrupts], RampWrites] = RampWrites
    ram: Callable[[RegisterLink, RegisterFile], Ram] | None = None
    compare: str | None = None
    compare_interrupt: str | None = None


CHIPS = {
    "tmc428": Chip(
        tmc428.axis_roles, (tmc428.GLOBAL,), tmc428.Tmc428Identity, tmc428.Tmc428Switching, tmc428.Tmc428Writes, Ram
    ),
    "tmc429": Chip(
        tmc428.axis_roles,
        (tmc428.GLOBAL, tmc429.INTERFACE),
        tmc429.Tmc429Identity,
        tmc429.Tmc429Switching,
        tmc428.Tmc428Writes,
        Ram,
        compare=tmc429.COMPARE,
        compare_interrupt=tmc429.COMPARE_INTERRUPT,
    ),
    "tmc4210": Chip(
        tmc4210.axis_roles,
        (tmc4210.GLOBAL,),
        tmc4210.Tmc4210Identity,
        tmc4210.Tmc4210Switching,
        compare=tmc4210.COMPARE,
        compare_interrupt=tmc4210.COMPARE_INTERRUPT,
    ),
}


def compose(
    device_id: str, config: DeviceConfig, port: FramePort, clock: Clock, queue: LinkQueue | None = None
) -> Device:
    """A device of this family, of its parts."""
    chip = CHIPS[config.model]
    session = Session(device_id, config, port, clock, COUNTER_WRITES.__contains__, queue)
    link = RegisterLink(session, SPI32, session.family.table)
    axes = session.family.axes
    rows = [chip.axis_roles(link.table, axis) for axis in range(axes)]
    memory = RampMemory(link, rows, [link.table.get(name) for name in chip.besides])
    books = tuple(TickedBook() for _ in rows)
    switching = chip.switching(link, memory)
    resets = Resets(memory)
    tasks = BackgroundTasks()
    compare = chip.compare_interrupt and Compare(link.table.get(chip.compare_interrupt), memory.axis_compared)
    interrupts = Interrupts(link, rows, compare or None, tasks)
    writes = chip.writes(link, memory, books, interrupts)
    registers = RegisterFile(link, writes, axes)
    stops = RampStops(session, memory, books)
    ram = None if chip.ram is None else chip.ram(link, registers)
    cover = None if ram is None else ChainCover(link, memory, resets, ram)
    chain = None if cover is None else ChainStatus(link, memory, cover, interrupts)
    parts = Parts(
        identity=chip.identity(link, memory, resets, tasks),
        registers=registers,
        raw=RawDatagrams32(link, memory, writes, switching.status_names),
        motion=RampMotion(link, memory, switching, books, stops),
        monitor=RampMonitor(link, memory, switching, books, resets, interrupts, chain),
        counter=RampCounter(link, memory, resets, chip.compare),
        telemetry=RampTelemetry(link, memory, switching, books, interrupts),
        configuration=RampConfiguration(registers, memory, writes),
        others=(
            stops,
            memory,
            switching,
            interrupts,
            RampStream(link, memory, books),
            Pace(link, memory, registers),
            *(part for part in (ram, cover) if part is not None),
        ),
    )
    return Device(session, parts)


def limit_rules(device: Device, limits: Sequence[AxisLimits], clock_hz: float) -> RampRules:
    """What its registers mean for soft limits."""
    registers, memory = device.part(RegisterFile), device.part(RampMemory)
    assert registers is not None  # it was composed here
    assert memory is not None
    return RampRules(registers, memory, limits, clock_hz)


FAMILY = DeviceFamily("tmc428", tuple(CHIPS), compose, limit_rules, plan)
