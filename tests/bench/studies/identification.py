"""Motor and machine on plants drawn from a seed that the study does not know."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from app.studies.fitted import Estimate
from app.studies.record import StudyRecord
from tests.bench.collected import collected
from tests.bench.table import Row
from tests.plants.machines import Machine, drawn
from tests.studies.harness import START, studied

NAMES = ("VMAX", "VSTART", "VSTOP", "AMAX", "DMAX", "V1", "IHOLD_IRUN")
LONGEST_S = 1000.0
WITHIN = {"inertia": 0.10, "resonance": 0.02, "damping": 0.15}
BACKLASH = 1.0
COIL = ("resistance", "inductance", "back-EMF")
SHARE, COVERED = 0.95, 0.90
FIRST = 1000
"""Seed of the first plant: those below were looked at while the study was made."""


@dataclass(frozen=True)
class Judged:
    """What a study told of a plant. as_before : whether its axis is set as it was"""

    machine: Machine
    record: StudyRecord
    as_before: bool

    def figures(self) -> dict[str, tuple[Estimate | None, float]]:
        """What was told, and what is true."""
        told, true = self.record.identified, self.machine
        if told is None:
            return dict.fromkeys((*WITHIN, "backlash", *COIL), (None, 0.0))
        motor = true.options["motor"]
        return {
            "inertia": (told.inertia_kgm2, true.inertia_kgm2),
            "resonance": (told.resonance_hz, true.resonance_hz),
            "damping": (told.damping_ratio, true.damping),
            "backlash": (told.backlash_microsteps, true.backlash_microsteps),
            "resistance": (told.resistance_ohm, motor["resistance_ohm"]),
            "inductance": (told.inductance_h, motor["inductance_h"]),
            "back-EMF": (
                told.back_emf_v_s_rad,
                motor["holding_torque_nm"] / (math.sqrt(2) * motor["rated_current_a"]),
            ),
        }

    def right(self, name: str) -> bool:
        """Whether a figure is as near to the truth as it has to be."""
        if name == "lines":
            return self.record.identified is not None and self.record.identified.encoder_lines == self.machine.lines
        told, true = self.figures()[name]
        most = BACKLASH if name == "backlash" else WITHIN[name] * true
        return told is not None and abs(told.value - true) <= most

    def holds(self, name: str) -> bool | None:
        """Whether the truth is in the interval; None where nothing was told."""
        told, true = self.figures()[name]
        return None if told is None else told.interval.low <= true <= told.interval.high


async def judged(seed: int, folder: Path) -> Judged:
    """A study of the plant of that seed."""
    machine = drawn(seed)
    start = replace(START, irun=31, ihold=16, stops=False, counts_per_rev=4 * machine.lines)
    async with studied(folder, start, **machine.options) as s:
        before = await s.settings(*NAMES)
        motor = machine.options["motor"]
        study = {
            "kind": "identification",
            "hold_torque_nm": machine.torque_nm,
            "supply_v": machine.options["supply_v"],
            "run_current_a": motor["rated_current_a"],
        }
        record = await s.finish(s.begin(s.document(study)), LONGEST_S)
        return Judged(machine, record, await s.settings(*NAMES) == before)


def measure(quick: bool) -> Sequence[Row]:
    """Two rows of a batch of plants; quick: a few."""
    found = collected("identification", judged, range(FIRST, FIRST + (4 if quick else 100)))
    plants, count = found.values(), len(found)
    figures = (*WITHIN, "backlash")
    names = (*figures, "lines")
    right = {name: sum(one.right(name) for one in plants) for name in names}
    told = {name: [each for one in plants if (each := one.holds(name)) is not None] for name in (*figures, *COIL)}
    covered = {name: sum(each) / len(each) if each else 0.0 for name, each in told.items()}
    odd = [one.record.message for one in plants if one.record.state != "done" or not one.as_before]
    said = [
        f"plant {seed}: {name}, {_words(one, name)}"
        for seed, one in found.items()
        for name in names
        if not one.right(name)
    ]
    return [
        Row(
            what=f"motor and machine of {count} blind plants within 10 % (inertia), 2 %, 15 %, 1 microstep, exact",
            measured=", ".join(f"{name} {number}" for name, number in right.items()),
            peer=f"{count}",
            ratio=min(right.values()) / count,
            required=f">= {SHARE:g} of each, every axis as before",
            ok=min(right.values()) >= SHARE * count and not odd,
            notes=(*said, *odd),
        ),
        Row(
            what="the same: truth inside the told 95 % interval",
            measured=", ".join(f"{name} {sum(each)} of {len(each)}" for name, each in told.items()),
            peer="of those that were told",
            ratio=min(covered.values()),
            required=f">= {COVERED:g} of each",
            ok=min(covered.values()) >= COVERED,
            notes=tuple(
                f"{name} cannot be told of {count - len(each)} plants"
                for name, each in told.items()
                if len(each) < count
            ),
        ),
    ]


def _words(one: Judged, name: str) -> str:
    identified = one.record.identified
    if name == "lines" or identified is None:
        return f"{identified and identified.encoder_lines} for {one.machine.lines}; {one.record.message}"
    told, true = one.figures()[name]
    return f"none for {true:.4g}" if told is None else f"{told.value:.4g} for {true:.4g}"
