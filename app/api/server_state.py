"""What the routes work on: made once by the composition root, found again in the application's state."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from dataclasses import dataclass, field

from ..clock import BackgroundClock, Clock
from ..conditions.service import ConditionService
from ..devices.manager import DeviceManager
from ..emulators.wiring import EmulatorWiring
from ..kernels import Progress
from ..lease.calls import CallsUnderWay
from ..lease.lease import Lease
from ..macros.service import MacroService
from ..positions import ExtendedPositionService
from ..procedures.procedures import Procedures
from ..profiles.scripts.service import Scripts
from ..profiles.service import ProfileService
from ..profiles.undo import UndoService
from ..recording.service import RecordingService
from ..settings import Settings
from ..store.audit import AuditLog
from ..store.database import Database
from ..store.layouts import LayoutStore
from ..store.macros import MacroStore
from ..store.motors import OwnMotors
from ..store.profiles import ProfileStore
from ..store.saver import Saver
from ..studies.service import StudyService
from ..telemetry.hub import TelemetryHub
from ..twin.service import Twin
from .access.tokens import Tokens
from .conditions.pages import Pages
from .health.vitals import Vitals
from .http.sessions import Sessions
from .links.probing import Probing
from .programs.watch import ProgramWatch
from .register_maps.shelf import MapShelf
from .schemas import Port


@dataclass(frozen=True, slots=True)
class ServerState:
    """The parts behind the edge."""

    settings: Settings
    clock: Clock
    background: BackgroundClock
    manager: DeviceManager
    hub: TelemetryHub
    procedures: Procedures
    positions: ExtendedPositionService
    recordings: RecordingService
    database: Database
    audit: AuditLog
    lease: Lease
    twin: Twin
    profiles: ProfileService
    undo: UndoService
    profile_store: ProfileStore
    conditions: ConditionService
    list_serial_ports: Callable[[], list[Port]]
    saver: Saver
    """Of the connections."""
    position_saver: Saver
    pages: Pages
    vitals: Vitals
    kernels: Progress
    """Of what a first start compiles."""
    compiled: Callable[[], Awaitable[bool]]
    """Whether emulators are as fast as they get; waits while they are taken from disk."""
    tokens: Tokens
    sessions: Sessions
    maps: MapShelf
    motors: OwnMotors
    layouts: LayoutStore
    wiring: EmulatorWiring
    studies: StudyService
    macro_store: MacroStore
    macros: MacroService
    probing: Probing = field(default_factory=Probing)
    scripts: Scripts = field(default_factory=Scripts)
    calls: CallsUnderWay = field(default_factory=CallsUnderWay)
    programs: ProgramWatch = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "programs", ProgramWatch(self.background, self.procedures))

    def users_of(self, port: str) -> list[str]:
        """Ids of the devices that are connected, or try to be, through the serial port of that name."""
        return [
            device.id
            for device in self.manager.devices
            if device.link.get("port") == port and device.state != "disconnected"
        ]
