"""The S-ramp planner against Ruckig, a time-optimal planner in C++: many at once, and one by one from Python.

Symmetric moves from rest to rest (all bows equal, AMAX = DMAX), where both have to find the same duration. Ruckig gets
them with VMAX and AMAX as units, in which its fixed thresholds fit.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from itertools import repeat

import numpy as np
from numpy.typing import NDArray
from ruckig import InputParameter, Ruckig, Trajectory

from app.calc.ramps.sramp import SRamp, position_plan, warm_up
from app.calc.ramps.sramp_many import plan_many
from tests.bench.table import Row

MANY_REQUIRED = 1.0
SINGLE_REQUIRED = 0.02
SAME = 1e-9

FloatArray = NDArray[np.float64]


def cases(count: int) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """VMAX, AMAX, bow, distance: whole ranges, from ramps that never reach AMAX to ones that are nearly trapezoids,
    and from moves of bows alone to long ones at VMAX.
    """
    rng = np.random.default_rng(4361)
    vmax, amax = (np.exp(rng.uniform(np.log(1e2), np.log(4e6), count)) for _ in range(2))
    steepness, length = (np.exp(rng.uniform(np.log(1e-2), np.log(1e2), count)) for _ in range(2))
    return vmax, amax, steepness * amax**2 / vmax, np.minimum(length * vmax**2 / amax, 2.0**31)


def ruckig_one_by_one(bows: list[float], distances: list[float]) -> list[float]:
    """Durations of moves with VMAX = AMAX = 1; the input object is made once, which is the fast way to use it."""
    planner, wanted, trajectory = Ruckig(1), InputParameter(1), Trajectory(1)
    wanted.current_position = wanted.current_velocity = wanted.current_acceleration = [0.0]
    wanted.target_velocity = wanted.target_acceleration = [0.0]
    wanted.max_velocity = wanted.max_acceleration = [1.0]
    durations = []
    for bow, distance in zip(bows, distances, strict=True):
        wanted.max_jerk = [bow]
        wanted.target_position = [distance]
        planner.calculate(wanted, trajectory)
        durations.append(trajectory.duration)
    return durations


def plan_one_by_one(ramps: list[tuple[SRamp, float]]) -> None:
    for ramp, distance in ramps:
        position_plan(ramp, distance)


def fastest(rounds: int, work: Callable[[], object]) -> float:
    """[s]"""
    seconds = []
    for _ in repeat(None, rounds):
        start_s = time.perf_counter()
        work()
        seconds.append(time.perf_counter() - start_s)
    return min(seconds)


def measure(quick: bool) -> Sequence[Row]:
    count, rounds = (10_000, 2) if quick else (100_000, 5)
    vmax, amax, bow, distance = cases(count)
    unit_s = vmax / amax
    scaled = ((bow * unit_s / amax).tolist(), (distance / (vmax * unit_s)).tolist())
    warm_up()
    plans = plan_many(distance[:10], vmax=vmax[:10], amax=amax[:10], bow1=bow[:10])  # compiled before the clock runs

    best = np.array(ruckig_one_by_one(*scaled)) * unit_s
    ruckig_s = fastest(rounds, lambda: ruckig_one_by_one(*scaled)) / count
    many_s = fastest(rounds, lambda: plan_many(distance, vmax=vmax, amax=amax, bow1=bow)) / count
    plans = plan_many(distance, vmax=vmax, amax=amax, bow1=bow)
    worst = float(np.abs(plans.duration_s / best - 1).max())

    few = list(zip(*(x[:5000].tolist() for x in (vmax, amax, bow, distance)), strict=True))
    ramps = [(SRamp(v, a, a, b, b, b, b), d) for v, a, b, d in few]
    single_s = fastest(rounds, lambda: plan_one_by_one(ramps)) / len(ramps)

    same = worst <= SAME
    notes = (f"durations differ by at most {worst:.1e} of themselves",)
    return [
        Row(
            what=f"S-ramps, {count:,} symmetric moves in one call",
            measured=f"{1 / many_s:,.0f} /s",
            peer=f"Ruckig one by one {1 / ruckig_s:,.0f} /s",
            ratio=ruckig_s / many_s,
            required=f">= {MANY_REQUIRED:g}, same to 1e-9",
            ok=same and ruckig_s / many_s >= MANY_REQUIRED,
            notes=notes,
        ),
        Row(
            what="S-ramps, a single plan with its pieces and warnings",
            measured=f"{single_s * 1e6:.1f} us",
            peer=f"Ruckig {ruckig_s * 1e6:.2f} us",
            ratio=ruckig_s / single_s,
            required=f">= {SINGLE_REQUIRED:g}",
            ok=ruckig_s / single_s >= SINGLE_REQUIRED,
        ),
    ]
