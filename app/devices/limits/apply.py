"""Putting limits in force: on a device that is made, and on one whose connection was edited."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING

from ...errors import BenchError
from ..tmc5xxx.driver import Tmc5xxx
from ..tmc428.chip import RampChip
from ..tmc4361.driver import Tmc4361
from ..tmcl.driver import Pd42
from .limiter import Limiter
from .rules import Rules
from .tmc5xxx import SixPointRules
from .tmc428 import RampRules
from .tmc4361 import SRampRules
from .tmcl import ModuleRules
from .watch import RangeWatch

if TYPE_CHECKING:
    from ..core.config import DeviceConfig
    from ..core.device import Device


def apply_limits(device: Device) -> None:
    """Have the limits of `device.config` kept from now on. Where there are none, nothing is looked at any more."""
    before = device.limiter
    if before is not None and before.watch is not None:
        before.watch.end()
    if not any(axis.limits.given for axis in device.config.axes):
        device.limiter = device.queue.gate = None
        return
    limiter = Limiter(_rules(device, device.config))
    if before is not None:
        limiter.adopt(before)
    device.limiter = device.queue.gate = limiter
    if any(axis.limits.ranged for axis in device.config.axes):
        limiter.watch = RangeWatch(device, limiter)


async def learn(device: Device) -> None:
    """Ask a chip that is connected what its limits depend on; what fails here, the next look finds out too."""
    if device.limiter is not None and device.state == "connected":
        with contextlib.suppress(BenchError):
            await device.limiter.rules.learn()


def require_clock(device: Device, config: DeviceConfig) -> None:
    """Raises SoftLimit where, by the clock of `config`, what the chip is set to would come to be beyond its limits."""
    if device.limiter is None or config.clock_hz == device.clock_hz:
        return
    limits = [axis.limits for axis in device.config.axes]
    if [axis.limits for axis in config.axes] != limits:
        return  # new limits: what is beyond them is told, not refused
    device.limiter.require_as(_rules(device, config))


def _rules(device: Device, config: DeviceConfig) -> Rules:
    limits = [axis.limits for axis in config.axes]
    if isinstance(device, RampChip):
        return RampRules(device, limits, config.clock_hz)
    if isinstance(device, Tmc5xxx):
        return SixPointRules(device, limits, config.clock_hz)
    if isinstance(device, Tmc4361):
        return SRampRules(device, limits, config.clock_hz)
    assert isinstance(device, Pd42)
    return ModuleRules(device, limits, config.clock_hz)
