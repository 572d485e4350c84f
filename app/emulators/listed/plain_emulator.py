"""What a plain emulated chip and a plain emulated module have in common: axes that move, time and faults."""

from __future__ import annotations

import random
from abc import abstractmethod
from dataclasses import asdict, dataclass

from ...clock import Clock
from ...registers.entry import Model
from ..core.base import ChipFaults, EmulatorBase
from ..core.ground_truth import GroundTruth
from ..wire_documents import WireFaultsState
from .axis import Axis
from .options import ListedAxisState, ListedOptions, ListedPatch, ListedState

SPEED, ACCELERATION = 2000, 2000
"""After power-on [counts/s, counts/s^2]: no package tells any, and with 0 nothing would move."""
FULL_STEP = 256
"""Counts that are called a full step in the ground truth."""


@dataclass(slots=True)
class ListedFaults(ChipFaults):
    """On the wire; a serial line looks at them for every frame."""

    late_reply_s: float = 0.0
    half_frame_rate: float = 0.0


class PlainEmulatorBase(EmulatorBase[ListedPatch, ListedState]):
    """Axes that move by their own speed and acceleration, each worked out at once however long it was."""

    faults: ListedFaults

    def __init__(self, model: Model, clock: Clock, options: ListedOptions) -> None:
        super().__init__(clock, options.time_scale, ListedFaults())
        self._model = model
        self.options = options
        self._noise = random.Random(options.seed)
        self._axes: list[Axis] = []

    @property
    def model(self) -> str:
        """The name in the catalog."""
        return self._model.name

    @abstractmethod
    def _power_on(self) -> None:
        """Registers or parameters and axes as after power-on."""

    def _change(self, change: ListedPatch) -> None:
        if change.power_cycle:
            self._power_on()

    def _ground_truth(self, axis: int) -> GroundTruth:
        moving = self._axes[axis]  # the counter: there is no motor that could be elsewhere
        return GroundTruth(moving.position / FULL_STEP, speed_fullsteps_s=moving.speed / FULL_STEP)

    def _told(self, depth: str, address: int) -> ListedState:
        return ListedState(
            model=self.model,
            **self._times,
            depth=depth,
            address=address,
            plain_axes=[ListedAxisState(position=axis.position, velocity=axis.speed) for axis in self._axes],
            faults=WireFaultsState(**asdict(self.faults)),
        )

    def _run(self, until_s: float) -> None:
        if until_s > self._latest_s:
            for axis in self._axes:
                axis.run(until_s - self._latest_s)
            self._latest_s = until_s

    @property
    def _quiet(self) -> bool:
        return True
