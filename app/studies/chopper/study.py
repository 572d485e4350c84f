"""The study itself: runs at constant speeds, a search over settings of SpreadCycle, and the proof by pairs."""

from __future__ import annotations

import statistics
from collections.abc import Sequence

from ...clock import WallClock
from ...number_text import plain
from ..document import CalmChopper
from ..moves import MeasuredMoves
from ..proof import compared_pairs, pair_order
from ..record import Figures, Held, Trial
from ..run import StudyRun
from ..search import Asked, Searcher, Space
from .found import ChopperFound, ChopperTried, RippleEffect, RipplePair
from .margin import Margins
from .plan import AGAIN, BASELINE_ROUNDS, FINALISTS, Cruise, Ground, look
from .ripple import rate_for, ripple_of, together
from .setting import UNITS, ChopperSetting, dimensions, nearest, setting_of

SPREAD_SHARE, MARGINS_FROM = 0.2, 0.4
"""So much of the trials is spread over margins; from so much of them on, margins say what is next."""
PASSED_MOST = 5
"""Settings that were asked for and not tried, as they may not be or were before, one after another: then margins say
what is next, too."""
ALIKE = 0.005
"""Settings within this share of the calmest are as calm: of them the least hysteresis has the least ripple."""
SEARCH_SHARE, PROOF_FROM = 0.7, 0.75
MAP_NEXT = "the resonance map: what shakes the shaft yet is the motor's own, at some speeds more than at others"


class ChopperStudy(StudyRun):
    """Looks for the setting of SpreadCycle by which the shaft shakes least."""

    _ground: Ground
    _moves: MeasuredMoves

    @property
    def wanted(self) -> CalmChopper:
        """What is looked for."""
        return self.record.document.wanted(CalmChopper)

    @property
    def found(self) -> ChopperFound:
        """What of it stands in the record."""
        assert self.record.chopper is not None
        return self.record.chopper

    async def _study(self) -> None:
        record = self.record
        ground = self._ground = await self.looked(look, self.wanted)
        self._moves = MeasuredMoves(self.device, self.axis, self.clock, ground.full_step, band_fullsteps=1.0)
        self._moves.way_fullsteps = record.way_fullsteps
        record.units = dict(UNITS)
        record.chopper = record.chopper or ChopperFound(speeds_rps=self.wanted.speeds_rps)
        if not record.baseline:
            record.baseline = [*ground.ramp.before, *ground.chopper.before]
            record.baseline_setting = ground.chopper.now.told
        await self.keeper.save(record)
        self._touched = True
        self.tell("baseline", 0.0, "running with the chopper as it is set now")
        self.keeper.mark("baseline")
        # A rotor that stood beside its field when it was switched on falls into step with the first move.
        await self._there_and_back(ground.cruises[0])
        if self.found.chosen is None:
            await self._baseline()  # anew where it goes on: a motor has cooled down meanwhile
            await self._search()
            best = await self._best()
        else:  # it was cut off in the proof
            best = record.trial(record.best)
        if best is not None:
            await self._prove(best)
        await self.back()
        await self._moves.go(ground.start)
        trial = record.trial(record.best)
        if record.improved and self.wanted.keep and trial is not None:
            await self.apply(trial.registers, "the new chopper setting")
            self._touched = False

    # --- runs ---------------------------------------------------------------------------------------

    async def _shaken(self, registers: Sequence[Held], rounds: int = 1) -> list[float]:
        """How much the shaft shakes by a setting at each speed, there and back [full steps]."""
        await self.apply(registers, "a chopper setting")
        return [
            statistics.fmean([each for _ in range(rounds) for each in await self._there_and_back(cruise)])
            for cruise in self._ground.cruises
        ]

    async def _there_and_back(self, cruise: Cruise) -> tuple[float, float]:
        ground = self._ground
        await self.apply(ground.ramp.registers(cruise.ramp), "runs at a constant speed")
        rate_hz = rate_for(cruise.ramp["speed"] / (4 * ground.full_step))
        found = []
        for target, low in ((cruise.length, cruise.lead), (0, cruise.tail)):
            run = await self._moves.sampled(ground.start + target, rate_hz)
            low += ground.start
            found.append(ripple_of(run, low, low + cruise.way, ground.full_step))
            self.record.runs += 1
        self.record.way_fullsteps = self._moves.way_fullsteps
        return found[0], found[1]

    def _tried(self, setting: ChopperSetting, by_speed: Sequence[float], why: str = "") -> ChopperTried:
        return ChopperTried(
            off=setting.off,
            blank=setting.blank,
            hysteresis=setting.hysteresis,
            ripple_fullsteps=together(by_speed, self._ground.least),
            by_speed_fullsteps=list(by_speed),
            chopper_hz=self._ground.chopper.chopper_hz(setting),
            why=why,
        )

    # --- baseline, search ---------------------------------------------------------------------------

    async def _baseline(self) -> None:
        ground, found = self._ground, self.found
        now = await self._shaken(ground.chopper.registers_now(), BASELINE_ROUNDS)
        found.before = self._tried(ground.chopper.now, now, "as it was")
        await self.keeper.save(self.record)

    async def _search(self) -> None:
        record, ground, budget = self.record, self._ground, self.record.document.budget
        space = Space(dimensions(ground.allowed), 1, "tpe")
        seed = record.document.seed + len(record.trials)
        searcher = Searcher(self.keeper.folder / "optuna.db", space, seed, aside=isinstance(self.clock, WallClock))
        known = {_setting(one): one for one in self.found.tried}
        margins = Margins(ground.allowed, ground.chopper.ripples)
        passed = 0
        try:
            await searcher.open()
            spread = margins.spread(round(SPREAD_SHARE * budget.trials), record.document.seed)
            await searcher.first([setting.told for setting in dict.fromkeys((*self._first(), *spread))])
            while (
                len(known) < budget.trials and len(known) < len(ground.allowed) and not self.spent(share=SEARCH_SHARE)
            ):
                done = len(known)
                self.tell(
                    "search",
                    0.05 + (PROOF_FROM - 0.05) * done / budget.trials,
                    f"trial {done + 1}{self._best_text()}",
                    ground.round_s * (budget.trials - done + 2 * self.wanted.pairs),
                )
                if done > 1 and (done >= MARGINS_FROM * budget.trials or passed >= PASSED_MOST):
                    # Other limits since it was cut off may leave out some that were tried.
                    allowed = [setting for setting in known if setting in ground.allowed]
                    tried = {setting: known[setting].ripple_fullsteps for setting in allowed}
                    told = margins.steepest(tried) if done % 2 else margins.calmest(tried)
                    await searcher.first([told.told])
                asked = await searcher.ask()
                passed = 0 if await self._trial(searcher, asked, known) else passed + 1
        finally:
            searcher.close()

    def _first(self) -> list[ChopperSetting]:
        """Before any that the search asks for: as it is now and as calculated, or the nearest to them that may be
        tried."""
        chopper, allowed = self._ground.chopper, self._ground.allowed
        return [nearest(wanted, allowed) for wanted in (chopper.calculated, chopper.now)]

    async def _trial(self, searcher: Searcher, asked: Asked, known: dict[ChopperSetting, ChopperTried]) -> bool:
        """Try what was asked for; False where that took no run."""
        record, found, chopper = self.record, self.found, self._ground.chopper
        setting = setting_of(asked.values)
        if setting in known:
            await searcher.tell(asked, [known[setting].ripple_fullsteps], 0.0)
            return False
        if setting not in self._ground.allowed:
            await searcher.fail(asked)
            return False
        self.keeper.mark(f"trial {asked.number}: {setting.words}")
        registers = chopper.registers(setting)
        calculated = setting == nearest(chopper.calculated, self._ground.allowed)
        tried = self._tried(setting, await self._shaken(registers), "calculated" if calculated else "")
        known[setting] = tried
        found.tried.append(tried)
        found.calculated = tried if calculated else found.calculated
        record.trials.append(
            Trial(
                number=asked.number,
                setting=setting.told,
                registers=registers,
                state="feasible",
                figures=Figures(deviation_fullsteps=tried.ripple_fullsteps, runs=2 * len(tried.by_speed_fullsteps)),
                why=tried.why,
                at_s=self.since_s,
            )
        )
        record.best = record.trials[self._calmest(found.tried)].number
        await searcher.tell(asked, [tried.ripple_fullsteps], 0.0)
        await self.keeper.save(record)
        return True

    def _calmest(self, tried: Sequence[ChopperTried]) -> int:
        """Which of them: of those that are as calm as the calmest the one with the least hysteresis."""
        least = min(each.ripple_fullsteps for each in tried)
        near = [index for index, each in enumerate(tried) if each.ripple_fullsteps <= least * (1 + ALIKE)]
        return min(near, key=lambda index: (tried[index].hysteresis, tried[index].ripple_fullsteps))

    def _best_text(self) -> str:
        tried = self.found.tried
        return f", best {plain(tried[self._calmest(tried)].ripple_fullsteps, 3)} full steps" if tried else ""

    # --- proof --------------------------------------------------------------------------------------

    async def _best(self) -> Trial | None:
        """The best after the first few were measured again: the least of many is least by luck, too."""
        record, found = self.record, self.found
        first = sorted(range(len(found.tried)), key=lambda index: found.tried[index].ripple_fullsteps)[:FINALISTS]
        calmest = self._calmest(found.tried) if found.tried else None
        indices = list(dict.fromkeys([*first, *([] if calmest is None else [calmest])]))
        again: list[ChopperTried] = []
        for index in indices:
            if self.spent(share=SEARCH_SHARE + 0.05):
                break
            self.tell("search", PROOF_FROM, f"trial {record.trials[index].number} again")
            one = found.tried[index]
            by_speed = await self._shaken(record.trials[index].registers, AGAIN)
            again.append(self._tried(_setting(one), by_speed, "measured again"))
        if not again:
            record.improved = None
            record.verdict = "the budget ended before anything was compared: nothing is shown"
            record.next = "more time"
            return None
        chosen = self._calmest(again)
        found.chosen = again[chosen]
        best = record.trials[indices[chosen]]
        record.best = best.number
        before = found.before
        assert before is not None
        same = _setting(found.chosen) == self._ground.chopper.now
        if same or found.chosen.ripple_fullsteps >= before.ripple_fullsteps * (1 - self.wanted.smallest_gain):
            record.improved, record.best = False, None
            record.verdict = (
                f"nothing that was tried is calmer than {self._ground.chopper.now.words} by more than "
                f"{100 * self.wanted.smallest_gain:g} %: it stays as it is"
            )
            record.next = MAP_NEXT
            return None
        return best

    async def _prove(self, best: Trial) -> None:
        found, wanted = self.found, self.wanted
        settings = {"A": self._ground.chopper.registers_now(), "B": best.registers}
        self.keeper.mark(f"proof of trial {best.number}")
        for index in range(len(found.pairs), wanted.pairs):
            if self.spent():
                break
            self.tell(
                "proof",
                PROOF_FROM + (1 - PROOF_FROM) * index / wanted.pairs,
                f"pair {index + 1} of {wanted.pairs}",
                2 * (wanted.pairs - index) * self._ground.round_s,
            )
            order = pair_order(index)
            shaken = {which: together(await self._shaken(settings[which]), self._ground.least) for which in order}
            found.pairs.append(RipplePair(baseline_fullsteps=shaken["A"], winner_fullsteps=shaken["B"], order=order))
            await self.keeper.save(self.record)
        self._decide(best)
        await self.keeper.save(self.record)

    def _decide(self, best: Trial) -> None:
        record, found, wanted = self.record, self.found, self.wanted
        chosen = found.chosen
        assert chosen is not None
        if len(found.pairs) < wanted.pairs:
            record.improved, record.best = None, None
            record.verdict = f"the budget ended after {len(found.pairs)} of {wanted.pairs} pairs: nothing is shown"
            record.next = "more time"
            return
        before = [pair.baseline_fullsteps for pair in found.pairs]
        after = [pair.winner_fullsteps for pair in found.pairs]
        shown = compared_pairs(before, after, wanted.smallest_gain, record.document.seed)
        effect, old, new, record.improved = shown.effect, shown.old, shown.new, shown.better
        found.effect = RippleEffect(
            pairs=len(found.pairs),
            baseline_fullsteps=old,
            winner_fullsteps=new,
            difference_fullsteps=effect.mean,
            interval_fullsteps=effect.interval,
            p=effect.p,
            significant=record.improved,
        )
        setting, around = _setting(chosen), effect.interval
        if record.improved:
            record.verdict = (
                f"{setting.words} instead of {self._ground.chopper.now.words}: the shaft shakes "
                f"{100 * (1 - new / old):.3g} % less ({100 * -around.high / old:.3g} to {100 * -around.low / old:.3g} "
                f"%, 95 %), the chopper at about {plain(chosen.chopper_hz / 1e3, 3)} kHz; "
                f"{'it is set' if wanted.keep else 'one click takes it'}"
            )
            record.next = MAP_NEXT
            return
        record.best = None
        record.verdict = f"{setting.words} is not shown to be calmer: {self._ground.chopper.now.words} stays"
        record.next = f"more pairs than {wanted.pairs}, or speeds at which the shaft shakes more"


def _setting(tried: ChopperTried) -> ChopperSetting:
    return ChopperSetting(tried.off, tried.blank, tried.hysteresis)
