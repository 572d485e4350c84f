"""The motor current of an axis as a setting: which register holds its scales, and how to write them."""

from __future__ import annotations

from dataclasses import dataclass

from ..devices.core.device import Device
from ..errors import WrongState
from ..profiles.capture import CapturedConfiguration
from .field_settings import word_before
from .record import Held


@dataclass(frozen=True, slots=True)
class CurrentPlaces:
    """The register of both scales and its fields; the current is (scale + 1) of `steps` parts."""

    register: str
    run: str
    hold: str
    steps: int


class CurrentSpace:
    """Run and hold current of one axis."""

    def __init__(self, device: Device, axis: int, places: CurrentPlaces, held: CapturedConfiguration) -> None:
        """`held` is what the device was set to before. Raises WrongState where that could not be put back."""
        found = device.family.table.find(places.register, axis)
        run = None if found is None else found[0].field_named(places.run)
        hold = None if found is None else found[0].field_named(places.hold)
        if found is None or run is None or hold is None:
            raise WrongState(f"a {device.family.title} has no current scales that a study sets", "")
        self._row, self._run, self._hold, self.steps = found[0], run, hold, places.steps
        word = self._word = word_before(device, self._row, held)
        self.before = [Held(name=self._row.name, axis=self._row.axis, value=self._row.decode(word))]
        self.run_scale = run.unpack(word)
        """As it was before."""
        self.hold_scale = hold.unpack(word)

    def share(self, scale: int) -> float:
        """The current at a scale, of that at the run scale."""
        return (scale + 1) / (self.run_scale + 1)

    def registers(self, scale: int, hold: int | None = None) -> list[Held]:
        """What to write for this scale; `hold`: the one at rest, None for the same."""
        word = self._hold.pack(scale if hold is None else hold, self._run.pack(scale, self._word))
        return [Held(name=self._row.name, axis=self._row.axis, value=self._row.decode(word))]
