"""A program tried on an emulated device of its own, which is set as the real one is: nothing on the bench moves.

It lives on a clock of its own that runs as fast as it can, and is gone afterwards.
"""

from __future__ import annotations

import asyncio
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal, cast

from ..calc.tmcl.instructions import Command
from ..clock import Clock, VirtualClock
from ..devices.core.capabilities import ProgramMemory
from ..devices.core.config import DeviceConfig
from ..devices.core.device import Device
from ..devices.core.results import ProgramState
from ..devices.manager import DeviceManager
from ..emulators.build import build_emulator, options_of
from ..emulators.core.family import Emulator
from ..emulators.core.ground_truth import ProgramGroundTruth
from ..links.emulator import EmulatorPort
from ..links.port import FramePort
from ..links.registry import Link
from ..profiles.apply import Transaction
from ..profiles.document import ProfileDocument

BEAT_S = 0.02
"""From one row of the outcome to the next [s]."""
DURATION_MAX_S = 60.0
WORK_MAX_S = 5.0
"""How long a trial may take of the processor [s]."""
VARIABLES = tuple(range(64))
"""Those that are looked at."""


@dataclass(slots=True)
class Outcome:
    """How it went. `ended`: by itself, or when its time or its share of the processor was over."""

    ended: Literal["stopped", "time", "work"] = "time"
    state: ProgramState | None = None
    ground_truth: ProgramGroundTruth | None = None
    time_s: list[float] = field(default_factory=list)
    """From the start of the program [s]."""
    position: list[int] = field(default_factory=list)
    velocity_pps: list[float] = field(default_factory=list)
    counter: list[int] = field(default_factory=list)


class Trial:
    """One program, on an emulator set as `document` says. `run` blocks until it is over: it belongs into a thread."""

    def __init__(
        self,
        device: Device,
        document: ProfileDocument,
        commands: Sequence[Command],
        address: int,
        duration_s: float,
    ) -> None:
        """`device` is only asked how it is connected, and what its axes are."""
        known = options_of(device.model).model_fields
        options = {name: value for name, value in device.link.items() if name in known and device.session.emulated}
        axes = tuple(axis.settings for axis in device.axes)
        link = {**options, "kind": "emulator", "time_scale": 1.0}
        self._config = DeviceConfig("trial", device.model, link, device.session.clock_hz, axes)
        self._document, self._commands = document, tuple(commands)
        self._address, self._duration_s = address, duration_s

    def run(self) -> Outcome:
        """Raises BenchError: what the emulated device refuses, the real one would refuse too."""
        return asyncio.run(self._live())

    async def _live(self) -> Outcome:
        clock = VirtualClock()
        manager = DeviceManager({"emulator": _port}, clock)
        try:
            device = await manager.add(self._config)
            if device.problem is not None:
                raise device.problem
            await Transaction(device, self._document).run()
            return await self._follow(device, clock)
        finally:
            closing = asyncio.create_task(manager.close())
            while not closing.done():  # letting go of a device may wait for its motor, on the clock
                await clock.advance(BEAT_S)
            await closing

    async def _follow(self, device: Device, clock: VirtualClock) -> Outcome:
        program, made = device.need(ProgramMemory), Outcome()
        await program.download(self._commands)
        began_s, work_s = device.device_time_s(), time.thread_time()
        await program.run_program(self._address)
        while True:
            state = await program.program_state()
            axis = await device.monitor.axis_state(0)
            at_s = device.device_time_s() - began_s
            made.time_s.append(round(at_s, 6))
            made.position.append(axis.position)
            made.velocity_pps.append(axis.velocity_pps)
            made.counter.append(state.counter)
            if state.status == "stopped" and not axis.moving:
                made.ended = "stopped"
            elif time.thread_time() - work_s > WORK_MAX_S:
                made.ended = "work"
            elif at_s < self._duration_s:
                await clock.advance(BEAT_S)
                continue
            made.state = await program.program_state(VARIABLES)
            port = device.session.port
            assert isinstance(port, EmulatorPort)
            made.ground_truth = cast("Emulator", port.wire).ground_truth(0, port.last_exchange_s).program
            return made


def _port(model: str, link: Link, clock: Clock) -> FramePort:
    options = {name: value for name, value in link.items() if name != "kind"}
    return EmulatorPort(build_emulator(model, clock, options_of(model).model_validate(options)))
