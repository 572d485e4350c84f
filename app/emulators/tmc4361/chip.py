"""An emulated TMC4361 as the far end of a wire: seconds, bytes and faults around a chip."""

from __future__ import annotations

import random
import threading

from app.clock import Clock, ScaledClock
from app.emulators.tmc4361 import world
from app.emulators.tmc4361.options import Tmc4361Options, Tmc4361Patch
from app.emulators.tmc4361.registers import Chip
from app.emulators.tmc4361.state import FaultsState, Tmc4361State
from app.links.datagram40 import FRAME_BYTES, Reply, Request

MODEL = "tmc4361"


class EmulatedTmc4361:
    """Bytes in, bytes out, at its own clock's time; safe to use from several threads.

    The chip never runs by itself: whoever asks makes it catch up first.
    """

    def __init__(self, clock: Clock, options: Tmc4361Options | None = None) -> None:
        """A chip that has just been switched on and lives by `clock`."""
        self.options = options = options or Tmc4361Options()
        self.clock = ScaledClock(clock, options.time_scale)
        self._chip = Chip(options.feedback(), options.clock_hz)
        world.place(self._chip, options.stage)
        self._chip.reset()
        self._noise = random.Random(options.seed)
        self._lock = threading.Lock()
        self._latest_s = 0.0
        self._data = 0
        self._silence = False
        self._unplugged = False
        self._bit_error_rate = 0.0

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
        before them leave after 40 clocks, to the next chip of a chain (002, 5.2). Raises what `exchange` does, but
        for lengths.
        """
        if self._unplugged:
            raise ConnectionError(f"emulated {MODEL} is unplugged")
        with self._lock:
            chip = self._chip
            chip.advance(self._clocks(at_s))
            chip.wake()
            received = (Reply(chip.spi_status, self._data).encode() + sent)[: len(sent)]
            if len(sent) >= FRAME_BYTES:
                request = Request.decode(sent[-FRAME_BYTES:])
                if request.write:
                    chip.write(request.address, request.data)
                    self._data = request.data
                else:
                    self._data = chip.read(request.address)
            if self._bit_error_rate:
                received = self._spoilt(received)
        if self._silence:
            raise TimeoutError(f"emulated {MODEL} is silent")
        return received

    def _spoilt(self, received: bytes) -> bytes:
        word = int.from_bytes(received, "big")
        for bit in range(8 * len(received)):
            if self._noise.random() < self._bit_error_rate:
                word ^= 1 << bit
        return word.to_bytes(len(received), "big")

    # --- the world around ------------------------------------------------------------------------

    def state(self, at_s: float | None = None) -> Tmc4361State:
        """Everything that GET .../emulator answers, at chip time `at_s` [s], by default now."""
        with self._lock:
            self._chip.advance(self._clocks(at_s))
            return self._describe()

    def patch(self, change: Tmc4361Patch, at_s: float | None = None) -> Tmc4361State:
        """Change the world around the chip at chip time `at_s` [s], by default now.

        Raises OutOfRange for switches that would change places, ValueError for a load that cannot be computed.
        """
        with self._lock:
            chip = self._chip
            world.check_stage(chip, change.stage)
            chip.advance(self._clocks(at_s))
            chip.feedback.change(change.feedback())
            if change.power_cycle:
                chip.reset()
                self._data = 0
            world.change(chip, change, self.options.clock_hz)
            faults = change.faults
            self._silence = self._silence if faults.silence is None else faults.silence
            self._unplugged = self._unplugged if faults.unplugged is None else faults.unplugged
            if faults.bit_error_rate is not None:
                self._bit_error_rate = faults.bit_error_rate
            if change.time_scale is not None:
                self.clock.scale = change.time_scale
            return self._describe()

    def caught_up(self, lag_s: float = 1e-9) -> bool:
        """Has the chip been brought to within `lag_s` [s] of its clock?"""
        return self.clock.now() - self._latest_s <= lag_s

    def catch_up(self, slice_s: float) -> bool:
        """Bring the chip on by at most `slice_s` [s] of its time; True once it is up to date.

        Never needed for correctness: who asks after hours without it just waits for all of them at once.
        """
        now_s = self.clock.now()
        with self._lock:
            until_s = min(now_s, self._latest_s + slice_s)
            self._chip.advance(self._clocks(until_s))
        return until_s == now_s

    def _clocks(self, at_s: float | None) -> int:
        """Clocks of the oscillator by `at_s`, rounded so that exact instants stay exact."""
        self._latest_s = max(self._latest_s, self.clock.now() if at_s is None else at_s)
        return int(self._latest_s * self.options.clock_hz + 0.5)

    def _describe(self) -> Tmc4361State:
        return world.describe(
            self._chip,
            FaultsState(silence=self._silence, unplugged=self._unplugged, bit_error_rate=self._bit_error_rate),
            time_scale=self.clock.scale,
            chip_time_s=self._latest_s,
            clock_hz=self.options.clock_hz,
        )
