"""What the routes work on: made once by the composition root, found again in the application's state."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from app.api.schemas import Port
from app.clock import Clock
from app.devices.manager import DeviceManager
from app.settings import Settings
from app.telemetry.hub import TelemetryHub
from app.tuning.procedures import Procedures


@dataclass(frozen=True, slots=True)
class Bench:
    """The parts behind the edge."""

    settings: Settings
    clock: Clock
    manager: DeviceManager
    hub: TelemetryHub
    procedures: Procedures
    list_serial_ports: Callable[[], list[Port]]
