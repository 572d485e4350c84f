"""The position loop of an axis as a setting: the registers of its gains, in physical units."""

from __future__ import annotations

from dataclasses import dataclass

from ...calc.motors.position_loop import Gains
from ...devices.core.device import Device
from ...errors import WrongState
from ...profiles.capture import CapturedConfiguration
from ...profiles.items import items_by_key, key_of
from ...registers.model import Register
from ..record import Held, Switched

PROPORTIONAL, INTEGRAL = "proportional", "integral"
UNITS = {PROPORTIONAL: "1/s", INTEGRAL: "1/s^2"}
P_PARTS, SUM_PARTS = 256, 65_536
"""A deviation counts P / 256 pps; the sum of all of them I / 65536."""


@dataclass(frozen=True, slots=True)
class LoopPlaces:
    """Registers of the gains, of what bounds the sum (a field) and the velocity, of a deviation that counts as none, of
    the ramp's shape, and the field that switches it on."""

    proportional: str
    integral: str
    derivative: str
    clip: str
    sum_clip: str
    most: str
    tolerance: str
    shape: str
    mode: str
    modus: str
    off: int
    alone: int
    cycle_clocks: int


async def regulation_now(device: Device, axis: int, places: LoopPlaces) -> int:
    """Which regulation is on: what no profile holds. Raises BenchError."""
    return (await device.registers.read(places.mode, axis)).fields[places.modus]


class LoopSpace:
    """The position loop of one axis."""

    def __init__(self, device: Device, axis: int, places: LoopPlaces, held: CapturedConfiguration, mode: int) -> None:
        """`held` is what the device was set to before, `mode` which regulation is on. Raises WrongState where what it
        held could not be put back."""
        self._device, self._axis, self._places = device, axis, places
        self._rate_hz = device.clock_hz / places.cycle_clocks
        gains = (places.proportional, places.integral, places.derivative, places.clip, places.most, places.tolerance)
        names = (*gains, places.shape)
        self._rows: dict[str, Register] = {}
        self._words: dict[str, int] = {}
        for name in names:
            found = device.family.table.find(name, axis)
            word = None if found is None else held.words.get(key_of(found[0]))
            if found is None or word is None or key_of(found[0]) not in items_by_key(device.model):
                raise WrongState(f"what {name} holds is not known, so it could not be put back", "write it once")
            self._rows[name], self._words[name] = found[0], word
        self.before = [self._held(name, self._words[name]) for name in gains]
        self.shape = self._held(places.shape, self._words[places.shape])
        clip = self._rows[places.clip].field_named(places.sum_clip)
        assert clip is not None
        self._clip = clip
        self.mode, self.alone, self.open = mode, places.alone, places.off
        """Which regulation was on; the position loop, and none."""

    @property
    def on(self) -> bool:
        """Whether the loop was on."""
        return self.mode == self.alone

    @property
    def off(self) -> bool:
        """Whether nothing regulated."""
        return self.mode == self.open

    @property
    def now(self) -> Gains:
        """Gains as they were set before."""
        p, i = (self._words[name] for name in (self._places.proportional, self._places.integral))
        return Gains(p / P_PARTS, i / SUM_PARTS * self._rate_hz)

    @property
    def switched(self) -> Switched:
        """Which regulation was on, for who puts it back."""
        places = self._places
        return Switched(name=places.mode, field=places.modus, axis=self._axis, before=self.mode, off=places.off)

    async def switch(self, mode: int) -> None:
        """Switch regulation on or off, which no profile does. Raises BenchError."""
        await self._device.registers.write(self._places.mode, self._axis, None, {self._places.modus: mode})

    def registers(self, gains: Gains, most_pps: float, tolerance: int) -> list[Held]:
        """What to write for these gains without a derivative, a regulation of `most_pps` at most, and no deviation
        within `tolerance` [microsteps]."""
        places = self._places
        words = {
            places.proportional: round(gains.proportional * P_PARTS),
            places.integral: round(gains.integral * SUM_PARTS / self._rate_hz),
            places.derivative: 0,
            places.clip: self._clip.pack(self._clip.maximum, self._words[places.clip]),
            places.most: round(most_pps),
            places.tolerance: tolerance,
        }
        for name, word in words.items():
            row = self._rows[name]
            if not row.minimum <= row.decode(word) <= row.maximum:
                raise WrongState(f"{name} would be {word}, and holds {row.maximum} at most", "ask for larger margins")
        return [self._held(name, word) for name, word in words.items()]

    def rounded(self, gains: Gains) -> Gains:
        """The gains that the chip makes of it."""
        return Gains(
            round(gains.proportional * P_PARTS) / P_PARTS,
            round(gains.integral * SUM_PARTS / self._rate_hz) / SUM_PARTS * self._rate_hz,
        )

    def _held(self, name: str, word: int) -> Held:
        row = self._rows[name]
        return Held(name=row.name, axis=row.axis, value=row.decode(word))
