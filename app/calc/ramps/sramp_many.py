"""Many S-ramps in one call: what a sweep over bows, or a map of durations, is made of."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from . import sramp_kernel as kernel
from .curve import FloatArray
from .sramp import POSITION_LIMIT

PHASES = kernel.PHASES
"""Order of the last axis of `SRampPlans.phase_s`."""


@dataclass(frozen=True)
class SRampPlans:
    """Moves onto a target, in the broadcast shape of what they were asked with.

    duration_s : when each is at rest on its target [s]
    peak_velocity_pps : the highest |velocity| of each [pps]
    phase_s : time in each of the seven phases, `PHASES` along the last axis [s]; where a motor comes back after an
        overshoot the times of both ways are together
    """

    duration_s: FloatArray
    peak_velocity_pps: FloatArray
    phase_s: FloatArray


def plan_many(
    distance: ArrayLike,
    *,
    vmax: ArrayLike,
    amax: ArrayLike,
    bow1: ArrayLike,
    dmax: ArrayLike | None = None,
    bow2: ArrayLike | None = None,
    bow3: ArrayLike | None = None,
    bow4: ArrayLike | None = None,
    vstart: ArrayLike = 0.0,
    vstop: ArrayLike = 0.0,
    astart: ArrayLike = 0.0,
    use_astart_and_vstart: ArrayLike = False,
    v_actual: ArrayLike = 0.0,
    a_actual: ArrayLike = 0.0,
) -> SRampPlans:
    """Moves by `distance` [microsteps, signed] as `position_plan` plans them, for arrays that broadcast.

    vmax, vstart, vstop, v_actual [pps], amax, dmax, astart, a_actual [pps^2], bow1..bow4 [pps^3] as in `SRamp`;
    dmax is amax, and the other bows are bow1, where they are not given.

    Raises ValueError, naming the first of them: what `SRamp` and `position_plan` refuse, shapes that do not broadcast.
    """
    named: dict[str, ArrayLike] = {
        "vmax": vmax,
        "amax": amax,
        "dmax": amax if dmax is None else dmax,
        "bow1": bow1,
        "bow2": bow1 if bow2 is None else bow2,
        "bow3": bow1 if bow3 is None else bow3,
        "bow4": bow1 if bow4 is None else bow4,
        "vstart": vstart,
        "vstop": vstop,
        "astart": astart,
    }
    inputs = {name: np.asarray(value, dtype=np.float64) for name, value in named.items()}
    for place, (name, values) in enumerate(inputs.items()):
        wrong = ~(np.isfinite(values) & ((values > 0) if place <= kernel.BOW4 else (values >= 0)))
        if wrong.any():
            lowest = "above 0" if place <= kernel.BOW4 else "not below 0"
            raise ValueError(f"{name} is finite and {lowest}, got {values[wrong].flat[0]}")
    way, v, a = (np.asarray(x, dtype=np.float64) for x in (distance, v_actual, a_actual))
    if not np.all(np.abs(way) < POSITION_LIMIT):
        raise ValueError("distance is below 2^32 microsteps")
    for name, values in (("v_actual", v), ("a_actual", a)):
        if not np.isfinite(values).all():
            raise ValueError(f"{name} is finite")
    use = np.asarray(use_astart_and_vstart, dtype=np.float64)
    shape = np.broadcast_shapes(way.shape, v.shape, a.shape, use.shape, *(x.shape for x in inputs.values()))
    count = int(np.prod(shape))
    parameters = np.zeros((count, kernel.PARAMETERS))
    for column, values in enumerate(inputs.values()):
        parameters[:, column] = np.broadcast_to(values, shape).ravel()
    parameters[:, kernel.USE_ASTART] = np.broadcast_to(use, shape).ravel()
    moves, velocities, accelerations = (np.ascontiguousarray(np.broadcast_to(x, shape).ravel()) for x in (way, v, a))
    rows = np.empty((kernel.MOST_ROWS, kernel.COLUMNS))
    durations, peaks, phases = np.empty(count), np.empty(count), np.empty((count, len(PHASES)))
    kernel.many(parameters, moves, velocities, accelerations, rows, durations, peaks, phases)
    return SRampPlans(durations.reshape(shape), peaks.reshape(shape), phases.reshape((*shape, len(PHASES))))
