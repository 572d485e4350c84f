"""The study itself: whether the current limits at all, its edge, a margin above it, and the proof."""

from __future__ import annotations

import math
from collections.abc import Sequence

from ...number_text import plain
from ...procedures.procedure import Failed
from ..document import LeastCurrent, told_twin
from ..parts import Interval
from ..proof import rate_bound, runs_for
from ..record import Figures, Finding, Trial
from ..run import StudyRun
from ..search import Dimension, Space
from ..twins.identified import why_no_amperes
from ..twins.search import look_on_twins
from .cool_search import Bench, CoolSearch
from .cycle import Cycle, faster
from .cycles import NAME, ON_TWIN, LoadCycles
from .found import CoolStepFound, CurrentTried, LeastCurrentFound, Saving
from .plan import BASELINE_CYCLES, MORE_SEARCHES, Ground, look

PROOFS_MOST = 4
"""So often the edge is taken one scale higher after steps were lost in the proof."""
COPPER_WARM = 1 + 0.00393 * 60
"""Resistance of copper at 80 deg C, of that at 20."""
CURRENT_SHARE = 0.05
"""How well a driver's scale and its sense resistor are known."""
UNITS = {"run current scale": "1/32"}
PROOF, COOL_PROOF = (0.4, 0.95), (0.5, 0.8)
"""How far the study is, where the proof begins and ends."""


class LeastCurrentStudy(StudyRun):
    """Lowers the run current until a load cycle loses steps, and proves one that lies a margin above, where the current
    and not the supply is what limits."""

    _ground: Ground
    _load: LoadCycles
    _gone_over: int
    """So many of those that were tried count: what was tried before it was cut off is gone over step by step, and
    not tried again."""

    @property
    def wanted(self) -> LeastCurrent:
        """What is looked for."""
        return self.record.document.wanted(LeastCurrent)

    @property
    def found(self) -> LeastCurrentFound:
        """What of it stands in the record."""
        assert self.record.least_current is not None
        return self.record.least_current

    async def _study(self) -> None:
        record, wanted = self.record, self.wanted
        ground = self._ground = await self.looked(look, wanted)
        record.trials, record.best, record.findings = [], None, []
        if not record.baseline:
            cool = [] if ground.cool is None else ground.cool.before
            record.baseline = [*ground.current.before, *ground.space.before, *cool]
            record.baseline_setting = {NAME: float(ground.current.run_scale)}
        record.units = dict(UNITS)
        self._load = LoadCycles(self.device, self.axis, self.clock, ground, record.document.seed, self.apply)
        self._load.before = record.baseline
        self._load.mark, self._load.spent, self._load.left = self.keeper.mark, self.spent, self._tell_left
        self._load.moves.way_fullsteps = record.way_fullsteps
        self._load.ran = lambda: self.ran(self._load.moves)
        earlier = [] if record.least_current is None else record.least_current.tried
        self._gone_over = 0
        self._span = PROOF if ground.cool is None else (PROOF[0], COOL_PROOF[0])
        record.least_current = LeastCurrentFound(
            scale_before=ground.current.run_scale,
            tried=earlier,
            coolstep=CoolStepFound(why=ground.why_not_cool) if wanted.coolstep else None,
        )
        await self.keeper.save(record)
        await self._baseline()
        if await self._supply_limits():
            await self._speed_that_holds()
            self._no_coolstep("the supply limits, and not the current")
        else:
            await self._twins()
            await self._cool(await self._prove(await self._edge()))
        await self.back()
        await self._load.moves.go(ground.start)

    # --- cycles -----------------------------------------------------------------------------------

    def _tell_left(self, left_s: float, done: float) -> None:
        if self.record.phase == "proof":
            low, high = self._span
            self.tell("proof", low + (high - low) * done, self.record.message, left_s)

    def _spent(self, share: float = 1.0) -> bool:
        """Whether that is used up, and nothing is left that was tried before it was cut off."""
        return self._gone_over == len(self.found.tried) and self.spent(share)

    async def _tried(self, scale: int, cycles: int, cycle: Cycle) -> bool:
        """Whether so many cycles at a scale lose no step."""
        tried = self.found.tried
        if self._gone_over < len(tried):
            one = tried[self._gone_over]
            whole = one.cycles == cycles or not one.held
            if whole and (one.scale, one.speed_times) == (scale, cycle.times):
                self._gone_over += 1
                return one.held
            del tried[self._gone_over :]  # with other limits than before this is another search
        seen = await self._load.at(scale, cycles, cycle)
        tried.append(
            CurrentTried(
                scale=scale,
                share=self._ground.current.share(scale),
                held=seen.held,
                cycles=seen.done,
                speed_times=cycle.times,
                deviation_fullsteps=seen.worst,
            )
        )
        self._gone_over += 1
        await self.keeper.save(self.record)
        return seen.held

    # --- baseline, edge ---------------------------------------------------------------------------

    async def _baseline(self) -> None:
        self.tell("baseline", 0.0, "load cycles with the current as it is set now")
        self._touched = True
        await self._load.moves.fall_into_step(self._ground.start, self._ground.cycle.way)
        for _ in range(BASELINE_CYCLES):
            if not (await self._load.once(self._ground.cycle)).held:
                raise Failed("it loses steps with the current as it is set now: more current, or a gentler ramp, first")

    async def _supply_limits(self) -> bool:
        """Whether more speed alone loses steps with the current as it was before."""
        more, scale = self._ground.faster, self._ground.current.run_scale
        if more is None:
            return False
        self.tell("baseline", 0.04, f"{100 * (more.times - 1):.0f} % more speed, with the current as it is set now")
        self.found.limited_by_supply = not await self._tried(scale, self.wanted.repeats, more) and not self._spent()
        return self.found.limited_by_supply

    async def _speed_that_holds(self) -> None:
        """By halves how much more speed loses no step."""
        record, found, ground, more = self.record, self.found, self._ground, self._ground.faster
        assert more is not None
        low, high = 1.0, more.times
        for index in range(MORE_SEARCHES - 1):
            middle = (low + high) / 2
            cycle = faster(ground.cycle, middle, ground.most, ground.room)
            if cycle is None or self._spent():
                break
            self.tell("search", 0.1 + 0.2 * index, f"{100 * (middle - 1):.0f} % more speed")
            if await self._tried(ground.current.run_scale, self.wanted.repeats, cycle):
                low = middle
            else:
                high = middle
        found.speed_times_held = low
        record.improved = False
        record.verdict = (
            f"limited by the supply voltage, not by the current: with {found.scale_before + 1}/32 of the current as "
            f"before, {100 * (high - 1):.2g} % more speed loses steps, {100 * (low - 1):.2g} % more does not; less "
            "current would be no margin, so it stays as it is"
        )
        record.next = "more supply voltage, a motor of less inductance, or a slower ramp; then once more"

    async def _twins(self) -> None:
        """Every scale on twins, and the least that held there remembered; the motor rests meanwhile."""
        record, twin = self.record, told_twin(self.wanted.twin)
        if twin is None or record.twin:
            return
        if why := why_no_amperes(self.device, self.axis):
            record.findings.append(Finding(name="twin", text=f"could not be tried: {why}", sure="missing"))
            return
        most = self._ground.current.run_scale
        space = Space((Dimension(NAME, 0.0, float(most), log=False),), 1, "tpe")
        every = [{NAME: float(scale)} for scale in range(most, -1, -1)]
        await look_on_twins(self, ON_TWIN, twin.model_copy(update={"trials": len(every)}), space, every)

    async def _edge(self) -> int:
        """The least scale at which no step is lost: near what held on a twin, where one was tried, else by halves."""
        low, high, step = -1, self._ground.current.run_scale, 1
        guesses = [round(one.setting[NAME]) for one in self.record.twin]
        while high - low > 1 and not self._spent(0.5):
            between = [scale for scale in guesses if low < scale < high]
            if between:
                scale = between[0]
            elif guesses and low < 0 and high <= guesses[0]:
                scale, step = max(high - step, 0), 2 * step
            else:
                scale = (low + high) // 2
            self.tell("search", 0.1 + 0.25 * min(len(self.found.tried) / 5, 1), f"trying {scale + 1}/32 of the current")
            if await self._tried(scale, self.wanted.repeats, self._ground.cycles[0]):
                high = scale
            else:
                low = scale
        return high

    # --- proof ------------------------------------------------------------------------------------

    def _choice(self, edge: int) -> tuple[int, int]:
        """The least scale whose current less the margin is that of the edge, and the scale of that margin."""
        kept = 1 - self.wanted.margin
        chosen = math.ceil((edge + 1) / kept - 1e-9) - 1
        return chosen, math.floor((chosen + 1) * kept + 1e-9) - 1

    async def _prove(self, edge: int) -> int | None:
        """The scale that has its margin; None where what is set has none, or nothing was shown."""
        record, found, wanted = self.record, self.found, self.wanted
        cycles, before = runs_for(wanted.loss_rate_max), self._ground.current.run_scale
        for _ in range(PROOFS_MOST):
            chosen, stressed = self._choice(edge)
            found.edge, found.chosen, found.proved = edge, chosen, stressed
            share = self._ground.current.share(chosen) ** 2
            if chosen >= before or 1 - share < wanted.smallest_gain:
                found.chosen = found.proved = None
                record.improved = False
                record.verdict = (
                    f"{edge + 1}/32 of the current holds, and with {100 * wanted.margin:g} % of margin that is no less "
                    f"than the {before + 1}/32 that are set: it stays as it is"
                )
                record.next = "a smaller margin, a gentler ramp or less load leaves room for less current"
                return before if chosen <= before else None
            self.tell("proof", 0.4, f"{cycles} load cycles at {stressed + 1}/32 of the current")
            if await self._held(stressed, cycles):
                self._decide(chosen, stressed, cycles, share)
                return chosen
            if self._spent():
                break
            edge = max(edge, stressed) + 1
        record.improved, found.chosen, found.proved = None, None, None
        record.verdict = "the budget ended, or steps were lost, before the proof was over: nothing is shown"
        record.next = "more time, or a greater margin"
        return None

    async def _held(self, scale: int, count: int) -> bool:
        """Whether so many cycles lose no step, faster ones and as they are."""
        for cycle in self._ground.cycles:
            if not await self._tried(scale, count, cycle):
                return False
        return True

    def _decide(self, chosen: int, stressed: int, cycles: int, share: float) -> None:
        record, found, wanted = self.record, self.found, self.wanted
        found.cycles, found.loss_rate_max, found.heat_share = cycles, rate_bound(0, cycles), share
        found.saving = self._saving(1.0, share)
        worst: Sequence[float] = [each.deviation_fullsteps or 0.0 for each in found.tried if each.scale == stressed]
        record.trials = [
            Trial(
                number=1,
                setting={NAME: float(chosen)},
                registers=self._ground.scaled(chosen),
                state="feasible",
                figures=Figures(deviation_fullsteps=max(worst), runs=cycles),
                why=f"proved at {stressed + 1}/32",
            )
        ]
        record.best, record.improved = 1, True
        more, raised, watts = self._ground.faster, "", ""
        if more is not None:
            found.speed_times = more.times
            raised = f", nor in as many with {100 * (more.times - 1):.0f} % more speed"
        if found.saving is not None:
            low, high = found.saving.interval_w.low, found.saving.interval_w.high
            watts = (
                f", about {plain(found.saving.saved_w, 3)} W (calculated, 95 %: {plain(low, 3)} to {plain(high, 3)} W)"
            )
        record.verdict = (
            f"{chosen + 1}/32 of the current instead of {found.scale_before + 1}/32: {100 * (1 - share):.3g} % less "
            f"heat in the coils while it moves{watts}; at {stressed + 1}/32 no step was lost in {cycles} load cycles"
            f"{raised}: fewer than {100 * found.loss_rate_max:.2g} % lose some there"
        )
        if wanted.margin < 0.1:
            record.next = "so little margin holds for the load, warmth and supply of now alone"
        elif more is None:
            record.next = "more speed was not tried: nothing shows what a lower supply does"
        else:
            record.next = "take it, then StallGuard and fastest move anew: both depend on the current"

    # --- CoolStep ---------------------------------------------------------------------------------

    def _no_coolstep(self, why: str) -> None:
        cool = self.found.coolstep
        if cool is not None:
            cool.why = cool.why or why

    async def _cool(self, chosen: int | None) -> None:
        """CoolStep on top of the run current."""
        ground, record, found = self._ground, self.record, self.found.coolstep
        if found is None or ground.cool is None:
            return
        if chosen is None:
            self._no_coolstep("no run current with its margin was found, which is its upper end")
            return
        self._span = COOL_PROOF
        bench = Bench(
            space=ground.cool,
            wanted=self.wanted,
            current=ground.scaled,
            chosen=chosen,
            most=ground.current.run_scale,
            cycles=ground.cycles,
            ramp=ground.ramp,
            run=self._load.some,
            tell=self.tell,
            spent=self.spent,
            seed=record.document.seed,
        )
        registers = await CoolSearch(bench, found).run()
        if not registers:
            return
        assert found.setting is not None
        assert found.scale is not None
        assert found.saved_share is not None
        assert found.interval_share is not None
        share = self._ground.current.share(chosen) ** 2
        found.saving = self._saving(share, share * (1 - found.saved_share), found.interval_share)
        record.trials.append(
            Trial(
                number=2,
                setting={NAME: float(found.scale), **{name.upper(): float(value) for name, value in found.setting}},
                registers=registers,
                state="feasible",
                figures=Figures(runs=found.cycles),
                why="with CoolStep",
            )
        )
        record.best, record.improved = 2, True
        record.units |= {name.upper(): "" for name, _ in found.setting}
        record.baseline_setting |= {name.upper(): float(value) for name, value in ground.cool.now}
        around = found.interval_share
        watts = "" if found.saving is None else f", about {plain(found.saving.saved_w, 3)} W"
        low, saved, high = (plain(100 * each, 3) for each in (around.low, found.saved_share, around.high))
        record.verdict += (
            f". With CoolStep ({found.setting}), up to {found.scale + 1}/32, the coils have {saved} % less heat than "
            f"without while it moves (95 %: {low} to {high} %){watts}; with SEMIN {found.setting.semin - 1} and "
            f"{100 * self.wanted.margin:g} % less current no step was lost in {found.cycles} cycles"
        )

    def _saving(self, before_share: float, after_share: float, share: Interval | None = None) -> Saving | None:
        """Of two shares of the heat before; `share` where the heat saved was measured, of the first of them."""
        wanted = self.wanted
        if wanted.resistance_ohm is None or wanted.run_current_a is None:
            return None
        # Both coils together have twice the heat of the RMS current in one.
        full = 2 * wanted.run_current_a**2 * wanted.resistance_ohm
        before, saved = full * before_share, full * (before_share - after_share)
        least, most = (saved, saved) if share is None else (share.low * before, share.high * before)
        low, high = ((1 + sign * CURRENT_SHARE) ** 2 for sign in (-1, 1))
        return Saving(
            before_w=before,
            after_w=before - saved,
            saved_w=saved,
            interval_w=Interval(low=least * low, high=most * high * COPPER_WARM),
        )
