"""The calmest chopper on plants drawn from a seed that the study does not know, against the whole grid of its settings.

The grid is worked out on the drive itself, at the same speeds: the load angle, without the encoder and the wire.
"""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from app.emulators.drive import Drive
from app.emulators.tmc5xxx import Tmc5xxxOptions
from app.studies.chopper.ripple import rate_for, together
from app.studies.chopper.setting import ChopperSetting, ChopperSpace, Coil
from app.studies.families import chopper_of
from app.studies.ramp_settings import held_of
from app.studies.record import StudyRecord
from tests.bench.collected import at_least, at_most, collected
from tests.bench.table import Row
from tests.plants.choppers import ChopperPlant, drawn
from tests.studies.harness import START, Studied, studied

SPEEDS = (0.25, 0.5, 1.0)
TRIALS = 60
BUDGET: dict[str, Any] = {"trials": TRIALS, "time_s": 20_000.0}
LOWEST_HZ = 20e3
NAMES = ("CHOPCONF", "GCONF", "VMAX", "AMAX")
UNITS_A_TURN = 53_687.1
"""VMAX of a turn a second."""
SPEED_UP_S, SETTLES_S, RUN_S, PERIODS = 0.25, 0.7, 0.4, 8
PLANTS, FIRST, NULLS, NULL = 100, 200, 100, 1000
"""So many of each kind, and the first seed of either: some below were looked at while the study was made."""
WITHIN, SHARE, CLAIMED_MAX = 1.03, 0.95, 0.05
BEGINS = 1.1
"""Plants begin with a setting that shakes at least so much more than the best, as far as the grid has any."""


@dataclass(frozen=True)
class Judged:
    """A study on a plant. ratio : how much the shaft shakes by what it leaves set, over the best of the whole grid."""

    record: StudyRecord
    as_before: bool
    ratio: float
    before: float
    calculated: float
    grid: int


def shaken(options: Tmc5xxxOptions, registers: Mapping[str, int]) -> float:
    """How much the shaft shakes by its load angle [full steps], as the study puts speeds together."""
    by_speed = []
    for rps in SPEEDS:
        drive = Drive(options.drive(1.0, has_encoder=True))
        for name, value in registers.items():
            drive.write(name, value)
        drive.advance(round(0.1 * 16e6))
        speed = round(rps * UNITS_A_TURN)
        drive.write("AMAX", max(round(rps * 51_200 / 0.2 / (16e6**2 / 2**41)), 1))
        drive.write("VMAX", speed)
        drive.write("RAMPMODE", 1)
        drive.advance(round((0.1 + SPEED_UP_S + SETTLES_S) * 16e6) + round(4 / (200 * rps) * 16e6))
        rate_hz, seen = rate_for(50 * rps), []
        began = drive.clocks
        for index in range(round(max(RUN_S, PERIODS / (50 * rps)) * rate_hz)):
            drive.advance(began + round(index / rate_hz * 16e6))
            seen.append(drive.plant_state.load_angle_deg / 90)
        by_speed.append(float(np.std(seen)))
    return together(by_speed, 1e-6)


class Grid:
    """All that may be tried on a plant, and how much the shaft shakes by each."""

    def __init__(self, plant: ChopperPlant, space: ChopperSpace, registers: Mapping[str, int]) -> None:
        self._options = Tmc5xxxOptions.model_validate(plant.options)
        self._space, self._registers = space, dict(registers)
        self.of = {each: self.shaken(each) for each in space.allowed(LOWEST_HZ)}

    def shaken(self, setting: ChopperSetting) -> float:
        """By one of them, or another."""
        words = {each.name: each.value for each in self._space.registers(setting)}
        return shaken(self._options, {**self._registers, "CHOPCONF": words["CHOPCONF"]})

    @property
    def bad(self) -> list[ChopperSetting]:
        """Those that are not nearly the best; the worst of all where all are."""
        least, most = self.of[self.best], max(self.of.values())
        return [each for each, found in self.of.items() if found >= min(BEGINS * least, most)]

    @property
    def best(self) -> ChopperSetting:
        """The calmest of all."""
        return min(self.of, key=lambda each: self.of[each])


async def _space(s: Studied, plant: ChopperPlant) -> ChopperSpace:
    coil = Coil(
        plant.told["resistance_ohm"],
        plant.told["inductance_h"],
        plant.told["run_current_a"],
        plant.told["supply_v"],
        16e6,
        plant.irun,
    )
    return ChopperSpace(s.device, 0, chopper_of(s.device), await held_of(s.device), coil)


async def _judged(seed: int, folder: Path, *, best_before: bool) -> Judged:
    """`best_before` : the axis is set to the best of the grid at first, so that there is nothing to gain."""
    plant = drawn(seed)
    counts = 4 * plant.options["encoder"]["lines"]
    start = replace(START, vmax=51_200, amax=256_000, irun=plant.irun, ihold=plant.irun, counts_per_rev=counts)
    async with studied(folder, start, **plant.options) as s:
        space = await _space(s, plant)
        names = ("CHOPCONF", "IHOLD_IRUN", "GLOBAL_SCALER")
        chopconf, current, scaler = await s.settings(*names)
        grid = Grid(plant, space, {"CHOPCONF": chopconf, "IHOLD_IRUN": current, "GLOBALSCALER": scaler})
        first = grid.best if best_before else random.Random(seed).choice(grid.bad)
        words = {each.name: each.value for each in space.registers(first)}
        await s.passing(_set(s, words["CHOPCONF"]))
        before = await s.settings(*NAMES)
        study = {"kind": "chopper", "speeds_rps": list(SPEEDS), "lowest_hz": LOWEST_HZ, **plant.told}
        record = await s.finish(s.begin(s.document(study, budget=BUDGET, seed=seed)), 20_000)
        as_before = await s.settings(*NAMES) == before
    found, best = record.chopper, grid.of[grid.best]
    left = first
    if record.improved and found is not None and found.chosen is not None:
        left = ChopperSetting(found.chosen.off, found.chosen.blank, found.chosen.hysteresis)
    return Judged(
        record,
        as_before,
        grid.of[left] / best,
        grid.of[first] / best,
        grid.of.get(space.calculated, 0.0) / best,
        len(grid.of),
    )


async def _set(s: Studied, chopconf: int) -> None:
    await s.device.registers.write("CHOPCONF", 0, chopconf)


def measure(quick: bool) -> Sequence[Row]:
    """Two rows; quick: a few plants of each."""
    plants, nulls = (3, 2) if quick else (PLANTS, NULLS)
    any_first, best = (partial(_judged, best_before=each) for each in (False, True))
    judged = collected("chopper", any_first, range(FIRST, FIRST + plants), share=2 / 3).values()
    empty = collected("chopper at its best", best, range(NULL, NULL + nulls), share=1 / 3).values()
    near = [one for one in judged if one.ratio <= WITHIN]
    far = [one for one in judged if one.ratio > WITHIN]
    odd = [one for one in (*judged, *empty) if one.record.state != "done" or not one.as_before]
    claimed = [one for one in empty if one.record.improved]
    ratios, before = [one.ratio for one in judged], [one.before for one in judged]
    calculated = [one.calculated for one in judged]
    return [
        Row(
            what=f"chopper on {len(judged)} blind plants: ripple of what {TRIALS} trials leave set, over the best of "
            f"the whole grid, {min(one.grid for one in judged)} to {max(one.grid for one in judged)} settings",
            measured=f"{at_least(len(near), len(judged))}, within 3 %; "
            f"median {np.median(ratios):.3f}, worst {max(ratios):.3f}",
            peer=f"before {np.median(before):.3f}, worst {max(before):.3f}; calculated {np.median(calculated):.3f}",
            ratio=len(near) / len(judged),
            required=f">= {SHARE:g}, every axis as before",
            ok=len(near) >= SHARE * len(judged) and not odd,
            notes=tuple(one.record.verdict or one.record.message for one in (*odd, *far)),
        ),
        Row(
            what=f"a calmer chopper claimed on {len(empty)} plants that have the best of the grid already",
            measured=at_most(len(claimed), len(empty)),
            peer=f"{len(empty)}",
            ratio=len(claimed) / len(empty),
            required=f"<= {CLAIMED_MAX:g}",
            ok=len(claimed) <= CLAIMED_MAX * len(empty),
            notes=tuple(one.record.verdict for one in claimed),
        ),
    ]
