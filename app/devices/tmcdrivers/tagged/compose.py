"""How the driver of such a chip is composed, and its rules for soft limits."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar

from ....clock import Clock
from ....links.port import FramePort
from ....links.queue import LinkQueue
from ....links.register_access import access_of
from ....links.spi_access import TaggedAccess
from ....registers.model import Register
from ...core.axis_limits import AxisLimits
from ...core.capabilities import ConfigurationRules
from ...core.config import DeviceConfig
from ...core.device import Device, Parts
from ...core.raw_datagrams import RawDatagrams
from ...core.register_file import RegisterFile
from ...core.register_link import RegisterLink
from ...core.results import AxisState
from ...core.session import Session
from .limits import TaggedRules
from .memory import TaggedMemory, TaggedRoles
from .monitor import TaggedIdentity, TaggedMonitor, TaggedPlace
from .motion import TaggedMotion
from .registers import TaggedByHand, TaggedRegisters, TaggedWrites
from .status import StatusReader
from .telemetry import TaggedTelemetry

P = TypeVar("P")


class TaggedConfiguration(ConfigurationRules):
    """All of it is configuration."""

    def __init__(self, memory: TaggedMemory) -> None:
        self._memory = memory

    def unread(self, register: Register, /) -> int | None:
        return self._memory.word(register)

    async def require_idle(self) -> None:
        """Nothing runs in such a chip but its motor."""

    async def hold_still(self, axis: int, state: AxisState, /) -> list[str]:
        del axis, state
        return []


def compose(
    device_id: str, config: DeviceConfig, port: FramePort, clock: Clock, queue: LinkQueue | None = None
) -> Device:
    """A device of its parts."""
    session = Session(device_id, config, port, clock, lambda what: False, queue)
    link = RegisterLink(session, access_of(config.link, config.model), session.family.table)
    memory = TaggedMemory(link, TaggedRoles(session.family))
    reader = StatusReader(link, memory)
    writes = TaggedWrites(link, memory)
    registers = TaggedRegisters(link, writes, memory)
    session.state_hooks.append(memory.heard_state)
    if isinstance(link.access, TaggedAccess):
        session.state_hooks.append(link.access.on_state)
    parts = Parts(
        identity=TaggedIdentity(memory, reader),
        registers=registers,
        raw=RawDatagrams(link, writes, TaggedByHand(memory)),
        motion=TaggedMotion(session, memory, reader),
        monitor=TaggedMonitor(session, memory, reader),
        counter=TaggedPlace(session, memory, reader),
        telemetry=TaggedTelemetry(link, memory),
        configuration=TaggedConfiguration(memory),
        others=(memory, reader),
    )
    return Device(session, parts)


def limit_rules(device: Device, limits: Sequence[AxisLimits], clock_hz: float) -> TaggedRules:
    """What its registers mean for soft limits."""
    return TaggedRules(_own(device, RegisterFile), _own(device, TaggedMemory), limits, clock_hz)


def _own(device: Device, kind: type[P]) -> P:
    part = device.part(kind)
    assert part is not None  # it was composed here
    return part
