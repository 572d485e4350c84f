"""A setting of SpreadCycle: which there are, which may be tried, and the registers that make it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

from ...devices.core.device import Device
from ...errors import WrongState
from ...profiles.capture import CapturedConfiguration
from ..field_settings import FieldSpace, Place
from ..record import Held
from ..search import Dimension

OFF, BLANK, HYSTERESIS = "TOFF", "TBL", "hysteresis"
UNITS = {OFF: "", BLANK: "", HYSTERESIS: ""}
OFF_LEAST, OFF_MOST = 2, 15
"""TOFF 0 switches the driver off, and 1 takes a long blank time (DS-TMC5160 8)."""
START_MOST, END_MOST = 8, 12
"""What the greatest numbers of HSTRT and HEND mean; each less is one less, whatever number that is."""
HYSTERESIS_LEAST, HYSTERESIS_MOST = -2, START_MOST + END_MOST - 4
BLANK_LEAST_S = 1e-6
"""What is shorter looks into the ringing after a switch (AN-SPREADCYCLE: 1 to 2 us are where to begin)."""
CHOPPER_MOST_HZ = 60e3
"""Beyond it driver and motor only get warmer."""


@dataclass(frozen=True, slots=True, order=True)
class ChopperSetting:
    """TOFF, TBL, and the effective hysteresis at its start, -2 to 16."""

    off: int
    blank: int
    hysteresis: int

    @property
    def told(self) -> dict[str, float]:
        """As a record has it."""
        return {OFF: float(self.off), BLANK: float(self.blank), HYSTERESIS: float(self.hysteresis)}

    @property
    def words(self) -> str:
        """For people."""
        return f"TOFF {self.off}, TBL {self.blank}, hysteresis {self.hysteresis}"


def nearest(wanted: ChopperSetting, to: Iterable[ChopperSetting]) -> ChopperSetting:
    """Of some settings that which is most like another. Raises ValueError where there are none."""

    def away(each: ChopperSetting) -> int:
        return (
            abs(each.off - wanted.off) + 2 * abs(each.blank - wanted.blank) + abs(each.hysteresis - wanted.hysteresis)
        )

    return min(to, key=away)


@dataclass(frozen=True, slots=True)
class Coil:
    """A motor's coil as it was told, SI units. current_a : RMS, at the current scale `run_scale`."""

    resistance_ohm: float
    inductance_h: float
    current_a: float
    supply_v: float
    clock_hz: float
    run_scale: int


class Calculator(Protocol):
    """What a family's data sheets say of its chopper at a coil."""

    def first(self, model: str, coil: Coil) -> ChopperSetting:
        """A setting to begin with."""
        ...

    def chopper_hz(self, coil: Coil, setting: ChopperSetting) -> float:
        """At rest and the current's peak, estimated; 0 where the supply cannot drive it [Hz]."""
        ...

    def blank_s(self, coil: Coil, blank: int) -> float:
        """How long the comparator is not looked at by this TBL [s]."""
        ...

    def ripples(self, coil: Coil, off: int, blank: int) -> tuple[float, float]:
        """Of the blank time and of the slow decay, as hysteresis that would just hold them."""
        ...

    def split(self, hysteresis: int) -> tuple[int, int]:
        """Start, 1 to 8, and end, -3 to 12, of an effective hysteresis."""
        ...


@dataclass(frozen=True, slots=True)
class ChopperPlaces:
    """Where a chip keeps its chopper.

    blanks : how many values TBL has
    fixed : what has to be so for SpreadCycle to turn the motor at every speed, as far as the chip has it
    """

    off: Place
    blank: Place
    start: Place
    end: Place
    blanks: int
    fixed: Mapping[Place, int]
    calculator: Calculator

    @property
    def own(self) -> tuple[Place, ...]:
        """What a setting is made of."""
        return self.off, self.blank, self.start, self.end


def setting_of(values: Mapping[str, float]) -> ChopperSetting:
    """The setting nearest to what was asked for."""
    return ChopperSetting(round(values[OFF]), round(values[BLANK]), round(values[HYSTERESIS]))


class ChopperSpace:
    """SpreadCycle of one axis."""

    def __init__(
        self, device: Device, axis: int, places: ChopperPlaces, held: CapturedConfiguration, coil: Coil
    ) -> None:
        """Raises WrongState for a chip without SpreadCycle, and for what could
        not be put back."""
        self._places, self._coil = places, coil
        self._fields = FieldSpace(device, axis, (*places.own, *places.fixed), held)
        if any(place not in self._fields for place in places.own):
            raise WrongState(f"a {device.family.title} has no SpreadCycle that a study sets", "")
        self._model = device.model
        self._start_by = START_MOST - self._fields.greatest(places.start)
        self._end_by = END_MOST - self._fields.greatest(places.end)
        self.before = self._fields.before

    @property
    def now(self) -> ChopperSetting:
        """As the axis had it before."""
        places, fields = self._places, self._fields
        start = max(fields[places.start] + self._start_by, 1)
        return ChopperSetting(fields[places.off], fields[places.blank], start + fields[places.end] + self._end_by)

    @property
    def unfit(self) -> list[str]:
        """What was set so before that SpreadCycle did not turn the motor at every speed, in words."""
        return [
            f"{place.register}{f'.{place.field}' if place.field else ''} was {self._fields[place]}, {value} is tried"
            for place, value in self._places.fixed.items()
            if place in self._fields and self._fields[place] != value
        ]

    @property
    def calculated(self) -> ChopperSetting:
        """To begin with: from the coil's figures, as the page Current and chopper has it."""
        return self._places.calculator.first(self._model, self._coil)

    def chopper_hz(self, setting: ChopperSetting) -> float:
        """At rest and the current's peak, estimated [Hz]."""
        return self._places.calculator.chopper_hz(self._coil, setting)

    def ripples(self, setting: ChopperSetting) -> tuple[float, float]:
        """Of its blank time and its slow decay, as hysteresis that would just hold them."""
        return self._places.calculator.ripples(self._coil, setting.off, setting.blank)

    def refused(self, setting: ChopperSetting, lowest_hz: float) -> str:
        """Why it may not be tried; empty where it may."""
        if not OFF_LEAST <= setting.off <= OFF_MOST or not HYSTERESIS_LEAST <= setting.hysteresis <= HYSTERESIS_MOST:
            return "outside of what a chopper works with"
        if self._places.calculator.blank_s(self._coil, setting.blank) < BLANK_LEAST_S * (1 - 1e-9):
            return "its blank time is below 1 us"
        found = self.chopper_hz(setting)
        if found < lowest_hz:
            return f"it would be heard: about {found / 1e3:.3g} kHz"
        return f"about {found / 1e3:.3g} kHz only heat" if found > CHOPPER_MOST_HZ else ""

    def allowed(self, lowest_hz: float) -> Sequence[ChopperSetting]:
        """All that may be tried."""
        every = (
            ChopperSetting(off, blank, hysteresis)
            for off in range(OFF_LEAST, OFF_MOST + 1)
            for blank in range(self._places.blanks)
            for hysteresis in range(HYSTERESIS_LEAST, HYSTERESIS_MOST + 1)
        )
        return [setting for setting in every if not self.refused(setting, lowest_hz)]

    def registers(self, setting: ChopperSetting) -> list[Held]:
        """What to write for it."""
        places = self._places
        # As much as can be in HSTRT, as the calculator has it; what was set before comes back as it was.
        start, end = places.calculator.split(setting.hysteresis)
        numbers = (setting.off, setting.blank, start - self._start_by, end - self._end_by)
        return self._fields.registers({**places.fixed, **dict(zip(places.own, numbers, strict=True))})

    def registers_now(self) -> list[Held]:
        """What to write for the chopper as it was before, where nothing but SpreadCycle turns the motor."""
        own = {place: self._fields[place] for place in self._places.own}
        return self._fields.registers({**own, **self._places.fixed})


def dimensions(allowed: Sequence[ChopperSetting]) -> tuple[Dimension, ...]:
    """The box around what may be tried, half a step wider: each end is as likely as what lies between."""
    columns = zip(*(tuple(each.told.values()) for each in allowed), strict=True)
    return tuple(
        Dimension(name, min(column) - 0.49, max(column) + 0.49, log=False)
        for name, column in zip(UNITS, columns, strict=True)
    )
