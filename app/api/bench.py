"""What the routes work on: made once by the composition root, found again in the application's state."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from app.api.lease import Lease
from app.api.lease_gate import CallsUnderWay
from app.api.pages import Pages
from app.api.probing import Probing
from app.api.recording_desk import RecordingDesk
from app.api.schemas import Port
from app.api.sessions import Sessions
from app.api.tokens import Tokens
from app.api.vitals import Vitals
from app.clock import BackgroundClock, Clock
from app.conditions.service import ConditionService
from app.devices.manager import DeviceManager
from app.settings import Settings
from app.store.audit import AuditLog
from app.store.database import Database
from app.store.profiles import ProfileStore
from app.store.saver import Saver
from app.telemetry.hub import TelemetryHub
from app.tuning.endless import EndlessService
from app.tuning.procedures import Procedures
from app.tuning.profile_scripts.service import Scripts
from app.tuning.profiles.service import ProfileService
from app.twin.service import Twin


@dataclass(frozen=True, slots=True)
class Bench:
    """The parts behind the edge."""

    settings: Settings
    clock: Clock
    background: BackgroundClock
    manager: DeviceManager
    hub: TelemetryHub
    procedures: Procedures
    endless: EndlessService
    desk: RecordingDesk
    database: Database
    audit: AuditLog
    lease: Lease
    twin: Twin
    profiles: ProfileService
    profile_store: ProfileStore
    conditions: ConditionService
    list_serial_ports: Callable[[], list[Port]]
    saver: Saver
    """Of the connections."""
    position_saver: Saver
    pages: Pages
    vitals: Vitals
    tokens: Tokens
    sessions: Sessions
    probing: Probing = field(default_factory=Probing)
    scripts: Scripts = field(default_factory=Scripts)
    calls: CallsUnderWay = field(default_factory=CallsUnderWay)

    def users_of(self, port: str) -> list[str]:
        """Ids of the devices that are connected, or try to be, through the serial port of that name."""
        return [
            device.id
            for device in self.manager.devices
            if device.link.get("port") == port and device.state != "disconnected"
        ]
