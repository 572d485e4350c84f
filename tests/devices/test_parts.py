"""The shape of every driver: parts with few ancestors and few methods, each with the capabilities that it inherits."""

from __future__ import annotations

import importlib
import inspect
import pkgutil
from collections.abc import Iterator

import app.devices
from app.devices.core.capabilities import EventLog
from app.devices.core.device import Device, Parts

from .limits.harness import bench

METHODS_MAX, ANCESTORS_MAX = 30, 2


def classes_of_drivers() -> Iterator[type]:
    for module in pkgutil.walk_packages(app.devices.__path__, "app.devices."):
        for kind in vars(importlib.import_module(module.name)).values():
            if inspect.isclass(kind) and kind.__module__ == module.name:
                yield kind


def public_methods(kind: type) -> list[str]:
    return [
        name
        for name, value in inspect.getmembers_static(kind)
        if not name.startswith("_") and (inspect.isroutine(value) or isinstance(value, property))
    ]


def test_classes_of_drivers_have_few_ancestors_and_few_methods() -> None:
    kinds = list(classes_of_drivers())
    ancestors = {kind: [base for base in kind.__mro__[1:] if base.__module__.startswith("app.")] for kind in kinds}
    assert max(map(len, ancestors.values())) > 0, "the count sees nobody's ancestors"
    assert [kind for kind, ours in ancestors.items() if len(ours) > ANCESTORS_MAX] == []
    assert len(public_methods(Device)) > 15, "the count sees nobody's methods"
    assert [kind for kind in kinds if len(public_methods(kind)) > METHODS_MAX] == []


class Chronicle:
    """A part with a field that happens to be called as the method of a capability."""

    def __init__(self) -> None:
        self.events: list[str] = []


async def test_a_part_has_no_capability_by_the_name_of_a_field() -> None:
    chronicle = Chronicle()
    async with bench("tmc4210") as made:
        composed = made.device
        device = Device(
            composed.session,
            Parts(
                composed.identity,
                composed.registers,
                composed.raw,
                composed.motion,
                composed.monitor,
                composed.counter,
                composed.telemetry,
                composed.configuration,
                others=(chronicle,),
            ),
        )
        assert device.part(EventLog) is None
        assert device.part(Chronicle) is chronicle
