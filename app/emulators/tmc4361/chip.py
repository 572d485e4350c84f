"""An emulated TMC4361 as the far end of a wire: seconds, bytes and faults around a chip."""

from __future__ import annotations

import random
from dataclasses import asdict

from ...clock import Clock
from ...links.datagram40 import FRAME_BYTES, Reply, Request
from ..core.base import ChipFaults, FarEnd
from ..core.ground_truth import GroundTruth
from ..drive.bench import ChipFaultsState, ground_truth
from . import world
from .options import Tmc4361Options, Tmc4361Patch
from .registers import Chip
from .state import Tmc4361State

MODEL = "tmc4361"


class EmulatedTmc4361(FarEnd):
    """Bytes in, bytes out, at its own clock's time; safe to use from several threads."""

    def __init__(self, clock: Clock, options: Tmc4361Options | None = None) -> None:
        """A chip that has just been switched on and lives by `clock`."""
        self.options = options = options or Tmc4361Options()
        super().__init__(clock, options.time_scale)
        self._chip = Chip(options.feedback(), options.clock_hz)
        world.place(self._chip, options.stage)
        self._chip.reset()
        self._noise = random.Random(options.seed)
        self._data = 0
        self._faults = ChipFaults()

    @property
    def model(self) -> str:
        """The name in the catalog."""
        return MODEL

    # --- datagrams -------------------------------------------------------------------------------

    def exchange(self, frame: bytes, at_s: float | None = None) -> bytes:
        """Answer one 5-byte datagram at chip time `at_s` [s], by default now; never before the latest time used.

        Raises ValueError for a frame of another length, ConnectionError while unplugged and TimeoutError
        while silent. A silent chip still obeys: only its answer is lost.
        """
        if len(frame) != FRAME_BYTES:
            raise ValueError(f"a datagram has {FRAME_BYTES} bytes, not {len(frame)}")
        return self.transfer(frame, at_s)

    def transfer(self, sent: bytes, at_s: float | None = None) -> bytes:
        """What comes out while `sent` goes in, between NSCS low and NSCS high: any whole number of bytes.

        Fewer than 40 bits only fetch the beginning of the reply; of more the last 40 are the command, and those
        before them leave after 40 clocks, to the next chip of a chain (DS-TMC4361 5.2). Raises what `exchange` does,
        but for lengths.
        """
        self._faults.require_plugged(MODEL)
        with self._lock:
            chip = self._chip
            self._run_until(at_s)
            chip.wake()
            received = (Reply(chip.spi_status, self._data).encode() + sent)[: len(sent)]
            if len(sent) >= FRAME_BYTES:
                request = Request.decode(sent[-FRAME_BYTES:])
                if request.write:
                    chip.write(request.address, request.data)
                    self._data = request.data
                else:
                    self._data = chip.read(request.address)
            return self._faults.pass_on(MODEL, received, self._noise)

    # --- the world around ------------------------------------------------------------------------

    def state(self, at_s: float | None = None) -> Tmc4361State:
        """Everything that GET .../emulator answers, at chip time `at_s` [s], by default now."""
        with self._lock:
            self._run_until(at_s)
            return self._describe()

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

    def _run(self, until_s: float) -> None:
        self._chip.advance(self._clocks(until_s, self.options.clock_hz))

    @property
    def _quiet(self) -> bool:
        return self._chip.quiet

    def _describe(self) -> Tmc4361State:
        return world.describe(
            self._chip,
            ChipFaultsState(**asdict(self._faults)),
            time_scale=self.clock.scale,
            chip_time_s=self._latest_s,
            time_skipped_s=self.clock.skipped_s,
            clock_hz=self.options.clock_hz,
        )
