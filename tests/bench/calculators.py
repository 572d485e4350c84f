"""All inputs of the pmul/pdiv design in one call, against the data sheets' own loop (DS-TMC428 8.11 and 19) one by
one."""

from __future__ import annotations

import time

import numpy as np
from numpy.typing import NDArray

from app.calc.ramps import pmul_pdiv
from tests.bench.table import Row

REQUIRED = 50.0


def plain_loop(a_max: int, ramp_div: int, pulse_div: int, reduction: float) -> tuple[int, int]:
    """(pmul, pdiv), or (-1, -1): try each exponent until the mantissa fits 128..255."""
    p = a_max / (128.0 * 2.0 ** (ramp_div - pulse_div)) * (1.0 - reduction)
    for pdiv in range(14):
        p_mul = int(p * 8.0 * 2.0**pdiv)
        if 128 <= p_mul <= 255:
            return p_mul - 128, pdiv
    return -1, -1


def measure(*, quick: bool) -> Row:
    dividers = np.arange(0, 14, 4 if quick else 1)
    a_max, ramp_div, pulse_div = (
        axis.ravel() for axis in np.meshgrid(np.arange(1, 2048), dividers, dividers, indexing="ij")
    )
    reduction = pmul_pdiv.default_reduction("tmc428")

    vector_s = []
    for _ in range(7):
        start_s = time.perf_counter()
        table = pmul_pdiv.design_many(a_max, ramp_div, pulse_div, reduction)
        vector_s.append(time.perf_counter() - start_s)

    inputs = list(zip(a_max.tolist(), ramp_div.tolist(), pulse_div.tolist(), strict=True))
    start_s = time.perf_counter()
    looped = [plain_loop(a, r, p, reduction) for a, r, p in inputs]
    loop_s = time.perf_counter() - start_s

    pairs: NDArray[np.int64] = np.stack([table.pmul, table.pdiv], axis=1)
    identical = bool(np.array_equal(pairs, np.array(looped)))
    ratio = loop_s / min(vector_s)
    return Row(
        what=f"pmul/pdiv, {len(inputs):,} inputs in one call",
        measured=f"{min(vector_s) * 1e3:.1f} ms",
        peer=f"plain loop {loop_s * 1e3:.0f} ms",
        ratio=ratio,
        required=f">= {REQUIRED:g}, identical",
        ok=identical and ratio >= REQUIRED,
        notes=() if identical else ("the results differ",),
    )
