"""What a family of chips or modules is to the layer of drivers."""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Sequence
from dataclasses import dataclass
from typing import Protocol, TypeAlias

from ...clock import Clock
from ...links.port import FramePort
from ...links.queue import LinkQueue
from ...links.register_access import RegisterAccess
from .axis_limits import AxisLimits
from .config import DeviceConfig
from .device import Device
from .limit_rules.rules import Rules
from .start_up import StartPlanner

LimitRules: TypeAlias = Callable[[Device, Sequence[AxisLimits], float], Rules]
"""What a family's registers mean for soft limits: of a device, the limits of its axes and a clock [Hz]."""
FoundBy: TypeAlias = Callable[[LinkQueue, RegisterAccess], Awaitable[tuple[str, ...]]]
"""Models of a family that answer where another chip was expected; empty where none does. Raises LinkError, BadReply."""
FullScale: TypeAlias = Callable[[str, AxisLimits], float | None]
"""RMS of a coil at the greatest current scale of a model [A], by whichever figure of the limits tells it; None where
none does. A setting that lessens it (vsense, a scaler, a range) is at its most."""


def as_told(model: str, limits: AxisLimits) -> float | None:
    """Full scale where nothing but that figure tells it."""
    del model
    return limits.current_full_scale_a


class Compose(Protocol):
    """Makes a device of the family's parts; over `queue` where it is not the connection's own."""

    def __call__(
        self, device_id: str, config: DeviceConfig, port: FramePort, clock: Clock, queue: LinkQueue | None = None
    ) -> Device: ...


@dataclass(frozen=True, slots=True)
class DeviceFamily:
    """One family's drivers.

    models : by name, as in the catalog. limit_rules : what registers mean for soft limits
    start_plan : how a device is set up after power-on. found_by : how it is known where another family was expected
    full_scale_a : what its current scales are in A
    """

    name: str
    models: tuple[str, ...]
    compose: Compose
    limit_rules: LimitRules
    start_plan: StartPlanner
    found_by: FoundBy | None = None
    full_scale_a: FullScale = as_told
