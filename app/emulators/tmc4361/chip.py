"""An emulated TMC4361 as the far end of a wire: seconds, bytes and faults around a chip."""

from __future__ import annotations

from dataclasses import asdict

from ...clock import Clock
from ..core.chip40 import FarEnd40
from ..core.ground_truth import GroundTruth
from ..drive.bench import ChipFaultsState, ground_truth
from . import world
from .options import Tmc4361Options, Tmc4361Patch
from .registers import Chip
from .state import Tmc4361State

MODEL = "tmc4361"


class EmulatedTmc4361(FarEnd40[Chip, Tmc4361State]):
    """Bytes in, bytes out, at its own clock's time; safe to use from several threads."""

    def __init__(self, clock: Clock, options: Tmc4361Options | None = None) -> None:
        """A chip that has just been switched on and lives by `clock`."""
        self.options = options = options or Tmc4361Options()
        chip = Chip(options.feedback(), options.clock_hz)
        super().__init__(clock, options.time_scale, chip, options.clock_hz, options.seed)
        world.place(chip, options.stage)
        chip.reset()

    @property
    def model(self) -> str:
        """The name in the catalog."""
        return MODEL

    def _selected(self) -> None:
        self._chip.wake()

    # --- the world around ------------------------------------------------------------------------

    def patch(self, change: Tmc4361Patch, at_s: float | None = None) -> Tmc4361State:
        """Change the world around the chip at chip time `at_s` [s], by default now.

        Raises OutOfRange for switches that would change places, ValueError for a load that cannot be computed.
        """
        with self._lock:
            chip = self._chip
            world.check(chip, change)
            self._run_until(at_s)
            chip.feedback.change(change.feedback())
            if change.power_cycle:
                chip.reset()
                self._data = 0
            world.change(chip, change, self.options.clock_hz)
            self._faults.change(change.faults)
            if change.time_scale is not None:
                self.clock.scale = change.time_scale
            return self._describe()

    def ground_truth(self, axis: int, at_s: float | None = None) -> GroundTruth:
        """How it really is with the axis, which is the only one, at chip time `at_s` [s], by default now."""
        with self._lock:
            self._run_until(at_s)
            return ground_truth(self._chip.feedback.truth, self._chip.feedback.world)

    def _describe(self) -> Tmc4361State:
        return world.describe(
            self._chip,
            ChipFaultsState(**asdict(self._faults)),
            time_scale=self.clock.scale,
            chip_time_s=self._latest_s,
            time_skipped_s=self.clock.skipped_s,
            clock_hz=self.options.clock_hz,
        )
