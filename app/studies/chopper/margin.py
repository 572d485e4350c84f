"""Margin: the hysteresis of a setting beyond what the ripple of its blank time and its slow decay takes.

How much a shaft shakes changes with the margin above all: it is least about where the hysteresis just holds both
ripples. Both are known as well as the coil's figures are. So those shares of them are taken that make the smoothest
curve of what was measured over the margin; and by that curve is told what to try next.
"""

from __future__ import annotations

import itertools
import random
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from ...telemetry.sampling import FloatArray
from .setting import ChopperSetting

SHARES = np.geomspace(0.5, 1.7, 13)
"""So much there may be of a calculated ripple: a data sheet's L is off by 20 %, the rest is the estimate."""
CURVES = 10
"""So many of the smoothest curves have a say."""
REACH = 4.0
"""Settings to begin with have margins of this to either side of the calculated one."""
ALIKE_MARGINS = 12
"""So many settings of nearly the same margin there are to draw from."""
GAP_MOST = 0.25
"""A margin further than this from those that were tried is as good as any other."""


class Margins:
    """The settings that may be tried, by the ripples of each."""

    def __init__(
        self, allowed: Sequence[ChopperSetting], ripples: Callable[[ChopperSetting], tuple[float, float]]
    ) -> None:
        """`ripples` : of a setting's blank time and of its slow decay, as hysteresis."""
        self._allowed = list(allowed)
        self._places = {each: index for index, each in enumerate(self._allowed)}
        hysteresis = np.array([each.hysteresis for each in self._allowed], float)
        blank, decay = np.array([ripples(each) for each in self._allowed]).T
        self._calculated: FloatArray = hysteresis - blank - decay
        self._margins: list[FloatArray] = [
            hysteresis - first * blank - second * decay for first, second in itertools.product(SHARES, SHARES)
        ]
        """Of every setting, by each pair of shares."""

    def spread(self, count: int, seed: int) -> list[ChopperSetting]:
        """So many settings with evenly spread margins, by the calculated ripples."""
        chance, found = random.Random(seed), dict[ChopperSetting, None]()
        for wanted in np.linspace(-REACH, REACH, 2 * count + 1)[1::2]:
            order = (self._allowed[index] for index in np.argsort(np.abs(self._calculated - wanted), kind="stable"))
            alike = [each for each in itertools.islice(order, ALIKE_MARGINS) if each not in found]
            if alike:
                found[chance.choice(alike)] = None
        return list(found)

    def calmest(self, tried: Mapping[ChopperSetting, float]) -> ChopperSetting:
        """Of the untried settings that which shakes the shaft least, by the smoothest curves through the tried ones.

        tried : at least two, and how much the shaft shakes by each
        """
        untried, curves = self._curves(tried)
        told = sum(np.interp(wanted, known, height) for known, height, wanted in curves)
        return self._allowed[untried[int(np.argmin(told))]]

    def steepest(self, tried: Mapping[ChopperSetting, float]) -> ChopperSetting:
        """Of the untried settings that which lies in the middle of the curve's steepest step."""
        untried, curves = self._curves(tried)
        told = np.zeros(len(untried))
        for known, height, wanted in curves:
            right = np.clip(np.searchsorted(known, wanted), 1, len(known) - 1)
            gap = np.minimum(np.abs(wanted - known[right - 1]), np.abs(known[right] - wanted))
            between = (wanted > known[0]) & (wanted < known[-1])
            told += between * np.abs(height[right] - height[right - 1]) * np.minimum(gap, GAP_MOST)
        return self._allowed[untried[int(np.argmax(told))]]

    def _curves(
        self, tried: Mapping[ChopperSetting, float]
    ) -> tuple[list[int], list[tuple[FloatArray, FloatArray, FloatArray]]]:
        """The untried settings, and by each of the smoothest curves: rising margins of the tried ones, how much the
        shaft shakes there, and the margins of the untried ones."""
        at = [self._places[each] for each in tried]
        ripple, untried = np.log(list(tried.values())), sorted(set(range(len(self._allowed))) - set(at))
        curves = []
        for margins in self._smoothest(ripple, at):
            order = np.argsort(margins[at], kind="stable")
            curves.append((margins[at][order], ripple[order], margins[untried]))
        return untried, curves

    def _smoothest(self, ripple: FloatArray, at: Sequence[int]) -> list[FloatArray]:
        def rough(margins: FloatArray) -> float:
            return float(np.sum(np.diff(ripple[np.argsort(margins[at], kind="stable")]) ** 2))

        return sorted(self._margins, key=rough)[:CURVES]
