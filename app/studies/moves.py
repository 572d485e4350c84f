"""Moves that are measured: how long one took until the encoder rested, how far it was off, and what was lost."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..calc.signals.step_response import score
from ..clock import Clock
from ..devices.core.device import Device
from ..devices.core.results import AxisState
from ..procedures.procedure import POLL_S, Failed
from ..procedures.standing import Standing
from ..telemetry.sampling import FloatArray
from .driver_faults import state_now
from .sampled import sampling

RATE_HZ = 500.0
REST_S = 0.12
"""How long the shaft may ring before it is looked at [s]."""
STILL_S = 0.05
"""From one look at the shaft to the next [s]: it rests when it has moved less than `STILL_FULLSTEPS` meanwhile, twice
where it was seen to ring."""
STILL_FULLSTEPS = 0.25
STILL_MAX = 200
"""Looks at a shaft that does not come to rest, e.g. one that is still turned by its load: a heavy one with little
friction rings for seconds."""
LONGEST = 3.0
"""A move may take so many times what it should."""
LOOK_S = 0.25
SAYS_WHY_S = 1.0
"""How long a driver may take to tell why a motor rests [s]."""
SAMPLES_LEAST = 2
"""Behind the command of a move: a score needs them."""
PERIOD_FULLSTEPS = 4.0
"""A rotor that slips does so by whole electrical periods."""


@dataclass(frozen=True, slots=True)
class MoveFigures:
    """Of one move. `time_s` is None where the encoder did not end within its band of the target [s];
    `deviation_fullsteps` where there is none."""

    time_s: float | None
    deviation_fullsteps: float | None
    lost_fullsteps: float


@dataclass(frozen=True, slots=True)
class Sampled:
    """A move as it was sampled [microsteps]; `time_s` from its command on, at `began_s` of the device's time.
    deviation : at rest, at its end; beside : other channels [rows, channels]."""

    began_s: float
    time_s: FloatArray
    position: FloatArray
    encoder: FloatArray
    start: int
    deviation: float
    beside: FloatArray


def deviation_of(state: AxisState) -> float:
    """Encoder less position [microsteps]. Raises Failed where no encoder tells it: a chip that was reset has none."""
    if state.encoder_position is None:
        raise Failed("the encoder tells nothing")
    return float(state.encoder_position - state.position)


def figures_of(found: Sampled, target: int, before: float, full_step: int, band: float) -> MoveFigures:
    """Of a move whose encoder was `before` off its position at rest; `band` it has to end within [all microsteps].

    Raises Failed where too few samples came.
    """
    counts = (found.time_s >= 0) & np.isfinite(found.position) & np.isfinite(found.encoder)
    if np.count_nonzero(counts) < SAMPLES_LEAST:
        raise Failed("hardly a sample came of a move: the link is too slow, or something else keeps it busy")
    off = (found.deviation - before) / full_step
    lost = PERIOD_FULLSTEPS * round(off / PERIOD_FULLSTEPS)
    scored = score(
        found.time_s, float(target), found.position, found.encoder - before, band, float(target - found.start)
    )
    return MoveFigures(
        time_s=None if lost else scored.settling_s,
        deviation_fullsteps=scored.peak / full_step,
        lost_fullsteps=abs(lost),
    )


def worst_of(moves: Iterable[MoveFigures]) -> float | None:
    """The greatest deviation of them [full steps]; None where no encoder told any."""
    return max((one.deviation_fullsteps for one in moves if one.deviation_fullsteps is not None), default=None)


class Stood(Failed):
    """The motor came to rest on its way, `at` [microsteps]; its move began at `since_s` of the device's time."""

    def __init__(self, at: int, target: int, since_s: float) -> None:
        super().__init__(f"the motor stands at {at}, not {target}: by a switch, or its ramp is 0")
        self.at, self.since_s = at, since_s


async def stopped_by_a_stall(device: Device, axis: int, clock: Clock, since_s: float) -> bool:
    """Whether the driver says that a stall ended the move that began at `since_s` of the device's time."""
    until_s = clock.now() + SAYS_WHY_S
    while True:
        ends = device.monitor.motion_ends(axis)
        if ends and ends[-1].time_s >= since_s:
            return ends[-1].reason == "stall"
        if clock.now() >= until_s:
            return False
        await clock.sleep(POLL_S)


class MeasuredMoves:
    """Moves one axis and looks at its encoder. Positions in microsteps of the counter, all else in full steps."""

    def __init__(
        self,
        device: Device,
        axis: int,
        clock: Clock,
        microsteps: int,
        band_fullsteps: float,
        beside: Sequence[str] = (),
        *,
        has_encoder: bool = True,
    ) -> None:
        """`microsteps` of a full step. `band_fullsteps`: how near the encoder has to stay; `beside`: other channels
        that are sampled. Without an encoder the counter is looked at in its place: when the ramp is over is seen, and
        nothing of the shaft."""
        self._beside, self._has_encoder = tuple(beside), has_encoder
        self._device, self._axis, self._clock = device, axis, clock
        self._microsteps, self._band = microsteps, band_fullsteps * microsteps
        self.way_fullsteps = 0.0
        """Of all moves so far."""
        self.last: Sampled | None = None
        """The latest that was measured."""
        self.stalled_at: int | None = None
        """Where a stall ended that one [microsteps]; None where none did."""

    async def state(self) -> AxisState:
        """The axis now. Raises DriverFault, BenchError."""
        return await state_now(self._device, self._axis, self._clock)

    async def fall_into_step(self, start: int, way: int = 1) -> None:
        """By an electrical period to one side of `start` and back: a rotor that stood beside its field when it was
        switched on falls into step with the first move. Raises Failed, BenchError."""
        await self.go(start + way * round(PERIOD_FULLSTEPS) * self._microsteps)
        await self.go(start)

    async def go(self, target: int) -> None:
        """Move without measuring. Raises Failed where the motor rests elsewhere, BenchError."""
        state = await self.state()
        if state.position == target:
            return
        self.way_fullsteps += abs(target - state.position) / self._microsteps
        started = await self._device.motion.move(self._axis, target)
        await self._arrive(target, started.predicted_duration_s, lambda: None)
        await self.deviation()

    async def measured(self, target: int, *, stalls: bool = False) -> MoveFigures:
        """Move to `target` and measure; `stalls`: also a move that a stall ends, whose time is not told then.

        Raises Failed where it does not arrive, BenchError.
        """
        before = await self.deviation()
        found = await self.sampled(target, RATE_HZ, stalls=stalls)
        self.last, at = found, self.stalled_at
        figures = figures_of(found, target if at is None else at, before, self._microsteps, self._band)
        if at is not None:
            figures = replace(figures, time_s=None)
        return figures if self._has_encoder else replace(figures, deviation_fullsteps=None)

    async def sampled(self, target: int, rate_hz: float, *, stalls: bool = False) -> Sampled:
        """Move to `target`, and what was sampled until the shaft rests. Raises as `measured`."""
        own = ("position", "encoder_position") if self._has_encoder else ("position",)
        names = [*(f"{name}.{self._axis}" for name in own), *self._beside]
        with sampling(self._device, names, rate_hz, self._clock) as samples:
            start = (await self.state()).position
            self.way_fullsteps += abs(target - start) / self._microsteps
            started = await self._device.motion.move(self._axis, target)
            self.stalled_at = None
            try:
                await self._arrive(target, started.predicted_duration_s, samples.take)
            except Stood as stood:
                if not stalls or not await stopped_by_a_stall(self._device, self._axis, self._clock, stood.since_s):
                    raise
                self.stalled_at = stood.at
            after = await self.deviation()
            samples.take()
        times_s, rows = samples.all()
        position, shaft = rows[:, 0], rows[:, len(own) - 1]
        began_s = started.started_at_s
        return Sampled(began_s, times_s - began_s, position, shaft, start, after, rows[:, len(own) :])

    async def deviation(self) -> float:
        """Encoder less position at rest [microsteps]. Raises Failed where the shaft goes on turning, BenchError."""
        await self._clock.sleep(REST_S)
        if not self._has_encoder:
            return 0.0
        last, still, rang = await self._deviation_now(), 0, False
        for index in range(STILL_MAX):
            # Not always as far apart: what rings may be where it was a whole swing ago.
            await self._clock.sleep(STILL_S * (1.0, 0.6)[index % 2])
            now = await self._deviation_now()
            moved = abs(now - last) >= STILL_FULLSTEPS * self._microsteps
            still, rang, last = 0 if moved else still + 1, rang or moved, now
            if still > rang:
                return now
        raise Failed("the shaft does not come to rest: its encoder goes on counting")

    async def _deviation_now(self) -> float:
        return deviation_of(await self.state())

    async def _arrive(self, target: int, predicted_s: float | None, take: Callable[[], None]) -> None:
        """Return when the ramp is over. Device time may run faster or slower than ours."""
        device, clock = self._device, self._clock
        began_s = device.device_time_s()
        usual_s = 60.0 if predicted_s is None else predicted_s
        longest_s, pause_s = usual_s * LONGEST + 2.0, POLL_S
        standing = Standing()
        while True:
            device_s, server_s = device.device_time_s(), clock.now()
            await clock.sleep(pause_s)
            take()
            passed_s = clock.now() - server_s
            rate = (device.device_time_s() - device_s) / passed_s if passed_s > 0 else 0.0
            left_s = (began_s + usual_s - device.device_time_s()) / rate if rate > 0 else LOOK_S
            pause_s = min(max(left_s / 2, POLL_S), LOOK_S)
            state = await self.state()
            if state.position_reached and not state.moving and state.position == target:
                return
            if standing.seen(state) and device.device_time_s() - began_s > POLL_S:
                raise Stood(state.position, target, began_s)
            if device.device_time_s() - began_s > longest_s:
                raise Failed(f"the motor has not arrived at {target} after {longest_s:.3g} s")
