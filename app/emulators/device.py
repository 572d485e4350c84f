"""An emulated device as the far end of a wire: seconds, bytes and faults around a chip."""

from __future__ import annotations

import random
import threading

from app.clock import Clock, ScaledClock
from app.emulators import stage
from app.emulators.options import EmulatorOptions, EmulatorPatch
from app.emulators.state import EmulatorState, Faults, Inputs
from app.emulators.tmc428 import Tmc428
from app.emulators.tmc4210 import Tmc4210
from app.links.datagram32 import FRAME_BYTES
from app.links.errors import OutOfRange


class EmulatedDevice:
    """Bytes in, bytes out, at its own clock's time; safe to use from several threads.

    The chip never runs by itself: whoever asks makes it catch up first.
    """

    def __init__(self, model: str, clock: Clock, options: EmulatorOptions) -> None:
        self.model = model
        self.clock = ScaledClock(clock, options.time_scale)
        self._clock_hz = options.clock_hz
        self._chip = Tmc428(options) if model == "tmc428" else Tmc4210(options)
        self._options = options
        self._lock = threading.Lock()
        self._latest_s = 0.0
        self._silence = False
        self._unplugged = False
        self._bit_error_rate = 0.0
        self._noise = random.Random(options.seed)

    def exchange(self, frame: bytes, at_s: float | None = None) -> bytes:
        """Answer one 4-byte frame at chip time `at_s` [s], by default now; never before the latest time used.

        Raises ValueError for a frame of another length, ConnectionError while unplugged and TimeoutError
        while silent. A silent chip still obeys: only its answer is lost.
        """
        if len(frame) != FRAME_BYTES:
            raise ValueError(f"a datagram has {FRAME_BYTES} bytes, not {len(frame)}")
        if self._unplugged:
            raise ConnectionError(f"emulated {self.model} is unplugged")
        with self._lock:
            reply: int = self._chip.exchange(int.from_bytes(frame, "big"), self._clocks(at_s))
            if self._bit_error_rate:
                for bit in range(32):
                    if self._noise.random() < self._bit_error_rate:
                        reply ^= 1 << bit
        if self._silence:
            raise TimeoutError(f"emulated {self.model} is silent")
        return reply.to_bytes(FRAME_BYTES, "big")

    def state(self, at_s: float | None = None) -> EmulatorState:
        """Everything that GET /emulator answers, at chip time `at_s` [s], by default now."""
        with self._lock:
            self._chip.advance(self._clocks(at_s))
            return self._describe()

    def patch(self, change: EmulatorPatch, at_s: float | None = None) -> EmulatorState:
        """Change the world around the chip at chip time `at_s` [s], by default now.

        Raises OutOfRange for an axis that the chip does not have.
        """
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
        with self._lock:
            clocks = self._clocks(at_s)
            chip.advance(clocks)
            if change.power_cycle:
                chip.power_cycle(clocks)
            for moved in change.stages:
                stage.change(chip.axes[moved.axis], moved, chip.stage_units)
            for forced in change.switches:
                stage.force(chip.axes[forced.axis], forced)
            if isinstance(chip, Tmc428):
                for driver in change.drivers:
                    chip.driver_status[driver.axis] = driver.status
            if change.inputs.gp_in is not None:
                chip.set_general_input(change.inputs.gp_in)
            chip.refresh()
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
        """Clocks of the chip's oscillator by `at_s`, rounded so that exact instants stay exact."""
        self._latest_s = max(self._latest_s, self.clock.now() if at_s is None else at_s)
        return int(self._latest_s * self._clock_hz + 0.5)

    def _describe(self) -> EmulatorState:
        chip = self._chip
        return EmulatorState(
            model="tmc428" if isinstance(chip, Tmc428) else "tmc4210",
            time_scale=self.clock.scale,
            chip_time_s=self._latest_s,
            clock_hz=self._clock_hz,
            wiring=self._options.wiring if isinstance(chip, Tmc428) else "triple-switch",
            axes=[stage.describe(index, axis, chip.stage_units) for index, axis in enumerate(chip.axes)],
            inputs=Inputs(gp_in=chip.general_input),
            faults=Faults(silence=self._silence, unplugged=self._unplugged, bit_error_rate=self._bit_error_rate),
            powered_down=chip.powered_down,
            driver_chain=chip.describe_chain() if isinstance(chip, Tmc428) else None,
            step_dir=chip.describe_step_dir() if isinstance(chip, Tmc4210) else None,
        )
