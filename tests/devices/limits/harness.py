"""A harness for any model with soft limits, on which every frame is noted that reaches the emulated chip."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass, replace
from typing import cast

from app.clock import Clock, VirtualClock
from app.devices.core.axis_limits import AxisLimits
from app.devices.core.config import AxisSettings, DeviceConfig
from app.devices.core.device import Device
from app.devices.core.events import DeviceEvent, LimitReached
from app.devices.manager import DeviceChange, DeviceManager
from app.emulators.build import build_emulator, options_of
from app.links.emulator import EmulatorPort
from app.links.port import FramePort, Wire
from app.links.registry import Link
from app.registers.catalog import MODELS

ALL_MODELS = tuple(MODELS)
LIMITS = AxisLimits(
    position_min=-20_000,
    position_max=30_000,
    velocity_max_pps=20_000.0,
    acceleration_max_pps2=150_000.0,
    current_max_a=0.7,
    sense_resistor_ohm=0.15,
    current_full_scale_a=1.6,
)


def limits_of(model: str, limits: AxisLimits = LIMITS) -> AxisLimits:
    """`limits` as far as `model` can keep them."""
    if not MODELS[model].counts_position:  # nor has it a ramp
        limits = replace(limits, position_min=None, position_max=None, acceleration_max_pps2=None)
        if MODELS[model].current_scale == "full_scale":
            return replace(limits, sense_resistor_ohm=None, current_max_a=0.4)
        return replace(limits, current_full_scale_a=None)
    if model == "tmc4210":
        return replace(limits, current_max_a=None)
    if model == "tmc5160" and limits is LIMITS:
        limits = replace(limits, current_max_a=0.15)  # whatever GLOBAL_SCALER was left at, it can be passed
    if model == "tmc5240":
        limits = replace(limits, sense_resistor_ohm=None)
        return replace(limits, current_max_a=0.55) if limits.current_max_a == 0.7 else limits  # as after a reset it has
    return replace(limits, current_full_scale_a=None) if model.startswith("tmc5") else limits


class Overheard(EmulatorPort):
    """An emulator's port that remembers what reached the chip."""

    def __init__(self, wire: Wire) -> None:
        super().__init__(wire)
        self.frames: list[bytes] = []

    def _answer(self, frame: bytes, at_s: float) -> bytes:
        self.frames.append(frame)
        return super()._answer(frame, at_s)


def emulator_port(model: str, link: Link, clock: Clock) -> FramePort:
    options = options_of(model).model_validate({key: value for key, value in link.items() if key != "kind"})
    return Overheard(build_emulator(model, clock, options))


@dataclass
class Bench:
    """One device, connected, and everything around it."""

    clock: VirtualClock
    manager: DeviceManager
    told: list[DeviceEvent]

    @property
    def device(self) -> Device:
        return self.manager.devices[0]

    @property
    def port(self) -> Overheard:
        return cast("Overheard", self.device.session.port)

    @property
    def reached(self) -> list[LimitReached]:
        """Every time that the watch has stopped an axis."""
        return [event for event in self.told if isinstance(event, LimitReached)]

    async def limit(self, limits: AxisLimits | None, axes: int | None = None) -> None:
        """Give the first `axes` axes (None: all) these limits."""
        settings = [
            replace(axis, limits=AxisLimits() if limits is None or (axes is not None and index >= axes) else limits)
            for index, axis in enumerate(self.device.config.axes)
        ]
        await self.manager.edit(self.device.id, DeviceChange(axes=tuple(settings)))

    async def farthest(self, seconds: float, axis: int = 0, step_s: float = 0.02) -> tuple[int, int]:
        """Let time pass; the least and the greatest position on the way."""
        seen = []
        for _ in range(round(seconds / step_s)):
            await self.clock.advance(step_s)
            seen.append((await self.device.monitor.axis_state(axis)).position)
        return min(seen), max(seen)


@asynccontextmanager
async def bench(model: str, limits: AxisLimits | None = None, **options: object) -> AsyncIterator[Bench]:
    """A connected device as after power-on; with `limits` all of its axes have them from the start."""
    clock = VirtualClock()
    manager = DeviceManager({"emulator": emulator_port}, clock)
    axes = tuple(AxisSettings(limits=limits or AxisLimits()) for _ in range(MODELS[model].axes))
    device = await manager.add(DeviceConfig("Bench", model, {"kind": "emulator", **options}, axes=axes))
    assert device.state == "connected", device.problem
    told: list[DeviceEvent] = []
    device.listen(told.append)
    try:
        yield Bench(clock, manager, told)
    finally:
        await manager.close()
