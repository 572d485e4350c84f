"""The calculator's exact ramp and the emulated chip, written apart from each other, draw the same curve."""

from __future__ import annotations

import random

import numpy as np
import pytest

from app.calc.ramps.ticked import RampParameters, exact_ramp
from tests.emulators.harness import DIVIDERS, TICK, V_ACTUAL, X_ACTUAL, X_TARGET, free_bench


@pytest.mark.parametrize("mode", ["ramp", "soft"])
@pytest.mark.parametrize("seed", range(12))
def test_the_emulated_move_is_the_predicted_one(mode: str, seed: int) -> None:
    draw = random.Random(seed)
    pulse_div, ramp_div = draw.randint(0, 6), draw.randint(0, 6)
    a_max = draw.randint(20, 2047)
    p = min(255 / 8, a_max / 128 / 2 ** (ramp_div - pulse_div) * draw.uniform(0.7, 0.98))
    if mode == "soft":
        p /= 20
    pdiv = next(n for n in range(14) if p * 2 ** (3 + n) >= 128 or n == 13)
    pmul = max(0, min(127, int(p * 2 ** (3 + pdiv)) - 128))
    v_max, v_min = draw.randint(100, 2047), draw.randint(1, 40)
    distance = draw.choice((-1, 1)) * draw.randint(1, 9000)
    curve = exact_ramp(
        RampParameters(v_min, v_max, a_max, ramp_div, pulse_div, pmul, pdiv, mode), distance, samples=301
    )

    bench = free_bench()
    flags = {"ramp": 0, "soft": 1}
    bench.ramp(
        mode=flags[mode],
        v_min=v_min,
        v_max=v_max,
        a_max=a_max,
        p=pmul << 8 | pdiv,
        dividers=pulse_div << 12 | ramp_div << 8 | 6,
    )
    bench.ticks(1 << 13)  # a moment at which both dividers begin a period
    began = round(bench.clock.now() * 16e6)
    assert began % (TICK << 13) == 0
    bench.write(X_TARGET, distance)
    positions, velocities = [], []
    for at_s in curve.time_s:
        bench.clock.set((began + round(at_s * 16e6)) / 16e6)
        positions.append(bench.signed(X_ACTUAL))
        velocities.append(bench.signed(V_ACTUAL, 12))
    np.testing.assert_array_equal(positions, curve.position)
    rates = np.array(velocities) * 16e6 / (65536 * 2**pulse_div)
    np.testing.assert_allclose(rates, curve.velocity_pps)
    assert bench.read(DIVIDERS) == pulse_div << 12 | ramp_div << 8 | 6
