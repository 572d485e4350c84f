"""An emulated device behind a wire: seconds, bytes and faults around a chip."""

from __future__ import annotations

import random
from collections.abc import Mapping
from dataclasses import asdict

from ...clock import Clock
from ...errors import OutOfRange, WrongState
from ...links.datagram32 import FRAME_BYTES
from ..core.base import ChipFaults, EmulatorBase
from ..core.ground_truth import GroundTruth
from ..drive.documents import ChipFaultsState
from . import stage
from .options import EmulatorOptions, EmulatorPatch
from .state import EmulatorState, Inputs
from .step_dir import StepDirChip
from .tmc428 import Tmc428
from .tmc429 import Tmc429
from .tmc4210 import Tmc4210
from .wires import Wires

CHIPS: Mapping[str, type[Tmc428 | Tmc4210]] = {"tmc428": Tmc428, "tmc429": Tmc429, "tmc4210": Tmc4210}


class EmulatedDevice(EmulatorBase[EmulatorPatch, EmulatorState]):
    """Bytes in, bytes out, at its own clock's time; safe to use from several threads."""

    def __init__(self, model: str, clock: Clock, options: EmulatorOptions) -> None:
        super().__init__(clock, options.time_scale, ChipFaults())
        self._model = model
        self._clock_hz = options.clock_hz
        self._chip = CHIPS[model](options)
        self._options = options
        self._noise = random.Random(options.seed)
        self.wires = options.wires
        self.wired: Wires = Wires(self._chip, options.clock_hz, lambda: self.brought_to_s)

    @property
    def model(self) -> str:
        """The name in the catalog."""
        return self._model

    def exchange(self, frame: bytes, at_s: float | None = None) -> bytes:
        """Answer one 4-byte frame at chip time `at_s` [s], by default now; never before the latest time used.

        Raises ValueError for a frame of another length, ConnectionError while unplugged and TimeoutError
        while silent. A silent chip still obeys: only its answer is lost.
        """
        if len(frame) != FRAME_BYTES:
            raise ValueError(f"a datagram has {FRAME_BYTES} bytes, not {len(frame)}")
        self.faults.require_plugged(self.model)
        with self._lock:
            clocks = self._clocks(self._reach(at_s), self._clock_hz)
            reply: int = self._chip.exchange(int.from_bytes(frame, "big"), clocks)
            return self.faults.pass_on(self.model, reply.to_bytes(FRAME_BYTES, "big"), self._noise)

    # --- plant ----------------------------------------------------------------------------------

    def _check(self, change: EmulatorPatch) -> None:
        chip = self._chip
        axes = chip.model.axes
        named = [
            *(entry.axis for entry in change.switches),
            *(entry.axis for entry in change.stages),
            *(entry.axis for entry in change.drivers),
        ]
        if named and max(named) >= axes:
            raise OutOfRange("axis", max(named), 0, axes - 1)
        if change.drivers and not isinstance(chip, Tmc428):
            raise OutOfRange("drivers", len(change.drivers), 0, 0, f"a {self.model} has no driver chain")
        for driver in change.drivers:
            motor = isinstance(chip, Tmc428) and chip.drives is not None and chip.drives.has_motor(driver.axis)
            if driver.of_motor and not motor:
                raise WrongState(f"the driver of axis {driver.axis} has no motor with physics", "make it a tmc2660")
            if driver.status is not None and motor:
                raise WrongState(
                    f"the status of the driver of axis {driver.axis} follows from what is so", "change motor or load"
                )

    def _change(self, change: EmulatorPatch) -> None:
        chip = self._chip
        if change.power_cycle:
            chip.power_cycle(self._clocks(self._latest_s, self._clock_hz))
        for moved in change.stages:
            stage.change(chip.axes[moved.axis], moved, chip.stage_units)
        for forced in change.switches:
            stage.force(chip.axes[forced.axis], forced)
            stage.wire(chip.axes[forced.axis], self.wired.held.get(forced.axis))
        if isinstance(chip, Tmc428):
            for driver in change.drivers:
                if driver.status is not None:
                    chip.driver_status[driver.axis] = driver.status
                if driver.of_motor and chip.drives is not None:
                    chip.drives.change(driver)
            for moved in change.stages:
                if moved.position_fullsteps is not None and chip.drives is not None:
                    chip.drives.turn_by_hand(moved.axis, moved.position_fullsteps)
        if change.inputs.gp_in is not None:
            chip.set_general_input(change.inputs.gp_in)
        chip.refresh()

    def _ground_truth(self, axis: int) -> GroundTruth:
        return GroundTruth(stage.describe(axis, self._chip.axes[axis], self._chip.stage_units).position_fullsteps)

    def _run(self, until_s: float) -> None:
        self._chip.advance(self._clocks(until_s, self._clock_hz))

    @property
    def _quiet(self) -> bool:
        return self._chip.quiet

    def _describe(self) -> EmulatorState:
        chip = self._chip
        step_dir = chip.describe_step_dirs() if isinstance(chip, StepDirChip) else []
        return EmulatorState(
            model=self.model,
            **self._times,
            clock_hz=self._clock_hz,
            wiring=self._options.wiring if isinstance(chip, Tmc428) else "triple-switch",
            chip_selects=self._options.chip_selects,
            v_actual_writable=self._options.v_actual_writable,
            axes=[stage.describe(index, axis, chip.stage_units) for index, axis in enumerate(chip.axes)],
            inputs=Inputs(gp_in=chip.general_input),
            faults=ChipFaultsState(**asdict(self.faults)),
            powered_down=chip.powered_down,
            driver_chain=chip.describe_chain() if isinstance(chip, Tmc428) else None,
            step_dir=step_dir[0] if step_dir else None,
            step_dirs=step_dir,
        )
