"""Every family of drivers, one line each, and the devices that they make."""

from __future__ import annotations

import contextlib
from functools import partial

from ..clock import Clock
from ..errors import BadReply
from ..links.port import FramePort
from ..links.queue import LinkQueue
from ..links.register_access import RegisterAccess
from ..registers.catalog import MODELS
from .core.config import DeviceConfig
from .core.device import Device
from .core.family import DeviceFamily
from .limits import apply
from .limits.apply import apply_limits
from .listed.family import FAMILY as LISTED
from .tmc5xxx.family import FAMILY as TMC5XXX
from .tmc428.family import FAMILY as TMC428
from .tmc4361.family import FAMILY as TMC4361
from .tmcdrivers.family import FAMILY as TMCDRIVERS
from .tmcl.family import FAMILY as TMCL

FAMILIES = (TMC428, TMC4361, TMC5XXX, TMCDRIVERS, TMCL, LISTED)
_BY_NAME = {family.name: family for family in FAMILIES}


def family_of(model: str) -> DeviceFamily:
    """Of a model that `DeviceConfig` has checked."""
    return _BY_NAME[MODELS[model].family]


def make_device(device_id: str, config: DeviceConfig, port: FramePort, clock: Clock) -> Device:
    """The device for `config.model`, which `DeviceConfig` has checked."""
    device = family_of(config.model).compose(device_id, config, port, clock)
    device.driver_of = _driver_of
    device.session.models_found = partial(models_found, device.session.queue)
    limit(device)
    return device


async def models_found(queue: LinkQueue, access: RegisterAccess) -> tuple[str, ...]:
    """Models of the chip that answers, by its own words; empty where none of them is known. Only reads.

    Raises LinkError.
    """
    for family in FAMILIES:
        if family.found_by is not None:
            with contextlib.suppress(BadReply):
                if models := await family.found_by(queue, access):
                    return models
    return ()


def limit(device: Device) -> None:
    """Have the limits of `device.config` kept from now on."""
    apply_limits(device, family_of(device.model).limit_rules)


def require_clock(device: Device, config: DeviceConfig) -> None:
    """Raises SoftLimit where, by the clock of `config`, what the chip is set to would come to be beyond its limits."""
    apply.require_clock(device, config, family_of(device.model).limit_rules)


def _driver_of(device: Device, model: str) -> Device:
    """The driver of `model` over the port of `device`, past what holds that back. Raises UsageError where that link
    cannot be its."""
    session = device.session
    config = DeviceConfig(name=device.name, model=model, link=device.link)
    return family_of(model).compose(device.id, config, session.port, session.clock, session.queue.beside())
