"""Resistance, inductance and back-EMF by StealthChop's automatic tuning: its amplitude for a known current."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from ...calc.motors.pwm_amplitude import PwmScale, Turning, coil_constants, resistance_of
from ...calc.motors.ring_down import Fitted
from ...clock import Clock
from ...devices.core.device import Device
from ...procedures.procedure import Failed
from ..driver_faults import state_now
from ..field_settings import Place
from .found import Identified

STANDS_S, LOOK_S = 0.4, 0.06
"""At rest: before the amplitude is tuned, and between two looks at it [s]."""
TUNES_WITHIN_S = 4.0
SAME = 4
"""So many looks alike, and it is tuned."""
SPEEDS_RPS = (1.0, 1.5, 2.2, 3.3)
ENOUGH, ENOUGH_AT_LAST, MOST = 2.2, 1.5, 240.0
"""An amplitude at speed tells the back-EMF well from so many times that at rest on, at the last speed less has to do;
near its end there is no regulation."""
SPEED_UP_S = 0.15
POLL_S = 0.01
LESS_MOST, LESS_SURE = 0.8, 1.1
"""The smaller current: at most so much of the run current, and so many times what is just regulated."""
MIDDLE = 0.25
"""Of the way: what counts is nearer than that to its middle, where the speed is constant."""


@dataclass(frozen=True, slots=True)
class AmplitudePlaces:
    """Where a chip tells the amplitude of its PWM.

    before, tuned : what switches its regulation off with the fields that it begins with, and on
    at_rest, now : names of what is read
    full_scale_v : peak voltage of an amplitude of 1, over the supply
    least_duty : of the shortest pulse whose current is measured
    """

    before: Mapping[Place, int]
    tuned: Mapping[Place, int]
    at_rest: str
    now: str
    full_scale_v: float
    least_duty: float

    @property
    def least_counts(self) -> float:
        """Amplitude at rest of the least current that is regulated."""
        return self.least_duty / self.full_scale_v

    @property
    def every(self) -> tuple[Place, ...]:
        """All that is set."""
        return tuple({**self.before, **self.tuned})


@dataclass(frozen=True, slots=True)
class AtSpeed:
    """PWM amplitudes of a motor that turns [counts]. less : the smaller current over the run current"""

    rps: float
    counts: float
    less: float
    less_counts: float


@dataclass(frozen=True, slots=True)
class CoilTold:
    """What was told of the motor and its supply. current_a : RMS [A]"""

    current_a: float
    supply_v: float


@dataclass(frozen=True, slots=True)
class CoilFound:
    """None where it could not be told, `why` then."""

    resistance: Fitted | None = None
    inductance: Fitted | None = None
    back_emf: Fitted | None = None
    why: list[str] = field(default_factory=list)


def load_sine_of(told: Identified, rps: float, teeth: float) -> Fitted:
    """Sine of the load angle at a speed, from friction and damping; a guess that is as wide as it is large without."""
    if told.friction_share is None or told.damping_ratio is None or told.resonance_hz is None:
        return Fitted(0.1, 0.1)
    viscous = 2 * told.damping_ratio.value * teeth * rps / told.resonance_hz.value
    sine = max(told.friction_share.value, 0.0) + viscous
    return Fitted(sine, 0.3 * sine + 0.02)


def coil_of(
    at_rest: float, at_speed: AtSpeed | str, told: CoilTold, places: AmplitudePlaces, teeth: float, load_sine: Fitted
) -> CoilFound:
    """What amplitudes say of the coil. at_rest : of the run current [counts]; at_speed : or why there is nothing;
    load_sine : of the load angle at that speed."""
    scale = PwmScale(told.supply_v * places.full_scale_v, told.current_a * math.sqrt(2))
    try:
        resistance = resistance_of(at_rest, scale)
    except ValueError as error:
        return CoilFound(why=[f"resistance: {error}"])
    if isinstance(at_speed, str):
        return CoilFound(resistance, why=[f"inductance, back-EMF: {at_speed}"])
    omega = at_speed.rps * 2 * math.pi
    turning = Turning(at_speed.counts, at_speed.less_counts, at_speed.less, omega, teeth, load_sine)
    try:
        both = coil_constants(turning, resistance, scale)
    except ValueError as error:
        return CoilFound(resistance, why=[f"inductance, back-EMF: {error}"])
    return CoilFound(resistance, both.inductance_h, both.back_emf)


class AmplitudeRuns:
    """Lets StealthChop tune itself at rest, then turns, and looks at its amplitude."""

    def __init__(self, device: Device, axis: int, clock: Clock, places: AmplitudePlaces) -> None:
        self._device, self._axis, self._clock, self._places = device, axis, clock, places

    async def _read(self, name: str) -> int:
        return (await self._device.registers.read(name, self._axis)).value

    async def at_rest(self, scale: int, steps: int) -> float:
        """The amplitude of the run current of that scale [counts], from the one that is tuned for all `steps` of it.

        Raises Failed where the tuning does not come to an end, BenchError.
        """
        await self._clock.sleep(STANDS_S)
        last, same, until_s = -1, 0, self._clock.now() + TUNES_WITHIN_S
        while same < SAME:
            if self._clock.now() > until_s:
                raise Failed(f"StealthChop has not tuned itself at rest within {TUNES_WITHIN_S:g} s")
            found = await self._read(self._places.at_rest)
            last, same = found, same + 1 if found == last else 0
            await self._clock.sleep(LOOK_S)
        return last * (scale + 1) / steps

    async def there_and_back(self, start: int, way: int, longest_s: float) -> float | None:
        """Mean amplitude in the middle of a way there and back [counts]; None where nothing was seen there.

        Raises Failed where the motor does not arrive, BenchError.
        """
        seen = []
        for target in (start + way, start):
            await self._device.motion.move(self._axis, target)
            until_s = self._clock.now() + longest_s
            while True:
                await self._clock.sleep(POLL_S)
                state = await state_now(self._device, self._axis, self._clock)
                counts = await self._read(self._places.now)
                if abs(state.position - start - way / 2) < MIDDLE * abs(way):
                    seen.append(counts)
                if state.position == target and not state.moving:
                    break
                if self._clock.now() > until_s:
                    raise Failed(f"the motor has not arrived at {target} after {longest_s:.3g} s")
        return sum(seen) / len(seen) if seen else None
