"""An emulated TMC5xxx as the far end of a wire: seconds, bytes and faults around a chip."""

from __future__ import annotations

from dataclasses import asdict

from ...clock import Clock
from ..core.chip40 import UartFarEnd40
from ..core.ground_truth import GroundTruth
from ..drive.bench import ChipFaultsState, ground_truth
from . import world
from .chips import CHIPS
from .options import Tmc5xxxModel, Tmc5xxxOptions, Tmc5xxxPatch
from .registers import Chip
from .state import Tmc5xxxState


class EmulatedTmc5xxx(UartFarEnd40[Chip, Tmc5xxxState]):
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

    # --- the world around ------------------------------------------------------------------------

    def patch(self, change: Tmc5xxxPatch, at_s: float | None = None) -> Tmc5xxxState:
        """Change the world around the chip at chip time `at_s` [s], by default now.

        Raises OutOfRange for an axis or an encoder that the chip does not have and for switches that would change
        places, WrongState for a load on a rigid motor. Then nothing was changed.
        """
        with self._lock:
            chip = self._chip
            world.check(chip, self._model, self.options, change)
            self._run_until(at_s)
            if change.power_cycle:
                chip.reset()
                self._data = 0
            world.change(chip, change)
            self._faults.change(change.faults)
            if change.time_scale is not None:
                self.clock.scale = change.time_scale
            return self._describe()

    def ground_truth(self, axis: int, at_s: float | None = None) -> GroundTruth:
        """How it really is with an axis at chip time `at_s` [s], by default now."""
        with self._lock:
            self._run_until(at_s)
            drive = self._chip.axes[axis].drive
            return ground_truth(drive.truth, drive.world)

    def _describe(self) -> Tmc5xxxState:
        return world.describe(
            self._chip,
            self._model,
            self.options,
            ChipFaultsState(**asdict(self._faults)),
            time_scale=self.clock.scale,
            chip_time_s=self._latest_s,
            time_skipped_s=self.clock.skipped_s,
        )
