"""StallGuard's threshold on plants drawn from a seed that the study does not know.

The referee takes a chip of its own with the same plant, sets it as the study's axis was and as the study says, and
counts: 500 free runs and 500 into the stop at each speed that the study answers for, by the threshold that it
names there, up to 2000 where these leave open whether fewer than 1 % are wrong.
Where the study says that no threshold does it, the referee tries thresholds all over the range, with and without the
filter. Of so many one may pass by luck: one is there where as many runs show less than 1 %, with 95 %.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from app.clock import VirtualClock
from app.emulators.tmc5xxx import Tmc5xxxOptions
from app.emulators.tmc5xxx.family import FAMILY
from app.registers.tmc5xxx.table import TABLES
from app.studies.proof import rate_bound, rate_shown
from app.studies.ramp_settings import held_of
from app.studies.record import Held, StudyRecord
from tests.bench.collected import at_least, collected
from tests.bench.table import Row
from tests.plants.stalls import APART_PUSH_FULLSTEPS, APART_RPS, apart, drawn
from tests.studies.harness import START, studied

FULL = replace(START, stops=False, vmax=102_400, amax=400_000, irun=31, ihold=16)
"""At the rated current while it moves."""
NAMES = ("VMAX", "AMAX", "DMAX", "COOLCONF", "SW_MODE", "TCOOLTHRS", "THIGH", "GCONF")
TABLE = TABLES["tmc5160"]
FULL_STEP, TURN = 256, 51_200
CLOCK_HZ = 16e6
STALL, STEP_S, RUN_FULLSTEPS, PUSH_FULLSTEPS, SHORT_FULLSTEPS = 1 << 6, 0.005, 200.0, 8.0, 3.0
"""Event of a stop by StallGuard in RAMP_STAT; how often the referee looks [s]; what it counts as the study does."""
RUNS, RUNS_MOST, RATE_MAX = 500, 2000, 0.01
GRID = 4
"""From one threshold of the referee's search to the next."""
FOUND_RUNS = 100
SHARE = 0.95
PROOF = 366
"""Runs of the study's own proof: without a wrong one they show less than 1 %; two may be made up for by more."""
NOISE = {"full_scale": 60.0, "noise": 200.0, "noise_with_speed": 1000.0}
"""Load values whose noise is five times what a load makes of them."""
FIRST_SEED = 1000
"""Those below were looked at while the study was written."""


def _decided(wrong: int, count: int, runs: int, searching: bool) -> bool:
    """Whether so many runs tell enough: fewer than `RUNS` are for a look, and one that is wrong ends that.

    searching : what the first runs speak against is given up; a claim has all of its runs, or a few that are wrong
    early would end it too often
    """
    if runs < RUNS:
        return wrong > 0 or count >= runs
    if count >= RUNS_MOST or (count >= RUNS and rate_bound(wrong, count) < RATE_MAX):
        return True
    return searching and rate_shown(wrong, count) > RATE_MAX


class Referee:
    """A chip with a plant, set as a study has left its axis but for what is tried."""

    def __init__(
        self, options: dict[str, Any], words: dict[int, int], seed: int, push_fullsteps: float = PUSH_FULLSTEPS
    ) -> None:
        """words : by address, what every register of the configuration holds"""
        self._push_fullsteps = push_fullsteps
        self._chip = FAMILY.make("tmc5160", VirtualClock(), Tmc5xxxOptions.model_validate({"motor": {}, **options}))
        self._end = float(options["stage"]["left_end_fullsteps"])
        self._t = 0.0
        self._random = random.Random(seed)
        for address, word in sorted(words.items()):
            self._chip.write(address, word, 0.0)
        self._to("DMAX", 65_535)
        self._to("RAMPMODE", 1)
        self._wait(1.0)

    def set(self, registers: Sequence[Held]) -> None:
        """Set what a study says, and let a stall stop the motor."""
        for each in registers:
            row = TABLE.get(each.name, each.axis)
            self._chip.write(row.address, row.encode(each.value), self._t)
        row = TABLE.get("SW_MODE", 0)
        field = row.field_named("sg_stop")
        assert field is not None
        self._chip.write(row.address, field.mask, self._t)

    def _to(self, name: str, word: int) -> None:
        self._chip.write(TABLE.get(name, 0).address, word & 0xFFFFFFFF, self._t)

    def _wait(self, seconds: float) -> float:
        """Let time pass; where the field is then, but for where it was at power-on [full steps]."""
        self._t += seconds
        word = self._chip.read(TABLE.get("XACTUAL", 0).address, self._t)
        return (word - (word >> 31 << 32)) / FULL_STEP

    def _stalled(self) -> bool:
        return bool(self._chip.read(TABLE.get("RAMP_STAT", 0).address, self._t) & STALL)

    def _rotor(self) -> float:
        """Where the rotor is [full steps]."""
        return self._chip.ground_truth(0, self._t).shaft_fullsteps

    def _turn(self, way: int, speed_pps: float) -> None:
        self._to("RAMPMODE", 1 if way > 0 else 2)
        self._to("VMAX", round(speed_pps * 2**24 / CLOCK_HZ))

    def _rest(self) -> None:
        self._to("VMAX", 0)
        self._wait(0.1 + 2 * TURN / FULL.amax)
        self._to("RAMP_STAT", STALL)
        self._wait(0.01)

    def _away(self, speed_pps: float) -> None:
        """To where a run into the stop begins, by StallGuard unhindered."""
        stop = TABLE.get("SW_MODE", 0).address
        held = self._chip.read(stop, self._t)
        self._chip.write(stop, 0, self._t)
        up = (speed_pps**2 / (2 * FULL.amax)) / FULL_STEP
        begin = self._end + up + 60 + self._random.uniform(0, 4)
        for _ in range(4000):
            rotor = self._rotor()
            if abs(rotor - begin) < 4:
                break
            self._turn(1 if rotor < begin else -1, 0.5 * TURN)
            self._wait(STEP_S)
        self._rest()
        self._chip.write(stop, held, self._t)

    def missed(self, speed_pps: float, runs: int, searching: bool) -> tuple[int, int, int]:
        """(missed, false, runs) of runs into the stop."""
        missed = false = count = 0
        while not _decided(max(missed, false), count, runs, searching):
            self._away(speed_pps)
            off = self._wait(0.0) - self._rotor()
            self._turn(-1, speed_pps)
            for _ in range(4000):
                beyond = self._end - (self._wait(STEP_S) - off)
                if self._stalled():
                    false += beyond < -SHORT_FULLSTEPS
                    break
                if beyond > self._push_fullsteps:
                    missed += 1
                    break
            self._rest()
            count += 1
        return missed, false, count

    def false(self, speed_pps: float, runs: int, searching: bool) -> tuple[int, int]:
        """(false stalls, runs) of runs past nothing."""
        false = count = 0
        self._away(speed_pps)
        while not _decided(false, count, runs, searching):
            begin = self._wait(0.0)
            self._turn(1 if count % 2 == 0 else -1, speed_pps)
            for _ in range(4000):
                field = self._wait(STEP_S)
                if self._stalled():
                    false += 1
                    break
                if abs(field - begin) >= RUN_FULLSTEPS:
                    break
            self._rest()
            count += 1
            if count % 20 == 0 or self._rotor() < self._end + 100:
                self._away(speed_pps)
        return false, count

    def holds(self, speeds_pps: Sequence[float], runs: int, *, searching: bool = False) -> str:
        """What is wrong too often in so many runs; empty for nothing. searching : or what is not shown to be so."""

        def fails(wrong: int, count: int) -> bool:
            shown = not searching or runs < RUNS or rate_bound(wrong, count) < RATE_MAX
            return wrong >= RATE_MAX * count or not shown

        for speed_pps in speeds_pps:
            missed, early, count = self.missed(speed_pps, runs, searching)
            if fails(max(missed, early), count):
                return f"{missed} missed, {early} false in {count} runs into the stop at {speed_pps / TURN:g} turns/s"
            false, count = self.false(speed_pps, runs, searching)
            if fails(false, count):
                return f"{false} of {count} free runs stopped at {speed_pps / TURN:g} turns/s"
        return ""

    def finds(self, speeds_pps: Sequence[float], registers: Sequence[Held]) -> str:
        """A threshold that does it at all of these speeds; empty for none."""
        sgt, sfilt = (TABLE.get("COOLCONF", 0).field_named(name) for name in ("sgt", "sfilt"))
        assert sgt is not None
        assert sfilt is not None
        armed = round(CLOCK_HZ / (0.9 * min(speeds_pps)))
        for filtered in (0, 1):
            for threshold in range(sgt.minimum, sgt.maximum + 1, GRID):
                word = sfilt.pack(filtered, sgt.pack(threshold))
                values = {"COOLCONF": word, "TCOOLTHRS": armed}
                self.set([each.model_copy(update={"value": values.get(each.name, each.value)}) for each in registers])
                # Of many thresholds one may pass by luck: it has to do so again.
                if not any(self.holds(speeds_pps, runs, searching=True) for runs in (10, FOUND_RUNS, RUNS)):
                    return f"threshold {threshold}{' with the filter' if filtered else ''}"
        return ""


@dataclass(frozen=True, slots=True)
class Judged:
    """One plant. claims: the study has found a threshold; wrong: why that is not right, empty where it is; owns: speeds
    with a threshold of their own."""

    claims: bool
    wrong: str
    as_before: bool
    says: str
    owns: int = 0


async def claimed(seed: int, folder: Path) -> tuple[bool, str]:
    """Whether a threshold is claimed where load values are noise."""
    options, speeds = drawn(seed)
    options["motor"] = {**options["motor"], "load_value": NOISE}
    record = (await _studied(seed, folder, options, speeds))[0]
    return bool(record.improved), record.verdict or record.message


async def _studied(
    seed: int, folder: Path, options: dict[str, Any], speeds: list[float], push_fullsteps: float = PUSH_FULLSTEPS
) -> tuple[StudyRecord, dict[int, int], list[Held], bool]:
    async with studied(folder, FULL, **options) as s:
        before = await s.settings(*NAMES)
        words = {key[1]: word for key, word in (await held_of(s.device)).words.items() if word is not None}
        study = {
            "kind": "stallguard",
            "within_fullsteps": 450.0,
            "stop_confirmed": True,
            "speeds_rps": speeds,
            "free_runs": PROOF,
            "stops": PROOF,
            "push_fullsteps": push_fullsteps,
        }
        record = await s.finish(s.begin(s.document(study, budget={"time_s": 40_000.0}, seed=seed)), 40_000)
        return record, words, list(record.baseline), await s.settings(*NAMES) == before


async def judged(seed: int, folder: Path) -> Judged:
    """The study on one plant, and whether it is right."""
    return await _judged(seed, folder, *drawn(seed), PUSH_FULLSTEPS)


async def judged_apart(seed: int, folder: Path) -> Judged:
    """The study on a plant that needs a threshold of its own at each of two speeds, and whether it is right."""
    return await _judged(seed, folder, apart(seed), APART_RPS, APART_PUSH_FULLSTEPS)


async def _judged(
    seed: int, folder: Path, options: dict[str, Any], speeds: list[float], push_fullsteps: float
) -> Judged:
    record, words, baseline, as_before = await _studied(seed, folder, options, speeds, push_fullsteps)
    says = record.verdict or record.message
    found = record.stallguard
    if record.state != "done" or found is None:
        return Judged(claims=False, wrong=f"it {record.state}: {says}", as_before=as_before, says=says)
    referee = Referee(options, words, seed, push_fullsteps)
    kept = [each for each in baseline if each.name not in ("VMAX", "AMAX", "DMAX", "V1", "V2")]
    best, wrong, claimed = record.trial(record.best), "", list[float]()
    if record.improved and best is not None:
        claimed = [one.speed_pps for one in found.speeds if not one.why]
        referee.set(best.registers)
        wrong = referee.holds(claimed, RUNS)
        kept = best.registers
    owns = 0
    for one in found.speeds:
        if one.why and not wrong:
            there = Referee(options, words, seed, push_fullsteps).finds(sorted([*claimed, one.speed_pps]), kept)
            wrong = f"there is one at {one.speed_rps:g} turns/s: {there}" if there else ""
        if one.why and not wrong:
            own = None if one.own is None else record.trial(one.own.trial)
            referee = Referee(options, words, seed, push_fullsteps)
            if own is not None:
                owns += 1
                referee.set(own.registers)
                wrong = referee.holds([one.speed_pps], RUNS)
            else:
                there = referee.finds([one.speed_pps], kept) if claimed else ""
                wrong = f"there is one of its own at {one.speed_rps:g} turns/s: {there}" if there else ""
    return Judged(claims=bool(record.improved), wrong=wrong, as_before=as_before, says=says, owns=owns)


def measure(quick: bool) -> Sequence[Row]:
    """Two rows; quick: a few plants."""
    plants = 4 if quick else 100
    seeds = range(FIRST_SEED, FIRST_SEED + plants)
    found = collected("stallguard", judged, seeds, share=0.5)
    return [
        _row("StallGuard thresholds on {} blind plants: false and missed < 1 %, or none does it", found),
        _row(
            "the same on {} plants that need one of its own at each of two speeds",
            collected("stallguard apart", judged_apart, seeds),
        ),
    ]


def _row(what: str, found: dict[int, Judged]) -> Row:
    right = sum(not one.wrong for one in found.values())
    return Row(
        what=what.format(len(found)),
        measured=f"{at_least(right, len(found))}; {sum(one.claims for one in found.values())} with a threshold, "
        f"{sum(one.owns for one in found.values())} speeds with one of their own",
        peer=f"{len(found)}",
        ratio=right / len(found),
        required=f">= {SHARE:g}, every axis as before",
        ok=right >= SHARE * len(found) and all(one.as_before for one in found.values()),
        notes=tuple(f"plant {seed}: {one.wrong}; {one.says}" for seed, one in found.items() if one.wrong),
    )
