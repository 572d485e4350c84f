"""An emulated TMC4361 behind a wire: seconds, bytes and faults around a chip."""

from __future__ import annotations

from dataclasses import asdict

from ...clock import Clock
from ..core.chip40 import EmulatorBase40
from ..core.ground_truth import GroundTruth
from ..drive.documents import ChipFaultsState, ground_truth
from . import plant
from .options import Tmc4361Options, Tmc4361Patch
from .registers import Chip
from .state import Tmc4361State
from .wires import Wires

MODEL = "tmc4361"


class EmulatedTmc4361(EmulatorBase40[Chip, Tmc4361Patch, Tmc4361State]):
    """Bytes in, bytes out, at its own clock's time; safe to use from several threads."""

    def __init__(self, clock: Clock, options: Tmc4361Options | None = None) -> None:
        """A chip that has just been switched on and lives by `clock`."""
        self.options = options = options or Tmc4361Options()
        chip = Chip(options.feedback(), options.clock_hz)
        super().__init__(clock, options.time_scale, chip, options.clock_hz, options.seed)
        plant.place(chip, options.stage)
        chip.reset()
        self.wired: Wires = Wires(chip, options.clock_hz)
        self.wires = options.wires

    @property
    def model(self) -> str:
        """The name in the catalog."""
        return MODEL

    def _selected(self) -> None:
        self._chip.wake()

    # --- plant ----------------------------------------------------------------------------------

    def _check(self, change: Tmc4361Patch) -> None:
        plant.check(self._chip, change)

    def _change(self, change: Tmc4361Patch) -> None:
        self._chip.catch_up_driver()
        self._chip.feedback.change(change.feedback())
        if change.power_cycle:
            self._power_cycle()
        plant.change(self._chip, change, self.options.clock_hz)

    def _ground_truth(self, axis: int) -> GroundTruth:
        return ground_truth(self._chip.feedback.plant_state, self._chip.feedback.plant)

    def _describe(self) -> Tmc4361State:
        faults = ChipFaultsState(**asdict(self.faults))
        return plant.describe(self._chip, faults, self._times, self.options.clock_hz)
