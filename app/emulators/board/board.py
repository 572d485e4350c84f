"""An emulated Landungsbrücke as a line sees it: frames, time and faults around its firmware and its chip."""

from __future__ import annotations

import threading

from app.emulators.board.firmware import VERSION_STRING, Firmware
from app.emulators.board.options import BoardFaults, BoardPatch, BoardState
from app.emulators.board.registers import ChipRegisters
from app.emulators.tmc4361 import EmulatedTmc4361, Tmc4361Patch
from app.links.tmcl import FRAME_BYTES
from app.registers.tmc4361 import TMC4361

MODEL = "landungsbruecke"


class EmulatedBoard:
    """`LineModule` with a chip at its SPI; safe to use from several threads. Time is the chip's."""

    def __init__(self, chip: EmulatedTmc4361) -> None:
        """A board that has just been plugged in, and has set up its chip."""
        self.chip = chip
        self.clock = chip.clock
        self.faults = BoardFaults()
        self._lock = threading.Lock()
        self._registers = ChipRegisters(chip, TMC4361)
        self._registers.at_s = chip.clock.now()
        self._firmware = Firmware(self._registers, self._reset_chip)

    @property
    def model(self) -> str:
        """What the command line calls it."""
        return MODEL

    @property
    def reply_pause_s(self) -> float:
        """It answers at once."""
        return 0.0

    def receive(self, frame: bytes, at_s: float | None = None) -> bytes | None:
        """Obey one frame at chip time `at_s` [s], by default now; None where it is for another module.

        Raises ValueError for a frame of another length.
        """
        if len(frame) != FRAME_BYTES:
            raise ValueError(f"a TMCL frame has {FRAME_BYTES} bytes, not {len(frame)}")
        with self._lock:
            self._registers.at_s = self.clock.now() if at_s is None else at_s
            return self._firmware.receive(frame)

    def unsolicited(self, at_s: float | None = None) -> list[tuple[float, bytes]]:
        """A board speaks only when it is asked."""
        del at_s
        return []

    def catch_up(self, slice_s: float) -> bool:
        """Bring the chip on by at most `slice_s` [s] of its time; True once it is up to date."""
        with self._lock:
            return self.chip.catch_up(slice_s)

    def state(self, at_s: float | None = None) -> BoardState:
        """Everything that GET /emulator of the control port answers."""
        with self._lock:
            return self._describe(at_s)

    def patch(self, change: BoardPatch, at_s: float | None = None) -> BoardState:
        """Change the world around the board at chip time `at_s` [s], by default now. Raises what the chip raises."""
        with self._lock:
            self._registers.at_s = self.clock.now() if at_s is None else at_s
            if change.power_cycle:
                self._firmware.power_on()
            self.chip.patch(change.chip, at_s)
            self.faults = self.faults.model_copy(update=change.faults.model_dump(exclude_none=True))
            return self._describe(at_s)

    def _describe(self, at_s: float | None) -> BoardState:
        return BoardState(version=VERSION_STRING.decode(), faults=self.faults, chip=self.chip.state(at_s))

    def _reset_chip(self) -> None:
        self.chip.patch(Tmc4361Patch(power_cycle=True), self._registers.at_s)
