"""An emulated driver behind a wire: seconds, bytes and faults around a chip."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict

from ...clock import Clock
from ..core.chip40 import UartEmulatorBase40
from ..core.ground_truth import GroundTruth
from ..core.pins import PinWire
from ..drive.documents import ChipFaultsState, ground_truth, motor_state, truth_state
from ..motor_documents import change_load
from .chips import CHIPS
from .options import DriverModel, TmcDriverOptions, TmcDriverPatch, check_change
from .registers import Chip
from .state import DriverPinsState, DriverUartState, TmcDriverState
from .wires import Wires


class EmulatedDriver(UartEmulatorBase40[Chip, TmcDriverPatch, TmcDriverState]):
    """Bytes in, bytes out, at its own clock's time; safe to use from several threads.

    What it has of buses its `Kind` says; of a chip with a UART alone `exchange` is that.
    """

    def __init__(self, model: DriverModel, clock: Clock, options: TmcDriverOptions | None = None) -> None:
        """A chip that has just been switched on and lives by `clock`."""
        self.options = options = (options or TmcDriverOptions()).for_clock(CHIPS[model].clock_hz)
        self._model: DriverModel = model
        super().__init__(clock, options.time_scale, Chip(model, options), options.clock_hz, options.seed)
        self._wired = Wires(self._chip, options.clock_hz)

    @property
    def model(self) -> DriverModel:
        """The name in the catalog."""
        return self._model

    @property
    def wired(self) -> Wires:
        return self._wired

    @property
    def wires(self) -> Sequence[PinWire]:
        return self.options.wires

    def exchange(self, frame: bytes, at_s: float | None = None) -> bytes:
        return super().exchange(frame, at_s) if CHIPS[self._model].spi else self.uart(frame, at_s)

    # --- plant ----------------------------------------------------------------------------------

    def _check(self, change: TmcDriverPatch) -> None:
        check_change(self.options, change)

    def _change(self, change: TmcDriverPatch) -> None:
        chip, plant = self._chip, self._chip.drive.plant
        if change.power_cycle:
            self._power_cycle()
        if change.pins.enn is not None:
            chip.enn = change.pins.enn
        if change.pins.step_hz is not None:
            chip.step_hz = change.pins.step_hz
        if change.supply_v is not None:
            plant.supply_v = change.supply_v
        change_load(plant, change)

    def _ground_truth(self, axis: int) -> GroundTruth:
        return ground_truth(self._chip.drive.plant_state, self._chip.drive.plant)

    def _describe(self) -> TmcDriverState:
        chip, drive = self._chip, self._chip.drive
        plant = drive.plant
        return TmcDriverState(
            model=self._model,
            **self._times,
            clock_hz=self.options.clock_hz,
            rigid=self.options.rigid,
            supply_v=plant.supply_v,
            motor=motor_state(plant, drive.options.motor),
            load_torque_nm=plant.load_torque_nm,
            blocked=plant.blocked,
            friction=plant.extra_friction_nm,
            truth=truth_state(drive.plant_state),
            uart=DriverUartState(node=chip.pins, reply_delay_bits=self.reply_delay_bits, writes=chip.ifcnt)
            if chip.has_uart
            else None,
            pins=DriverPinsState(enn=chip.enn, diag=chip.diag, step_hz=chip.step_hz, steps=chip.steps_made),
            faults=ChipFaultsState(**asdict(self.faults)),
        )
