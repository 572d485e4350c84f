"""An emulated driver behind a wire: seconds, bytes and faults around a chip."""

from __future__ import annotations

from ...clock import Clock
from ...registers.catalog import MODELS
from ..core.chip40 import UartEmulatorBase40
from ..core.ground_truth import GroundTruth
from ..drive.documents import ground_truth
from ..drive.tmc22xx import StepDirDriver
from . import plant
from .chips import CHIPS
from .options import DriverModel, TmcDriverOptions, TmcDriverPatch, check_change
from .state import DriverUartState, TmcDriverState
from .wires import Wires


class EmulatedDriver(UartEmulatorBase40[StepDirDriver, TmcDriverPatch, TmcDriverState]):
    """Bytes in, bytes out, at its own clock's time; safe to use from several threads.

    What it has of buses its `Kind` says; of a chip with a UART alone `exchange` is that.
    """

    def __init__(self, model: DriverModel, clock: Clock, options: TmcDriverOptions | None = None) -> None:
        """A chip that has just been switched on and lives by `clock`."""
        self.options = options = (options or TmcDriverOptions()).for_clock(CHIPS[model].clock_hz)
        self._model: DriverModel = model
        kind = CHIPS[model]
        drive = options.drive(kind.full_scale_a)
        chip = StepDirDriver(kind, MODELS[model].table, drive, pins=options.node)
        super().__init__(clock, options.time_scale, chip, options.clock_hz, options.seed)
        self.wired: Wires = Wires(self._chip, options.clock_hz)
        self.wires = options.wires

    @property
    def model(self) -> DriverModel:
        """The name in the catalog."""
        return self._model

    def exchange(self, frame: bytes, at_s: float | None = None) -> bytes:
        return super().exchange(frame, at_s) if CHIPS[self._model].spi else self.uart(frame, at_s)

    # --- plant ----------------------------------------------------------------------------------

    def _check(self, change: TmcDriverPatch) -> None:
        check_change(self.options, change, has_vref=self._chip.has_vref)

    def _change(self, change: TmcDriverPatch) -> None:
        if change.power_cycle:
            self._power_cycle()
        if change.pins.vref_v is not None:
            self._chip.vref_v = change.pins.vref_v
        plant.change(self._chip, change)

    def _ground_truth(self, axis: int) -> GroundTruth:
        return ground_truth(self._chip.drive.plant_state, self._chip.drive.plant)

    def _describe(self) -> TmcDriverState:
        chip = self._chip
        uart = (
            DriverUartState(node=chip.pins, reply_delay_bits=self.reply_delay_bits, writes=chip.ifcnt)
            if chip.has_uart
            else None
        )
        vref_v = chip.vref_v if chip.has_vref else None
        return plant.describe(
            self._model, chip, self.options, self._times, self.faults, uart, index=chip.index, vref_v=vref_v
        )
