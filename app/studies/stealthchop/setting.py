"""A setting of StealthChop: its amplitudes, the speed up to which it works, and the registers that make it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

from ...devices.core.device import Device
from ...errors import WrongState
from ...number_text import counted
from ...profiles.capture import CapturedConfiguration
from ..field_settings import FieldSpace, Place
from ..record import Held

OFFSET, GRADIENT, SWITCH = "PWM_OFS", "PWM_GRAD", "switch-over"
SHORTEST_BLANK = 1
"""Of the blank times, 0 to 3: 1 and 2 are what sheets recommend; with less the ringing of the bridges may be seen."""
UNITS = {OFFSET: "", GRADIENT: "", SWITCH: "turns/s"}


@dataclass(frozen=True, slots=True)
class Motor:
    """A motor as it was told, SI units. current_a : RMS, at the current scale `run_scale`; holding_torque_nm : None
    where the back-EMF is not known."""

    resistance_ohm: float
    inductance_h: float
    current_a: float
    supply_v: float
    clock_hz: float
    run_scale: int
    holding_torque_nm: float | None
    rated_current_a: float | None
    full_steps_a_turn: int


@dataclass(frozen=True, slots=True)
class StealthSetting:
    """offset, gradient : None for a chip that has none. threshold : 0 is StealthChop at every speed. on : whether it
    works at all."""

    offset: int | None
    gradient: int | None
    frequency: int
    threshold: int
    on: bool = True


class Calculator(Protocol):
    """What a family's data sheets say of StealthChop at a motor."""

    def first(self, model: str, motor: Motor) -> tuple[int | None, int | None]:
        """Amplitude at rest at full current scale, and what velocity adds (None without a torque).

        Nulls for chips whose amplitude has no such parts.
        """
        ...

    def suiting(self, motor: Motor) -> Sequence[int]:
        """Settings of a PWM that is neither heard nor needlessly fast, the best one first."""
        ...

    def regulates(self, motor: Motor, blank: int, frequency: int) -> bool:
        """Whether a pulse of that current is long enough to be measured."""
        ...

    def threshold(self, rps: float, motor: Motor) -> int:
        """What the register of the switch-over speed holds for turns a second."""
        ...

    def of_velocity(self, rps: float, motor: Motor) -> float:
        """What a gradient of 1 adds to the amplitude at turns a second, of 255."""
        ...

    def rps(self, threshold: int, motor: Motor) -> float:
        """The inverse; `threshold` is above 0."""
        ...


@dataclass(frozen=True, slots=True)
class StealthPlaces:
    """Where a chip keeps its StealthChop.

    tunes : what lets it tune itself; begins : 0 there makes it begin with offset and gradient as they are set
    fixed : what has to be so for it to work up to the threshold, as far as the chip has it
    amplitude : the register that tells its amplitude; now, added, of it; offset_auto, gradient_auto : what it has tuned
    """

    on: Place
    offset: Place
    gradient: Place
    frequency: Place
    threshold: Place
    blank: Place
    tunes: tuple[Place, ...]
    fixed: Mapping[Place, int]
    amplitude: str
    now: str
    added: str
    offset_auto: str
    gradient_auto: str
    calculator: Calculator


class StealthSpace:
    """StealthChop of one axis."""

    def __init__(
        self, device: Device, axis: int, places: StealthPlaces, held: CapturedConfiguration, motor: Motor
    ) -> None:
        """Raises WrongState for a chip without StealthChop or a switch-over that is set, and for what could not be put
        back."""
        self.places, self.motor, self._model = places, motor, device.model
        needed = (places.on, places.frequency, places.threshold, places.blank, places.tunes[0])
        own = (*needed, places.offset, places.gradient, *places.tunes)
        self._fields = FieldSpace(device, axis, (*own, *places.fixed), held)
        if any(place not in self._fields for place in needed):
            raise WrongState(
                f"a {device.model.upper()} has no StealthChop with a switch-over to SpreadCycle that a study sets",
                "find its chopper instead",
            )
        self.before = self._fields.before
        self.amplitude_full = _full_of(device, axis, places)
        """The greatest amplitude, as the chip tells it."""
        self.tuned = places.offset in self._fields
        """Whether its amplitude has a part at rest and one of velocity, which it tunes."""

    @property
    def now(self) -> StealthSetting:
        """As the axis had it before."""
        places, fields = self.places, self._fields
        return StealthSetting(
            fields[places.offset] if self.tuned else None,
            fields[places.gradient] if self.tuned else None,
            fields[places.frequency],
            fields[places.threshold],
            bool(fields[places.on]),
        )

    @property
    def unfit(self) -> list[str]:
        """What was set otherwise than it is for this, in words."""
        wanted = {**self.places.fixed, **dict.fromkeys(self.places.tunes, 1)}
        return [
            f"{place.register}{f'.{place.field}' if place.field else ''} was {self._fields[place]}, {value} is tried"
            for place, value in wanted.items()
            if place in self._fields and self._fields[place] != value
        ]

    @property
    def calculated(self) -> tuple[int | None, int | None]:
        """Amplitude at rest and what velocity adds, by the motor's figures."""
        return self.places.calculator.first(self._model, self.motor) if self.tuned else (None, None)

    @property
    def frequency(self) -> int:
        """The one that is set, where it suits and lets the current be regulated; else the best that does."""
        now, suiting = self.now.frequency, self.places.calculator.suiting(self.motor)
        ordered = [*(each for each in (now,) if each in suiting), *suiting]
        return next((each for each in ordered if self.regulates(each)), ordered[0])

    def regulates(self, frequency: int) -> bool:
        """Whether the current is regulated at all with that PWM: shorter pulses than the blank time are not seen."""
        return self.places.calculator.regulates(self.motor, self._fields[self.places.blank], frequency)

    def for_tuning(self, frequency: int) -> tuple[int, int] | None:
        """Blank time and PWM frequency with which the chip can tune itself; None: it cannot.

        As they are, where it can so; else the longest shorter blank time that is usual, then a PWM that suits as well.
        What it tunes are voltages: they hold with any of both.
        """
        blank = self._fields[self.places.blank]
        others = [each for each in self.places.calculator.suiting(self.motor) if each != frequency]
        return next(
            (
                (shorter, pwm)
                for shorter in (blank, *range(blank - 1, SHORTEST_BLANK - 1, -1))
                for pwm in (frequency, *others)
                if self.places.calculator.regulates(self.motor, shorter, pwm)
            ),
            None,
        )

    def switch_rps(self, setting: StealthSetting) -> float | None:
        """Turns a second up to which StealthChop works; None at every speed."""
        return self.places.calculator.rps(setting.threshold, self.motor) if setting.threshold else None

    def threshold(self, rps: float) -> int:
        """Of a switch-over speed [turns a second]."""
        return self.places.calculator.threshold(rps, self.motor)

    def told(self, setting: StealthSetting) -> dict[str, float]:
        """As a record has it."""
        told: dict[str, float] = {}
        if setting.offset is not None and setting.gradient is not None:
            told = {OFFSET: float(setting.offset), GRADIENT: float(setting.gradient)}
        rps = self.switch_rps(setting)
        return told if rps is None else {**told, SWITCH: rps}

    def words(self, setting: StealthSetting) -> str:
        """For people."""
        if not setting.on:
            return "SpreadCycle at every speed"
        parts = [] if setting.offset is None else [f"PWM_OFS {setting.offset}, PWM_GRAD {setting.gradient}"]
        rps = self.switch_rps(setting)
        up_to = "at every speed" if rps is None else f"up to {counted(rps, 'turn', 3)} a second"
        parts.append(f"StealthChop {up_to}")
        return ", ".join(parts)

    def registers(self, setting: StealthSetting) -> list[Held]:
        """What to write for it."""
        return self._registers(setting, tunes=1)

    def fresh(self, setting: StealthSetting) -> list[Held]:
        """What to write before that, so that the chip forgets what it has tuned and begins with what is set."""
        return self._registers(setting, tunes=0)

    def tuning(self, setting: StealthSetting, *, begins: bool) -> list[Held]:
        """As `fresh` where it begins, else as `registers`, but with a blank time and a PWM that let it tune itself."""
        found = self.for_tuning(setting.frequency)
        assert found is not None
        blank, frequency = found
        return self._registers(replace(setting, frequency=frequency), tunes=int(not begins), blank=blank)

    def _registers(self, setting: StealthSetting, tunes: int, blank: int | None = None) -> list[Held]:
        places = self.places
        own = {places.on: int(setting.on), places.frequency: setting.frequency, places.threshold: setting.threshold}
        if setting.offset is not None and setting.gradient is not None:
            own |= {places.offset: setting.offset, places.gradient: setting.gradient}
        own[places.blank] = self._fields[places.blank] if blank is None else blank
        return self._fields.registers({**places.fixed, **own, **dict.fromkeys(places.tunes, tunes)})


def _full_of(device: Device, axis: int, places: StealthPlaces) -> int:
    found = device.family.table.find(places.amplitude, axis)
    if found is None:
        raise WrongState(f"a {device.model.upper()} does not tell the amplitude of its StealthChop", "")
    row = found[0]
    return (1 << (row.field_named(places.now) or row).width) - 1
