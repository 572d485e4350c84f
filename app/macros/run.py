"""A macro that runs: a procedure which does one step after the other, each once, until the end, a failure or a stop."""

from __future__ import annotations

import time
from collections.abc import Awaitable, Callable
from dataclasses import dataclass, field
from typing import Literal, Protocol

import numpy as np

from ..clock import Clock
from ..devices.core.device import Device
from ..devices.core.results import AxisState
from ..errors import BenchError
from ..links.queue import SampleDropped
from ..number_text import plain
from ..procedures.procedure import Ended, Failed, Procedure
from ..profiles.apply import Transaction
from .document import (
    ApplyProfile,
    MacroDocument,
    MoveStep,
    RecordStart,
    RecordStop,
    RotateStep,
    Step,
    StopStep,
    WaitChannel,
    WaitPosition,
    WaitStep,
    WriteStep,
)

POLL_S = 0.02
"""How often a waiting step looks [s]."""
STANDS_POLLS = 3
"""So many looks in a row at a motor that stands elsewhere say that it will not arrive."""

RunState = Literal["idle", "running", "done", "failed", "aborted"]


class Aside(Protocol):
    """What steps do that is not the device's own: recordings, profiles."""

    async def record(self, device: Device, step: RecordStart) -> str:
        """Begin to record; what came of it, for people. Raises BenchError."""
        ...

    async def stop_recording(self) -> str:
        """End that recording; what it is, for people. Does nothing, and says "", where none runs. Raises BenchError."""
        ...

    async def apply(self, device: Device, step: ApplyProfile) -> str:
        """Bring a kept profile into the device; what changed, for people. Raises BenchError."""
        ...


@dataclass(frozen=True, slots=True)
class StepDone:
    """A step that is done. number : from 1. came : what came of it, for people"""

    number: int
    text: str
    took_s: float
    came: str


@dataclass(slots=True)
class MacroState:
    """How a run goes, or went. Names as in the REST contract."""

    state: RunState = "idle"
    macro: str = ""
    """Its id; empty for a document that is not kept."""
    revision: int = 0
    name: str = ""
    by: str = ""
    step: int = 0
    """The one under way, or where it ended, from 1; 0 before the first."""
    steps: int = 0
    text: str = ""
    """That step, for people."""
    left_s: float | None = None
    """How long that step takes yet, or may take at most [s]; None where nobody knows."""
    started_unix_s: float | None = None
    took_s: float = 0.0
    message: str = ""
    way_out: str = ""
    done: list[StepDone] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)
    recordings: list[str] = field(default_factory=list)


class MacroRun(Procedure):
    """One macro on one device. `over` is called when all is as it will stay."""

    kind = "macro"

    def __init__(
        self,
        device: Device,
        clock: Clock,
        document: MacroDocument,
        aside: Aside,
        state: MacroState,
        over: Callable[[MacroState], None] = lambda _: None,
    ) -> None:
        axes = document.axes
        super().__init__(device, axes[0] if axes else 0, clock)
        self._axes = frozenset(device.axis(axis).index for axis in axes) or frozenset({self.axis})
        self._document, self._aside, self._ended = document, aside, over
        self._moved: set[int] = set()
        self._way_out = ""
        self._began_s = clock.now()
        self._until_s: float | None = None
        self.told = state
        state.state, state.name, state.steps = "running", document.name, len(document.steps)
        state.started_unix_s = time.time()

    @property
    def state(self) -> MacroState:
        """As it is now."""
        told = self.told
        if told.state == "running":
            told.took_s = self.clock.now() - self._began_s
            told.left_s = None if self._until_s is None else max(0.0, self._until_s - self.clock.now())
        return told

    def is_own(self, by: object) -> bool:
        # There is one transaction of a device at a time, and nobody else begins one while this runs.
        return super().is_own(by) or (isinstance(by, Transaction) and by.device is self.device)

    def concerns(self, axis: int) -> bool:
        return axis in self._axes

    # --- the steps ------------------------------------------------------------------------------

    async def _run(self) -> None:
        told = self.told
        for number, step in enumerate(self._document.steps, 1):
            told.step, told.text, self._until_s = number, step.text, None
            began_s = self.clock.now()
            try:
                self.device.session.require_connected()
                came = await self._do(step)
            except (Failed, BenchError) as error:
                self._way_out = getattr(error, "way_out", "")
                raise Failed(f"step {number} of {told.steps}, {step.text}: {error}") from error
            told.done.append(StepDone(number, step.text, self.clock.now() - began_s, came))
        self._until_s = None

    async def _do(self, step: Step) -> str:
        device = self.device
        match step:
            case WriteStep():
                return await self._write(step)
            case MoveStep():
                self._moved.add(step.axis)
                started = await device.motion.move(step.axis, step.target, step.relative, step.unit)
                self._warn(started.warnings)
                takes = started.predicted_duration_s
                told = "" if takes is None else f", in {plain(takes, 3)} s"
                return f"from {started.from_position} to {started.target_position} microsteps{told}"
            case RotateStep():
                self._moved.add(step.axis)
                rotating = await device.motion.rotate(step.axis, step.velocity, step.unit)
                self._warn(rotating.warnings)
                return f"{plain(rotating.velocity_pps)} pps"
            case StopStep():
                await device.stop(step.axis, step.mode)
                return ""
            case WaitStep():
                await self._wait(step.seconds)
                return ""
            case WaitPosition():
                return await self._arrive(step)
            case WaitChannel():
                return await self._channel(step)
            case RecordStart():
                recording = await self._aside.record(device, step)
                if recording:
                    self.told.recordings.append(recording)
                return recording or "left out on a twin"
            case RecordStop():
                return await self._aside.stop_recording()
            case ApplyProfile():
                return await self._aside.apply(device, step)

    def _warn(self, warnings: list[str]) -> None:
        self.told.warnings += [each for each in warnings if each not in self.told.warnings]

    async def _write(self, step: WriteStep) -> str:
        fields: dict[str, int | str] | None = None if step.fields is None else dict(step.fields)
        written = await self.device.registers.write(step.name, step.axis, step.value, fields)
        if written.verified is False:
            raise Failed(f"it holds {written.value} afterwards")
        return written.note or f"reads back {written.value}"

    async def _wait(self, seconds: float) -> None:
        self._until_s = self.clock.now() + seconds
        while (left_s := self._until_s - self.clock.now()) > 0:
            await self.clock.sleep(min(left_s, POLL_S))
            self.device.session.require_connected()  # a dead link ends it now, not at the next step

    async def _until(self, at_most_s: float, look: Callable[[], Awaitable[str | None]], what: str) -> str:
        """Look until something came of it. Raises Failed when the time is over."""
        self._until_s = self.clock.now() + at_most_s
        while (came := await look()) is None:
            if self.clock.now() >= self._until_s:
                raise Failed(f"not within {plain(at_most_s)} s: {what}")
            await self.clock.sleep(POLL_S)
            self.device.session.require_connected()
        return came

    async def _arrive(self, step: WaitPosition) -> str:
        stood = 0
        where = "nobody has seen where it is"

        async def look() -> str | None:
            nonlocal stood, where
            state = await self.device.monitor.axis_state(step.axis)
            where = _place(state)
            if state.position_reached and not state.moving:
                return f"at {state.position}"
            stood = 0 if state.moving else stood + 1
            if stood >= STANDS_POLLS:
                self._way_out = ""
                raise Failed(f"{where}: a switch or a stall has stopped it, or its ramp lets it not move")
            return None

        return await self._until(step.at_most_s, look, "the motor was not there")

    async def _channel(self, step: WaitChannel) -> str:
        telemetry = self.device.telemetry
        plan = telemetry.sample_plan([step.channel])
        unit = plan.units[0]

        async def look() -> str | None:
            try:
                taken = await telemetry.take_samples(plan)
            except SampleDropped:  # the link was busy: the next look comes soon
                return None
            value = float(plan.decode(np.array(taken.times_s), b"".join(taken.replies))[-1, 0])
            if value > step.value if step.when == "above" else value < step.value:
                return f"{plain(value)} {unit}"
            return None

        return await self._until(step.at_most_s, look, f"{step.channel} was never {step.when} {plain(step.value)}")

    # --- its end --------------------------------------------------------------------------------

    async def _stop(self) -> None:
        """Stop what this macro has moved, all of it at once."""
        if self._moved:
            await self.device.stop_axes(sorted(self._moved))

    def _over(self, how: Ended) -> None:
        told = self.told
        told.state, told.message, told.way_out = how, self.message, self._way_out
        if how == "aborted":
            told.message = f"step {told.step} of {told.steps}, {told.text}: {self.message}"
            told.way_out = f"{len(told.done)} steps are done; what they wrote stays"

    async def _give_back(self) -> None:
        told = self.told
        told.took_s, told.left_s = self.clock.now() - self._began_s, None
        try:
            if self._taken_over:  # on one axis: the others of this macro have nobody who would stop them
                await self._stop_others()
            await self._aside.stop_recording()
        finally:
            self._ended(told)

    async def _stop_others(self) -> None:
        others = sorted(self._moved - {self._taken_axis})
        if others:
            await self.device.stop_axes(others)


def _place(state: AxisState) -> str:
    return f"the motor {'is' if state.moving else 'stands'} at {state.position}, not {state.target_position}"
