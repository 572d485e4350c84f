"""The ramp of an axis as settings in physical units: which registers hold its speed and acceleration, and how to write
them."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Protocol, TypeAlias

from ..devices.core.device import Device
from ..errors import WrongState
from ..profiles.capture import CapturedConfiguration, axis_part, read_held
from ..profiles.document import ProfileDocument
from ..profiles.items import Key, key_of
from ..profiles.physical import UnitContext
from ..registers.model import Register
from .field_settings import FieldSpace, Place, units_of, word_before
from .record import Held
from .table_settings import with_registers

SPEED, ACCELERATION, JERK = "speed", "acceleration", "jerk"
KNEE, KNEE_ACCELERATION = "knee speed", "acceleration below the knee"
DECELERATION, KNEE_DECELERATION = "deceleration", "deceleration below the knee"
REST_JERK, TOP_JERK = "jerk near rest", "jerk near full speed"
UNITS = {
    SPEED: "pps",
    ACCELERATION: "pps^2",
    JERK: "pps^3",
    KNEE: "pps",
    KNEE_ACCELERATION: "pps^2",
    DECELERATION: "pps^2",
    KNEE_DECELERATION: "pps^2",
    REST_JERK: "pps^3",
    TOP_JERK: "pps^3",
}
LeastTime: TypeAlias = Callable[[UnitContext, int, float, Mapping[str, float]], float]
"""The time that a move takes by a ramp [s]: of the units of a device as it is set, the axis, the distance [microsteps]
and the ramp's settings. Raises ValueError for a ramp that gets nowhere."""


class Fitting(Protocol):
    """What has to fit the acceleration, where a chip brakes by more than that: a TMC428 by pmul and pdiv."""

    @property
    def places(self) -> Sequence[Place]:
        """The fields that it sets."""
        ...

    def allowed(self, units: UnitContext, axis: int) -> tuple[int, int]:
        """The least and the greatest acceleration that something fits, as its register has it."""
        ...

    def of(self, units: UnitContext, axis: int, acceleration: int) -> Mapping[Place, int]:
        """What fits that acceleration, as its register has it."""
        ...


@dataclass(frozen=True, slots=True)
class Share:
    """Between which shares of another setting a setting is looked for. like : the setting whose share it has, where it
    is not looked for by itself"""

    of: str
    low: float
    high: float
    like: str = ""


@dataclass(frozen=True, slots=True)
class RampRegisters:
    """Which registers of an axis make a ramp of one speed and one acceleration, and one jerk where it has S-ramps.

    settings : by what they are
    off : what is written with them so that nothing else has a part in it, where the chip has it
    only : a setting that counts only while a field has a value: (field, value)
    brake : registers of the acceleration that count only as it slows down
    fitting : what is set to fit the acceleration, where the chip has such
    shares : settings that are looked for as a share of another one
    time_s : how long a move by it takes; None: as a trapezoid of its speed and acceleration
    """

    settings: Mapping[str, tuple[str, ...]]
    off: Mapping[str, int] = field(default_factory=dict)
    only: Mapping[str, tuple[str, int]] = field(default_factory=dict)
    brake: tuple[str, ...] = ()
    fitting: Fitting | None = None
    shares: Mapping[str, Share] = field(default_factory=dict)
    time_s: LeastTime | None = None


@dataclass(frozen=True, slots=True)
class _Setting:
    rows: tuple[Register, ...]
    unit: float
    """What one more in the register is [pps, pps^2, pps^3]."""
    least: int
    most: int

    def raw(self, value: float) -> int:
        return min(max(round(value / self.unit), self.least), self.most)


class RampSpace:
    """Speed, acceleration and perhaps jerk of one axis, and the registers that hold them."""

    def __init__(self, device: Device, axis: int, names: RampRegisters, held: CapturedConfiguration) -> None:
        """`held` is what the device was set to before. Raises WrongState for a register whose contents nobody knows."""
        self._device, self._axis = device, axis
        self._brake, self._fitting, self._time_s = names.brake, names.fitting, names.time_s
        self.shares = names.shares
        context = self._units = units_of(device, held)
        self._settings = {
            name: self._setting(context, registers)
            for name, registers in names.settings.items()
            if name not in names.only or context.field(names.only[name][0], axis) == names.only[name][1]
        }
        off = [(row, value) for name, value in names.off.items() if (row := self._find(name)) is not None]
        self._off = [Held(name=row.name, axis=row.axis, value=value) for row, value in off]
        rows = [row for setting in self._settings.values() for row in setting.rows] + [row for row, _ in off]
        self.before: list[Held] = []
        for row in rows:
            self.before.append(Held(name=row.name, axis=row.axis, value=row.decode(word_before(device, row, held))))
        if self._fitting is not None:
            self._fields = FieldSpace(device, axis, self._fitting.places, held)
            self.before += self._fields.before
            setting = self._settings[ACCELERATION]
            least, most = self._fitting.allowed(context, axis)
            bound = replace(setting, least=max(setting.least, least), most=min(setting.most, most))
            self._settings[ACCELERATION] = bound

    def _find(self, name: str) -> Register | None:
        found = self._device.family.table.find(name, self._axis)
        return None if found is None or found[1] is not None else found[0]

    def _setting(self, context: UnitContext, names: Sequence[str]) -> _Setting:
        rows = tuple(row for name in names if (row := self._find(name)) is not None)
        unit = context.physical(rows[0], 1)
        if unit is None:
            raise WrongState(f"what {rows[0].name} counts in is not known", "")
        lows, highs = zip(*(self._device.configuration.range_of(row) for row in rows), strict=True)
        return _Setting(rows, unit.value, max(1, *lows), min(highs))

    def names(self, name: str) -> frozenset[str]:
        """The registers that hold a setting."""
        return frozenset(row.name for row in self._settings[name].rows)

    def most(self, name: str) -> float:
        """The greatest that its registers hold [pps, pps^2, pps^3]."""
        setting = self._settings[name]
        return setting.most * setting.unit

    def allowed(self, name: str) -> float:
        """The greatest that its registers hold and the axis's soft limits allow [pps, pps^2]."""
        limits = self._device.axes[self._axis].settings.limits
        bound = {SPEED: limits.velocity_max_pps, ACCELERATION: limits.acceleration_max_pps2}[name]
        return min(bound or math.inf, self.most(name))

    def now(self) -> dict[str, float]:
        """The settings as the axis had them before: of several registers the first."""
        held = {each.name: each.value for each in self.before}
        return {name: held[setting.rows[0].name] * setting.unit for name, setting in self._settings.items()}

    @property
    def off(self) -> list[str]:
        """Registers that are 0 with every setting, so that they have no part in the ramp."""
        return [each.name for each in self._off]

    def least_time_s(self, distance: float, values: Mapping[str, float]) -> float:
        """The least that a move by `distance` [microsteps] takes with these settings from rest to rest [s].

        Raises ValueError for a ramp that gets nowhere.
        """
        if self._time_s is None:
            return least_time_s(distance, values[SPEED], values[ACCELERATION])
        return self._time_s(self._units, self._axis, distance, values)

    def registers(self, values: Mapping[str, float]) -> list[Held]:
        """What to write for those of them that are given [pps, pps^2, pps^3], each at its nearest number."""
        wanted = list(self._off)
        for name, setting in self._settings.items():
            if name not in values:
                continue
            raw = setting.raw(values[name])
            wanted += [Held(name=row.name, axis=row.axis, value=raw) for row in setting.rows]
            if self._fitting is not None and name == ACCELERATION:
                wanted += self._fields.registers(self._fitting.of(self._units, self._axis, raw))
        return wanted

    def braking_hard(self, values: Mapping[str, float]) -> list[Held]:
        """The same, but that it slows down as fast as the chip can: for what is held by a stop anyway."""
        most = self._settings[ACCELERATION].most
        return [
            each.model_copy(update={"value": most}) if each.name in self._brake else each
            for each in self.registers(values)
        ]

    def rounded(self, values: Mapping[str, float]) -> dict[str, float]:
        """The setting that the chip makes of it."""
        return {name: setting.raw(values[name]) * setting.unit for name, setting in self._settings.items()}


def document_of(device: Device, registers: Sequence[Held], name: str) -> ProfileDocument:
    """A profile of these registers alone."""
    empty = ProfileDocument(
        name=name,
        model=device.model,
        clock_hz=device.clock_hz,
        axes=[axis_part(axis.settings) for axis in device.axes],
    )
    return with_registers(empty, registers)


async def held_of(device: Device) -> CapturedConfiguration:
    """What the device is set to now. Raises BenchError."""
    return await read_held(device)


def value_now(device: Device, held: CapturedConfiguration, register: Held) -> int | None:
    """What a register holds now; None where nobody knows."""
    found = device.family.table.find(register.name, register.axis)
    if found is None:
        return None
    key: Key = key_of(found[0])
    word = held.words.get(key)
    return None if word is None else found[0].decode(word)


def least_time_s(distance: float, speed: float, acceleration: float) -> float:
    """The least that a move by `distance` [microsteps] takes from rest to rest, at most at `speed` [pps] and
    `acceleration` [pps^2] either way [s]: a trapezoid, or a triangle where it does not get to that speed."""
    distance = abs(distance)
    if distance * acceleration <= speed**2:
        return 2 * math.sqrt(distance / acceleration)
    return distance / speed + speed / acceleration
