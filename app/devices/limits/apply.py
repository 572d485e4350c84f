"""Putting limits in force: on a device that is made, and on one whose connection was edited."""

from __future__ import annotations

import contextlib

from ...errors import BenchError
from ..core.config import DeviceConfig
from ..core.device import Device
from ..core.family import LimitRules
from ..core.limit_rules.rules import Rules
from .limiter import Limiter
from .watch import RangeWatch


def apply_limits(device: Device, rules_of: LimitRules) -> None:
    """Have the limits of `device.config` kept from now on. Where there are none, nothing is looked at any more."""
    session, before = device.session, limiter_of(device)
    if before is not None:
        before.end_watch()
    if not any(axis.limits.given for axis in device.config.axes):
        session.limiter = session.queue.gate = None
        return
    limiter = Limiter(_rules(device, device.config, rules_of))
    if before is not None:
        limiter.adopt(before)
    session.limiter = session.queue.gate = limiter
    if any(axis.limits.ranged for axis in device.config.axes):
        limiter.end_watch = RangeWatch(device, limiter).end


def limiter_of(device: Device) -> Limiter | None:
    """What keeps the limits of a device; None where it has none."""
    limiter = device.limiter
    assert limiter is None or isinstance(limiter, Limiter)  # nobody else makes one
    return limiter


async def learn(device: Device) -> None:
    """Ask a chip that is connected what its limits depend on; what fails here, the next look finds out too."""
    if device.limiter is not None and device.state == "connected":
        with contextlib.suppress(BenchError):
            await device.limiter.learn()


def require_clock(device: Device, config: DeviceConfig, rules_of: LimitRules) -> None:
    """Raises SoftLimit where, by the clock of `config`, what the chip is set to would come to be beyond its limits."""
    limiter = limiter_of(device)
    if limiter is None or config.clock_hz == device.clock_hz:
        return
    limits = [axis.limits for axis in device.config.axes]
    if [axis.limits for axis in config.axes] != limits:
        return  # new limits: what is beyond them is told, not refused
    limiter.require_as(_rules(device, config, rules_of))


def _rules(device: Device, config: DeviceConfig, rules_of: LimitRules) -> Rules:
    return rules_of(device, [axis.limits for axis in config.axes], config.clock_hz)
