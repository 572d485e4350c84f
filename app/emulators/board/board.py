"""An emulated Landungsbrücke as a line sees it: frames, time and faults around its firmware and its chip."""

from __future__ import annotations

import threading

from pydantic import ValidationError

from ...errors import UsageError
from ...links.tmcl import FRAME_BYTES
from ...registers.catalog import MODELS
from ..tmc5xxx import EmulatedTmc5xxx, Tmc5xxxPatch
from ..tmc4361 import EmulatedTmc4361, Tmc4361Patch
from .firmware import VERSION_STRING, Firmware
from .functions import BoardFunctions
from .options import MODEL, BoardFaults, BoardPatch, BoardState
from .registers import ChipRegisters
from .sixpoint import SixPointBoard
from .tmc4361 import Tmc4361Board

BoardChip = EmulatedTmc4361 | EmulatedTmc5xxx


class EmulatedBoard:
    """`LineModule` with a chip at its SPI; safe to use from several threads. Time is the chip's."""

    def __init__(self, chip: BoardChip) -> None:
        """A board that has just been plugged in, and has set up its chip."""
        self.chip = chip
        self.clock = chip.clock
        self.faults = BoardFaults()
        self._lock = threading.Lock()
        self._registers = ChipRegisters(chip, MODELS[chip.model].table)
        self._registers.at_s = chip.clock.now()
        self._firmware = Firmware(self._registers, self._functions)

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
            at_s = self.clock.now() if at_s is None else at_s
            self._firmware.pass_time(at_s, self.chip.brought_to_s)
            self._registers.at_s = at_s
            return self._firmware.receive(frame)

    def unsolicited(self, at_s: float | None = None) -> list[tuple[float, bytes]]:
        """A board speaks only when it is asked."""
        del at_s
        return []

    def catch_up(self, slice_s: float) -> bool:
        """Bring the chip on by at most `slice_s` [s] of its time; True once it is up to date."""
        with self._lock:
            up_to_date = self.chip.catch_up(slice_s)
            self._firmware.pass_time(self.chip.brought_to_s, self.chip.brought_to_s)
            return up_to_date

    def state(self, at_s: float | None = None) -> BoardState:
        """Everything that GET /emulator of the control port answers."""
        with self._lock:
            return self._describe(at_s)

    def patch(self, change: BoardPatch, at_s: float | None = None) -> BoardState:
        """Change what is outside the board at chip time `at_s` [s], by default now. Raises what the chip raises."""
        of_chip = self._patch_of_chip(change)
        with self._lock:
            self._registers.at_s = self.clock.now() if at_s is None else at_s
            if change.power_cycle:
                self._firmware.power_on()
            self._patch_chip(of_chip, at_s)
            self.faults = self.faults.model_copy(update=change.faults.model_dump(exclude_none=True))
            return self._describe(at_s)

    def _describe(self, at_s: float | None) -> BoardState:
        return BoardState(version=VERSION_STRING.decode(), faults=self.faults, chip=self.chip.state(at_s))

    def _functions(self, registers: ChipRegisters) -> BoardFunctions:
        model = self.chip.model
        if isinstance(self.chip, EmulatedTmc4361):
            return Tmc4361Board(registers, self._reset_chip)
        return SixPointBoard(model, MODELS[model].table, MODELS[model].axes, registers, self._reset_chip)

    def _reset_chip(self) -> None:
        off_and_on = Tmc4361Patch if isinstance(self.chip, EmulatedTmc4361) else Tmc5xxxPatch
        self._patch_chip(off_and_on(power_cycle=True), self._registers.at_s)

    def _patch_of_chip(self, change: BoardPatch) -> Tmc4361Patch | Tmc5xxxPatch:
        """What is said of the chip, as this chip takes it. Raises UsageError for what it does not have."""
        known = Tmc4361Patch if isinstance(self.chip, EmulatedTmc4361) else Tmc5xxxPatch
        try:
            return known.model_validate(change.chip.model_dump(exclude_unset=True))
        except ValidationError as error:
            what = ".".join(str(part) for part in error.errors()[0]["loc"])
            raise UsageError(f"chip.{what} is not for a {self.chip.model}") from error

    def _patch_chip(self, change: Tmc4361Patch | Tmc5xxxPatch, at_s: float | None) -> None:
        if isinstance(self.chip, EmulatedTmc4361):
            assert isinstance(change, Tmc4361Patch)
            self.chip.patch(change, at_s)
        else:
            assert isinstance(change, Tmc5xxxPatch)
            self.chip.patch(change, at_s)
