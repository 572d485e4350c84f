"""Microstep tables of one-bit differences: every sin^f and sigma wave there and back, and the nearest one."""

from __future__ import annotations

import itertools
import time

import numpy as np

from app.calc.microsteps.mslut import POWER_ON, decode, encode, refusals
from app.calc.microsteps.mslut_nearest import nearest
from app.calc.microsteps.mslut_waves import GRIDS, Formula, exponent_of_thousandths, wanted_wave
from tests.bench.table import Row

AMPLITUDES = (None, 120.0, 200.0, 255.0)


def measure(*, quick: bool) -> Row:
    amplitudes = AMPLITUDES[:1] if quick else AMPLITUDES
    exponents = [exponent_of_thousandths(c) for c in range(30, 201)]
    sigmas = [hundredths / 100 for hundredths in range(-100, 101)]
    formulas = [
        *(Formula(exponent=f, grid=g, amplitude=a) for f, g, a in itertools.product(exponents, GRIDS, amplitudes)),
        *(
            Formula(sigma=s, grid=g, amplitude=a, full_scale=full)
            for s, g, a, full in itertools.product(sigmas, GRIDS, amplitudes, (False, True))
        ),
    ]
    encodable = exact = 0
    start_s = time.perf_counter()
    for formula in formulas:
        wave = wanted_wave(formula).wave
        if not any(refusals(wave)):
            encodable += 1
            exact += decode(encode(wave.values, wave.mirror)) == wave
    each_s = (time.perf_counter() - start_s) / len(formulas)

    noisy = np.asarray(decode(POWER_ON).values) + np.random.default_rng(4361).normal(0, 10, 256)
    start_s = time.perf_counter()
    found = nearest(noisy)
    nearest_s = time.perf_counter() - start_s
    return Row(
        what=f"MSLUT round trip, {len(formulas):,} sin^f and sigma waves",
        measured=f"{exact:,} exact",
        peer=f"{encodable:,} encodable",
        ratio=exact / encodable,
        required="all exact",
        ok=exact == encodable > 0,
        notes=(
            (
                f"{each_s * 1e3:.2f} ms for a wave, its registers and back; "
                f"{nearest_s * 1e3:.0f} ms for the nearest wave to a noisy one, {found.distance_rms:.1f} counts away"
            ),
        ),
    )
