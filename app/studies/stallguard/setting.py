"""A setting of StallGuard as registers: threshold, filter, the speed from which on it counts, and what has to be so."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from ...devices.core.device import Device
from ...errors import WrongState
from ...profiles.capture import CapturedConfiguration
from ...profiles.items import key_of
from ...registers.model import Field, Register
from ..field_settings import Place, place_of, units_of, word_before
from ..record import Held
from ..speed_threshold import SpeedThreshold
from .scale import COUNTS_A_THRESHOLD, Generation, Scale

THRESHOLD, FILTER, ARMED = "threshold", "filter", "armed from"
UNITS = {THRESHOLD: "", FILTER: "0/1", ARMED: "pps"}


@dataclass(frozen=True, slots=True)
class StallPlaces:
    """Where a chip keeps what one generation of StallGuard works by.

    armed : registers of the speed from which on a stall stops: the first that the chip has; in clocks a step, or as a
        velocity
    stop : whether a stall stops the motor; None: the speed says it too, 0 for never
    fixed : what has to be so for the value to mean anything, as far as the chip has it
    """

    generation: Generation
    threshold: Place
    filter: Place
    armed: tuple[str, ...]
    fixed: Sequence[tuple[Place, int]]
    stop: Place | None = None


@dataclass(frozen=True, slots=True)
class StallSetting:
    """threshold; filtered: the mean of four full steps counts; armed_pps: the speed from which on a stall stops."""

    threshold: int
    filtered: bool
    armed_pps: float


class StallSpace:
    """What StallGuard works by on one axis."""

    def __init__(
        self, device: Device, axis: int, places: StallPlaces, held: CapturedConfiguration, full_step: int
    ) -> None:
        """`full_step` [microsteps]. Raises WrongState for a chip without it, and for what could not be put back."""
        self._device, self._axis, self._places, self._full_step = device, axis, places, full_step
        self._units = units_of(device, held)
        threshold = self._find(places.threshold)
        armed = next((row for name in places.armed if (row := self._row(name)) is not None), None)
        stop = None if places.stop is None else self._find(places.stop)
        if threshold is None or armed is None or (stop is None and places.stop is not None):
            raise WrongState(
                f"a {device.family.title} has no StallGuard{places.generation} that could stop its motor", ""
            )
        self._threshold, self._armed, self._stop = threshold, armed, stop
        self._filter = self._find(places.filter)
        self._fixed = [(found, value) for place, value in places.fixed if (found := self._find(place)) is not None]
        bits = threshold[1] or threshold[0]
        slope = COUNTS_A_THRESHOLD if places.generation == 2 else 0.0
        self.scale = Scale(places.generation, bits.minimum, bits.maximum, slope)
        parts = [
            threshold,
            *([stop] if stop else []),
            (armed, None),
            *([self._filter] if self._filter else []),
            *(at for at, _ in self._fixed),
        ]
        self.before: list[Held] = []
        self._rows = {key_of(row): row for row, _ in parts}
        for row in self._rows.values():
            self.before.append(Held(name=row.name, axis=row.axis, value=row.decode(word_before(device, row, held))))
        self._words = {key: held.words[key] or 0 for key in self._rows}

    def _row(self, name: str) -> Register | None:
        found = self._find(Place(name))
        return None if found is None else found[0]

    def _find(self, place: Place) -> tuple[Register, Field | None] | None:
        return place_of(self._device, self._axis, place)

    def now(self) -> StallSetting:
        """As the axis had it before; a threshold of speed of 0 clocks is one that is never passed."""
        armed = self._words[key_of(self._armed)]
        filtered = self._filter is not None and bool(self._of(self._filter))
        return StallSetting(self._of(self._threshold), filtered, self._from.speed_pps(armed))

    @property
    def misfits(self) -> int:
        """How much would have to be other than it was before for this StallGuard to measure."""
        return sum(self._of(at) != value for at, value in self._fixed)

    def unfit(self) -> list[str]:
        """What was set so before that the load value would mean nothing, in words."""
        return [
            f"{row.name}{f'.{field.name}' if field else ''} was {self._of((row, field))}, and has to be {value}"
            for (row, field), value in self._fixed
            if self._of((row, field)) != value
        ]

    def in_the_way(self) -> list[str]:
        """What kept a stall from being measured, or from stopping the motor, as it was set before, in words."""
        told = self.unfit()
        if not self._words[key_of(self._armed)]:
            told.append(f"{self._armed.name} was 0: it never stopped the motor")
        return told

    def _of(self, at: tuple[Register, Field | None]) -> int:
        row, field = at
        word = self._words[key_of(row)]
        return row.decode(word) if field is None else field.unpack(word)

    @property
    def _from(self) -> SpeedThreshold:
        return SpeedThreshold(self._armed, self._units, self._full_step)

    def registers(self, setting: StallSetting, *, stops: bool | None) -> list[Held]:
        """What to write. stops : whether a stall stops the motor; None: as before, where that is told apart."""
        words = dict(self._words)

        def put(at: tuple[Register, Field | None], value: int) -> None:
            row, field = at
            key = key_of(row)
            words[key] = row.encode(value) if field is None else field.pack(value, words[key])

        for at, value in self._fixed:
            put(at, value)
        put(self._threshold, setting.threshold)
        if self._filter is not None:
            put(self._filter, int(setting.filtered))
        put((self._armed, None), self._from.word(setting.armed_pps))
        if self._stop is not None and stops is not None:
            put(self._stop, int(stops))
        elif self._stop is None and stops is False:
            put((self._armed, None), 0)
        return [Held(name=row.name, axis=row.axis, value=row.decode(words[key])) for key, row in self._rows.items()]

    def told(self, setting: StallSetting) -> dict[str, float]:
        """The setting as figures, as the chip holds it; without the speed of one that is never passed."""
        told = {THRESHOLD: float(setting.threshold), FILTER: float(setting.filtered)}
        if math.isfinite(setting.armed_pps):
            told[ARMED] = self._from.speed_pps(self._from.word(setting.armed_pps))
        return told
