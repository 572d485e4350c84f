"""The motor current of an axis as a setting: where its scales are, and how to write them."""

from __future__ import annotations

from dataclasses import dataclass

from ..devices.core.device import Device
from ..errors import WrongState
from ..profiles.capture import CapturedConfiguration
from .field_settings import FieldSpace, Place
from .record import Held


@dataclass(frozen=True, slots=True)
class CurrentPlaces:
    """Where both scales are; the current is (scale + 1) of `steps` parts. per : numbers of the register a scale"""

    run: Place
    hold: Place
    steps: int
    per: int = 1

    def word(self, scale: int) -> int:
        """The greatest number that means this scale."""
        return (scale + 1) * self.per - 1


class CurrentSpace:
    """Run and hold current of one axis."""

    def __init__(self, device: Device, axis: int, places: CurrentPlaces, held: CapturedConfiguration) -> None:
        """`held` is what the device was set to before. Raises WrongState where that could not be put back."""
        self._space, self._places = FieldSpace(device, axis, (places.run, places.hold), held), places
        if places.run not in self._space or places.hold not in self._space:
            raise WrongState(f"a {device.family.title} has no current scales that a study sets", "")
        self.before, self.steps = self._space.before, places.steps
        self.run_scale, self.hold_scale = (self._space[each] // places.per for each in (places.run, places.hold))
        """As they were before."""

    def share(self, scale: int) -> float:
        """The current at a scale, of that at the run scale."""
        return (scale + 1) / (self.run_scale + 1)

    def registers(self, scale: int, hold: int | None = None) -> list[Held]:
        """What to write for this scale; `hold`: the one at rest, None for the same."""
        places = self._places
        at_rest = places.word(scale if hold is None else hold)
        return self._space.registers({places.run: places.word(scale), places.hold: at_rest})
