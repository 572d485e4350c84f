"""Motor current of the TMC5xxx from their settings, and the settings nearest to a wanted current.

A sine wave through a coil has the peak VFS / (R_sense + 20 mOhm) * (CS + 1) / 32, with CS the scale IRUN or IHOLD and
VFS the voltage that vsense selects; the TMC5160 scales by GLOBALSCALER / 256 instead of vsense and has no resistance of
its own to add. A TMC5130 can measure in its own transistors: full scale is then 3000 times the current that a resistor
from 5VOUT lets into AIN_IREF. A TMC5240 always measures inside: full scale is what CURRENT_RANGE stands for, less with
a greater resistor at IREF, times GLOBALSCALER / 256. RMS is the peak over the square root of 2.

Sources: KLIPPER for the TMC5240 (of the TMC2240);
DS-TMC5160 9 and 28.2; DS-TMC5130 9 to 11 and 30.2; DS-TMC5072 7 and 23.2; DS-TMC5031 6; DS-TMC5062 7. Their
tables of R_sense for the chips with two axes are reckoned with some 3 % less than the 0.32 V and 0.18 V that the same
sheets state; the TMC5130's with the 0.325 V of its electrical characteristics, where its text says 0.32 V. The stated
electrical characteristics are used here.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

from ..families import CHIPS
from .chips import Chip, Sensing

SCALES = 32
SCALER_FULL = 256
SCALER_LEAST = 32
SCALER_GOOD = 128
"""A smaller GLOBALSCALER gives worse results (DS-TMC5160 6.1)."""
FINE_SCALE = 16
"""A smaller CS makes microsteps coarser (all sheets, IRUN)."""
REFERENCE_GAIN = 3000.0
REFERENCE_V = 5.0
REFERENCE_OHM = 1000.0
"""Of the pin AIN_IREF itself."""
INTERNAL_SENSITIVE = 0.55
"""Of the current inside with vsense = 0: what vsense = 1 gives (DS-TMC5130 11)."""
AIN_FULL_V = 2.5
RANGE_OHM = (12_000.0, 60_000.0)
"""Of the resistor at IREF of a chip with ranges (KLIPPER)."""

REACH = 0.03
"""How far off the best fine setting may be before coarse ones are looked at."""
_SAME = 0.01
"""Errors that differ by less are alike: sense resistors are no more exact."""
FAR = 1e9
"""Steps of `_SAME` beyond which an error is no better told: a wanted current next to nothing."""


class Setting(NamedTuple):
    """scale : IRUN or IHOLD. select : vsense, or for a TMC5160 the scaler of 256 (32..256). peak_a : [A]."""

    scale: int
    select: int
    peak_a: float

    @property
    def rms_a(self) -> float:
        return self.peak_a / math.sqrt(2)


@dataclass(frozen=True)
class CurrentStage:
    """A chip with its resistors.

    sense_ohm : external; None measures inside, by `reference_ohm`: a TMC5130 can, a TMC5240 knows nothing else
    ain_v : of a TMC5130 with sense resistors: what AIN_IREF scales with; None for the reference inside
    current_range : of a chip that has ranges; None for its widest

    Raises ValueError for what the chip has not, and numbers that are not above 0.
    """

    model: str
    sense_ohm: float | None
    reference_ohm: float | None = None
    ain_v: float | None = None
    current_range: int | None = None

    def __post_init__(self) -> None:
        if self.model not in CHIPS:
            raise ValueError(f"model is one of {', '.join(CHIPS)}, not {self.model}")
        name = self.model.upper()
        if self.ranged:
            self._check_range(name)
            return
        if self.current_range is not None:
            raise ValueError(f"a {name} has no current_range")
        if not self.kind.reference and self.sense_ohm is None:
            raise ValueError(f"a {name} measures with sense resistors: sense_resistor_ohm is missing")
        if not self.kind.reference and (self.reference_ohm is not None or self.ain_v is not None):
            raise ValueError(f"a {name} has no AIN_IREF; a TMC5130 has")
        if self.sense_ohm is None and self.reference_ohm is None:
            raise ValueError("without sense resistors it takes a reference_resistor_ohm, from 5VOUT to AIN_IREF")
        if self.sense_ohm is not None and self.reference_ohm is not None:
            raise ValueError("a reference resistor takes the place of the sense resistors: one of them, not both")
        if self.sense_ohm is None and self.ain_v is not None:
            raise ValueError("without sense resistors AIN_IREF is where the reference resistor is, not a voltage")
        for label, ohm in (("sense", self.sense_ohm), ("reference", self.reference_ohm)):
            if ohm is not None and not 0 < ohm < math.inf:
                raise ValueError(f"{label}_resistor_ohm is above 0 and finite, got {ohm}")
        if self.ain_v is not None and not 0 <= self.ain_v <= REFERENCE_V:
            raise ValueError(f"ain_v is 0 to {REFERENCE_V:g} V, got {self.ain_v}")

    def _check_range(self, name: str) -> None:
        least, most = RANGE_OHM
        if self.sense_ohm is not None or self.ain_v is not None:
            raise ValueError(f"a {name} measures inside: it takes a reference_resistor_ohm at IREF and nothing else")
        if self.reference_ohm is None or not least <= self.reference_ohm <= most:
            raise ValueError(f"reference_resistor_ohm is {least:g} to {most:g}, got {self.reference_ohm}")
        if self.current_range is not None and not 0 <= self.current_range < len(self.chip.range_va):
            raise ValueError(f"current_range is 0 to {len(self.chip.range_va) - 1}, got {self.current_range}")

    @property
    def kind(self) -> Chip:
        return CHIPS[self.model]

    @property
    def chip(self) -> Sensing:
        return self.kind.sensing

    @property
    def ranged(self) -> bool:
        """Whether full scale is one of several ranges."""
        return bool(self.chip.range_va)

    @property
    def internal(self) -> bool:
        """Whether it measures inside although it need not."""
        return self.sense_ohm is None and not self.ranged

    def for_peak(self, peak_a: float) -> CurrentStage:
        """In the lowest range that gets to a wanted peak, else in the widest (FIELDS-TMC5240, CURRENT_RANGE)."""
        if not self.ranged or self.current_range is not None:
            return self
        stages = [replace(self, current_range=index) for index in range(len(self.chip.range_va))]
        widest = max(stages, key=lambda stage: stage.full_scale_a(SCALER_FULL))
        return next((stage for stage in stages if stage.full_scale_a(SCALER_FULL) >= peak_a), widest)

    @property
    def selects(self) -> range:
        """What can be selected: vsense 0 and 1; of a TMC5160 the scaler, of 256."""
        return range(SCALER_LEAST, SCALER_FULL + 1) if self.chip.scaled else range(2)

    def full_scale_a(self, select: int) -> float:
        """Peak at CS = 31 [A]. Raises ValueError for a vsense or scaler that the chip has not."""
        if select not in self.selects:
            what = "GLOBAL_SCALER is 0 (which is 256) or 32 to 255" if self.chip.scaled else "vsense is 0 or 1"
            raise ValueError(f"{what}, got {select}")
        if self.ranged:
            value = max(self.chip.range_va) if self.current_range is None else self.chip.range_va[self.current_range]
            return value / (self.reference_ohm or RANGE_OHM[0]) * select / SCALER_FULL
        if self.reference_ohm is not None:
            reference_a = REFERENCE_V / (self.reference_ohm + REFERENCE_OHM)
            return reference_a * REFERENCE_GAIN * (INTERNAL_SENSITIVE if select else 1.0)
        ohm = (self.sense_ohm or 0.0) + self.chip.added_ohm
        if self.chip.scaled:
            return self.chip.full_scale_v[0] / ohm * select / SCALER_FULL
        share = 1.0 if self.ain_v is None else min(self.ain_v / AIN_FULL_V, 1.0)
        return self.chip.full_scale_v[select] / ohm * share

    def setting(self, scale: int, select: int) -> Setting:
        """The current of a scale, 0..31. Raises ValueError outside."""
        if not 0 <= scale < SCALES:
            raise ValueError(f"a current scale is 0 to 31, got {scale}")
        return Setting(scale, select, self.full_scale_a(select) * (scale + 1) / SCALES)

    def settings(self, select: int | None = None) -> Iterator[Setting]:
        """Every setting that there is, or every one with that vsense or scaler."""
        for chosen in self.selects if select is None else (select,):
            full = self.full_scale_a(chosen)
            for scale in range(SCALES):
                yield Setting(scale, chosen, full * (scale + 1) / SCALES)

    def run_and_hold(self, run_a: float, hold_a: float) -> tuple[Setting, Setting]:
        """The best settings of at most `run_a`, else the least there is, and nearest to `hold_a` [A RMS]. Raises
        ValueError as `ranked`."""
        within = (s for s in self.ranked(run_a * math.sqrt(2)) if s.rms_a <= run_a * (1 + 1e-9))
        run = next(within, None) or min(self.settings(), key=lambda setting: setting.peak_a)
        return run, nearest_hold(self.settings(run.select), hold_a * math.sqrt(2))

    def ranked(self, peak_a: float, select: int | None = None) -> list[Setting]:
        """Settings for a wanted peak [A], best first; of a TMC5160 one for each scale, with its best scaler.

        A fine scale (16..31) comes before a coarse one wherever it gets within `REACH`; then the smaller error in
        whole percents, then the greater scale (DS-TMC5160 9: IRUN 31, and the rest by GLOBALSCALER), then the error.

        Raises ValueError for a current that is not above 0.
        """
        if not 0 < peak_a < math.inf:
            raise ValueError(f"a wanted current is above 0 A, got {peak_a:g}")
        every = list(self.settings(select))
        if self.chip.scaled:
            scales = [[s for s in every if s.scale == scale] for scale in range(SCALES)]
            every = [min(of_scale, key=lambda s: abs(error(s, peak_a))) for of_scale in scales]
        fine = any(s.scale >= FINE_SCALE and abs(error(s, peak_a)) <= REACH for s in every)

        def rank(s: Setting) -> tuple[bool, int, int, float]:
            off = abs(error(s, peak_a))
            coarse = fine and (s.scale < FINE_SCALE or off > REACH)
            return coarse, int(min(off / _SAME, FAR)), -s.scale, off

        return sorted(every, key=rank)

    def sense_power_w(self, peak_a: float) -> float | None:
        """What a sense resistor gets at most, the peak in its coil at rest [W]; None without one (DS-TMC5160 9)."""
        return None if self.sense_ohm is None else peak_a**2 * self.sense_ohm


def full_scale_rms_a(model: str, sense_ohm: float | None, told_a: float | None) -> float | None:
    """RMS of a coil at CS 31 with the most that vsense, scaler and range let through [A].

    `told_a` is that, and counts before a resistor. None where neither tells it: with ranges there is no resistor.
    """
    if told_a is not None or sense_ohm is None or CHIPS[model].sensing.range_va:
        return told_a
    stage = CurrentStage(model, sense_ohm)
    return stage.full_scale_a(SCALER_FULL if stage.chip.scaled else 0) / math.sqrt(2)


def select_share(model: str, select: int) -> float:
    """Share of that which a vsense leaves, or a scaler of 256."""
    sensing = CHIPS[model].sensing
    return select / SCALER_FULL if sensing.scaled else sensing.full_scale_v[select] / sensing.full_scale_v[0]


def range_share(model: str, index: int) -> float:
    """Share of that which CURRENT_RANGE `index` leaves; 1 of a chip without ranges."""
    ranges = CHIPS[model].sensing.range_va
    return ranges[index] / max(ranges) if ranges else 1.0


def error(setting: Setting, peak_a: float) -> float:
    """Relative: how much more than wanted."""
    return setting.peak_a / peak_a - 1


def nearest_hold(settings: Iterable[Setting], peak_a: float) -> Setting:
    """Of the settings with the run current's vsense or scaler, the one nearest to a wanted peak, which may be 0 [A]."""
    return min(settings, key=lambda s: abs(s.peak_a - peak_a))


def warnings(stage: CurrentStage, run: Setting, hold: Setting | None) -> list[str]:
    """What is to be said of settings."""
    found, chip = list[str](), stage.chip
    if run.rms_a > chip.rated_rms_a * (1 + REACH):
        found.append(
            f"{run.rms_a:.3g} A RMS is more than the {chip.rated_rms_a:g} A that the chip is made for ({chip.source})"
        )
    if run.scale < FINE_SCALE:
        found.append(f"IRUN {run.scale} is below 16: microsteps become coarser; {_finer(stage)} helps")
    least = stage.kind.sheet.least_irun
    if run.scale < least:
        found.append(f"IRUN {run.scale} is below {least}: StealthChop does not regulate the current by itself")
    if chip.scaled and run.select <= SCALER_GOOD:
        found.append(f"GLOBAL_SCALER {run.select} is not above {SCALER_GOOD}: {_finer(stage)} regulates better")
    if stage.internal and not 0.2 <= run.rms_a <= 1.2:
        found.append("measured inside, currents of 0.2 to 1.2 A RMS are regulated well (DS-TMC5130 11)")
    if stage.ain_v is not None and stage.ain_v < 0.5:
        found.append("AIN_IREF below 0.5 V: noise of the digital part shows in the current (DS-TMC5130 9)")
    if hold is not None and hold.peak_a > run.peak_a:
        found.append("the current at rest is above the one in motion")
    return found


def _finer(stage: CurrentStage) -> str:
    """What gives the same current with more of the scale."""
    return "a lower CURRENT_RANGE" if stage.ranged else "a greater sense resistor"
