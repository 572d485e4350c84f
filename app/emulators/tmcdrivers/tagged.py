"""An emulated TMC2660 behind a wire: 20 bits in 24, answered at once by a status."""

from __future__ import annotations

import random

from ...clock import Clock
from ...registers.tmcdrivers.tmc2660 import FORMAT
from ..core.base import ChipFaults, EmulatorBase
from ..core.ground_truth import GroundTruth
from ..drive.documents import ground_truth
from ..drive.tmc26x import Tmc26x
from . import plant
from .options import DriverModel, TmcDriverOptions, TmcDriverPatch, check_change
from .state import TmcDriverState
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
        self.wired: Wires = Wires(self._chip, options.clock_hz)
        self.wires = options.wires

    @property
    def model(self) -> str:
        """The name in the catalog."""
        return MODEL

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
        if change.power_cycle:
            self._chip.reset()
        plant.change(self._chip, change)

    def _ground_truth(self, axis: int) -> GroundTruth:
        return ground_truth(self._chip.drive.plant_state, self._chip.drive.plant)

    def _describe(self) -> TmcDriverState:
        return plant.describe(MODEL, self._chip, self.options, self._times, self.faults)
