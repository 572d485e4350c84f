"""TMCL modules: what the layer of drivers knows of them, and the parts that a driver of one is composed of."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar

from ...clock import Clock
from ...links.port import FramePort
from ...links.queue import LinkQueue
from ...registers.tmcl.modules import MODULES
from ..core.axis_limits import AxisLimits
from ..core.background_tasks import BackgroundTasks
from ..core.config import DeviceConfig
from ..core.device import Device, Parts
from ..core.family import DeviceFamily
from ..core.session import Session
from ..core.tmcl_console import Console
from ..core.tmcl_link import TmclLink
from .arrivals import Arrivals
from .borrowed import BorrowedAcceleration
from .configuration import ModuleConfiguration
from .console import ModuleSender
from .counter import ModuleCounter, TickTimer, counter_writes
from .departure import Departure
from .download_mode import download_hold
from .encoder import ModuleEncoders
from .identity import ModuleIdentity
from .limits import ModuleRules
from .monitor import ModuleMonitor
from .motion import ModuleMotion
from .moving_writes import MovingWrites
from .ongoing import OngoingMotion
from .parameters import Parameters
from .polling import Poller
from .position import ModulePosition
from .program import ProgramStore
from .records import Records
from .samples import ModuleTelemetry
from .searches import Searches
from .stall import ModuleStall
from .start_up import plan
from .state import ModuleState
from .stops import Stops
from .store import Eeprom

P = TypeVar("P")


def compose(
    device_id: str, config: DeviceConfig, port: FramePort, clock: Clock, queue: LinkQueue | None = None
) -> Device:
    """A device of this family. What a part needs is made above it; what it tells another goes by a hook."""
    session = Session(device_id, config, port, clock, queue=queue)
    tasks = BackgroundTasks()
    state = ModuleState(session)
    link = TmclLink(session, state, tasks)
    download = download_hold(session, link.address)
    records = Records(session, state)
    ongoing = OngoingMotion(session, state)
    poller = Poller(session, state, link, ongoing, tasks)
    arrivals = Arrivals(session, link, ongoing, poller, tasks)
    ticks = TickTimer(session, state)
    borrowed = BorrowedAcceleration(session, state, link, records, tasks)
    departure = Departure(session, state, link, ongoing, borrowed)
    stops = Stops(session, state, link, download, ongoing, borrowed)
    moving = MovingWrites(session, state, link, records, ongoing, borrowed)
    parameters = Parameters(session, state, link, records, moving)
    console = Console(session, link, ModuleSender(session, state, link, download, records, ongoing, moving))

    session.writes_counter = counter_writes(state.roles)
    session.link_filters.append(link.counts)
    session.state_hooks += [state.on_state, ongoing.on_state, arrivals.on_state]
    session.listen(ongoing.on_event)
    state.saw_hooks.append(ongoing.on_seen)
    ongoing.began_hooks.append(poller.begin)
    if queue is None:  # another way goes past what holds the connection's own back
        session.queue.holds = (download,)

    identity = ModuleIdentity(session, state, link, download, tasks, borrowed.give_back_at_rest)

    return Device(
        session,
        Parts(
            identity=identity,
            registers=parameters,
            raw=console,
            motion=ModuleMotion(session, state, link, ongoing, departure, stops, arrivals),
            monitor=ModuleMonitor(session, state, link, ongoing, ticks),
            counter=ModuleCounter(session, state, link, ticks),
            telemetry=ModuleTelemetry(session, state, link, ongoing),
            configuration=ModuleConfiguration(session, state, parameters, borrowed, stops),
            others=(
                tasks,
                state,
                link,
                ongoing,
                arrivals,
                Eeprom(session, state, link, records),
                ProgramStore(session, state, link, download, ongoing, console, moving, identity.refresh),
                ModuleEncoders(session, state),
                ModulePosition(session, state, link, ongoing),
                Searches(session, state, link, ongoing, departure),
                ModuleStall(session, state, parameters),
            ),
        ),
    )


def limit_rules(device: Device, limits: Sequence[AxisLimits], clock_hz: float) -> ModuleRules:
    """What its registers mean for soft limits."""
    state, link, ongoing = _own(device, ModuleState), _own(device, TmclLink), _own(device, OngoingMotion)
    return ModuleRules(device.session, state, link, ongoing, limits, clock_hz)


def _own(device: Device, kind: type[P]) -> P:
    part = device.part(kind)
    assert part is not None  # it was composed here
    return part


FAMILY = DeviceFamily("tmcl", tuple(MODULES), compose, limit_rules, plan)
