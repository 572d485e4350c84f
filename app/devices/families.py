"""Which driver drives which model."""

from __future__ import annotations

from collections.abc import Callable

from ..clock import Clock
from ..links.port import FramePort
from ..registers.tmc5xxx.table import TABLES as TMC5XXX
from .core.config import DeviceConfig
from .core.device import Device
from .core.start_up import StartPlanner
from .limits.apply import apply_limits
from .tmc5xxx import start_up as tmc5xxx_start
from .tmc5xxx.driver import Tmc5xxx
from .tmc428 import start_up as ramp_start
from .tmc428.tmc428 import Tmc428
from .tmc428.tmc4210 import Tmc4210
from .tmc4361 import start_up as tmc4361_start
from .tmc4361.driver import Tmc4361
from .tmcl import start_up as pd42_start
from .tmcl.driver import Pd42

DRIVERS: dict[str, Callable[[str, DeviceConfig, FramePort, Clock], Device]] = {
    "tmc428": Tmc428,
    "tmc4210": Tmc4210,
    "tmc4361": Tmc4361,
    **dict.fromkeys(TMC5XXX, Tmc5xxx),
    "pd42-1241": Pd42,
}
START_PLANS: dict[str, StartPlanner] = {
    "tmc428": ramp_start.plan,
    "tmc4210": ramp_start.plan,
    "tmc4361": tmc4361_start.plan,
    **dict.fromkeys(TMC5XXX, tmc5xxx_start.plan),
    "pd42-1241": pd42_start.plan,
}
"""How each model is set up after power-on."""


def make_device(device_id: str, config: DeviceConfig, port: FramePort, clock: Clock) -> Device:
    """The driver for `config.model`, which `DeviceConfig` has checked."""
    device = DRIVERS[config.model](device_id, config, port, clock)
    device.driver_of = _driver_of
    apply_limits(device)
    return device


def _driver_of(device: Device, model: str) -> Device:
    """The driver of `model` over the port of `device`. Raises UsageError where that link cannot be its."""
    config = DeviceConfig(name=device.name, model=model, link=device.link)
    return DRIVERS[model](device.id, config, device.port, device.clock)
