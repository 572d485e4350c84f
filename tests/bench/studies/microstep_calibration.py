"""Microstep calibration on plants whose motors and encoders are uneven, and which it does not know.

The judge works out where the rotor of such a motor stands without friction, from its options: where the torque of both
coils and the detent torque balance. Of the error over the electrical angle that part counts which a table of a quarter
wave can hold; the rest is told beside it.
"""

from __future__ import annotations

import math
import random
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.calc.microsteps.angle_correction import GRID, quarter_part, rms
from app.calc.microsteps.mslut import POWER_ON, Wave, decode
from app.devices.core.capabilities import MslutTable
from app.emulators.drive.options import MotorOptions
from app.studies.record import AngleFigures, StudyRecord
from tests.bench.collected import at_least, at_most, collected
from tests.bench.table import Row
from tests.plants.uneven import drawn
from tests.studies.harness import START, Studied, studied

FULL = replace(START, irun=31, ihold=31)
"""At the rated current, also at rest."""
STUDY: dict[str, Any] = {"kind": "microstep_calibration"}
BUDGET: dict[str, Any] = {"time_s": 3600.0}
LONGEST_S = 4000.0
NAMES = ("VMAX", "AMAX", "DMAX", "V1")
COUNTS_DEG = 0.35
"""From here on an error counts, root mean square [deg electrical]: five times what a table of 8 bits itself leaves."""
FACTOR, SHARE = 5.0, 0.95
NULLS = 1000
"""First seed of the plants with nothing to gain."""
AGAIN = 3000
"""Seed of the plant that is studied again and again."""
ORDERS = (2, 4)
"""Whose figures repeated studies have to agree on."""


def true_error_deg(options: dict[str, Any], wave: Wave) -> NDArray[np.float64]:
    """Rotor less command on `GRID`, by Newton's method from the field on [deg electrical]; mean 0."""
    motor = MotorOptions.model_validate(options["motor"])
    current = options["full_scale_a"] * (wave.period() + 0.5) / 248
    a, b = current, np.roll(current, -256)
    kt_a, kt_b = (motor.torque_constant * (1 + side * motor.phase_unbalance / 2) for side in (1, -1))
    third, apart = math.radians(motor.fourth_harmonic_deg), math.radians(motor.quadrature_error_deg)

    def torque(e: NDArray[np.float64]) -> NDArray[np.float64]:
        of_a = kt_a * (np.cos(e) + third * np.cos(3 * e))
        of_b = -kt_b * (np.sin(e + apart) - third * np.sin(3 * e))
        return np.asarray(a * of_a + b * of_b - motor.detent_torque_nm * np.sin(4 * e))

    rotor = np.arctan2(a, b)
    rotor = GRID + (rotor - GRID + math.pi) % (2 * math.pi) - math.pi
    for _ in range(30):
        rotor = rotor - torque(rotor) * 2e-6 / (torque(rotor + 1e-6) - torque(rotor - 1e-6))
    error = np.degrees(rotor - GRID)
    return np.asarray(error - error.mean())


@dataclass(frozen=True)
class Judged:
    """A study on a plant. before, after : what a table can hold of the true error; all_* : all of it [deg, rms]."""

    record: StudyRecord
    before: float
    after: float
    all_before: float
    all_after: float
    as_before: bool

    @property
    def counts(self) -> bool:
        """Whether there is anything that the table can take away."""
        return self.before >= COUNTS_DEG

    @property
    def factor(self) -> float:
        """By how much that became smaller."""
        return self.before / max(self.after, 1e-9)


async def _state(s: Studied) -> tuple[list[int], object]:
    return await s.settings(*NAMES), (await s.device.need(MslutTable).read_mslut(0)).registers


async def _judged(seed: int, folder: Path, *, nothing_to_gain: bool = False) -> Judged:
    options = drawn(seed, nothing_to_gain=nothing_to_gain)
    async with studied(folder, FULL, **options) as s:
        before = await _state(s)
        record = await s.finish(s.begin(s.document(STUDY, budget=BUDGET, seed=seed)), LONGEST_S)
        as_before = await _state(s) == before
    old = decode(POWER_ON)
    found = record.microsteps
    new = Wave(tuple(found.wave), old.mirror) if record.improved and found is not None and found.wave else old
    errors = [true_error_deg(options, wave) for wave in (old, new)]
    held = [rms(quarter_part(error)) for error in errors]
    return Judged(record, held[0], held[1], rms(errors[0]), rms(errors[1]), as_before)


async def claimed(seed: int, folder: Path) -> tuple[bool, str]:
    """Whether a table is changed that can do nothing."""
    record = (await _judged(seed, folder, nothing_to_gain=True)).record
    return bool(record.improved), record.verdict or record.message


async def _again(index: int, folder: Path, *, seed: int) -> AngleFigures:
    """What one of several studies of that plant tells, which begins elsewhere than the others."""
    begins = random.Random(1000 * seed + index).uniform(-100, 100)
    options = {**drawn(seed), "start_fullsteps": begins, "seed": index}
    async with studied(folder, FULL, **options) as s:
        record = await s.finish(s.begin(s.document(STUDY, budget=BUDGET)), LONGEST_S)
    assert record.microsteps is not None, record.message
    return record.microsteps.before


def agreeing(found: Sequence[AngleFigures]) -> tuple[int, int]:
    """Of all figures of all pairs of studies, how many agree within their intervals; and how many there are."""
    agreed = pairs = 0
    for first in range(len(found)):
        for second in range(first):
            for one, other in zip(found[first].harmonics, found[second].harmonics, strict=True):
                if one.order in ORDERS:
                    half = one.half_deg + other.half_deg
                    agreed += abs(one.sine_deg - other.sine_deg) <= half
                    agreed += abs(one.cosine_deg - other.cosine_deg) <= half
                    pairs += 2
    return agreed, pairs


async def _aborted(seed: int, folder: Path) -> bool:
    """Whether the axis is as before, or what is left is told, after a stop at a random moment."""
    rng = random.Random(seed)
    async with studied(folder, FULL, **drawn(seed)) as s:
        before, run = await _state(s), s.begin(s.document(STUDY, budget=BUDGET))
        await s.clock.advance(rng.uniform(0.05, 500))
        await s.device.stop_axes([0], rng.choice(("ramp", "immediate")))
        record = await s.finish(run, 60)
        return await _state(s) == before or bool(record.left)


def _words(one: Judged) -> str:
    return one.record.verdict or one.record.message


def measure(quick: bool) -> Sequence[Row]:
    """Four rows; quick: a few plants of each."""
    plants, repeats, aborts = (3, 3, 3) if quick else (100, 10, 20)
    judged = collected("calibration", _judged, range(plants), share=0.4).values()
    null = collected("gain microstep calibration", claimed, range(NULLS, NULLS + plants), share=0.3).values()
    again = collected("calibration again", partial(_again, seed=AGAIN), range(repeats), share=0.1)
    agreed, pairs = agreeing([*again.values()])
    stops = collected("calibration aborts", _aborted, range(2000, 2000 + aborts), share=0.2).values()
    worth = [one for one in judged if one.counts]
    factors = [one.factor for one in worth]
    reached = sum(factor >= FACTOR for factor in factors)
    odd = [one for one in judged if one.record.state != "done" or not one.as_before]
    whole = [float(np.median(each)) for each in zip(*((one.all_before, one.all_after) for one in worth), strict=True)]
    said = [
        f"the whole error, also what no such table takes away: median {whole[0]:.2f} to {whole[1]:.2f} deg electrical"
    ]
    said += [f"1/{one.factor:.1f}: {_words(one)}" for one in worth if one.factor < FACTOR]
    said += [f"not as before, or not over: {_words(one)}" for one in odd]
    changed = [words for better, words in null if better]
    return [
        Row(
            what=f"microstep calibration on {len(judged)} blind plants, "
            f"{len(worth)} with an error that a table can hold",
            measured=f"{at_least(reached, len(worth))} to a fifth or less; "
            f"median 1/{np.median(factors):.0f}, worst 1/{min(factors):.1f}",
            peer=f"{len(worth)}",
            ratio=reached / len(worth),
            required=f">= {SHARE:g}, every axis as before",
            ok=reached / len(worth) >= SHARE and not odd,
            notes=tuple(said),
        ),
        Row(
            what=f"microstep calibration on {len(null)} plants whose errors no table can hold",
            measured=f"{at_most(len(changed), len(null))} changed",
            peer=f"{len(null)}",
            ratio=len(changed) / len(null),
            required=f"<= {1 - SHARE:.2g}",
            ok=len(changed) <= (1 - SHARE) * len(null),
            notes=tuple(changed),
        ),
        Row(
            what=f"{len(again)} calibrations of one plant: harmonics 2 and 4, each pair of studies",
            measured=f"{agreed} within their intervals",
            peer=f"{pairs}",
            ratio=agreed / pairs,
            required=f">= {SHARE:g}",
            ok=agreed / pairs >= SHARE,
        ),
        Row(
            what=f"calibrations stopped at {len(stops)} random moments",
            measured=f"{sum(stops)} as before, or told what is left",
            peer=f"{len(stops)}",
            ratio=sum(stops) / len(stops),
            required="all",
            ok=all(stops),
        ),
    ]
