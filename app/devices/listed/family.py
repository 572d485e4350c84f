"""Chips and modules of which names are known and no more: what the layer of drivers knows of them, and the parts of a
module's driver; those of a chip's are in `chips`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar

from ...clock import Clock
from ...errors import UsageError
from ...links.port import FramePort
from ...links.queue import LinkQueue
from ...registers.catalog import MODELS
from ...registers.listed.chips import FAMILY as NAME
from ..core.axis_limits import AxisLimits
from ..core.background_tasks import BackgroundTasks
from ..core.config import DeviceConfig
from ..core.device import Device, Parts
from ..core.family import DeviceFamily
from ..core.limit_rules.rules import Rules
from ..core.session import COUNTER_WRITES, Session
from ..core.start_up import AxisStartUp, StartPlan
from ..core.tmcl_console import Console
from ..core.tmcl_link import TmclLink
from .chips import compose as chips
from .configuration import ListedConfiguration
from .console import ListedSender
from .identity import ListedIdentity
from .limits import ListedRules
from .monitor import ListedCounter, ListedMonitor
from .motion import ListedMotion
from .ongoing import ListedMotions
from .parameters import ListedParameters
from .state import ListedState
from .telemetry import ListedTelemetry

P = TypeVar("P")


def compose(
    device_id: str, config: DeviceConfig, port: FramePort, clock: Clock, queue: LinkQueue | None = None
) -> Device:
    """A device of this family."""
    if MODELS[config.model].kind == "chip":
        return chips.compose(device_id, config, port, clock, queue)
    session = Session(device_id, config, port, clock, queue=queue)
    tasks = BackgroundTasks()
    state = ListedState(session)
    link = TmclLink(session, state, tasks)
    motions = ListedMotions(session, state, link, tasks)

    counters = COUNTER_WRITES | {rows.position.name for rows in state.axes}
    by_hand = tuple(f"{command} {rows.position.address}," for command in ("SAP", "AAP", "RSAP") for rows in state.axes)
    session.writes_counter = lambda what: what in counters or what.startswith(by_hand)
    session.link_filters.append(link.counts)
    session.state_hooks += [state.on_state, motions.on_state]
    state.saw_hooks.append(motions.on_seen)

    motion = ListedMotion(session, state, link, motions)
    return Device(
        session,
        Parts(
            identity=ListedIdentity(session, state, link, tasks),
            registers=ListedParameters(session, state, link, motions),
            raw=Console(session, link, ListedSender(session, state, link, motions)),
            motion=motion,
            configuration=ListedConfiguration(state, motion),
            monitor=ListedMonitor(session, state, link, motions),
            counter=ListedCounter(session, state, link),
            telemetry=ListedTelemetry(session, state, link, motions),
            others=(state, link, motions),
        ),
    )


def limit_rules(device: Device, limits: Sequence[AxisLimits], clock_hz: float) -> Rules:
    """What its parameters or registers mean for soft limits."""
    if device.family.kind == "chip":
        return chips.limit_rules(device, limits, clock_hz)
    state, link, motions = _own(device, ListedState), _own(device, TmclLink), _own(device, ListedMotions)
    return ListedRules(device.session, state, link, motions, limits, clock_hz)


async def start_plan(device: Device, wanted: Sequence[AxisStartUp]) -> StartPlan:
    """None can be made. Raises UsageError."""
    del wanted
    raise UsageError(
        f"what a {device.family.title} needs to move is not known here: set current, speed and acceleration by its "
        f"{'registers' if device.family.kind == 'chip' else 'parameters'}, as its manual says"
    )


def _own(device: Device, kind: type[P]) -> P:
    part = device.part(kind)
    assert part is not None  # it was composed here
    return part


FAMILY = DeviceFamily(NAME, (), compose, limit_rules, start_plan)
"""It has no models of its own: whichever the installed package lists."""
