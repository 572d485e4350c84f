"""An emulated device that nothing but a script's frames has touched, behind our own driver."""

from __future__ import annotations

from collections.abc import AsyncIterator, Mapping, Sequence
from contextlib import asynccontextmanager

from ...clock import Clock, WallClock
from ...devices.core.config import AxisSettings, DeviceConfig
from ...devices.core.device import Device
from ...devices.manager import DeviceManager
from ...emulators.build import build_emulator, options_of
from ...links.emulator import EmulatorPort
from ...links.port import FramePort
from ...links.registry import Link

NAME = "trial"


def emulator_link(model: str, clock_hz: float) -> Mapping[str, object]:
    """The `link` of an emulated `model` at that clock; a module has the one clock that it has."""
    return {"kind": "emulator", **({"clock_hz": clock_hz} if "clock_hz" in options_of(model).model_fields else {})}


@asynccontextmanager
async def emulated(
    model: str, clock_hz: float, axes: Sequence[AxisSettings] = (), clock: Clock | None = None
) -> AsyncIterator[Device]:
    """A device that was switched on a moment ago, connected. In this process, without a socket.

    `axes` are settings of its axes, soft limits among them; it lives by `clock`, None: by the time of day.
    """
    manager = DeviceManager({"emulator": _port}, clock or WallClock())
    try:
        link = dict(emulator_link(model, clock_hz))
        yield await manager.add(DeviceConfig(NAME, model, link, clock_hz, tuple(axes)))
    finally:
        await manager.close()


def _port(model: str, link: Link, clock: Clock) -> FramePort:
    options = {name: value for name, value in link.items() if name != "kind"}
    return EmulatorPort(build_emulator(model, clock, options_of(model).model_validate(options)))
