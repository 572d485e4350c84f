"""Runs of one axis past nothing and into a stop: load values on the way, and where a stall stopped it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...clock import Clock
from ...devices.core.capabilities import PositionFromEncoder
from ...devices.core.device import Device
from ...devices.core.results import AxisState
from ...procedures.procedure import POLL_S, Failed
from ...procedures.standing import Standing
from ...telemetry.sampling import FloatArray
from ..driver_faults import state_now
from ..moves import LONGEST, LOOK_S, PERIOD_FULLSTEPS, deviation_of
from ..sampled import sampling

SAMPLES_A_FULLSTEP = 2.5
"""A new load value comes with each full step."""
RATE_HZ = (100.0, 2000.0)
PHASES = 64
"""Places within a full step of the counter at which one of the chip may begin."""
AWAY_FULLSTEPS = 2.0
"""So far an encoder is from the position as the rotor rests at a stop and the field goes on."""
SHORT_FULLSTEPS = 3.0
"""A stall told further before the stop is a false one."""
FALSE_MOST = 25
"""False stalls on one way, after which it is given up."""
SAYS_WHY_S = 1.0
"""How long the driver may take to tell why the motor rests [s]."""


@dataclass(frozen=True, slots=True)
class Samples:
    """What was measured on a way, once a full step: position [microsteps], speed [pps], load value."""

    position: FloatArray
    speed_pps: FloatArray
    load: FloatArray


def each_fullstep(position: FloatArray, load: FloatArray, full_step: int) -> NDArray[np.bool_]:
    """Which samples are the last of a full step of the chip, so that each of its load values counts once.

    position : microsteps of the counter, on one way; load : a new value with each full step of the chip, which begins
    anywhere within one of the counter. It is where the values are seen to change.
    """
    at = position / full_step
    changes = np.diff(load) != 0
    phases = np.arange(PHASES) / PHASES
    steps = np.floor(at[:, None] - phases)
    odd = (changes[:, None] & (np.diff(steps, axis=0) == 0)).sum(axis=0)
    fits = np.flatnonzero(odd == odd.min())
    # Of all that fit the middle of the widest range of them, around the circle.
    gaps = np.diff(fits, append=fits[0] + PHASES) > 1
    begins = np.roll(fits, -1)[gaps] if gaps.any() else fits[:1]
    ends = fits[gaps] if gaps.any() else fits[-1:]
    widths = [(ends[(index + 1) % len(ends)] - begin) % PHASES for index, begin in enumerate(begins)]
    widest = int(np.argmax(widths))
    phase = ((int(begins[widest]) + widths[widest] / 2) % PHASES) / PHASES
    return np.asarray(np.diff(np.floor(at - phase), append=np.inf) != 0)


class StallRuns:
    """Moves one axis, and tells where it came to rest. Positions in microsteps."""

    def __init__(self, device: Device, axis: int, clock: Clock, full_step: int, way: int) -> None:
        """Way : the sign of the side where the stop is"""
        self._device, self._axis, self._clock = device, axis, clock
        self._full_step, self._way = full_step, way
        self._off = 0.0
        """Encoder less position as both are in step [microsteps]."""
        self.way_fullsteps = 0.0
        """Of all moves so far."""
        self.runs = 0

    async def begin(self) -> None:
        """See where the encoder is to the position. Raises BenchError."""
        self._off = deviation_of(await self._state())

    async def find_stop(self, limit: int) -> int | None:
        """Go towards `limit` until the encoder stands: where it does; None where nothing holds the motor."""
        await self._device.motion.move(self._axis, limit)
        farthest = -float("inf")
        began_s, state = self._device.device_time_s(), await self._state()
        longest_s = None
        while True:
            await self._clock.sleep(POLL_S)
            state = await self._state()
            off = deviation_of(state) - self._off
            encoder = state.position + off
            farthest = max(farthest, self._way * encoder)
            if abs(off) > AWAY_FULLSTEPS * self._full_step:
                break
            if not state.moving and state.position == limit:
                return None
            if longest_s is None and state.velocity_pps:
                longest_s = LONGEST * abs(limit - state.position) / abs(state.velocity_pps) + 60.0
            if self._device.device_time_s() - began_s > (longest_s or 60.0):
                raise Failed(f"neither the stop nor {limit} came within its time")
        await self._device.stop(self._axis)
        while state.moving:
            await self._clock.sleep(POLL_S)
            state = await self._state()
        return self._way * round(farthest)

    async def measured(self, target: int, speed_pps: float) -> Samples:
        """Move to `target` at that speed, and what was measured on the way. Raises Failed where it does not arrive,
        BenchError."""
        names = [f"{name}.{self._axis}" for name in ("position", "velocity", "load_value")]
        rate_hz = min(max(SAMPLES_A_FULLSTEP * speed_pps / self._full_step, RATE_HZ[0]), RATE_HZ[1])
        with sampling(self._device, names, rate_hz, self._clock) as samples:
            state = await self._go(target, samples.take)
            samples.take()
        if state.position != target:
            raise Failed(f"the motor stands at {state.position}, not {target}: {await self._reason()}")
        position, velocity, load = samples.all()[1].T
        known = np.isfinite(position) & np.isfinite(velocity) & np.isfinite(load) & (velocity != 0)
        position, velocity, load = position[known], np.abs(velocity[known]), load[known]
        kept = each_fullstep(position, load, self._full_step)
        return Samples(position[kept], velocity[kept], load[kept])

    async def armed(self, target: int) -> int:
        """Move to `target` while a stall stops the motor, and go on after each: how many false stalls there were."""
        for false in range(FALSE_MOST):
            if await self._stopped(target) is None:
                return false
        return FALSE_MOST

    async def into_stop(self, target: int, stop_at: int) -> tuple[bool, int]:
        """Run to `target` behind the stop while a stall stops the motor: whether it was missed, and how many false
        stalls there were before the stop."""
        for false in range(FALSE_MOST):
            at = await self._stopped(target)
            if at is None:
                return True, false
            if self._way * (stop_at - at) <= SHORT_FULLSTEPS * self._full_step:
                return False, false
        return True, FALSE_MOST

    async def mend(self) -> bool:
        """Away from the stop: take the position from the encoder where whole periods were lost; whether any were."""
        off = (deviation_of(await self._state()) - self._off) / self._full_step
        if not round(off / PERIOD_FULLSTEPS):
            return False
        await self._device.need(PositionFromEncoder).position_from_encoder(self._axis)
        self._off = deviation_of(await self._state())
        return True

    async def back_to(self, target: int) -> None:
        """Go where nothing is in the way; no stall stops it. Raises Failed where it does not arrive."""
        state = await self._go(target, lambda: None)
        if state.position != target:
            raise Failed(f"the motor stands at {state.position}, not {target}: {await self._reason()}")

    async def _stopped(self, target: int) -> int | None:
        """Where a stall stopped it on the way; None at the target. Raises Failed where anything else did."""
        state = await self._go(target, lambda: None)
        if state.position == target:
            return None
        why = await self._reason()
        if why != "stall":
            raise Failed(f"the motor stands at {state.position}, not {target}: {why}")
        return state.position

    async def _go(self, target: int, take: Callable[[], None]) -> AxisState:
        """Move, and how the axis is as it rests, wherever that is."""
        device, clock = self._device, self._clock
        state = await self._state()
        if state.position == target and not state.moving:
            return state
        self.runs += 1
        started = await device.motion.move(self._axis, target)
        began_s = device.device_time_s()
        usual_s = 60.0 if started.predicted_duration_s is None else started.predicted_duration_s
        longest_s, pause_s = usual_s * LONGEST + 2.0, POLL_S
        begin, standing = state.position, Standing()
        while True:
            await clock.sleep(pause_s)
            take()
            left_s = began_s + usual_s - device.device_time_s()
            pause_s = min(max(left_s / 2, POLL_S), LOOK_S)
            state = await self._state()
            stands = standing.seen(state) and device.device_time_s() - began_s > 2 * POLL_S
            if stands or (state.position == target and not state.moving):
                self.way_fullsteps += abs(state.position - begin) / self._full_step
                return state
            if device.device_time_s() - began_s > longest_s:
                raise Failed(f"the motor has not arrived at {target} after {longest_s:.3g} s")

    async def _reason(self) -> str:
        """Why the motor rests, as the driver tells."""
        until_s = self._clock.now() + SAYS_WHY_S
        while self._clock.now() < until_s:
            ends = self._device.monitor.motion_ends(self._axis)
            if ends and ends[-1].reason != "target_reached":
                return "stall" if ends[-1].reason == "stall" else ends[-1].detail
            await self._clock.sleep(POLL_S)
        return "nothing says why"

    async def _state(self) -> AxisState:
        return await state_now(self._device, self._axis, self._clock)
