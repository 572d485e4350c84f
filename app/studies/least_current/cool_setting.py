"""CoolStep as registers: its thresholds and steps, the speed from which on it works, and what keeps it from working."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from ...devices.core.device import Device
from ...errors import WrongState
from ...profiles.capture import CapturedConfiguration
from ..field_settings import FieldSpace, Place, place_of, units_of
from ..record import Held
from ..speed_threshold import SpeedThreshold
from .found import CoolSetting


@dataclass(frozen=True, slots=True)
class CoolPlaces:
    """Where a family keeps CoolStep.

    lower, width, up, down, least : SEMIN, SEMAX, SEUP, SEDN, SEIMIN
    level : of StallGuard2, which shifts the load value; armed : registers of the speed from which on it works, the
        first that the chip has
    stop : whether a stall stops the motor; quiet : whether StealthChop is on
    measures_quiet : what a chip has whose StallGuard measures with StealthChop too; None: no chip of the family
    """

    lower: Place
    width: Place
    up: Place
    down: Place
    least: Place
    level: Place
    armed: tuple[Place, ...]
    stop: Place
    quiet: Place
    measures_quiet: Place | None = None


class CoolSpace:
    """CoolStep of one axis: what it was before, and what to write."""

    def __init__(
        self, device: Device, axis: int, places: CoolPlaces, held: CapturedConfiguration, full_step: int
    ) -> None:
        """`held` is what the device was set to before; `full_step` [microsteps]. Raises WrongState for a chip without
        it, and for what could not be put back."""
        armed = next(((place, at) for place in places.armed if (at := place_of(device, axis, place))), None)
        if armed is None or place_of(device, axis, places.lower) is None:
            raise WrongState(f"a {device.family.title} has no CoolStep that a study sets", "")
        self._places, self._armed = places, armed[0]
        mine = (places.lower, places.width, places.up, places.down, places.least, places.level, armed[0])
        self._space = FieldSpace(device, axis, mine, held)
        beside = FieldSpace(device, axis, (places.stop, places.quiet), held)
        blind = places.measures_quiet is None or place_of(device, axis, places.measures_quiet) is None
        self.before = self._space.before
        self.stops = places.stop in beside and bool(beside[places.stop])
        """Whether a stall stops the motor: then level and speed are not CoolStep's own."""
        self._stealth = places.quiet in beside and bool(beside[places.quiet]) and blind
        self._from = SpeedThreshold(armed[1][0], units_of(device, held), full_step)
        self.from_pps = self._from.speed_pps(self._space[armed[0]])
        """From where on it worked before."""
        self.level = self._space[places.level]

    @property
    def now(self) -> CoolSetting:
        """As the axis had it before."""
        places = self._places
        fields = places.lower, places.width, places.up, places.down, places.least
        return CoolSetting.model_validate(
            dict(zip(CoolSetting.model_fields, (self._space[each] for each in fields), strict=True))
        )

    def why_not(self, peak_pps: float) -> str:
        """What keeps CoolStep from working in a cycle of that speed, as the axis is set; empty where nothing does."""
        if self._stealth:
            return "StealthChop is on, and this chip's load value, which CoolStep goes by, comes with SpreadCycle alone"
        if self.stops and self.from_pps > peak_pps:
            return "a stall stops the motor from a speed on that the cycle does not get to, and CoolStep has the same"
        return ""

    def registers(self, setting: CoolSetting, from_pps: float, level: int) -> list[Held]:
        """What to write. from_pps : the speed from which on it works; level : of StallGuard2"""
        places = self._places
        values: Mapping[Place, int] = {
            places.lower: setting.semin,
            places.width: setting.semax,
            places.up: setting.seup,
            places.down: setting.sedn,
            places.least: setting.seimin,
            places.level: level,
            self._armed: self._from.word(from_pps),
        }
        return self._space.registers(values)
