"""An emulated TMC5xxx behind a wire: seconds, bytes and faults around a chip."""

from __future__ import annotations

from dataclasses import asdict

from ...clock import Clock
from ..core.chip40 import UartEmulatorBase40
from ..core.ground_truth import GroundTruth
from ..drive.documents import ChipFaultsState, ground_truth
from . import plant
from .chips import CHIPS
from .options import Tmc5xxxModel, Tmc5xxxOptions, Tmc5xxxPatch
from .registers import Chip
from .state import Tmc5xxxState


class EmulatedTmc5xxx(UartEmulatorBase40[Chip, Tmc5xxxPatch, Tmc5xxxState]):
    """Bytes in, bytes out, at its own clock's time; safe to use from several threads.

    `exchange` and `transfer` are its SPI, `uart` is its single wire. Both go by the same registers.
    """

    def __init__(self, model: Tmc5xxxModel, clock: Clock, options: Tmc5xxxOptions | None = None) -> None:
        """A chip that has just been switched on and lives by `clock`."""
        self.options = options = (options or Tmc5xxxOptions()).for_clock(CHIPS[model].clock_hz)
        super().__init__(clock, options.time_scale, Chip(model, options), options.clock_hz, options.seed)
        self._model: Tmc5xxxModel = model

    @property
    def model(self) -> Tmc5xxxModel:
        """The name in the catalog."""
        return self._model

    # --- plant ----------------------------------------------------------------------------------

    def _check(self, change: Tmc5xxxPatch) -> None:
        plant.check(self._chip, self._model, self.options, change)

    def _change(self, change: Tmc5xxxPatch) -> None:
        if change.power_cycle:
            self._power_cycle()
        plant.change(self._chip, change)

    def _ground_truth(self, axis: int) -> GroundTruth:
        drive = self._chip.axes[axis].drive
        return ground_truth(drive.plant_state, drive.plant)

    def _describe(self) -> Tmc5xxxState:
        faults = ChipFaultsState(**asdict(self.faults))
        return plant.describe(self._chip, self._model, self.options, faults, self._times)
