"""What of an emulated axis nothing can be spared: its motor's equations, compiled, and not a line besides.

The same steps of the same length as `app/emulators/drive/kernel.py` makes, of a motor that follows an even field: two
coils behind a regulator that the supply bounds, back-EMF, detent, load and friction. No ramp, no registers, no
switches, no encoder, no StallGuard: numbers in the registers of a processor. What a batch of whole axes makes of the
same cores can be held against that.
"""

from __future__ import annotations

import math
import time
from concurrent.futures import ThreadPoolExecutor

import numba
import numpy as np

from app.emulators.drive import Drive
from app.emulators.drive import kernel as k

FIELD_A_TICK = 0.5
"""How far the field turns in a tick [1/1024 of a period]."""
SPEED_UP = 1 << 16
"""Ticks until it does."""


FIGURES = (k.TEETH, k.KT, k.TD, k.LOAD, k.DT, k.DT_J, k.DAMP, k.FRICTION, k.KEEP, k.GAIN, k.ALPHA, k.SUPPLY)
"""Of a motor and a step of it, where the kernel keeps them."""


@numba.njit(nogil=True, error_model="numpy")
def _turned(ticks, table, figures):  # type: ignore[no-untyped-def]
    """Angle of the shaft [rad] after so many ticks. figures : `FIGURES`, and the peak of the current [A]"""
    teeth, kt, td, load, dt, dt_j, damp, friction, keep, gain, alpha, supply, peak = figures
    theta = omega = ia = ib = place = ahead = sine = 0.0
    cosine = 1.0
    reach = gain * supply
    for tick in range(ticks):
        place += FIELD_A_TICK * min(tick, SPEED_UP) / SPEED_UP
        look = int(place)
        ref_a, ref_b = peak * table[look & 1023], peak * table[(look + 256) & 1023]
        square = ahead * ahead
        fourth = square * square
        sin_by = ahead * ((1.0 - square * (1.0 / 6.0)) + fourth * (1.0 / 120.0 - square * (1.0 / 5040.0)))
        cos_by = (1.0 - 0.5 * square) + fourth * ((1.0 / 24.0 - square * (1.0 / 720.0)) + fourth * (1.0 / 40320.0))
        sine, cosine = sine * cos_by + cosine * sin_by, cosine * cos_by - sine * sin_by
        free_a = keep * ia - gain * (kt * omega * cosine)
        free_b = keep * ib + gain * (kt * omega * sine)
        ia = min(max(ia + alpha * (ref_a - ia), free_a - reach), free_a + reach)
        ib = min(max(ib + alpha * (ref_b - ib), free_b - reach), free_b + reach)
        detent = td * 4.0 * sine * cosine * (1.0 - 2.0 * sine * sine)
        new = (omega + (kt * (ia * cosine - ib * sine) - detent - load) * dt_j) * damp
        omega = new - friction if new > friction else new + friction if new < -friction else 0.0
        theta += omega * dt
        ahead = teeth * dt * omega
    return theta


def motors_alone(drives: list[Drive], seconds: int, tick_s: float) -> tuple[float, float]:
    """(motor-seconds a second of this machine, the least share of the field's way that a motor has gone)."""
    table = np.cos(np.arange(1024) * math.pi / 512)
    ticks = round(seconds / tick_s)
    figures = [(*(float(drive._f[cell]) for cell in FIGURES), float(drive._f[k.FULL_SCALE]) / 2) for drive in drives]
    _turned(1, table, figures[0])
    with ThreadPoolExecutor() as threads:
        began_s = time.perf_counter()
        angles = list(threads.map(lambda each: _turned(ticks, table, each), figures))
        took_s = time.perf_counter() - began_s
    way = FIELD_A_TICK * (ticks - SPEED_UP / 2) * 2 * math.pi / 1024 / figures[0][0]
    return len(drives) * seconds / took_s, min(angles) / way
