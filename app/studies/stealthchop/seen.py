"""What a run through the switch-over speed shows: the shaft's swing there, and what the regulation had to add."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..moves import Sampled

BEFORE_S, AFTER_S = 0.01, 0.03
"""What counts around the moment at which one chopper takes over from the other [s]: a swing of the rotor."""
LEAST_SAMPLES = 8


@dataclass(frozen=True, slots=True)
class Amplitude:
    """Once on the way: the amplitude, of the greatest there is, and what of it the regulation adds; None: not told.
    at_s : of the device's time; pps : the speed then."""

    at_s: float
    share: float
    added: float | None
    pps: float = 0.0


def with_speeds(amplitudes: Sequence[Amplitude], run: Sampled) -> list[Amplitude]:
    """The ones in motion, with the speed of a run as it was sampled; its first channel beside."""
    speeds = np.interp([each.at_s - run.began_s for each in amplitudes], run.time_s, np.abs(run.beside[:, 0]))
    found = [replace(each, pps=float(pps)) for each, pps in zip(amplitudes, speeds, strict=True)]
    return [each for each in found if each.pps > 0]


def jolts_of(run: Sampled, switch_pps: float, full_step: int) -> list[float]:
    """How far the shaft swings about its way each time that its speed passes `switch_pps` [full steps].

    The speed is the first channel beside. Moments with too few samples around are left out.
    """
    seen = np.isfinite(run.encoder)
    time_s, off = run.time_s[seen], (run.encoder - run.position)[seen]
    above = np.abs(run.beside[seen, 0]) >= switch_pps
    found = []
    for index in np.flatnonzero(above[1:] != above[:-1]) + 1:
        around = (time_s >= time_s[index] - BEFORE_S) & (time_s <= time_s[index] + AFTER_S)
        if around.sum() >= LEAST_SAMPLES:
            found.append(float(np.ptp(off[around])) / full_step)
    return found


def added_of(amplitudes: Sequence[Amplitude]) -> float | None:
    """What was added to amplitudes or taken from them, root mean square over their mean; None: not told."""
    told = [(each.share, each.added) for each in amplitudes if each.added is not None and each.share > 0]
    if not told:
        return None
    share, added = np.array(told).T
    return float(np.sqrt(np.mean(added**2)) / np.mean(share))


def beside(amplitudes: Sequence[Amplitude], pps: Sequence[float], needed: Sequence[float]) -> float | None:
    """By how much amplitudes are off what was needed at some speeds, root mean square over its mean; None: not told."""
    if not amplitudes:
        return None
    wanted = np.interp([each.pps for each in amplitudes], pps, needed)
    off = np.array([each.share for each in amplitudes]) - wanted
    return float(np.sqrt(np.mean(off**2)) / np.mean(wanted))
