"""Plays a velocity over time: each point sent as its time comes, and how late the chip had it told for each.

A point more than `STALE_S` late whose successor is due already is left out, so a link that is too slow makes the
profile coarser and not longer.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..calc.ramps.velocity_profile import FloatArray, VelocityProfile, held_positions
from ..clock import Clock, FineSleep
from ..devices.core.capabilities import VelocitySteps, VelocityStream
from ..devices.core.device import Device
from ..errors import OutOfRange, SoftLimit, UsageError, WrongState
from .procedure import Ended, Failed, Procedure, State

POINTS_MAX = 100_000
DURATION_MAX_S = 600.0
RATE_MAX_HZ = 2000.0
LATE_MAX_S = 0.1
"""A link that answers later than this cannot play anything; the motor is stopped [s]."""
STALE_S = 0.002
"""How late a point is still worth sending though the next one is due [s]."""
LEAD_S = 0.02
"""Between taking the axis and its first point [s]."""
COUNTS_MAX = 2047
POSITION_MAX = (1 << 23) - 1
"""Of the counter either way [microsteps]: beyond, it wraps."""


@dataclass(frozen=True, slots=True)
class ProfileSummary:
    """What a profile asks for, before anything is sent. Names as in the REST contract.

    step_pps is the chip's: velocities are rounded to it.
    """

    points: int
    duration_s: float
    peak_pps: float
    acceleration_pps2: float
    lowest: int
    highest: int
    end: int
    step_pps: float


@dataclass(frozen=True, slots=True)
class ProfileState:
    """How a profile goes, or went. Lateness is of the points that were sent [ms]; None before the first."""

    state: State
    summary: ProfileSummary | None
    sent: int
    skipped: int
    late_median_ms: float | None
    late_p99_ms: float | None
    late_max_ms: float | None
    position: int | None
    message: str


IDLE = ProfileState("idle", None, 0, 0, None, None, None, None, "")


@dataclass(frozen=True, slots=True)
class CheckedProfile:
    """A profile that was judged: times [s] and velocities [counts of the chip], and what they come to."""

    time_s: FloatArray
    counts: Sequence[int]
    summary: ProfileSummary


async def judge(
    device: Device, axis: int, time_s: Sequence[float], velocity_pps: Sequence[float], rate_hz: float | None
) -> CheckedProfile:
    """Check a profile against the chip and the soft limits; nothing is sent that moves anything.

    Raises UsageError for what is no profile, OutOfRange for what the chip cannot do, SoftLimit, WrongState.
    """
    stream = device.need(VelocityStream)
    index = device.axis(axis).index
    try:
        profile = VelocityProfile.of(time_s, velocity_pps)
    except ValueError as error:
        raise UsageError(str(error)) from error
    if profile.duration_s > DURATION_MAX_S:
        raise OutOfRange("time_s", profile.duration_s, 0, DURATION_MAX_S, "s")
    if rate_hz is not None and profile.duration_s * rate_hz > POINTS_MAX:
        raise OutOfRange("rate_hz", rate_hz, 0, POINTS_MAX / profile.duration_s, f"{POINTS_MAX} points are the most")
    times, velocities = profile.points(rate_hz)
    closest_s = float(np.diff(times[:-1] if rate_hz and len(times) > 2 else times).min())
    if closest_s < (1 - 1e-6) / RATE_MAX_HZ:
        raise OutOfRange("time_s", closest_s, 1 / RATE_MAX_HZ, None, "s between two points")
    unit_pps, position = await stream.stream_unit_pps(index)
    counts = np.rint(velocities / unit_pps).astype(int)
    if np.abs(counts).max() > COUNTS_MAX:
        raise OutOfRange("velocity_pps", profile.peak_pps, -COUNTS_MAX * unit_pps, COUNTS_MAX * unit_pps, "pps")
    ways = position + held_positions(times, counts * unit_pps)
    summary = ProfileSummary(
        points=len(times),
        duration_s=profile.duration_s,
        peak_pps=float(np.abs(counts).max() * unit_pps),
        acceleration_pps2=profile.acceleration_pps2,
        lowest=math.floor(ways.min()),
        highest=math.ceil(ways.max()),
        end=round(float(ways[-1])),
        step_pps=unit_pps,
    )
    if summary.highest > POSITION_MAX or summary.lowest < -POSITION_MAX - 1:
        beyond = summary.highest if summary.highest > POSITION_MAX else summary.lowest
        raise OutOfRange("position", beyond, -POSITION_MAX - 1, POSITION_MAX, "microsteps on the way")
    _require_limits(device, index, summary, position)
    return CheckedProfile(times, counts.tolist(), summary)


def _require_limits(device: Device, axis: int, summary: ProfileSummary, position: int) -> None:
    limiter = device.limiter
    if limiter is None:
        return
    limiter.require_velocity(axis, summary.peak_pps)
    for reached in (summary.lowest, summary.highest):
        limiter.require_target(axis, reached, position, "the profile goes there")
    most = limiter.limits[axis].acceleration_max_pps2
    if most is not None and summary.acceleration_pps2 > most:
        raise SoftLimit(
            "acceleration", summary.acceleration_pps2, most, axis, "pps^2", "the steepest part of the profile"
        )


class ProfilePlay(Procedure):
    """Plays one profile on one axis, which has to stand."""

    kind = "velocity profile"

    def __init__(self, device: Device, axis: int, clock: Clock, wanted: CheckedProfile) -> None:
        super().__init__(device, axis, clock)
        if device.session.time_scale != 1:
            raise WrongState("the emulator's time does not run with ours", "set its time scale to 1")
        self._wanted = wanted
        self._late_s = np.full(len(wanted.time_s), np.nan)
        self._sent = 0
        self._skipped = 0
        self._position: int | None = None

    @property
    def state(self) -> ProfileState:
        late_ms = self._late_s[~np.isnan(self._late_s)] * 1e3
        median, p99, most = (
            (None, None, None)
            if not len(late_ms)
            else (float(np.median(late_ms)), float(np.percentile(late_ms, 99, method="higher")), float(late_ms.max()))
        )
        return ProfileState(
            self._how, self._wanted.summary, self._sent, self._skipped, median, p99, most, self._position, self.message
        )

    def times_s(self) -> list[float]:
        """When each point is due, from the start on [s]."""
        times: list[float] = self._wanted.time_s.tolist()
        return times

    def lateness_ms(self) -> list[float | None]:
        """Of each point: how long after its time the chip had answered it [ms]; None where it was not sent."""
        return [None if math.isnan(late_s) else late_s * 1e3 for late_s in self._late_s.tolist()]

    async def _run(self) -> None:
        times, counts = self._wanted.time_s, self._wanted.counts
        steps = await self.device.need(VelocityStream).open_stream(self.axis)
        with FineSleep(self.clock) as fine:
            await self._send(steps, fine, times, counts)
        self._position = await steps.close()

    async def _send(self, steps: VelocitySteps, fine: FineSleep, times: FloatArray, counts: Sequence[int]) -> None:
        start_s = self.clock.now() + LEAD_S
        point = 0
        while point < len(times):
            await fine.until(start_s + times[point])
            since_s = self.clock.now() - start_s
            if since_s - times[point] > LATE_MAX_S:
                raise Failed(
                    f"the link is {since_s - times[point]:.3f} s late at point {point}: send fewer points a second"
                )
            newest = max(point, int(np.searchsorted(times, since_s, side="right")) - 1)
            due = min(newest, max(point, int(np.searchsorted(times, since_s - STALE_S))))
            self._skipped += due - point
            await steps.set(counts[due])
            self._late_s[due] = self.clock.now() - start_s - times[due]
            self._sent += 1
            point = due + 1

    def _over(self, how: Ended) -> None:
        super()._over(how)
        self.message = self.message or how

    async def _give_back(self) -> None:
        """The axis stays in the mode where it stands still until the next command; what it borrowed is only that."""
