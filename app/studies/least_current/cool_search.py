"""CoolStep for a load cycle: what the load value is, which setting saves most, its proof, and what it saves."""

from __future__ import annotations

import itertools
import math
from collections.abc import Awaitable, Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ...number_text import plain
from ...telemetry.sampling import FloatArray
from ..document import LeastCurrent
from ..parts import Interval
from ..proof import compared_pairs, pair_order, rate_bound, runs_for
from ..record import Held, Phase
from .cool_setting import CoolSpace
from .cycle import Cycle
from .found import UNIT, CoolPair, CoolSetting, CoolStepFound, CoolTried

CHANNELS = "velocity", "load_value", "actual_current_scale"
FROM = 0.75, 0.96
"""Shares of the cycle's speed from which on it works, in turn until one holds: further down the load value says little,
and from the second on it works in the steady part alone."""
UPPER = 1.0, 1.3, 1.7, 2.2
"""Run currents that CoolStep may go up to, of the one that holds without it, in turn until one holds: current that
comes late has to be more."""
STEADY = 0.97
"""Share of the cycle's speed that is its steady part."""
STEADY_SAMPLES = 20
LEAST_SEMIN = 2
"""It is proved with one less, and 0 switches it off."""
INSIDE = 8.0 * UNIT, 13.0 * UNIT
"""Where the load value is to lie at steady speed, where the level may be set for it."""
LEVELS = 4
COUNTS_A_LEVEL = 8.0
"""What one more of SGT adds to a load value, about (INFERRED): it is measured again after each step."""
LEVEL_STEP = 16
LEVEL_RANGE = -64, 63
SEMINS = 5
"""So many of them are tried, from the most careful one on."""
OTHERS: tuple[dict[str, int], ...] = ({"sedn": 1}, {"sedn": 3}, {"seup": 2}, {"seup": 1}, {"semax": 0}, {"semax": 3})
LESS = 0.01
"""Less heat than this is no reason to change a field [share]."""
HEAT_CYCLES = 2
PROOFS_MOST = 4
PAIRS = 10
CYCLES = LEVELS + 2 * PAIRS
"""Load cycles that it takes at the most, beside those of each setting and of the proof."""
SETTINGS = 2 * len(FROM) * len(UPPER) + SEMINS + len(OTHERS)


@dataclass(frozen=True, slots=True)
class Cycled:
    """Load cycles at one setting. held : no step was lost; worst : peak deviation [full steps]; beside : what was
    sampled while it moved, as `CHANNELS` have it."""

    held: bool
    done: int
    worst: float
    beside: FloatArray


RunCycles = Callable[[Sequence[Held], str, int, Cycle], Awaitable[Cycled]]
"""Sets registers, told in words, and does so many cycles; it ends with the first that loses a step."""


@dataclass(frozen=True, slots=True)
class Bench:
    """What the search works with. current : registers of a run current scale; chosen : the scale that holds without
    CoolStep, most : the greatest that there may be; cycles : the hardest first, the load cycle last; spent : whether
    the budget is used up"""

    space: CoolSpace
    wanted: LeastCurrent
    current: Callable[[int], list[Held]]
    chosen: int
    most: int
    cycles: Sequence[Cycle]
    ramp: Callable[[Cycle], list[Held]]
    run: RunCycles
    tell: Callable[[Phase, float, str], None]
    spent: Callable[[], bool]
    seed: int


class _Told(Exception):
    """Why there is none."""


class CoolSearch:
    """Looks for CoolStep at a run current that holds already."""

    def __init__(self, bench: Bench, found: CoolStepFound) -> None:
        self._bench, self.found = bench, found
        space, peak = bench.space, bench.cycles[-1].peak
        mine = [share * peak for share in FROM]
        # Where a stall stops the motor, it does so from the same speed on.
        self._speeds = [space.from_pps] if space.stops else [min(space.from_pps, mine[0]), mine[1]]
        self._from_pps, self._level = self._speeds[0], space.level
        above = {min(math.ceil(times * (bench.chosen + 1)) - 1, bench.most) for times in UPPER}
        self._uppers = sorted(above)
        self._upper = bench.chosen

    async def run(self) -> list[Held]:
        """The registers of what was found; empty where there is none, and `found` says why. Raises BenchError."""
        try:
            await self._measure()
            setting = await self._prove(await self._search())
            await self._weigh(setting)
        except _Told as why:
            self.found.why, self.found.setting = str(why), None
            return []
        return self._registers(setting)

    def _registers(self, setting: CoolSetting, *, stressed: bool = False, times: float = 1.0) -> list[Held]:
        """`times` the speed of the load cycle, and of the speed from which on it works."""
        bench = self._bench
        used = setting.but(semin=setting.semin - 1) if stressed else setting
        scale = math.floor((self._upper + 1) * (1 - bench.wanted.margin) + 1e-9) - 1 if stressed else self._upper
        return [*bench.current(scale), *bench.space.registers(used, times * self._from_pps, self._level)]

    async def _run(self, registers: Sequence[Held], words: str, count: int, cycle: Cycle) -> Cycled:
        if self._bench.spent():
            raise _Told("the budget ended before it was shown: give it more time")
        return await self._bench.run([*registers, *self._bench.ramp(cycle)], words, count, cycle)

    # --- the load value ---------------------------------------------------------------------------

    async def _measure(self) -> None:
        """The load value of the cycle without CoolStep, at a level at which it lies inside its range."""
        bench, found, cycle, steady_value = self._bench, self.found, self._bench.cycles[-1], 0.0
        off = CoolSetting(semin=0, semax=0, seup=0, sedn=0, seimin=0)
        for index in range(LEVELS):
            bench.tell("search", 0.0, "CoolStep: the load value of the cycle")
            seen = await self._run(self._registers(off), f"CoolStep off, SGT {self._level}", 1, cycle)
            if not seen.held:
                raise _Told("a step was lost while the load value was measured")
            speed, load = np.abs(seen.beside[:, 0]), seen.beside[:, 1]
            steady = load[speed >= STEADY * cycle.peak]
            changing = load[(speed < STEADY * cycle.peak) & (speed >= self._from_pps)]
            if len(steady) < STEADY_SAMPLES:
                raise _Told("the cycle has hardly a part at steady speed: there is nothing to save in")
            steady_value = found.steady = float(np.quantile(steady, 0.25))
            found.loaded = float(np.quantile(changing, 0.25)) if len(changing) else None
            low, high = INSIDE
            if low <= steady_value <= high or bench.space.stops or index == LEVELS - 1:
                break
            away = (sum(INSIDE) / 2 - steady_value) / COUNTS_A_LEVEL
            moved = self._level + round(min(max(away, -LEVEL_STEP), LEVEL_STEP))
            moved = min(max(moved, LEVEL_RANGE[0]), LEVEL_RANGE[1])
            if moved == self._level:
                break
            self._level = moved
        found.level = self._level
        if steady_value < UNIT * (LEAST_SEMIN + 1):
            raise _Told(
                f"StallGuard does not tell the load at this speed: its value is {steady_value:.0f} at steady "
                f"speed, and CoolStep takes current away from {UNIT * (LEAST_SEMIN + 1)} on at the least"
            )

    # --- the setting ------------------------------------------------------------------------------

    async def _tried(self, setting: CoolSetting) -> CoolTried:
        """A setting with one less of SEMIN and less run current, in the hardest cycle; where that holds, its heat."""
        bench, repeats = self._bench, self._bench.wanted.repeats
        bench.tell("search", 0.1 + 0.4 * len(self.found.tried) / SETTINGS, f"CoolStep: {setting}")
        hardest = bench.cycles[0]
        less = self._registers(setting, stressed=True, times=hardest.times)
        seen = await self._run(less, f"{setting}, less", repeats, hardest)
        heat = None
        if seen.held:
            heat = await self._heat(self._registers(setting), str(setting), HEAT_CYCLES)
        one = CoolTried(setting=setting, scale=self._upper, held=heat is not None, cycles=seen.done, heat_share=heat)
        self.found.tried.append(one)
        return one

    async def _heat(self, registers: Sequence[Held], words: str, count: int) -> float | None:
        """Mean of the current's square in the load cycle, of that of the run current; None where a step was lost."""
        seen = await self._run(registers, words, count, self._bench.cycles[-1])
        if not seen.held:
            return None
        return float(np.mean(((seen.beside[:, 2] + 1) / (self._bench.chosen + 1)) ** 2))

    async def _search(self) -> CoolSetting:
        """Field by field: the one with the least heat of those that hold."""
        assert self.found.steady is not None
        fits = int(self.found.steady // UNIT) - 1
        width = 1 if fits - 1 >= LEAST_SEMIN else 0
        top = min(fits - width, 15)
        best = await self._careful_one(top, width)
        for semin in range(top - 1, max(top - SEMINS, LEAST_SEMIN - 1), -1):
            one = await self._tried(best.setting.but(semin=semin))
            if not _less(one, best):
                break
            best = one
        for change in OTHERS:
            setting = best.setting.but(**change)
            if setting.upper > UNIT * (fits + 1) + UNIT * OTHERS[-1]["semax"] or setting == best.setting:
                continue
            one = await self._tried(setting)
            if _less(one, best):
                best = one
        return best.setting

    async def _careful_one(self, semin: int, width: int) -> CoolTried:
        """The first that holds, at the greatest SEMIN that the load value allows: with a lower one none would."""
        for upper, from_pps, least in itertools.product(self._uppers, self._speeds, (1, 0)):
            self._upper, self._from_pps = upper, from_pps
            one = await self._tried(CoolSetting(semin=semin, semax=width, seup=3, sedn=2, seimin=least))
            if one.held:
                self.found.scale, self.found.from_pps = upper, from_pps
                return one
        raise _Told("steps were lost at every setting: the load value does not tell the load in time at this speed")

    # --- proof ------------------------------------------------------------------------------------

    async def _prove(self, setting: CoolSetting) -> CoolSetting:
        """None of so many cycles loses a step with one less of SEMIN and less run current: else a more careful one."""
        bench, found = self._bench, self.found
        cycles = runs_for(bench.wanted.loss_rate_max)
        for careful in _careful(setting):
            bench.tell("proof", 0.5, f"CoolStep: {cycles} load cycles with {careful}, and less")
            held = True
            for cycle in bench.cycles:
                seen = await self._run(
                    self._registers(careful, stressed=True, times=cycle.times), f"{careful}, less", cycles, cycle
                )
                held = held and seen.held
                if not held:
                    found.tried.append(CoolTried(setting=careful, scale=self._upper, held=False, cycles=seen.done))
                    break
            if held:
                found.setting, found.cycles, found.loss_rate_max = careful, cycles, rate_bound(0, cycles)
                return careful
        raise _Told("steps were lost in the proof")

    async def _weigh(self, setting: CoolSetting) -> None:
        """What it saves, by pairs of load cycles with it and without."""
        bench, found = self._bench, self.found
        without = [*bench.current(bench.chosen), *bench.space.before]
        for index in range(PAIRS):
            bench.tell("proof", 0.8 + 0.2 * index / PAIRS, "CoolStep: load cycles with it, and without")
            order = pair_order(index)
            heat: dict[str, float] = {}
            for which in order:
                share = await self._heat(
                    *((without, "as before", 1) if which == "A" else (self._registers(setting), str(setting), 1))
                )
                if share is None:
                    raise _Told("a step was lost while its heat was measured")
                heat[which] = share
            found.pairs.append(CoolPair(without=heat["A"], with_it=heat["B"], order=order))
        old, new = [pair.without for pair in found.pairs], [pair.with_it for pair in found.pairs]
        seen = compared_pairs(old, new, bench.wanted.smallest_gain, bench.seed)
        found.saved_share, found.p = -seen.effect.mean, seen.effect.p
        found.interval_share = Interval(low=-seen.effect.interval.high, high=-seen.effect.interval.low)
        if not seen.better:
            around = found.interval_share
            raise _Told(
                f"{setting} saves {plain(100 * found.saved_share, 3)} % of the heat while it moves (95 %: "
                f"{plain(100 * around.low, 3)} to {plain(100 * around.high, 3)} %), which is not shown to be "
                f"{plain(100 * bench.wanted.smallest_gain, 3)} % or more"
            )


def _less(one: CoolTried, other: CoolTried) -> bool:
    """Whether it holds with less heat than the other."""
    if one.heat_share is None or other.heat_share is None:
        return one.heat_share is not None
    return one.heat_share < other.heat_share - LESS


def _careful(setting: CoolSetting) -> Iterator[CoolSetting]:
    """The setting, then each more careful than the one before: current comes back earlier, and goes less far down."""
    yield setting
    for _ in range(PROOFS_MOST - 1):
        if setting.semin < 15 and setting.semax > 0:
            setting = setting.but(semin=setting.semin + 1, semax=setting.semax - 1)
        elif setting.seimin:
            setting = setting.but(seimin=0)
        elif setting.sedn:
            setting = setting.but(sedn=setting.sedn - 1)
        else:
            return
        yield setting
