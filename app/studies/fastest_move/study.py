"""The study itself: baseline, search, proof."""

from __future__ import annotations

import math
import random
from collections.abc import Mapping
from typing import Literal

from ...clock import WallClock
from ...number_text import plain
from ...procedures.procedure import Failed
from ..document import FastestMove, told_twin
from ..leave_switch import leave_switch
from ..proof import compared_pairs, pair_order, rate_bound, runs_for
from ..ramp_settings import (
    ACCELERATION,
    DECELERATION,
    KNEE,
    KNEE_ACCELERATION,
    KNEE_DECELERATION,
    SPEED,
    UNITS,
)
from ..record import DeviationEvidence, Evidence, Figures, Pair, Trial
from ..run import StudyRun
from ..search import Asked, Searcher, Space
from ..switch_edge import SWITCHES, UNTOLD
from ..twins.search import look_on_twins
from .effects import effects_told
from .front import front_of, proposed
from .ranges import BASELINE_RUNS, Ranges, look, ramps_s
from .trials import ON_TWIN, MoveTrials, begun, curve_of, figures_of, told, tried, words_of

ASKED_FOR_ONE = 12
"""So many settings may be passed over for one that is tried: the search is over when none is worth trying."""
STEEP = "two gentler settings lost steps"
"""Why a setting was not tried: it would lose some too."""
DRAWN, WORTH_SHARE = 200, 0.01
"""So many settings, drawn at random, tell how many are worth a trial yet; less than this share is not told of."""
LADDER = (1.5, 2.2, 3.2, 5.0, 8.0)
"""The first settings: so many times the present speed and acceleration, as far as the space goes."""
TRAPEZOIDS, PASSED_OVER = 0.5, 6
"""Where a knee is searched too, a trapezoid is found first, by fewer settings than both at once would take: with that
share of the trials, or until so many are passed over for one that is tried. Then it begins at the best of them."""
SHAPED = (
    (1.0, 1.0, 0.5, 1.25, 1.0),
    (1.1, 0.9, 0.6, 1.4, 1.15),
    (1.25, 0.75, 0.6, 1.6, 1.15),
    (1.0, 0.85, 0.6, 1.3, 1.3),
)
"""The first settings with a knee: so many times the best speed and acceleration, where it lies, and how much more it
accelerates below, and how much more it brakes."""
CANDIDATES = 8
"""So many of the best go to the proof, one after the other, where one of them loses steps there."""
CANDIDATE = 1
"""Number of the trial of a setting that is to be proved without a search."""


class FastestMoveStudy(StudyRun):
    """Looks for the ramp with the shortest move there and back at which no step is lost."""

    _ranges: Ranges
    _trials: MoveTrials
    _exhausted = False
    """Whether the search ended because nothing that it asked for was worth a trial."""

    @property
    def wanted(self) -> FastestMove:
        return self.record.document.wanted(FastestMove)

    async def _study(self) -> None:
        record, wanted = self.record, self.wanted
        await leave_switch(self, SWITCHES[wanted.seen_by])
        ranges = self._ranges = await self.looked(look, wanted)
        seed = record.document.seed + len(record.trials)
        self._trials = MoveTrials(self.device, self.axis, self.clock, wanted, ranges, seed, self.apply)
        by = wanted.seen_by
        self._trials.losing = lambda: self.keeper.mark(f"steps lost: the position is taken from the {by}")
        self._trials.moves.way_fullsteps = record.way_fullsteps
        self._trials.ran = lambda: self.ran(self._trials.moves)
        if not record.baseline:
            record.baseline = ranges.space.before
            record.baseline_setting = ranges.space.now()
        record.units = {name: UNITS[name] for name in ranges.space.now()}
        if ranges.switch is not None:
            record.next = UNTOLD
        await self.keeper.save(record)
        self._touched = True  # a loss is mended by the setting before, which writes
        await self._trials.begin()
        await self._baseline()
        await self._twins()
        if wanted.candidate is None:
            await self._search()
        elif not record.trials:
            await self._alone_tried(wanted.candidate)
        await self._proof()
        await self.back()
        await self._trials.moves.go(ranges.start)
        record.next = "; ".join(part for part in (self._untried(), record.next.removeprefix(UNTOLD)) if part)

    # --- baseline ---------------------------------------------------------------------------------

    async def _baseline(self) -> None:
        record = self.record
        if record.baseline_figures is not None:
            return
        self.tell("baseline", 0.0, "moving as the axis is set now")
        self.keeper.mark("baseline")
        runs = []
        for index in range(BASELINE_RUNS):
            runs.append(await self._trials.once())
            figures = figures_of(runs)
            if figures.lost_fullsteps:
                raise Failed(
                    f"position and {self.wanted.seen_by} part by {figures.lost_fullsteps:g} full steps as the axis is "
                    "set now: too fast for it, too much load, an open phase, an encoder that slips, or a wrong "
                    "resolution of it"
                )
            if figures.time_s is None:
                raise Failed(
                    f"as it is set now the encoder does not end within {self.wanted.band_fullsteps:g} full steps "
                    "of the target: its resolution is set wrong (first look), or the band is too narrow"
                )
            self.tell("baseline", 0.05 * (index + 1) / BASELINE_RUNS, "moving as the axis is set now")
        record.baseline_figures = figures_of(runs)
        self._draw("before")
        await self.keeper.save(record)

    # --- the twin first ---------------------------------------------------------------------------

    async def _twins(self) -> None:
        """Search on twins, and remember the best; the motor rests meanwhile. What fails there costs nothing here."""
        record, twin = self.record, told_twin(self.wanted.twin)
        if twin is not None and not record.twin and not record.trials:
            await look_on_twins(self, ON_TWIN, twin, self._space(), self._ladder())

    # --- search -----------------------------------------------------------------------------------

    async def _search(self) -> None:
        record, budget = self.record, self.record.document.budget
        searcher = Searcher(
            self.keeper.folder / "optuna.db",
            self._space(),
            record.document.seed + len(record.trials),
            aside=isinstance(self.clock, WallClock),
        )
        try:
            if not await searcher.open():
                await searcher.first(self._ladder())
            passed, ladder, shares = 0, len(self._ladder()), self._ranges.space.shares
            plain_first = len(shares) > 0 and not record.twin
            while self._moved() < budget.trials and not self.spent(share=0.75) and passed < ASKED_FOR_ONE:
                tried = self._moved()
                self.tell("search", 0.05 + 0.7 * tried / budget.trials, f"trial {tried + 1}{self._best_text()}")
                if plain_first and (tried >= TRAPEZOIDS * budget.trials or passed >= PASSED_OVER):
                    plain_first, passed = False, 0
                    await searcher.first(self._shaped())
                asked = await searcher.ask(shares if plain_first and len(record.trials) >= ladder else ())
                trial = await self._trial(searcher, asked)
                passed = passed + 1 if trial.state == "pruned" else 0
                record.trials.append(trial)
                self._judge()
                if trial.state in ("feasible", "infeasible"):
                    self._draw("present")
                if trial.number == record.best:
                    self._draw("best")
                if trial.state != "pruned":
                    await self.keeper.save(record)
            self._exhausted = passed >= ASKED_FOR_ONE
        finally:
            searcher.close()

    async def _alone_tried(self, candidate: Mapping[str, float]) -> None:
        """Try the one setting that is to be proved."""
        self.tell("search", 0.05, "trying the setting that is to be proved")
        trial = begun(CANDIDATE, candidate, self._ranges, self.wanted, self.since_s)
        self.keeper.mark(f"trial {trial.number}: {words_of(trial.setting)}")
        await tried(self._trials, trial)
        if trial.state == "failed":
            await self._trials.home()
        self.record.trials.append(trial)
        self._judge()
        if trial.number == self.record.best:
            self._draw("best")
        await self.keeper.save(self.record)

    def _untried(self) -> str:
        """What would let the search go on, where it ended with settings left that were worth trying; else empty."""
        budget, tried = self.record.document.budget, self._moved()
        more = "more trials" if tried >= budget.trials else "more time or way"
        if self._exhausted or self.wanted.candidate is not None:
            return ""
        if self.wanted.quiet:
            return f"{more}: fewer gaps in the front of time and deviation"
        chance, low_high = random.Random(self.record.document.seed), self._ranges.dimensions
        drawn = [
            {each.name: each.low * (each.high / each.low) ** chance.random() for each in low_high} for _ in range(DRAWN)
        ]
        settings = [self._ranges.setting(each) for each in drawn]
        share = sum(
            not self._hopeless(each, ramps_s(self.wanted, self._ranges.space, each)) for each in settings
        ) / len(settings)
        if share < WORTH_SHARE:
            return ""
        return f"{more}: after {tried} trials about {plain(100 * share, 2)} % of all settings are worth one yet"

    def _shaped(self) -> list[dict[str, float]]:
        """The first settings with a shape: the best so far, with more acceleration below the knee than above."""
        best = self.record.trial(self.record.best)
        if best is None:
            return []
        found = []
        for speeds, accelerations, knee, below, braking in SHAPED:
            speed, acceleration = speeds * best.setting[SPEED], accelerations * best.setting[ACCELERATION]
            shape = {
                KNEE: knee * speed,
                KNEE_ACCELERATION: below * acceleration,
                DECELERATION: braking * acceleration,
                KNEE_DECELERATION: below * braking * acceleration,
            }
            found.append(self._ranges.asked({SPEED: speed, ACCELERATION: acceleration, **shape}))
        return found

    def _space(self) -> Space:
        quiet = self.wanted.quiet
        sampler = self.wanted.sampler or ("nsga2" if quiet else "tpe")
        return Space(self._ranges.dimensions, 2 if quiet else 1, sampler)

    def _draw(self, which: Literal["before", "best", "present"]) -> None:
        """Keep the latest move to the far end, for a plot."""
        if self._trials.there is not None:
            others = [move for move in self.record.moves if move.which != which]
            self.record.moves = [*others, curve_of(self._trials.there, which, self._ranges.microsteps)]

    def _moved(self) -> int:
        return sum(trial.state != "pruned" for trial in self.record.trials)

    def _ladder(self) -> list[dict[str, float]]:
        if self.record.twin:
            inside = [self._ranges.asked(one.setting) for one in self.record.twin]
            # The slowest of them first: where the twin was too bold, fewer steps are lost on the way.
            return inside[::-1]
        return [self._ranges.asked(self.record.baseline_setting, times) for times in LADDER]

    async def _trial(self, searcher: Searcher, asked: Asked) -> Trial:
        trial = begun(asked.number, self._ranges.setting(asked.values), self._ranges, self.wanted, self.since_s)
        assert trial.expected_s is not None
        trial.why = self._hopeless(trial.setting, trial.expected_s)
        if trial.why:
            await searcher.prune(asked, trial.expected_s, float(trial.why == STEEP))
            return trial
        self.keeper.mark(f"trial {asked.number}: {words_of(trial.setting)}")
        await tried(self._trials, trial)
        if trial.state == "failed":
            await searcher.fail(asked)
            await self._trials.home()
        else:
            of = told(self.wanted, trial)
            await searcher.tell(asked, of.values, of.violation)
        return trial

    def _hopeless(self, setting: Mapping[str, float], expected_s: float) -> str:
        """Why a setting need not be tried; empty where it is worth it."""
        record = self.record
        best, baseline = record.trial(record.best), record.baseline_figures
        if self.wanted.quiet or baseline is None or baseline.time_s is None:
            return ""
        # What beside its ramp a move takes until the encoder rests, at the least seen so far.
        over_s = baseline.time_s - ramps_s(self.wanted, self._ranges.space, record.baseline_setting)
        to_beat_s = baseline.time_s
        if best is not None and best.figures.time_s is not None and best.expected_s is not None:
            over_s = min(over_s, best.figures.time_s - best.expected_s)
            to_beat_s = best.figures.time_s
        if expected_s + min(over_s, 0.0) >= to_beat_s:
            return "its ramp alone takes longer than the best so far"
        worse = [
            trial
            for trial in self.record.trials
            if trial.state == "infeasible" and all(trial.setting[name] <= setting[name] for name in setting)
        ]
        # Two, not one: a setting may sit on a resonance that a faster one passes by.
        if len(worse) >= 2:
            return STEEP
        return ""

    def _judge(self) -> None:
        """The best so far: the fastest, or of two objectives the one of their front that is proposed."""
        record, wanted = self.record, self.wanted
        feasible = [trial for trial in record.trials if trial.state == "feasible"]
        timed = [trial for trial in feasible if trial.figures.time_s is not None]
        if wanted.quiet:
            front = front_of(timed)
            assert record.baseline_figures is not None
            best = proposed(front, record.baseline_figures, wanted.smallest_gain, wanted.deviation_max_fullsteps)
            record.front = [one.number for one in front]
            if best is None or best.number != record.best:  # another trial's move is no longer the best one's
                record.moves = [move for move in record.moves if move.which != "best"]
        else:
            best = min(timed, key=lambda trial: trial.figures.time_s or math.inf, default=None)
        record.best = None if best is None else best.number

    def _best_text(self) -> str:
        best = self.record.trial(self.record.best)
        if best is None or best.figures.time_s is None:
            return ""
        deviation = f", {plain(best.figures.deviation_fullsteps or 0.0, 3)} full steps off" if self.wanted.quiet else ""
        return f", best {plain(best.figures.time_s, 4)} s{deviation}"

    # --- proof ------------------------------------------------------------------------------------

    async def _proof(self) -> None:
        record, wanted = self.record, self.wanted
        for _ in range(CANDIDATES):
            best, baseline = record.trial(record.best), record.baseline_figures
            assert baseline is not None
            assert baseline.time_s is not None
            if not any(trial.state == "feasible" for trial in record.trials):
                record.improved, record.verdict = False, "no setting that was tried held its steps: it stays as it is"
                record.next = "more current, less load, or a smaller margin"
                return
            if wanted.quiet:
                nothing = best is None
            else:
                assert best is not None
                assert best.figures.time_s is not None
                nothing = best.figures.time_s >= baseline.time_s * (1 - wanted.smallest_gain)
            if nothing:
                record.improved, record.verdict = False, f"{self._nothing_gained()}: it stays as it is"
                record.next = "more room: a higher limit of speed or acceleration, or more current"
                return
            assert best is not None
            if await self._pairs(best):
                return
        record.improved = False
        beyond = "" if wanted.deviation_max_fullsteps is None else ", or deviated by more than asked,"
        record.verdict = f"the best settings, {CANDIDATES} at most, lost steps{beyond} in the proof: it stays as it is"
        record.next = "a greater margin, more repeats"

    def _nothing_gained(self) -> str:
        most = self.wanted.deviation_max_fullsteps
        if most is not None:
            return f"nothing that deviates by {plain(most, 3)} full steps at most is faster by more than can be told"
        quiet = ", or deviates less," if self.wanted.quiet else ""
        return f"nothing that was tried is faster{quiet} by more than can be told"

    async def _pairs(self, best: Trial) -> bool:
        """The pairs of one candidate; False where it lost steps."""
        record, wanted = self.record, self.wanted
        record.pairs, runs = [], 0
        self.keeper.mark(f"proof of trial {best.number}: {words_of(best.setting)}")
        for index in range(wanted.pairs):
            if self.spent():
                break
            self.tell("proof", 0.75 + 0.1 * index / wanted.pairs, f"pair {index + 1} of {wanted.pairs}")
            place = self._trials.place()
            order = pair_order(index)
            times: dict[str, float] = {}
            deviations: dict[str, float | None] = {}
            for which in order:
                await self._trials.set_before() if which == "A" else await self._trials.set(best.setting)
                figures = figures_of([await self._trials.once(place)])
                runs += which == "B"
                if figures.time_s is None:
                    if which == "A":
                        raise Failed("the setting before lost steps, or did not settle, in the proof")
                    return self._refuted(best, figures)
                times[which] = figures.time_s
                if wanted.quiet:
                    deviations[which] = figures.deviation_fullsteps
                    if which == "B":
                        self._draw("best")
                        if self._deviates(figures):
                            return self._refuted(best, figures)
            if wanted.margin:
                figures = await self._trials.stress(best.setting, 1)
                runs += figures.runs
                if figures.lost_fullsteps:
                    return self._refuted(best, figures)
            record.pairs.append(
                Pair(
                    baseline_s=times["A"],
                    winner_s=times["B"],
                    order=order,
                    baseline_deviation_fullsteps=deviations.get("A"),
                    winner_deviation_fullsteps=deviations.get("B"),
                )
            )
        if self._better(runs):
            alone = 0
            if wanted.loss_rate_max is not None:
                alone, lost = await self._alone(best, runs_for(wanted.loss_rate_max) - len(record.pairs))
                if lost is not None:
                    return self._refuted(best, lost)
            self._bound(runs + alone, len(record.pairs) + alone)
        await self.keeper.save(record)
        return True

    async def _alone(self, best: Trial, most: int) -> tuple[int, Figures | None]:
        """Move with the new setting alone: how often it held, and the one move that did not, which ends it."""
        self.keeper.mark(f"proof of trial {best.number}, alone: {words_of(best.setting)}")
        await self._trials.set(best.setting)
        held = 0
        while held < most and not self.spent():
            self.tell("proof", 0.85 + 0.15 * held / most, f"the new setting alone, move {held + 1} of {most}")
            figures = figures_of([await self._trials.once()])
            if figures.time_s is None or self._deviates(figures):
                return held, figures
            held += 1
        return held, None

    def _deviates(self, figures: Figures) -> bool:
        """Whether a move deviated by more than is asked for."""
        most, deviation = self.wanted.deviation_max_fullsteps, figures.deviation_fullsteps
        return most is not None and deviation is not None and deviation > most

    def _refuted(self, best: Trial, figures: Figures) -> bool:
        if figures.time_s is not None and not figures.lost_fullsteps:  # it held, and another keeps to the deviation
            best.figures.deviation_fullsteps = figures.deviation_fullsteps
            best.why = "it deviated by more than asked in the proof"
        else:
            best.state, best.figures.lost_fullsteps = "infeasible", figures.lost_fullsteps
            best.why = "it lost steps, or did not settle, in the proof"
        self.record.evidence = None
        self._judge()
        return False

    def _better(self, runs: int) -> bool:
        """Whether the pairs show the new setting to be better; `runs` of it, margin included, lost no step."""
        record, wanted = self.record, self.wanted
        if len(record.pairs) < 10:
            record.improved = None
            record.verdict = f"the budget ended after {len(record.pairs)} of {wanted.pairs} pairs: nothing is shown"
            record.next = "more time or way"
            return False
        before, after = [pair.baseline_s for pair in record.pairs], [pair.winner_s for pair in record.pairs]
        shown = compared_pairs(before, after, wanted.smallest_gain, record.document.seed, figures=1 + wanted.quiet)
        effect, old = shown.effect, shown.old
        test = "Wilcoxon signed-rank, two-sided; interval: bootstrap and Student's t over the pairs, the wider"
        record.evidence = Evidence(
            pairs=len(record.pairs),
            baseline_s=old,
            winner_s=shown.new,
            difference_s=effect.mean,
            interval_s=effect.interval,
            share=effect.mean / old,
            p=effect.p,
            test=f"{test}; each p counts twice, for two figures" if wanted.quiet else test,
            significant=shown.better,
            runs=runs,
            loss_rate_max=rate_bound(0, runs),
            deviation=self._deviation() if wanted.quiet else None,
        )
        calmer = record.evidence.deviation is not None and record.evidence.deviation.significant
        if not shown.better and not calmer:
            either = ", nor to deviate less" if wanted.quiet else ""
            record.improved = False
            record.verdict = f"the best setting is not shown to be faster{either}: it stays as it is"
            record.next = f"more pairs than {wanted.pairs} show less of a gain; more current, or less load, allows more"
        return shown.better or calmer

    def _deviation(self) -> DeviationEvidence | None:
        """The other objective by the same pairs; None where a move told none."""
        record, told = self.record, []
        for pair in record.pairs:
            if pair.baseline_deviation_fullsteps is None or pair.winner_deviation_fullsteps is None:
                return None
            told.append((pair.baseline_deviation_fullsteps, pair.winner_deviation_fullsteps))
        old, new = zip(*told, strict=True)
        shown = compared_pairs(old, new, self.wanted.smallest_gain, record.document.seed, figures=2)
        effect = shown.effect
        return DeviationEvidence(
            baseline_fullsteps=shown.old,
            winner_fullsteps=shown.new,
            difference_fullsteps=effect.mean,
            interval_fullsteps=effect.interval,
            share=effect.mean / shown.old if shown.old else 0.0,
            p=effect.p,
            significant=shown.better,
        )

    def _bound(self, runs: int, own: int) -> None:
        """How seldom the new setting loses a step, by `runs` of the proof, `own` of them without the margin."""
        record, asked = self.record, self.wanted.loss_rate_max
        evidence = record.evidence
        assert evidence is not None
        evidence.runs, evidence.loss_rate_max = runs, rate_bound(0, runs)
        record.improved = True
        together = f", all {many} distances together" if (many := len(self.wanted.every_distance)) > 1 else ""
        record.verdict = (
            f"{effects_told(evidence, self.wanted.smallest_gain)}{together}, "
            f"no step lost in {runs} runs: fewer than {100 * evidence.loss_rate_max:.2g} % lose some"
        )
        if (most := self.wanted.deviation_max_fullsteps) is not None:
            record.verdict += f"; no move of {own} deviated by more than {plain(most, 3)} full steps"
        if asked is None:
            record.next = "a loss rate asked for: 299 runs without a lost step show less than 1 %"
        elif own < runs_for(asked):
            record.improved = None
            record.verdict += f"; the budget ended before fewer than {100 * asked:.2g} % were shown"
            record.next = "more time or way"
        else:
            record.next = "take it, and see to its margin: a warmer motor, a lower supply and another load need one"
