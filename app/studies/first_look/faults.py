"""What is broken about an axis, by slow turns there and back: named, with what to do.

An encoder that follows the motor but for jumps slips where these are no whole electrical periods; a motor that is too
weak for its load loses whole periods (four full steps), or does not follow at all.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ...telemetry.sampling import FloatArray
from ..moves import PERIOD_FULLSTEPS
from ..record import Fault

STANDS = 0.02
"""An encoder that has gone less than this share of the way stands still."""
FOLLOWS_WITHIN, FOLLOWS_SHARE = 0.25, 0.6
"""The encoder follows where it goes by this share as the motor is told; a motor that runs does so over that share of
all periods."""
JUMP_FULLSTEPS = 0.5
"""What the encoder goes more or less than the motor within one period and is a jump: eccentricity is far below."""
WHOLE_WITHIN = 0.35
"""A jump this near to whole periods is one of steps that were lost [full steps]."""
HEAVY_FULLSTEPS = 1.0
"""What the shaft turns less after each reversal: a load that pulls the rotor so far behind takes most of its torque."""
ONE_WAY_SHARE = 0.5
"""A shaft that is pulled gets on by this share of all that its encoder counts: one that swings or slips does not."""
OPEN_SHARE = 0.5
"""Share of all looks in slow motion at which the driver has to tell of an open coil: it may be wrong now and then."""
SWITCH_PLAY_FULLSTEPS = 1.0
"""Between where a switch is pressed and released: more tells lost steps and a home place apart no longer."""

TO_DO: dict[Fault, str] = {
    "open phase": "switch off, and see to the motor's plug, cable and solder joints; measure the coil's resistance",
    "overload": "more current, less load or friction, or a gear; see that nothing is in its way",
    "encoder slips": "tighten the encoder's coupling or its disk, and look once more: until then no study can trust it",
    "switch backlash": "see to the switch's lever and mount, or take another one; approach it from one side alone",
}


@dataclass(frozen=True, slots=True)
class Way:
    """One way as it was sampled [microsteps]."""

    position: FloatArray
    encoder: FloatArray


@dataclass(frozen=True, slots=True)
class Named:
    """A fault and by what it is told."""

    fault: Fault
    text: str


def open_phase(looks: Sequence[dict[str, bool]]) -> Named | None:
    """By the flags of a driver that sees open coils, of looks in slow motion."""
    coils = [
        coil
        for flag, coil in (("ola", "A"), ("olb", "B"))
        if looks and sum(flags.get(flag, False) for flags in looks) >= OPEN_SHARE * len(looks)
    ]
    if not coils:
        return None
    return Named("open phase", f"no current comes through coil {' and '.join(coils)}, as the driver tells")


def pulled(way: Way, full_step: int) -> bool:
    """Whether the shaft turned on, one way and farther than before, while the ramp stood: at a switch, or all along."""
    position, encoder = way.position, way.encoder
    if not len(position):
        return False
    moved = np.flatnonzero(position != position[-1])
    stood = encoder[moved[-1] + 1 if len(moved) else 0 :]
    on, gone = abs(stood[-1] - stood[0]), float(np.abs(np.diff(stood)).sum())
    # The way before is the measure where the encoder's resolution is set wrong: a rotor swings by far less.
    return bool(on > max(PERIOD_FULLSTEPS * full_step, abs(stood[0] - encoder[0])) and on > ONE_WAY_SHARE * gone)


def of_turns(ways: Sequence[Way], full_step: int, load: float | None) -> Named | None:
    """By the encoder on all ways, there and back in turn.

    full_step : [microsteps]; load : median load value in motion, None where the chip tells none: 0 is a rotor that does
    not turn
    """
    period = PERIOD_FULLSTEPS * full_step
    gone = [_by_period(way, period) for way in ways]
    if not all(len(each) for each in gone):
        return None
    slopes = np.concatenate(gone)
    ratio = float(np.median(slopes))
    if abs(ratio) < STANDS:
        stands = "the shaft does not turn, by its encoder and its load value of 0; or the driver is off"
        return Named("overload", stands) if load == 0 else None
    if float(np.mean(np.abs(slopes / ratio - 1) < FOLLOWS_WITHIN)) < FOLLOWS_SHARE:
        return Named("overload", "the motor does not follow what it is told, slowly as that is")
    apart = [(each / ratio - 1) * PERIOD_FULLSTEPS for each in gone]
    if len(apart) > 1:
        turned = -float(np.median([each[0] for each in apart[1:]]))
        if turned > HEAVY_FULLSTEPS:
            return Named("overload", f"the rotor hangs {turned / 2:.2g} full steps behind on either way")
    jumps = [jump for each in apart for jump in _jumps(each[1:])]  # the first has what friction takes after a reversal
    back = [float(way.encoder[-1]) for way in ways[1::2]]
    jumps += [
        moved for before, after in pairwise(back) if abs(moved := (after - before) / ratio / full_step) > JUMP_FULLSTEPS
    ]
    if not jumps:
        return None
    if load == 0 and abs(ratio - 1) > FOLLOWS_WITHIN:
        return Named("overload", "the load turns the shaft, by its encoder and a load value of 0")
    far = max(jumps, key=lambda jump: abs(jump - PERIOD_FULLSTEPS * round(jump / PERIOD_FULLSTEPS)))
    if abs(far - PERIOD_FULLSTEPS * round(far / PERIOD_FULLSTEPS)) <= WHOLE_WITHIN:
        return Named("overload", f"steps are lost, slowly as it turns: by {abs(far):.2g} full steps")
    return Named("encoder slips", f"it jumps against the motor by {abs(far):.2g} full steps, which is no whole period")


def _by_period(way: Way, period: float) -> FloatArray:
    """How far the encoder went in each electrical period of the way, of how far the motor was told to."""
    position, encoder = way.position, way.encoder
    if len(position) < 2 or position[0] == position[-1]:
        return np.array([])
    forward = position[-1] > position[0]
    far = position if forward else -position
    marks = np.arange(far[0], far[-1], period)
    at = np.interp(marks, far, encoder)
    return np.asarray(np.diff(at) / (period if forward else -period), dtype=float)


def _jumps(apart: FloatArray) -> list[float]:
    """Sums of neighbouring periods in which the encoder went otherwise than the motor [full steps]."""
    found: list[float] = []
    last = -2
    for index in np.flatnonzero(np.abs(apart) > JUMP_FULLSTEPS):
        if index == last + 1:
            found[-1] += float(apart[index])
        else:
            found.append(float(apart[index]))
        last = int(index)
    return found
