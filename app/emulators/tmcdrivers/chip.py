"""An emulated driver as the far end of a wire: seconds, bytes and faults around a chip."""

from __future__ import annotations

from dataclasses import asdict

from ...clock import Clock
from ...errors import WrongState
from ..core.chip40 import UartFarEnd40
from ..core.ground_truth import GroundTruth
from ..drive.bench import ChipFaultsState, change_motor, ground_truth, motor_state, truth_state
from .chips import CHIPS
from .options import DriverModel, TmcDriverOptions, TmcDriverPatch
from .registers import Chip
from .state import DriverPinsState, DriverUartState, TmcDriverState


class EmulatedDriver(UartFarEnd40[Chip, TmcDriverState]):
    """Bytes in, bytes out, at its own clock's time; safe to use from several threads.

    What it has of buses its `Kind` says; of a chip with a UART alone `exchange` is that.
    """

    def __init__(self, model: DriverModel, clock: Clock, options: TmcDriverOptions | None = None) -> None:
        """A chip that has just been switched on and lives by `clock`."""
        self.options = options = options or TmcDriverOptions()
        self._model: DriverModel = model
        super().__init__(clock, options.time_scale, Chip(model, options), options.clock_hz, options.seed)

    @property
    def model(self) -> DriverModel:
        """The name in the catalog."""
        return self._model

    def exchange(self, frame: bytes, at_s: float | None = None) -> bytes:
        return super().exchange(frame, at_s) if CHIPS[self._model].spi else self.uart(frame, at_s)

    # --- the world around ------------------------------------------------------------------------

    def patch(self, change: TmcDriverPatch, at_s: float | None = None) -> TmcDriverState:
        """Change the world around the chip at chip time `at_s` [s], by default now.

        Raises WrongState for a load on a rigid motor. Then nothing was changed.
        """
        with self._lock:
            if self.options.rigid and (change.load_torque_nm or change.friction or change.blocked):
                raise WrongState("the motor is rigid", "make the emulator with a motor that has physics")
            self._run_until(at_s)
            chip, world = self._chip, self._chip.drive.world
            if change.power_cycle:
                chip.reset()
                self._data = 0
            if change.pins.enn is not None:
                chip.enn = change.pins.enn
            if change.supply_v is not None:
                world.supply_v = change.supply_v
            change_motor(world, change.motor)
            if change.load_torque_nm is not None:
                world.load_torque_nm = change.load_torque_nm
            if change.friction is not None:
                world.extra_friction_nm = change.friction
            if change.blocked is not None:
                world.blocked = change.blocked
            self._faults.change(change.faults)
            if change.time_scale is not None:
                self.clock.scale = change.time_scale
            return self._describe()

    def ground_truth(self, axis: int, at_s: float | None = None) -> GroundTruth:
        """How it really is with the motor at chip time `at_s` [s], by default now."""
        del axis  # there is one
        with self._lock:
            self._run_until(at_s)
            return ground_truth(self._chip.drive.truth, self._chip.drive.world)

    def _describe(self) -> TmcDriverState:
        chip, drive = self._chip, self._chip.drive
        world = drive.world
        return TmcDriverState(
            model=self._model,
            time_scale=self.clock.scale,
            chip_time_s=self._latest_s,
            time_skipped_s=self.clock.skipped_s,
            clock_hz=self.options.clock_hz,
            rigid=self.options.rigid,
            supply_v=world.supply_v,
            motor=motor_state(world, drive.options.motor),
            load_torque_nm=world.load_torque_nm,
            blocked=world.blocked,
            friction=world.extra_friction_nm,
            truth=truth_state(drive.truth),
            uart=DriverUartState(node=chip.pins, reply_delay_bits=self.reply_delay_bits, writes=chip.ifcnt),
            pins=DriverPinsState(enn=chip.enn, diag=chip.diag),
            faults=ChipFaultsState(**asdict(self._faults)),
        )
