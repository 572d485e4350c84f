"""A recording lived through once more, on an emulator: the same configuration, the same commands at the same times.

The emulator is one of its own, behind a link of its own, on a clock of its own that runs as fast as it can: ten
minutes take seconds, and nothing on the bench moves. Its telemetry is recorded like any other's.
"""

from __future__ import annotations

import asyncio
import contextlib
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields
from typing import Any, Literal, cast

from ..clock import VirtualClock
from ..devices.core.capabilities import MicrostepRam, PositionSetting
from ..devices.core.config import AxisSettings, DeviceConfig
from ..devices.core.device import Device
from ..devices.core.results import StopMode
from ..devices.manager import DeviceManager
from ..errors import BenchError, WrongState
from ..links.registry import PortFactory
from ..profiles.apply import Transaction
from ..profiles.document import FORMAT, parse
from ..store.recordings.head import Head
from ..store.recordings.marks import Mark
from ..telemetry.hub import TelemetryHub
from ..telemetry.recorder import Recorder, Sink, Trigger

BEAT_S = 0.05
"""How far time goes on at once [s]: less than a reader's queue holds, more than a beat of the telemetry."""
TOLD_MAX = 40
"""So many of what could not be replayed are told one by one."""
MOVING = ("move", "rotate")
SOON_S = 0.1
"""A start within this time behind a command is that command's [s]."""
JUST_BEFORE_S = 0.05
"""So long after the start some drivers tell of the command, on a busy machine [s]."""
DOING = ("move", "rotate", "stop", "set_position", "write")


@dataclass(frozen=True, slots=True)
class Step:
    """A command or a write. `at_s` counts from the recording's first row, and is negative before it [s]."""

    at_s: float
    axis: int | None
    text: str
    detail: Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class Plan:
    """What a replay does. `zero_s` is where the original's plots have their zero, from its first row on [s]."""

    head: Head
    steps: tuple[Step, ...]
    duration_s: float
    zero_s: float
    left_out: tuple[str, ...]


@dataclass(slots=True)
class Progress:
    """How a replay goes: written by its thread, read by anybody."""

    of: str
    duration_s: float
    commands: int
    recording: str | None = None
    state: Literal["running", "done", "failed"] = "running"
    message: str = ""
    done_s: float = 0.0
    played: int = 0
    left_out: list[str] = field(default_factory=list)
    cancelled: threading.Event = field(default_factory=threading.Event)


def plan_of(head: Head, marks: Sequence[Mark], first_s: float | None, last_s: float | None) -> Plan:
    """What can be done again of a recording, and what cannot. Raises WrongState for one without rows."""
    if first_s is None or last_s is None:
        raise WrongState(f"recording {head.id} has no rows", "there is nothing to replay")
    left_out = []
    steps = []
    writes = [mark for mark in marks if mark.kind == "write"]
    starts: dict[int | None, list[float]] = {}
    for mark in marks:
        if mark.kind == "move":
            starts.setdefault(mark.axis, []).append(mark.time_s)
    zero_s = next((mark.time_s for mark in marks if mark.kind == "trigger"), first_s)
    for mark in marks:
        if mark.kind not in ("command", "write") or mark.time_s > last_s:
            continue
        detail = mark.detail or {}
        at = f"at {mark.time_s - zero_s:.3f} s: {mark.text}"
        if detail.get("do") not in DOING or (detail["do"] == "write" and detail.get("new") is None):
            # A command is often marked by the write that it makes, too; that one says what to do.
            if not detail and any(is_write_of(write, mark) for write in writes):
                continue
            left_out.append(f"{at}: the recording does not say enough to do it again")
        else:
            steps.append(Step(done_s(mark, starts) - first_s, mark.axis, at, detail))
    for number, axis in enumerate(head.axes):
        if axis.get("velocity_pps"):
            left_out.append(f"axis {number} was turning already when the recording began; here it begins at rest")
        if axis.get("position") is None:
            left_out.append(f"where axis {number} was at the start is not known; here it begins at 0")
    if head.configuration is None:
        left_out.append("the configuration at the start was not read: the emulator has its own")
    if head.emulator is None:
        left_out.append("the motor, its load and its switches: those of an emulator with the usual ones")
    steps.sort(key=lambda step: step.at_s)
    return Plan(head, tuple(steps), last_s - first_s, zero_s - first_s, tuple(left_out))


def done_s(command: Mark, starts: Mapping[int | None, Sequence[float]]) -> float:
    """When a command reached the chip [s]: its mark is of a moment before or after, a start is marked exactly.

    `starts` are those of each axis [s].
    """
    if (command.detail or {}).get("do") not in MOVING:
        return command.time_s
    near = (at for at in starts.get(command.axis, ()) if -JUST_BEFORE_S <= at - command.time_s < SOON_S)
    return min(near, key=lambda at: abs(at - command.time_s), default=command.time_s)


def is_write_of(write: Mark, command: Mark) -> bool:
    """Whether `write` tells of the register whose write is marked as a command."""
    return (
        abs(write.time_s - command.time_s) < 0.05
        and str((write.detail or {}).get("register", "")).casefold() == command.text.casefold()
    )


class Replay:
    """One replay. `run` blocks until it is over: it belongs into a thread."""

    def __init__(
        self,
        plan: Plan,
        options: Mapping[str, Any],
        ports: PortFactory,
        begin: Callable[[Device, Recorder], Sink],
        end: Callable[[], None],
    ) -> None:
        """`options` are the emulator's; `begin` makes the recording's files, `end` is called when they are whole."""
        self.progress = Progress(
            plan.head.id, plan.duration_s, len(plan.steps), left_out=list(plan.left_out[:TOLD_MAX])
        )
        self._plan, self._options, self._ports = plan, options, ports
        self._begin, self._end = begin, end
        self._first_s = float("inf")
        """Device time at which the replay's recording begins [s]."""
        self._more_left_out = max(0, len(plan.left_out) - TOLD_MAX)

    def run(self) -> None:
        """Live through it. What goes wrong is in `progress`."""
        try:
            asyncio.run(self._live())
        except (BenchError, OSError) as error:
            self.progress.state, self.progress.message = "failed", str(error)
        except Exception as error:
            self.progress.state, self.progress.message = "failed", f"a mistake of ours: {error!r}"
            raise
        finally:
            if self._more_left_out:
                self.progress.left_out.append(f"and {self._more_left_out} more")
            if self.progress.state == "running":
                self.progress.state = "done"

    async def _live(self) -> None:
        head, clock = self._plan.head, VirtualClock()
        axes = tuple(settings_of(axis.get("settings", {})) for axis in head.axes)
        config = DeviceConfig("replay", head.model, {**self._options, "kind": "emulator"}, head.clock_hz, axes)
        manager = DeviceManager({"emulator": self._ports}, clock)
        hub = TelemetryHub(clock, history_minutes=0.1)
        try:
            device = await manager.add(config)
            if device.problem is not None:
                raise device.problem
            await self._configure(device)
            hub.sync(manager.devices)
            await self._replay(device, hub, clock)
        finally:
            await hub.close()
            closing = asyncio.create_task(manager.close())
            while not closing.done():  # letting go of a device may wait for its motor, on the clock
                await clock.advance(BEAT_S)
            await closing

    async def _configure(self, device: Device) -> None:
        for number, axis in enumerate(self._plan.head.axes):
            setting = device.part(PositionSetting)
            if axis.get("position") and setting is not None:
                with self._told(f"the position of axis {number}"):
                    await setting.set_position(number, int(axis["position"]))
        configuration = self._plan.head.configuration or {}
        if configuration.get("format") == FORMAT:
            with self._told("the configuration at the start"):
                await Transaction(device, parse(configuration)).run()
            return
        for entry in configuration.get("registers", ()):  # of a recording that is older than profiles
            name, axis, value = entry["name"], entry["axis"], entry["value"]
            held = None
            with contextlib.suppress(BenchError):  # write-only registers are written in any case
                held = (await device.registers.read(name, axis)).value
            if held != value:
                with self._told(f"the register {name}"):
                    await device.registers.write(name, axis, value=value)
        table = configuration.get("microstep_table")
        if table:
            with self._told("the microstep table"):
                await device.need(MicrostepRam).write_microstep_table(list(table))

    async def _replay(self, device: Device, hub: TelemetryHub, clock: VirtualClock) -> None:
        plan, progress = self._plan, self.progress
        # What was done while the recording waited for its trigger comes first, and is not recorded here either.
        first_s = device.device_time_s() - min(
            (step.at_s - BEAT_S for step in plan.steps if step.at_s < 0), default=0.0
        )
        self._first_s = first_s
        for step in plan.steps:
            if step.at_s < 0:
                await self._until(device, clock, first_s + step.at_s)
                await self._play(device, step)
        await self._until(device, clock, first_s)
        channels = tuple(column.name for column in plan.head.columns)
        recorder = Recorder(hub, device, channels, plan.head.rate_hz, Trigger(), plan.duration_s, clock)
        over = asyncio.Event()
        recorder.start(self._begin(device, recorder), over.set)
        recorder.mark("trigger", "trigger", None, first_s + plan.zero_s)
        try:
            for step in plan.steps:
                if step.at_s >= 0:
                    await self._until(device, clock, first_s + step.at_s)
                    await self._play(device, step)
            await self._until(device, clock, first_s + plan.duration_s)
            while not over.is_set() and device.device_time_s() < first_s + plan.duration_s + 1:
                await clock.advance(BEAT_S)
        finally:
            await recorder.stop()
            self._end()
        progress.message = recorder.message
        if recorder.state == "failed":
            progress.state = "failed"

    async def _until(self, device: Device, clock: VirtualClock, time_s: float) -> None:
        """Let time go on to device time `time_s` [s]."""
        while (left_s := time_s - device.device_time_s()) > 0:
            if self.progress.cancelled.is_set():
                raise WrongState("the replay was ended", "")
            before_s = device.device_time_s()
            await clock.advance(min(BEAT_S, left_s))
            if device.device_time_s() <= before_s:  # an emulator whose time stands still would never get there
                raise WrongState("the emulator's time stands still", "set its time scale to 1")
            self.progress.done_s = min(self.progress.duration_s, max(0.0, device.device_time_s() - self._first_s))
            await asyncio.sleep(0)

    async def _play(self, device: Device, step: Step) -> None:
        detail, axis = step.detail, step.axis or 0
        with self._told(step.text):
            match detail["do"]:
                case "move":
                    await device.motion.move(axis, detail["target"])
                case "rotate":
                    await device.motion.rotate(axis, detail["velocity"], "chip")
                case "stop":
                    await device.stop(axis, cast("StopMode", detail["mode"]))
                case "set_position":
                    await device.need(PositionSetting).set_position(axis, detail["position"])
                case "write":
                    await device.registers.write(detail["register"], step.axis, value=detail["new"])
        self.progress.played += 1

    @contextlib.contextmanager
    def _told(self, what: str) -> Iterator[None]:
        """What the emulator refuses is told, and the rest goes on."""
        try:
            yield
        except BenchError as error:
            if len(self.progress.left_out) < TOLD_MAX:
                self.progress.left_out.append(f"{what}: {error}")
            else:
                self._more_left_out += 1


def settings_of(kept: Mapping[str, Any]) -> AxisSettings:
    """An axis's settings out of a recording's head. Limits are left: what was refused then is not in the recording."""
    known = {each.name for each in fields(AxisSettings)} - {"limits"}
    return AxisSettings(**{name: value for name, value in kept.items() if name in known})
