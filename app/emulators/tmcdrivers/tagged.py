"""An emulated TMC2660 behind a wire: 20 bits in 24, answered at once by a status."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import asdict

from ...clock import Clock
from ...registers.tmcdrivers.tmc2660 import FORMAT
from ..core.base import ChipFaults, EmulatorBase
from ..core.ground_truth import GroundTruth
from ..core.pins import PinWire
from ..drive.documents import ChipFaultsState, ground_truth, motor_state, truth_state
from ..drive.tmc26x import SG_FLAG, Tmc26x
from ..motor_documents import change_load
from .options import DriverModel, TmcDriverOptions, TmcDriverPatch, check_change
from .state import DriverPinsState, TmcDriverState
from .wires import Wires

CLOCK_HZ = 15e6
FULL_SCALE_A = 3.1
"""100 mOhm, and 310 mV over them (KLIPPER-TMC2660)."""
LEAST_SUPPLY_V = 8.0
"""Of a chip for 9 V and more, as distributors list it (INFERRED)."""
MODEL: DriverModel = "tmc2660"


class EmulatedTagged(EmulatorBase[TmcDriverPatch, TmcDriverState]):
    """Bytes in, bytes out, at its own clock's time; safe to use from several threads."""

    def __init__(self, clock: Clock, options: TmcDriverOptions | None = None) -> None:
        """A chip that has just been switched on and lives by `clock`."""
        self.options = options = (options or TmcDriverOptions()).for_clock(CLOCK_HZ)
        super().__init__(clock, options.time_scale, ChipFaults())
        self._chip = Tmc26x(options.drive(FULL_SCALE_A))
        self._chip.drive.least_supply_v = LEAST_SUPPLY_V
        self._noise = random.Random(options.seed)
        self._wired = Wires(self._chip, options.clock_hz)

    @property
    def model(self) -> str:
        """The name in the catalog."""
        return MODEL

    @property
    def wired(self) -> Wires:
        return self._wired

    @property
    def wires(self) -> Sequence[PinWire]:
        return self.options.wires

    def exchange(self, frame: bytes, at_s: float | None = None) -> bytes:
        """Answer 24 bits, of which the last 20 are the datagram and the first 20 of the answer the status.

        Raises ValueError for a frame of another length, ConnectionError while unplugged and TimeoutError while silent.
        A silent chip still obeys: only its answer is lost.
        """
        if len(frame) != FORMAT.frame_bytes:
            raise ValueError(f"a datagram has {FORMAT.frame_bytes} bytes, not {len(frame)}")
        self.faults.require_plugged(self.model)
        with self._lock:
            self._run_until(at_s)
            datagram = int.from_bytes(frame, "big")
            answer = self._chip.exchange(datagram & (1 << FORMAT.word_bits) - 1)
            # behind its own 20 bits it passes on what has come first
            received = answer << 4 | datagram >> FORMAT.word_bits
            return self.faults.pass_on(self.model, received.to_bytes(FORMAT.frame_bytes, "big"), self._noise)

    def _run(self, until_s: float) -> None:
        self._chip.advance(self._clocks(until_s, self.options.clock_hz))

    @property
    def _quiet(self) -> bool:
        return self._chip.quiet

    # --- plant ----------------------------------------------------------------------------------

    def _check(self, change: TmcDriverPatch) -> None:
        check_change(self.options, change)

    def _change(self, change: TmcDriverPatch) -> None:
        chip, plant = self._chip, self._chip.drive.plant
        if change.power_cycle:
            chip.reset()
        if change.pins.enn is not None:
            chip.drive.enabled = not change.pins.enn
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
            model=MODEL,
            **self._times,
            clock_hz=self.options.clock_hz,
            rigid=self.options.rigid,
            supply_v=plant.supply_v,
            motor=motor_state(plant, drive.options.motor),
            load_torque_nm=plant.load_torque_nm,
            blocked=plant.blocked,
            friction=plant.extra_friction_nm,
            truth=truth_state(drive.plant_state),
            uart=None,
            pins=DriverPinsState(
                enn=not drive.enabled, diag=bool(chip.flags & SG_FLAG), step_hz=chip.step_hz, steps=chip.steps_made
            ),
            faults=ChipFaultsState(**asdict(self.faults)),
        )
