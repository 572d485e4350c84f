"""The study itself: whether the current limits at all, its edge, a margin above it, and the proof."""

from __future__ import annotations

import math
import random
from collections.abc import Sequence

from ...devices.core.capabilities import PositionFromEncoder
from ...number_text import plain
from ...procedures.procedure import Failed
from ..document import LeastCurrent
from ..moves import MeasuredMoves, MoveFigures
from ..parts import Interval
from ..proof import rate_bound, runs_for
from ..record import Figures, Held, Trial
from ..run import StudyRun
from .cycle import Cycle, faster
from .found import CurrentTried, LeastCurrentFound, Saving
from .plan import BASELINE_CYCLES, MORE_SEARCHES, Ground, look

PROOFS_MOST = 4
"""So often the edge is taken one scale higher after steps were lost in the proof."""
BAND_FULLSTEPS = 2.0
COPPER_WARM = 1 + 0.00393 * 60
"""Resistance of copper at 80 deg C, of that at 20."""
CURRENT_SHARE = 0.05
"""How well a driver's scale and its sense resistor are known."""
UNITS = {"run current scale": "1/32"}
NAME = "run current scale"


class LeastCurrentStudy(StudyRun):
    """Lowers the run current until a load cycle loses steps, and proves one that lies a margin above, where the current
    and not the supply is what limits."""

    _ground: Ground
    _moves: MeasuredMoves

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
        self.tell("preconditions", 0.0, "looking at the axis")
        ground = self._ground = (await look(self.device, self.axis, wanted)).required()
        self._moves = MeasuredMoves(self.device, self.axis, self.clock, ground.full_step, BAND_FULLSTEPS)
        self._random = random.Random(record.document.seed)
        record.runs, record.trials, record.best, record.findings = 0, [], None, []
        if not record.baseline:
            record.baseline = [*ground.current.before, *ground.space.before]
            record.baseline_setting = {NAME: float(ground.current.run_scale)}
        record.units = dict(UNITS)
        record.least_current = LeastCurrentFound(scale_before=ground.current.run_scale)
        await self.keeper.save(record)
        await self._baseline()
        if await self._supply_limits():
            await self._speed_that_holds()
        else:
            await self._prove(await self._edge())
        await self.back()
        await self._moves.go(ground.start)

    # --- cycles -----------------------------------------------------------------------------------

    async def _cycle(self, cycle: Cycle) -> tuple[bool, float]:
        """There and back from a place of the electrical period that is drawn anew: whether no step was lost, and the
        peak deviation [full steps]. Lost steps are mended."""
        ground = self._ground
        begin = ground.start + cycle.way * self._random.randrange(ground.period)
        moves: list[MoveFigures] = []
        try:
            await self._moves.go(begin)
            for target in (begin + cycle.distance, begin):
                moves.append(await self._moves.measured(target))
                if moves[-1].lost_fullsteps:
                    break
        finally:
            self.record.runs += 1
            self.record.way_fullsteps = self._moves.way_fullsteps
        held = not any(move.lost_fullsteps for move in moves)
        if not held:
            await self._mend()
        return held, max(move.deviation_fullsteps for move in moves)

    async def _mend(self) -> None:
        self.keeper.mark("steps lost: the position is taken from the encoder")
        await self.apply(self.record.baseline, "current and ramp before the study")
        await self.device.need(PositionFromEncoder).position_from_encoder(self.axis)
        await self._moves.go(self._ground.start)

    def _registers(self, scale: int) -> list[Held]:
        current = self._ground.current
        return current.registers(scale, min(scale, current.hold_scale))

    async def _tried(self, scale: int, cycles: int, cycle: Cycle) -> bool:
        """Whether so many cycles at a scale lose no step."""
        registers = [*self._registers(scale), *self._ground.ramp(cycle)]
        await self.apply(registers, f"run current {scale + 1}/32")
        self.keeper.mark(f"run current {scale + 1}/32")
        worst, done, held = 0.0, 0, True
        while held and done < cycles and not self.spent():
            held, deviation = await self._cycle(cycle)
            done, worst = done + 1, max(worst, deviation)
        self.found.tried.append(
            CurrentTried(
                scale=scale,
                share=self._ground.current.share(scale),
                held=held and done == cycles,
                cycles=done,
                speed_times=cycle.times,
                deviation_fullsteps=worst,
            )
        )
        await self.keeper.save(self.record)
        return held and done == cycles

    # --- baseline, edge ---------------------------------------------------------------------------

    async def _baseline(self) -> None:
        self.tell("baseline", 0.0, "load cycles with the current as it is set now")
        self._touched = True
        # A rotor that stood beside its field when it was switched on falls into step with the first move.
        await self._moves.go(self._ground.start + self._ground.cycle.way * self._ground.period)
        await self._moves.go(self._ground.start)
        for _ in range(BASELINE_CYCLES):
            held, _ = await self._cycle(self._ground.cycle)
            if not held:
                raise Failed("it loses steps with the current as it is set now: more current, or a gentler ramp, first")

    async def _supply_limits(self) -> bool:
        """Whether more speed alone loses steps with the current as it was before."""
        more, scale = self._ground.faster, self._ground.current.run_scale
        if more is None:
            return False
        self.tell("baseline", 0.04, f"{100 * (more.times - 1):.0f} % more speed, with the current as it is set now")
        self.found.limited_by_supply = not await self._tried(scale, self.wanted.repeats, more) and not self.spent()
        return self.found.limited_by_supply

    async def _speed_that_holds(self) -> None:
        """By halves how much more speed loses no step."""
        record, found, ground, more = self.record, self.found, self._ground, self._ground.faster
        assert more is not None
        low, high = 1.0, more.times
        for index in range(MORE_SEARCHES - 1):
            middle = (low + high) / 2
            cycle = faster(ground.cycle, middle, ground.most, ground.room)
            if cycle is None or self.spent():
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

    async def _edge(self) -> int:
        """The least scale at which no step is lost, by halves."""
        low, high = -1, self._ground.current.run_scale
        while high - low > 1 and not self.spent(share=0.5):
            middle = (low + high) // 2
            self.tell("search", 0.05 + 0.3 * len(self.found.tried) / 5, f"trying {middle + 1}/32 of the current")
            if await self._tried(middle, self.wanted.repeats, self._ground.cycles[0]):
                high = middle
            else:
                low = middle
        return high

    # --- proof ------------------------------------------------------------------------------------

    def _choice(self, edge: int) -> tuple[int, int]:
        """The least scale whose current less the margin is that of the edge, and the scale of that margin."""
        kept = 1 - self.wanted.margin
        chosen = math.ceil((edge + 1) / kept - 1e-9) - 1
        return chosen, math.floor((chosen + 1) * kept + 1e-9) - 1

    async def _prove(self, edge: int) -> None:
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
                return
            self.tell("proof", 0.4, f"{cycles} load cycles at {stressed + 1}/32 of the current")
            if await self._held(stressed, cycles):
                self._decide(chosen, stressed, cycles, share)
                return
            if self.spent():
                break
            edge = max(edge, stressed) + 1
        record.improved, found.chosen, found.proved = None, None, None
        record.verdict = "the budget ended, or steps were lost, before the proof was over: nothing is shown"
        record.next = "more time, or a greater margin"

    async def _held(self, scale: int, count: int) -> bool:
        """Whether so many cycles lose no step, faster ones and as they are."""
        for cycle in self._ground.cycles:
            if not await self._tried(scale, count, cycle):
                return False
        return True

    def _decide(self, chosen: int, stressed: int, cycles: int, share: float) -> None:
        record, found, wanted = self.record, self.found, self.wanted
        found.cycles, found.loss_rate_max, found.heat_share = cycles, rate_bound(0, cycles), share
        found.saving = self._saving(share)
        worst: Sequence[float] = [each.deviation_fullsteps or 0.0 for each in found.tried if each.scale == stressed]
        record.trials = [
            Trial(
                number=1,
                setting={NAME: float(chosen)},
                registers=self._registers(chosen),
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

    def _saving(self, share: float) -> Saving | None:
        wanted = self.wanted
        if wanted.resistance_ohm is None or wanted.run_current_a is None:
            return None
        # Both coils together have twice the heat of the RMS current in one.
        before = 2 * wanted.run_current_a**2 * wanted.resistance_ohm
        saved = before * (1 - share)
        low, high = ((1 + sign * CURRENT_SHARE) ** 2 for sign in (-1, 1))
        return Saving(
            before_w=before,
            after_w=before * share,
            saved_w=saved,
            interval_w=Interval(low=saved * low, high=saved * high * COPPER_WARM),
        )
