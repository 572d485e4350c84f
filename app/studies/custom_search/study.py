"""The study itself: baseline, search, proof."""

from __future__ import annotations

import math
import random
from collections.abc import Mapping, Sequence

from ...clock import WallClock
from ...errors import SoftLimit, WrongState
from ...number_text import plain
from ...procedures.procedure import Failed
from ...profiles.errors import ProfileLeft, ProfileTakenBack
from ..document import CustomSearch
from ..parts import Interval
from ..proof import compared_pairs, pair_order, rate_bound
from ..record import Figures, Trial
from ..run import StudyRun
from ..scored_move.found import Scored
from ..search import Asked, Searcher, Space, unbeaten
from .figures import NAMES, broken, judged, sign_of, value_of
from .found import CustomFound, CustomTried, FigureEffect, FigurePair
from .plan import AGAIN, FINALISTS, Ground, look
from .trials import BEFORE, CustomTrials

ASKED_FOR_ONE = 12
"""So many settings may be passed over for one that is tried: the search is over when none is left worth trying."""
SEARCH_SHARE = 0.75
PAIRS_LEAST = 10


class CustomSearchStudy(StudyRun):
    """Looks in an own space for the setting with the best figures."""

    _ground: Ground
    _trials: CustomTrials

    @property
    def wanted(self) -> CustomSearch:
        """What is looked for."""
        return self.record.document.wanted(CustomSearch)

    @property
    def found(self) -> CustomFound:
        """What of it stands in the record."""
        assert self.record.custom is not None
        return self.record.custom

    async def _study(self) -> None:
        record, wanted = self.record, self.wanted
        ground = self._ground = await self.looked(look, wanted)
        self._trials = CustomTrials(self.device, self.axis, self.clock, wanted, ground, self.apply)
        self._trials.losing = lambda: self.keeper.mark("steps lost: the position is taken from the encoder")
        self._trials.moves.way_fullsteps = record.way_fullsteps
        self._trials.ran = lambda: self.ran(self._trials.moves)
        if not record.baseline:
            record.baseline, record.baseline_setting = ground.space.before, ground.space.now
        record.units = ground.space.units
        if record.custom is None:
            record.custom = CustomFound(objectives=wanted.objectives)
        await self.keeper.save(record)
        self._touched = True  # a loss is mended by the setting before, which writes
        await self._trials.begin()
        await self._baseline()
        await self._search()
        await self._again()
        await self._proof()
        await self.back()
        await self._trials.moves.go(ground.start)

    # --- baseline ---------------------------------------------------------------------------------

    async def _baseline(self) -> None:
        record, found, wanted = self.record, self.found, self.wanted
        if found.before is not None:
            return
        self.tell("baseline", 0.0, "moving as the axis is set now")
        self.keeper.mark("baseline")
        before = await self._trials.measure(self._ground.space.before, BEFORE, self._ground.places(wanted.repeats))
        if before.lost_fullsteps:
            raise Failed(
                f"position and encoder part by {before.lost_fullsteps:g} full steps as the axis is set now: too fast "
                "for it, too much load, an open phase, an encoder that slips, or a wrong resolution of it"
            )
        untold = [NAMES[one][0] for one in wanted.objectives if value_of(before, one) is None]
        if untold:
            raise Failed(
                f"{untold[0]} cannot be told as the axis is set now: it does not end within "
                f"{wanted.band_fullsteps:g} full steps of the target, or nothing tells it; a wider band may help"
            )
        found.before, record.baseline_figures = before, _figures(before, wanted.repeats)
        await self.keeper.save(record)

    # --- search -----------------------------------------------------------------------------------

    async def _search(self) -> None:
        record, budget, wanted = self.record, self.record.document.budget, self.wanted
        sampler = wanted.sampler or ("nsga2" if len(wanted.objectives) > 1 else "tpe")
        searcher = Searcher(
            self.keeper.folder / "optuna.db",
            Space(self._ground.space.dimensions, len(wanted.objectives), sampler),
            record.document.seed + len(record.trials),
            aside=isinstance(self.clock, WallClock),
        )
        try:
            if not await searcher.open():
                await searcher.first(self._ground.space.neighbours())
            passed = 0
            while self._moved() < budget.trials and not self.spent(SEARCH_SHARE) and passed < ASKED_FOR_ONE:
                tried = self._moved()
                left_s = (budget.trials - tried) * self.since_s / tried if tried else None
                self.tell("search", 0.05 + 0.7 * tried / budget.trials, f"trial {tried + 1}{self._best_text()}", left_s)
                trial = await self._trial(searcher, await searcher.ask())
                passed = passed + 1 if trial.state == "pruned" else 0
                record.trials.append(trial)
                self._judge()
                if trial.state != "pruned":
                    await self.keeper.save(record)
        finally:
            searcher.close()

    def _moved(self) -> int:
        return sum(trial.state != "pruned" for trial in self.record.trials)

    async def _trial(self, searcher: Searcher, asked: Asked) -> Trial:
        space, wanted = self._ground.space, self.wanted
        setting = space.rounded(asked.values)
        trial = Trial(
            number=asked.number,
            setting=setting,
            registers=space.registers(setting),
            state="pruned",
            figures=Figures(),
            at_s=round(self.since_s, 3),
        )
        known = self._known(setting)
        if known is not None:
            trial.why = f"the same as trial {known.number}"
            await searcher.tell(asked, known.told, known.violation)
            return trial
        longest_s = wanted.repeats * self._ground.time_s(wanted, setting)
        if longest_s > self.record.document.budget.time_s - self.since_s:
            trial.why = "its moves would take longer than what is left of the time"
            await searcher.fail(asked)
            return trial
        self.keeper.mark(f"trial {asked.number}: {self._words(setting)}")
        found = await self._measured(trial, self._ground.places(wanted.repeats))
        if found is None:
            await searcher.fail(asked)
            return trial
        told = self._judged(trial, found)
        trial.figures = _figures(found, wanted.repeats)
        self.found.tried.append(told)
        await searcher.tell(asked, told.told, told.violation)
        return trial

    async def _measured(self, trial: Trial, places: Sequence[int]) -> Scored | None:
        """All moves with a trial's setting; None where they came to nothing, which stands in the trial."""
        try:
            return await self._trials.measure(trial.registers, self._words(trial.setting), places)
        except ProfileLeft:
            raise
        except (Failed, SoftLimit, WrongState, ProfileTakenBack) as error:
            trial.state, trial.why = "failed", str(error)
            await self._rest()
            await self._trials.home()
            return None

    def _judged(self, trial: Trial, found: Scored) -> CustomTried:
        """What the figures of a trial are worth, and whether it held."""
        said = judged(self.wanted, found)
        trial.state, trial.why = ("infeasible", said.why) if said.violation > 0 else ("feasible", "")
        return CustomTried(
            number=trial.number,
            figures=found,
            told=list(said.costs) if said.costs is not None and not found.lost_fullsteps else self._worst(),
            violation=said.violation,
        )

    def _known(self, setting: Mapping[str, float]) -> CustomTried | None:
        """What came of the same setting before."""
        numbers = {trial.number for trial in self.record.trials if trial.setting == setting}
        return next((one for one in self.found.tried if one.number in numbers), None)

    def _worst(self) -> list[float]:
        """The worst of each objective so far: what is told of a setting whose own figures mean nothing."""
        known = [self._baseline_costs(), *(one.told for one in self.found.tried)]
        return [max(column) for column in zip(*known, strict=True)]

    def _baseline_costs(self) -> list[float]:
        assert self.found.before is not None
        costs = judged(self.wanted, self.found.before).costs
        assert costs is not None  # else the baseline has ended the study
        return list(costs)

    def _gains(self, one: CustomTried) -> list[float]:
        """By which share of the setting before each objective is better: below 0 is better."""
        return [(cost - base) / (abs(base) or 1.0) for cost, base in zip(one.told, self._baseline_costs(), strict=True)]

    def _held(self, among: Sequence[CustomTried]) -> list[CustomTried]:
        """Those that held, the best first: none of its objectives worse, and the greatest gain altogether."""
        held = {trial.number for trial in self.record.trials if trial.state == "feasible"}

        def rank(one: CustomTried) -> tuple[bool, float]:
            gains = self._gains(one)
            return max(gains) > self.wanted.smallest_gain, sum(gains)

        return sorted((one for one in among if one.number in held), key=rank)

    def _judge(self) -> None:
        """The best so far, and the front of two objectives."""
        found = self.found
        held = self._held(found.again or found.tried)
        self.record.best = held[0].number if held else None
        if len(self.wanted.objectives) > 1:
            front = unbeaten(self._held(found.tried), lambda one: one.told)
            self.record.front = [one.number for one in front]

    def _tried(self, number: int | None) -> CustomTried | None:
        return next((one for one in (*self.found.again, *self.found.tried) if one.number == number), None)

    def _best_text(self) -> str:
        best = self._tried(self.record.best)
        if best is None:
            return ""
        told = zip(self.wanted.objectives, best.told, strict=True)
        return ", best " + ", ".join(f"{plain(sign_of(one) * cost, 4)} {NAMES[one][1]}".rstrip() for one, cost in told)

    def _words(self, setting: Mapping[str, float]) -> str:
        units = self.record.units
        return ", ".join(f"{name} {plain(value, 6)} {units[name]}".rstrip() for name, value in setting.items())

    # --- proof ------------------------------------------------------------------------------------

    async def _again(self) -> None:
        """Measure the best few again, from places that the search did not begin at."""
        record, found, wanted = self.record, self.found, self.wanted
        found.again = []
        places = [place + self._ground.full_step // 3 for place in self._ground.places(AGAIN * wanted.repeats)]
        again: list[CustomTried] = []
        for one in self._held(found.tried)[:FINALISTS]:
            trial = record.trial(one.number)
            if trial is None or self.spent(SEARCH_SHARE + 0.1):
                break
            self.tell("search", SEARCH_SHARE, f"trial {one.number} again")
            self.keeper.mark(f"trial {one.number} again: {self._words(trial.setting)}")
            measured = await self._measured(trial, places)
            if measured is not None:
                again.append(self._judged(trial, measured))
        found.again = again
        self._judge()
        await self.keeper.save(record)

    async def _proof(self) -> None:
        record = self.record
        for _ in range(FINALISTS):
            best, told = record.trial(record.best), self._tried(record.best)
            if best is None or told is None:
                record.improved, record.verdict = False, "no setting that was tried held: it stays as it is"
                return
            gains = self._gains(told)
            least = self.wanted.smallest_gain
            if max(gains) > least or min(gains) >= -least or best.setting == record.baseline_setting:
                record.improved, record.best = False, None
                record.verdict = "nothing that was tried is better by more than can be told: it stays as it is"
                record.next = "other settings, a wider range, or more trials"
                return
            if await self._pairs(best):
                return
        record.improved, record.best = False, None
        record.verdict = f"the best settings, {FINALISTS} at most, did not hold in the proof: it stays as it is"
        record.next = "bounds that leave room, more repeats"

    async def _pairs(self, best: Trial) -> bool:
        """The pairs of one candidate; False where it did not hold."""
        record, wanted, found = self.record, self.wanted, self.found
        found.pairs, found.effects, found.runs, found.loss_rate_max = [], [], 0, None
        self.keeper.mark(f"proof of trial {best.number}: {self._words(best.setting)}")
        drawn = random.Random(record.document.seed + best.number)
        winners: list[Scored] = []
        for index in range(wanted.pairs):
            if self.spent():
                break
            self.tell("proof", 0.75 + 0.25 * index / wanted.pairs, f"pair {index + 1} of {wanted.pairs}")
            place, order = drawn.randrange(self._ground.period), pair_order(index)
            costs: dict[str, list[float]] = {}
            for which in order:
                if which == "A":
                    one = await self._trials.measure(self._ground.space.before, BEFORE, [place])
                elif (new := await self._measured(best, [place])) is not None:
                    one = new
                else:
                    return self._refuted(best, best.why)
                said = judged(wanted, one)
                if one.lost_fullsteps or said.costs is None:
                    if which == "A":
                        raise Failed(f"the setting before did not hold in the proof: {said.why}")
                    return self._refuted(best, said.why)
                costs[which] = list(said.costs)
                if which == "B":
                    winners.append(one)
            found.pairs.append(self._pair(costs, index))
        if len(found.pairs) >= PAIRS_LEAST and (why := self._bound_broken(winners)):
            return self._refuted(best, why)
        self._decide(best)
        await self.keeper.save(record)
        return True

    def _pair(self, costs: Mapping[str, Sequence[float]], index: int) -> FigurePair:
        signs = [sign_of(figure) for figure in self.wanted.objectives]
        old, new = ([sign * cost for sign, cost in zip(signs, costs[which], strict=True)] for which in "AB")
        return FigurePair(baseline=old, winner=new, order=pair_order(index))

    def _bound_broken(self, winners: Sequence[Scored]) -> str:
        """Which bound the new setting breaks on average; empty where all hold."""
        for bound in self.wanted.bounds:
            values = [value_of(one, bound.figure) for one in winners]
            known = [value for value in values if value is not None]
            if len(known) < len(values):
                return f"{NAMES[bound.figure][0]} could not be told"
            mean = winners[0].model_copy(update={bound.figure: math.fsum(known) / len(known)})
            if why := broken([bound], mean)[1]:
                return why
        return ""

    def _refuted(self, best: Trial, why: str) -> bool:
        best.state, best.why = "infeasible", f"in the proof: {why}"
        self.found.pairs = []
        self._judge()
        return False

    def _decide(self, best: Trial) -> None:
        record, found, wanted = self.record, self.found, self.wanted
        if len(found.pairs) < PAIRS_LEAST:
            record.improved, record.best = None, None
            record.verdict = f"the budget ended after {len(found.pairs)} of {wanted.pairs} pairs: nothing is shown"
            record.next = "more time or way"
            return
        found.effects = [self._effect(index) for index in range(len(wanted.objectives))]
        found.runs = len(found.pairs)
        found.loss_rate_max = rate_bound(0, found.runs)
        better = [one for one in found.effects if one.significant]
        record.improved = bool(better) and not any(one.worse for one in found.effects)
        if not record.improved:
            record.best = None
            worse = [NAMES[one.figure][0] for one in found.effects if one.worse]
            but = f", or {' and '.join(worse)} may be worse" if better and worse else ""
            record.verdict = f"{self._words(best.setting)} is not shown to be better{but}: it stays as it is"
            return
        told = ", ".join(_told(one) for one in found.effects)
        record.verdict = (
            f"{told}, with {self._words(best.setting)}; no step lost in {found.runs} runs: fewer than "
            f"{100 * found.loss_rate_max:.2g} % lose some"
        )

    def _effect(self, index: int) -> FigureEffect:
        found, wanted = self.found, self.wanted
        figure = wanted.objectives[index]
        sign = sign_of(figure)
        old, new = [pair.baseline[index] for pair in found.pairs], [pair.winner[index] for pair in found.pairs]
        shown = compared_pairs(
            [sign * value for value in old],
            [sign * value for value in new],
            wanted.smallest_gain,
            self.record.document.seed,
            figures=len(wanted.objectives),
        )
        effect, around = shown.effect, shown.effect.interval
        ends = sorted((sign * around.low, sign * around.high))
        return FigureEffect(
            figure=figure,
            unit=NAMES[figure][1],
            baseline=sign * shown.old,
            winner=sign * shown.new,
            difference=sign * effect.mean,
            interval=Interval(low=ends[0], high=ends[1]),
            p=effect.p,
            significant=shown.better,
            worse=around.high > abs(wanted.smallest_gain * shown.old),
        )


def _figures(found: Scored, repeats: int) -> Figures:
    return Figures(
        time_s=found.time_s,
        deviation_fullsteps=found.peak_fullsteps,
        lost_fullsteps=found.lost_fullsteps,
        runs=repeats,
    )


def _told(effect: FigureEffect) -> str:
    name, unit = NAMES[effect.figure]
    share = f"{100 * effect.difference / abs(effect.baseline):+.3g} %, " if effect.baseline else ""
    return (
        f"{name} {plain(effect.baseline, 4)} to {plain(effect.winner, 4)} {unit}".rstrip()
        + f" ({share}95 %: {plain(effect.interval.low, 3)} to {plain(effect.interval.high, 3)})"
    )
