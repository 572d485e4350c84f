"""A macro tried on an emulated twin: a device of the same model, set as the real one is, that nothing hangs on.

The twin is made of what is known over the wire: the device's registers as a profile, its clock, the settings of its
axes with their soft limits, and where each axis is. Its motors are an emulator's usual ones, without a load: a twin
shows what is written, where it goes and which limit is in the way, and nothing of torque.
"""

from __future__ import annotations

import asyncio
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

from ..clock import Clock, VirtualClock
from ..devices.core.capabilities import PositionSetting
from ..devices.core.changes import RegisterChanged
from ..devices.core.config import AxisSettings
from ..devices.core.device import Device
from ..devices.core.events import DeviceEvent, LimitReached
from ..errors import BenchError, UnknownThing
from ..profiles.apply import Transaction
from ..profiles.document import ProfileDocument, parse
from ..profiles.scripts.emulated_device import emulated
from .document import ApplyProfile, MacroDocument, RecordStart
from .run import MacroRun, MacroState

BEAT_S = 0.02
LONGEST_S = 4000.0
"""A macro that takes longer is not tried to its end [s of the twin's own clock]."""
WRITES_TOLD = 200


@dataclass(frozen=True, slots=True)
class TrialJob:
    """All that a trial needs to know. It can be pickled.

    positions : of each axis [microsteps]; profiles : documents of the kept ones that it applies, by number
    """

    model: str
    clock_hz: float
    axes: tuple[AxisSettings, ...]
    positions: tuple[int, ...]
    setting: Mapping[str, Any]
    macro: Mapping[str, Any]
    profiles: Mapping[int, Mapping[str, Any]]


@dataclass(slots=True)
class AxisTrial:
    """What an axis of the twin did. Positions in microsteps."""

    axis: int
    start: int
    end: int
    least: int
    greatest: int
    top_speed_pps: float = 0.0
    moving: bool = False
    """Whether it still turns at the macro's end."""


@dataclass(frozen=True, slots=True)
class TrialWrite:
    """A register that was written on the twin; `old` is None where nobody knows."""

    name: str
    axis: int | None
    old: int | None
    new: int | None


@dataclass(slots=True)
class TrialResult:
    """What came of a trial. passed : the macro came to its end. Names as in the REST contract."""

    passed: bool = False
    run: dict[str, Any] = field(default_factory=lambda: asdict(MacroState()))
    axes: list[AxisTrial] = field(default_factory=list)
    writes: list[TrialWrite] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)
    why_not: str = ""
    """Why it could not be tried at all; empty where it was."""


def run_trial(job: TrialJob) -> TrialResult:
    """Try it; what cannot be tried is told in the answer. Blocks, for a fraction of the time that the macro takes."""
    try:
        return asyncio.run(_lived(job))
    except BenchError as error:
        return TrialResult(why_not=str(error))


async def _lived(job: TrialJob) -> TrialResult:
    clock = VirtualClock()
    work = asyncio.create_task(_tried(job, clock))
    while not work.done():
        if clock.now() > LONGEST_S:
            work.cancel()
        await clock.advance(BEAT_S)
    try:
        return await work
    except asyncio.CancelledError:
        return TrialResult(why_not=f"it takes more than {LONGEST_S:g} s")


async def _tried(job: TrialJob, clock: Clock) -> TrialResult:
    document, result = MacroDocument.model_validate(job.macro), TrialResult()
    async with emulated(job.model, job.clock_hz, job.axes, clock) as twin:
        if twin.problem is not None:
            raise twin.problem
        await _place(twin, job, result)
        await Transaction(twin, parse(dict(job.setting))).run()
        for axis in twin.axes:
            at = (await twin.monitor.axis_state(axis.index)).position
            result.axes.append(AxisTrial(axis.index, at, at, at, at))
        unlisten = twin.listen(lambda event: _hear(event, result))
        run = MacroRun(twin, clock, document, _TwinAside(job.profiles), MacroState())
        run.start()
        try:
            while run.running:
                await _look(twin, result)
                await clock.sleep(BEAT_S)
            await run.wait()
            await _look(twin, result)
        finally:
            unlisten()
        result.run = asdict(run.state)
        result.passed = run.state.state == "done"
        result.warnings += [each for each in run.state.warnings if each not in result.warnings]
        for seen in result.axes:
            if result.passed and seen.moving:
                result.warnings.append(f"axis {seen.axis} still turns at the end: add a stop, or a wait")
            result.warnings += twin.limit_warnings(seen.axis)
            await twin.stop(seen.axis)
    return result


async def _place(twin: Device, job: TrialJob, result: TrialResult) -> None:
    setting = twin.part(PositionSetting)
    for axis, position in enumerate(job.positions):
        if position and setting is not None:
            await setting.set_position(axis, position)
        elif position:
            result.warnings.append(f"axis {axis} began at 0 on the twin, not at {position}")


async def _look(twin: Device, result: TrialResult) -> None:
    for seen in result.axes:
        state = await twin.monitor.axis_state(seen.axis)
        seen.end, seen.moving = state.position, state.moving
        seen.least, seen.greatest = min(seen.least, state.position), max(seen.greatest, state.position)
        seen.top_speed_pps = max(seen.top_speed_pps, abs(state.velocity_pps))


def _hear(event: DeviceEvent, result: TrialResult) -> None:
    if isinstance(event, RegisterChanged) and len(result.writes) < WRITES_TOLD:
        result.writes.append(TrialWrite(event.register, event.axis, event.old, event.new))
    elif isinstance(event, LimitReached):
        result.warnings.append(
            f"axis {event.axis} was stopped at {event.position}: its {event.name} is {event.limit} microsteps"
        )


class _TwinAside:
    """Recordings are left out on a twin; profiles are applied as documents."""

    def __init__(self, profiles: Mapping[int, Mapping[str, Any]]) -> None:
        self._profiles = profiles

    async def record(self, device: Device, step: RecordStart) -> str:
        device.telemetry.sample_plan(step.channels)
        return ""

    async def stop_recording(self) -> str:
        return ""

    async def apply(self, device: Device, step: ApplyProfile) -> str:
        document = self._profiles.get(step.profile)
        if document is None:
            raise UnknownThing("profile", str(step.profile))
        profile: ProfileDocument = parse(dict(document))
        applied = await Transaction(device, profile).run()
        return f"{len(applied.written)} registers were written"
