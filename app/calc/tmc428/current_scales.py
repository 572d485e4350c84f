"""Coil current of a TMC428 over a ramp: which of its three scales holds when, and what that saves.

Table 8-2 of DS-TMC428 8.9: is_v0 at rest, is_agtat while the velocity changes by more than a_threshold a ramp tick,
else is_aleat. is_v0 waits for 255 ramp ticks after the last step.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from types import MappingProxyType
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ..ramps.ticked import RampParameters, exact_ramp

Scale = Literal["is_v0", "is_aleat", "is_agtat"]
SCALES: tuple[Scale, ...] = ("is_v0", "is_aleat", "is_agtat")
EIGHTHS = 8
REST_DELAY_TICKS = 255
"""Ramp ticks from the last step to is_v0 (DS-TMC428 8.9)."""
THRESHOLD_COMPARED = 1023
"""The comparison is signed: no acceleration is found above a greater a_threshold (DS-TMC428 8.9, Table 8-2)."""
TICKS_MOST = 400_000
"""Longer ramps are refused: each ramp tick is looked at."""
SPANS_MOST = 2_000


@dataclass(frozen=True)
class CurrentScales:
    """The fields of one axis: codes 0..7, 0 is full scale; a_threshold 0..2047 in units of a_max.

    Raises ValueError outside these ranges.
    """

    is_v0: int = 0
    is_aleat: int = 0
    is_agtat: int = 0
    a_threshold: int = 0

    def __post_init__(self) -> None:
        for name in SCALES:
            if not 0 <= getattr(self, name) < EIGHTHS:
                raise ValueError(f"{name} is 0 (100 %) to 7 (87.5 %), got {getattr(self, name)}")
        if not 0 <= self.a_threshold <= 2047:
            raise ValueError(f"a_threshold is 0 to 2047, got {self.a_threshold}")

    def eighths(self, scale: Scale) -> int:
        """1..8: what a code stands for (DS-TMC428 Table 8-1)."""
        return int(getattr(self, scale)) or EIGHTHS


@dataclass(frozen=True)
class Span:
    """From `start_s` to `end_s` [s] one scale holds. A stretch where scales take turns bears the one that holds longest
    in it, and in `eighths` the mean."""

    scale: Scale
    start_s: float
    end_s: float
    eighths: float


@dataclass(frozen=True)
class ScaledRamp:
    """The coil current before, during and after a move that begins at t = 0 from long rest.

    spans : in order without gaps, from before the move to after is_v0 has come back
    motion_s : of the move alone [s]; rest_delay_s : from its end to is_v0 [s]
    time_s : time under each scale from t = 0 to is_v0 [s]
    heat : mean of the squared share of current from t = 0 to is_v0, as a share of full scale's
    braking_below : share of the ramp ticks of braking at which is_aleat holds: the braking ramp steps down towards
        v_target, and between two steps it does not accelerate; None where nothing brakes
    warnings : what does not work as it seems
    """

    spans: tuple[Span, ...]
    motion_s: float
    rest_delay_s: float
    time_s: Mapping[Scale, float]
    heat: float
    braking_below: float | None
    warnings: tuple[str, ...]


def rest_delay_s(ramp_div: int, clock_hz: float) -> float:
    """Time from the last step to is_v0 [s] (DS-TMC428 8.9)."""
    return REST_DELAY_TICKS * (32 << ramp_div) / clock_hz


def scale_of(velocity_256: int, change: int, a_threshold: int) -> Scale:
    """Table 8-2 for one ramp tick: velocity after it and its change, both in 1/256 of the unit of v_actual."""
    if velocity_256 == 0:
        return "is_v0"
    return "is_agtat" if a_threshold <= THRESHOLD_COMPARED and abs(change) > a_threshold else "is_aleat"


def scaled_ramp(
    parameters: RampParameters, distance: int, scales: CurrentScales, continuous_update: bool | None = None
) -> ScaledRamp:
    """Which scale holds when, for the move that `exact_ramp` makes.

    continuous_update : that bit of the global parameters; None where it is not known
    Raises ValueError as `exact_ramp`, and where the ramp has more than `TICKS_MOST` ramp ticks.
    """
    period_s = parameters.ramp_period_clocks / parameters.clock_hz
    ticks = int(np.ceil(exact_ramp(parameters, distance, 2).duration_s / period_s))
    if ticks > TICKS_MOST:
        raise ValueError(
            f"the ramp has {ticks} ramp ticks of {period_s * 1e6:g} us, at most {TICKS_MOST} are looked at: "
            "take a shorter distance or a greater ramp_div"
        )
    ticks = max(ticks, 1)
    curve = exact_ramp(parameters, distance, ticks + 1, duration_s=ticks * period_s)
    velocity = np.zeros(ticks + 1, dtype=np.int64) if curve.velocity_256 is None else curve.velocity_256
    change = np.diff(velocity)
    after = velocity[1:]
    reached = scales.a_threshold <= THRESHOLD_COMPARED
    kinds = np.where(after == 0, 0, np.where(reached & (np.abs(change) > scales.a_threshold), 2, 1))
    moving = np.flatnonzero(after)
    rest_s = rest_delay_s(parameters.ramp_div, parameters.clock_hz)
    # the delay runs from each stop: a reversal passes through zero without is_v0
    held = np.where(kinds == 0, 1, kinds)
    last = int(moving[-1]) + 1 if moving.size else 0
    motion_s = last * period_s
    held = held[:last]
    spans = _spans(held, period_s, scales)
    end_s = motion_s + rest_s
    shown_s = max(end_s, period_s) / 20
    tail = (Span("is_aleat", motion_s, end_s, scales.eighths("is_aleat")),) if last else ()
    whole = (
        Span("is_v0", -shown_s, 0.0, scales.eighths("is_v0")),
        *spans,
        *tail,
        Span("is_v0", end_s if last else 0.0, end_s + 3 * shown_s, scales.eighths("is_v0")),
    )
    counted = np.bincount(held, minlength=3) * period_s
    time_s: dict[Scale, float] = {
        "is_v0": 0.0,
        "is_aleat": float(counted[1]) + (rest_s if last else 0.0),
        "is_agtat": float(counted[2]),
    }
    total = sum(time_s.values())
    squares = sum(seconds * (scales.eighths(scale) / EIGHTHS) ** 2 for scale, seconds in time_s.items())
    rest_heat = (scales.eighths("is_v0") / EIGHTHS) ** 2
    slowing = np.abs(velocity[:last]) > np.abs(velocity[1 : last + 1])
    first = int(np.argmax(slowing)) if slowing.any() else last
    braking = held[first:]
    return ScaledRamp(
        spans=whole,
        motion_s=motion_s,
        rest_delay_s=rest_s,
        time_s=MappingProxyType(time_s),
        heat=squares / total if total else rest_heat,
        braking_below=float(np.mean(braking == 1)) if braking.size else None,
        warnings=tuple(_warnings(parameters, scales, continuous_update, bool(np.any(held == 2)))),
    )


def _spans(held: NDArray[np.int64], period_s: float, scales: CurrentScales) -> tuple[Span, ...]:
    """Runs of one scale; where there are too many, stretches of equal length with their mean."""
    if not held.size:
        return ()
    edges = [0, *(np.flatnonzero(np.diff(held)) + 1).tolist(), held.size]
    if len(edges) - 1 > SPANS_MOST:
        edges = np.unique(np.linspace(0, held.size, SPANS_MOST + 1).astype(np.int64)).tolist()
    eighths = np.array([0, scales.eighths("is_aleat"), scales.eighths("is_agtat")])
    return tuple(
        Span(
            SCALES[int(np.argmax(np.bincount(held[a:b], minlength=3)))],
            a * period_s,
            b * period_s,
            float(np.mean(eighths[held[a:b]])),
        )
        for a, b in pairwise(edges)
    )


def _warnings(
    parameters: RampParameters, scales: CurrentScales, continuous_update: bool | None, accelerated: bool
) -> list[str]:
    found = []
    if scales.a_threshold > THRESHOLD_COMPARED:
        found.append("a_threshold above 1023 never selects is_agtat: the comparison is signed")
    elif not accelerated and parameters.a_max <= scales.a_threshold:
        found.append(f"is_agtat never holds: a_max {parameters.a_max} is not above a_threshold {scales.a_threshold}")
    if scales.eighths("is_v0") > scales.eighths("is_aleat"):
        zero = ": 0 stands for 100 %" if scales.is_v0 == 0 else ""
        found.append(f"the current at rest is above that in motion{zero}")
    if scales.eighths("is_agtat") < scales.eighths("is_aleat"):
        found.append("the current while accelerating is below that of constant velocity")
    if continuous_update is False and scales.eighths("is_v0") != scales.eighths("is_aleat"):
        found.append("continuous_update is off: with all motors at rest no datagram brings is_v0 to the drivers")
    return found
