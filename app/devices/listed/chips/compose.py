"""How the driver of such a chip is composed."""

from __future__ import annotations

from collections.abc import Sequence

from ....clock import Clock
from ....links.port import FramePort
from ....links.queue import LinkQueue
from ....links.register_access import access_of
from ....links.spi_access import TaggedAccess
from ...core.axis_limits import AxisLimits
from ...core.background_tasks import BackgroundTasks
from ...core.config import DeviceConfig
from ...core.device import Device, Parts
from ...core.raw_datagrams import RawDatagrams
from ...core.register_file import READ_AT_ONCE, RegisterFile
from ...core.register_link import RegisterLink
from ...core.session import COUNTER_WRITES, Session
from .configuration import ChipConfiguration
from .identity import ListedChipIdentity
from .limits import ListedChipRules
from .monitor import ChipCounter, ChipMonitor
from .motion import ChipMotion
from .ongoing import ChipMotions
from .rules import ChipRegisters
from .state import ChipState
from .telemetry import ChipTelemetry


def compose(
    device_id: str, config: DeviceConfig, port: FramePort, clock: Clock, queue: LinkQueue | None = None
) -> Device:
    """A device of any chip that the catalog has a table of."""
    session = Session(device_id, config, port, clock, queue=queue)
    link = RegisterLink(session, access_of(config.link, config.model), session.family.table)
    tasks = BackgroundTasks()
    state = ChipState(session, link.table)
    motions = ChipMotions(session, link, state, tasks)
    rules = ChipRegisters(session, link, state, motions)
    registers = RegisterFile(link, rules, session.family.axes, READ_AT_ONCE)
    motion = ChipMotion(session, link, state, motions)
    session.writes_counter = (COUNTER_WRITES | {ramp.position.name for ramp in state.ramps}).__contains__
    session.state_hooks += [state.on_state, motions.on_state]
    if isinstance(link.access, TaggedAccess):
        session.state_hooks.append(link.access.on_state)
    return Device(
        session,
        Parts(
            identity=ListedChipIdentity(session, link, tasks),
            registers=registers,
            raw=RawDatagrams(link, rules, rules),
            motion=motion,
            configuration=ChipConfiguration(state, registers),
            monitor=ChipMonitor(session, link, state, motions),
            counter=ChipCounter(session, link, state),
            telemetry=ChipTelemetry(link, state, motions),
            others=(state, motions),
        ),
    )


def limit_rules(device: Device, limits: Sequence[AxisLimits], clock_hz: float) -> ListedChipRules:
    """What its registers mean for soft limits."""
    registers, state, motions = device.part(RegisterFile), device.part(ChipState), device.part(ChipMotions)
    assert registers is not None  # all three were composed here
    assert state is not None
    assert motions is not None
    return ListedChipRules(registers, state, motions, limits, clock_hz)
