"""Step response and disturbance: what the encoder does while the command jumps or a load comes, recorded and scored."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from typing import Literal

import numpy as np

from ..calc.signals.step_response import Score, score
from ..clock import Clock
from ..devices.core.capabilities import VelocityJumps
from ..devices.core.device import Device
from ..errors import BenchError, OutOfRange, WrongState
from ..telemetry.sampling import Sampling
from .closed_loop import FloatArray, Load, Recording, ResponseState
from .procedure import POLL_S, Failed, Procedure

COLUMNS = (
    "target_position",
    "position",
    "encoder_position",
    "deviation",
    "velocity",
    "encoder_velocity",
    "load_angle",
)
"""Channels, in the order of `Recording`'s columns after `time_s`; what a chip does not have of the last two is NaN."""
Shape = Literal["ramp", "step"]


@dataclass(frozen=True, slots=True)
class Window:
    """What is recorded, before and after [s], and how near the encoder has to stay to count as settled [microsteps]."""

    seconds: float = 1.0
    before_s: float = 0.05
    rate_hz: float = 1000.0
    band: float = 50.0


USUAL_WINDOW = Window()


class Response(Procedure):
    """Records before and after something happens to an axis that stands."""

    def __init__(self, device: Device, axis: int, clock: Clock, window: Window) -> None:
        super().__init__(device, axis, clock)
        for name, value, low, high in (
            ("seconds", window.seconds, 0.05, 30.0),
            ("before_s", window.before_s, 0.0, 5.0),
            ("rate_hz", window.rate_hz, 10.0, 1000.0),
            ("band", window.band, 1e-9, 1e6),
        ):
            if not low <= value <= high:
                raise OutOfRange(name, value, low, high)
        self._window = window
        self._whole_s = window.before_s + window.seconds
        self._phase = "record"
        self._progress = 0.0
        self._started_at_s: float | None = None
        self._recording: Recording | None = None
        self._score: Score | None = None
        self._sampling: Sampling | None = None
        self._times_s: list[FloatArray] = []
        self._samples: list[FloatArray] = []
        self._failure: BenchError | None = None

    @property
    def state(self) -> ResponseState:
        progress = 1.0 if self._how == "done" else self._progress
        return ResponseState(
            self._how, self._phase, progress, self.message, self._started_at_s, self._recording, self._score
        )

    async def _run(self) -> None:
        axis = await self.device.monitor.axis_state(self.axis)
        if axis.moving:
            raise WrongState(f"axis {self.axis} moves", "stop it first")
        there = {channel.quantity for channel in self.device.telemetry.channels() if channel.axis == self.axis}
        names = [f"{quantity}.{self.axis}" for quantity in COLUMNS if quantity in there]
        self._sampling = Sampling(self.device, names, self._window.rate_hz, self.clock, self._failed)
        await self._record(self._window.before_s, 0.0)
        self._started_at_s = await self._act()
        await self._follow(self._started_at_s)
        self._end_sampling()
        self._phase = "score"
        self._make_recording(self._started_at_s)
        self._phase = "done"

    async def _record(self, seconds: float, from_progress: float) -> None:
        """Let samples come for so much device time."""
        device = self.device
        began_s = device.device_time_s()
        while (passed_s := device.device_time_s() - began_s) < seconds:
            await self.clock.sleep(POLL_S)
            self._take()
            self._progress = min(1.0, from_progress + passed_s / self._whole_s)

    def _take(self) -> None:
        assert self._sampling is not None
        port = self.device.session.sampling_port
        if port is not None:
            port.run_due_samples()
        block = self._sampling.take()
        if len(block.time_s):
            self._times_s.append(block.time_s)
            self._samples.append(block.samples)
        if self._failure is not None:
            raise self._failure

    def _failed(self, error: BenchError) -> None:
        self._failure = error

    def _end_sampling(self) -> None:
        if self._sampling is not None:
            self._sampling.end()

    def _make_recording(self, started_at_s: float) -> None:
        if not self._times_s:
            raise Failed("not one sample came")
        columns = np.concatenate(self._samples).T
        time_s = np.concatenate(self._times_s) - started_at_s
        columns = np.concatenate((columns, np.full((len(COLUMNS) - len(columns), len(time_s)), np.nan)))
        target, commanded, encoder, deviation, velocity, encoder_velocity, load_angle = columns
        self._recording = Recording(
            time_s,
            target,
            commanded,
            encoder,
            deviation,
            velocity,
            encoder_velocity,
            load_angle,
            self._load_over(time_s),
        )
        try:
            self._score = score(
                time_s,
                self._target(),
                self._recording.commanded,
                self._recording.encoder,
                self._window.band,
                self._distance(),
            )
        except ValueError as error:
            raise Failed(f"nothing to score: {error}") from error

    def _target(self) -> float:
        """Where the axis shall be at the end [microsteps]."""
        assert self._recording is not None
        known = self._recording.target[np.isfinite(self._recording.target)]
        return float(known[-1]) if len(known) else float("nan")

    def _distance(self) -> float:
        return 0.0

    def _load_over(self, time_s: FloatArray) -> FloatArray:
        """The load at these times [Nm]; NaN where nobody knows it."""
        return np.full(len(time_s), np.nan)

    @abstractmethod
    async def _act(self) -> float:
        """Let it happen; when it did, device time [s]."""

    async def _follow(self, started_at_s: float) -> None:
        """Record what comes of it."""
        del started_at_s
        await self._record(self._window.seconds, self._window.before_s / self._whole_s)

    async def _give_back(self) -> None:
        self._end_sampling()


class StepResponse(Response):
    """Goes by `distance` [microsteps]; "ramp" as the axis is set, "step" in hold mode, where velocity jumps to VMAX."""

    kind = "step response"

    def __init__(
        self,
        device: Device,
        axis: int,
        clock: Clock,
        distance: int,
        shape: Shape,
        window: Window,
    ) -> None:
        super().__init__(device, axis, clock, window)
        if distance == 0:
            raise OutOfRange("distance", distance, None, None, "a step of 0 is none")
        moves = device.part(VelocityJumps)
        if shape == "step" and moves is None:
            raise WrongState(f"the velocity of a {device.family.title} does not jump", "let it go on its ramp")
        self._jumps = moves
        self._by = distance
        self._shape: Shape = shape

    def _distance(self) -> float:
        return float(self._by)

    async def _act(self) -> float:
        self._phase = "step"
        if self._shape == "step" and self._jumps is not None:
            return (await self._jumps.move_in_steps(self.axis, self._by, relative=True)).started_at_s
        return (await self.device.motion.move(self.axis, self._by, relative=True)).started_at_s

    async def _give_back(self) -> None:
        await super()._give_back()
        if self._shape == "step" and self._how == "done" and self._jumps is not None:
            await self._jumps.stand_ready(self.axis)


class Disturbance(Response):
    """Puts a load on the axis for `load_s` [s] (None: half of `seconds`); without a load the user has to push."""

    kind = "disturbance"

    def __init__(
        self,
        device: Device,
        axis: int,
        clock: Clock,
        load: Load | None,
        load_s: float | None,
        window: Window,
    ) -> None:
        super().__init__(device, axis, clock, window)
        self._load = load
        self._load_s = window.seconds / 2 if load_s is None else load_s
        if not 0 < self._load_s <= window.seconds:
            raise OutOfRange("load_s", self._load_s, 0, window.seconds, "above 0, and no longer than the recording")
        self._loaded = False
        self._released_s: float | None = None

    async def _act(self) -> float:
        self._phase = "load"
        if self._load is not None:
            self._load.apply()
            self._loaded = True
        return self.device.device_time_s()

    async def _follow(self, started_at_s: float) -> None:
        before_s, whole_s = self._window.before_s, self._whole_s
        await self._record(self._load_s, before_s / whole_s)
        self._release()
        self._phase = "after the load"
        left_s = self._window.seconds - (self.device.device_time_s() - started_at_s)
        await self._record(left_s, (before_s + self._load_s) / whole_s)

    def _release(self) -> None:
        if self._load is not None and self._loaded:
            self._loaded = False
            self._load.release()
            self._released_s = self.device.device_time_s()

    def _load_over(self, time_s: FloatArray) -> FloatArray:
        if self._load is None or self._released_s is None or self._started_at_s is None:
            return super()._load_over(time_s)
        loaded = (time_s >= 0) & (time_s < self._released_s - self._started_at_s)
        return np.where(loaded, self._load.torque_nm, 0.0)

    async def _stop(self) -> None:
        """Nothing that this has set in motion: an axis that holds its place goes on holding it."""

    async def _give_back(self) -> None:
        self._release()
        await super()._give_back()
