"""The closed loop on plants drawn from a seed that the study does not know."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from app.calc.motors.position_loop import Gains, Margins, Plant, margins
from app.studies.closed_loop.found import LoopFound
from app.studies.ramp_settings import held_of, value_now
from app.studies.record import Held, StudyRecord
from app.studies.store import StudyStore
from tests.bench.collected import at_least, collected
from tests.bench.table import Row
from tests.devices.tmc4361.harness import START, bench
from tests.plants.loops import drawn
from tests.studies.harness import Studied

STUDY = {"kind": "closed_loop"}
NAMES = ("PID_P", "PID_I", "PID_D", "PID_DV_CLIP", "PID_TOLERANCE", "ENC_IN_CONF", "VMAX", "RAMPMODE")
ASKED_GAIN, ASKED_PHASE_DEG = 2.0, 60.0
TRUE_DELAY_S = 1e-4
"""Of the emulated chopper."""
REPEATED = 3000
"""Seed of the first plant that is studied again and again."""
WITHIN, SHARE, CAPTURES_MAX, LONGEST_S = 0.1, 0.9, 25, 300.0


@dataclass(frozen=True)
class Judged:
    """A study of a plant, and the margins that its gains truly have. as_before : whether its axis is set as it was"""

    record: StudyRecord
    true: Margins | None
    as_before: bool

    @property
    def as_asked(self) -> bool:
        """Margins as they were asked for, and steps as the study expected them."""
        found, true = self.record.loop, self.true
        if found is None or true is None or found.overshoot is None:
            return False
        return (
            abs(true.gain / ASKED_GAIN - 1) <= WITHIN
            and abs(true.phase_deg / ASKED_PHASE_DEG - 1) <= WITHIN
            and abs(found.overshoot.value / found.expected_overshoot - 1) <= WITHIN
        )


async def _state(s: Studied) -> list[int | None]:
    held = await held_of(s.device)
    return [value_now(s.device, held, Held(name=name, axis=0, value=0)) for name in NAMES]


async def claimed(number: int, folder: Path) -> tuple[bool, str] | None:
    """Whether gains are claimed to be better than those that a first study has set; None where it set none."""
    plant = drawn(number)
    start = replace(START, stops=False, counts_per_rev=4 * plant.options["encoder"]["lines"])
    async with bench(start, **plant.options) as b:
        s = Studied(b, StudyStore(folder, aside=False))
        if not (await s.finish(s.begin(s.document({**STUDY, "keep": True})), LONGEST_S)).improved:
            return None
        record = await s.finish(s.begin(s.document(STUDY)), LONGEST_S)
        return bool(record.improved), record.verdict or record.message


async def judged(number: int, folder: Path, **more: object) -> Judged:
    """A study of the plant of that number; `more` : options of its own."""
    plant = drawn(number)
    start = replace(START, stops=False, counts_per_rev=4 * plant.options["encoder"]["lines"])
    async with bench(start, **{**plant.options, **more}) as b:
        s = Studied(b, StudyStore(folder, aside=False))
        before = await _state(s)
        record = await s.finish(s.begin(s.document(STUDY)), LONGEST_S)
        found, true = record.loop, None
        if found is not None:
            gains = Gains(found.proportional_per_s, found.integral_per_s2)
            true = margins(gains, Plant(plant.w, plant.damping, TRUE_DELAY_S))
        return Judged(record, true, await _state(s) == before)


async def _again(index: int, folder: Path, *, number: int) -> LoopFound:
    """What one of several studies of that plant tells, which begins elsewhere than the others."""
    begins = random.Random(1000 * number + index).uniform(-100, 100)
    one = await judged(number, folder, start_fullsteps=begins, seed=index)
    assert one.record.loop is not None, one.record.message
    return one.record.loop


def agreeing(found: Sequence[LoopFound]) -> tuple[int, int]:
    """Of the overshoots and resonances of all pairs of studies, how many agree within their intervals; and of all."""
    agreed = pairs = 0
    for first in range(len(found)):
        for second in range(first):
            for a, b in (
                (found[first].resonance_hz, found[second].resonance_hz),
                (found[first].overshoot, found[second].overshoot),
            ):
                if a is not None and b is not None:
                    agreed += a.interval.low <= b.interval.high and b.interval.low <= a.interval.high
                    pairs += 1
    return agreed, pairs


def measure(quick: bool) -> Sequence[Row]:
    """One row; quick: a few plants."""
    found = collected("closed loop", judged, range(4 if quick else 100))
    plants, count = found.values(), len(found)
    good = sum(one.as_asked for one in plants)
    most = max(one.record.runs for one in plants)
    odd = [one.record.message for one in plants if one.record.state != "done" or not one.as_before]
    said = [f"plant {seed}: {words(one)}" for seed, one in found.items() if not one.as_asked]
    return [
        Row(
            what=f"closed loop of {count} blind plants: margins and overshoot as asked within 10 %",
            measured=f"{at_least(good, count)}, {most} captures at most",
            peer=f"{count}",
            ratio=good / count,
            required=f">= {SHARE:g}, <= {CAPTURES_MAX} captures, every axis as before",
            ok=good >= SHARE * count and most <= CAPTURES_MAX and not odd,
            notes=(*said, *odd),
        ),
    ]


def measure_repeats(quick: bool) -> Sequence[Row]:
    """A row a plant; quick: one plant, fewer repeats."""
    plants, times = (1, 3) if quick else (3, 10)
    found: dict[int, tuple[int, int]] = {}
    for plant in range(REPEATED, REPEATED + plants):
        again = collected(f"loop {plant} again", partial(_again, number=plant), range(times), share=1 / plants)
        found[plant] = agreeing([*again.values()])
    return [
        Row(
            what=f"{times} studies of loop plant {plant}: resonance and overshoot, each pair of studies",
            measured=f"{agreed} within their intervals",
            peer=f"{pairs}",
            ratio=agreed / pairs,
            required=f">= {SHARE:g}",
            ok=agreed >= SHARE * pairs,
        )
        for plant, (agreed, pairs) in found.items()
    ]


def words(one: Judged) -> str:
    """What a study told, and the margins that its gains truly have."""
    true = one.true
    told = one.record.verdict or one.record.message
    return told if true is None else f"{told}; truly {true.phase_deg:.1f} deg and {true.gain:.2f}"
