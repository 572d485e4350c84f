"""What only shows over time: steps that got lost, and the stretch of a stage with its switches."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from .shape import Shape, Slips, Travel

FloatArray = NDArray[np.float64]

SLACK = 0.6
"""How far beyond the middle between two places of rest a rotor has to be before it counts as in the next one,
electrical turns: a rotor that swings about the middle has not slipped yet."""


class SlipWatch:
    """Counts electrical turns that the rotor loses against its field.

    A stepper that is pulled over by more than half an electrical turn comes to rest a whole turn off, which is four
    full steps: `deviation`, encoder less position, is then near a multiple of four full steps.
    """

    def __init__(self) -> None:
        self._turn: int | None = None
        self._slips = Slips()

    @property
    def slips(self) -> Slips:
        return self._slips

    def restart(self) -> None:
        """The counter was set anew: what comes next is no slip. What was lost so far stays told."""
        self._turn = None

    def feed(self, time_s: FloatArray, deviation: FloatArray, microsteps: int | None) -> list[Slips]:
        """What is told after each slip in these samples, in order; mostly nothing.

        `deviation` [microsteps] at device time `time_s` [s], NaN where missing.
        """
        seen: list[Slips] = []
        turns = deviation / (4.0 * (microsteps or 1))
        known = np.isfinite(turns)
        if microsteps is None or not known.any():
            return seen
        turns = turns[known]
        if self._turn is None:
            self._turn = round(float(turns[0]))
        if np.abs(turns - self._turn).max() <= SLACK:
            return seen
        for at_s, turn in zip(time_s[known].tolist(), turns.tolist(), strict=True):
            while abs(turn - self._turn) > SLACK:
                step = 1 if turn > self._turn else -1
                self._turn += step
                self._slips = Slips(self._slips.lost_full_steps - 4 * step, self._slips.events + 1, at_s)
                seen.append(self._slips)
        return seen


class TravelWatch:
    """The stretch of a stage that was travelled, and where its switches closed: nobody tells it of a real one."""

    def __init__(self) -> None:
        self.restart()

    def restart(self) -> None:
        """The counter was set anew: places in it mean something else now."""
        self._low, self._high = math.inf, -math.inf
        self._switch: dict[str, float | None] = {"left": None, "right": None, "home": None}
        self._before: dict[str, tuple[float, float]] = {}

    def feed(self, place_mm: FloatArray, switches: Mapping[str, FloatArray]) -> None:
        """Samples in order: places [mm] and the switches `left`, `right`, `home` (0, 1 or NaN) of those moments."""
        known = np.isfinite(place_mm)
        if not known.any():
            return
        places = place_mm[known]
        self._low, self._high = min(self._low, float(places.min())), max(self._high, float(places.max()))
        for name, column in switches.items():
            levels = column[known]
            before = self._before.get(name, (math.nan, math.nan))
            edges = np.flatnonzero(np.abs(np.diff(levels, prepend=before[1])) > 0.5)
            if len(edges):
                # The edge lies between two samples; in the middle it is wrong by half of that at most.
                last = int(edges[-1])
                self._switch[name] = (float(places[last]) + (float(places[last - 1]) if last else before[0])) / 2
            self._before[name] = (float(places[-1]), float(levels[-1]))

    def travel(self, shape: Shape) -> Travel | None:
        """What to draw, widened to whole stretches so that it stands still; None for what is no stage."""
        if shape.travel_mm_per_rev is None:
            return None
        known = [place for place in (*self._switch.values(), *map(shape.place, shape.limits)) if place is not None]
        low, high = min([self._low, *known], default=math.inf), max([self._high, *known], default=-math.inf)
        grid = 5.0 * shape.travel_mm_per_rev
        if low > high:
            low, high = 0.0, 0.0
        return Travel(
            from_mm=(math.floor(low / grid - 0.1)) * grid,
            to_mm=(math.ceil(high / grid + 0.1)) * grid,
            left_mm=self._switch["left"],
            right_mm=self._switch["right"],
            home_mm=self._switch["home"],
        )


class Watches:
    """Both, of one axis."""

    def __init__(self) -> None:
        self._slips = SlipWatch()
        self._travel = TravelWatch()

    def restart(self) -> None:
        """The position counter was set anew."""
        self._slips.restart()
        self._travel.restart()

    def feed(self, shape: Shape, time_s: FloatArray, columns: Mapping[str, FloatArray]) -> list[Slips]:
        """Samples in order, by quantity; returns the slips in them."""
        nothing = np.full(len(time_s), np.nan)
        if shape.linear:
            scale = shape.place(1.0)
            place = columns.get("encoder_position", columns.get("position", nothing))
            home = columns.get("switch_home", columns.get("switch_reference", nothing))
            switches = {name: columns.get(f"switch_{name}", nothing) for name in ("left", "right")}
            self._travel.feed(place * (math.nan if scale is None else scale), {**switches, "home": home})
        return self._slips.feed(time_s, columns.get("deviation", nothing), shape.microsteps)

    @property
    def slips(self) -> Slips:
        return self._slips.slips

    def travel(self, shape: Shape) -> Travel | None:
        return self._travel.travel(shape)
