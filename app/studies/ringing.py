"""A hop, and how the rotor rings after it, as the encoder shows it."""

from __future__ import annotations

import math
from collections.abc import Awaitable, Callable

import numpy as np

from ..calc.motors.ring_down import Ring
from ..clock import Clock
from ..devices.core.device import Device
from ..procedures.procedure import Failed
from .sampled import sampling

HOP_PPS = 200_000.0
"""A hop of three quarters of a full step is over within a millisecond."""
HOPS = (0.75, 0.65, 0.85, 0.70, 0.80)
"""Of a full step, in turn: the rotor rings far, does not slip, and rests at another place of the detent torque."""
RING_S = 0.5
"""How long a ring is looked at [s]."""
RATE_HZ = 1000.0
BEFORE_S = 0.02
"""Sampled before a hop [s], and up to twice as long."""
GOLDEN = (math.sqrt(5) - 1) / 2
"""Multiples of it, less whole numbers, spread evenly."""
LEAST = 5
"""Samples that follow its last step belong to a ring."""


async def ring_after(
    hop: Callable[[int], Awaitable[object]],
    device: Device,
    axis: int,
    clock: Clock,
    target: int,
    full_step: int,
    number: int,
) -> Ring:
    """Hop to `target`, and what the encoder shows from there on. Raises Failed where it does not get there.

    number : of the hop: each begins at another place between two samples, by which a swing that is sampled too rarely
    is told from a slower one
    """
    with sampling(device, [f"position.{axis}", f"encoder_position.{axis}"], RATE_HZ, clock) as samples:
        await clock.sleep(BEFORE_S * (1 + number * GOLDEN % 1))
        await hop(target)
        await clock.sleep(RING_S)
        samples.take()
    times_s, rows = samples.all()
    position, encoder = rows.T
    known = np.isfinite(position) & np.isfinite(encoder)
    times_s, position, encoder = times_s[known], position[known], encoder[known]
    away = np.flatnonzero(position != target)
    begin = int(away[-1]) + 1 if len(away) else 0
    if begin + LEAST >= len(position):
        raise Failed(f"the motor stands at {position[-1]:g}, not {target}: by a switch, or its ramp is 0")
    rad = 2 * math.pi / (4 * full_step)
    forward = not len(away) or bool(position[away[0]] < target)
    gap_s = float(times_s[begin] - times_s[max(begin - 1, 0)])
    return Ring(times_s[begin:] - times_s[begin], encoder[begin:] * rad, target * rad, forward, gap_s)
