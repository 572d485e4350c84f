"""Step/direction outputs and position compare, as TMC4210 and TMC429 have them."""

from __future__ import annotations

from ...registers.model import to_signed
from . import kernel as k
from .chip import Chip
from .state import StepDirState

IF_CONFIGURATION, POS_COMP, POS_COMP_INT, TYPE = 0x34, 0x35, 0x36, 0x39
_INV_DIR = 1 << 4


class StepDirChip(Chip):
    """`Chip` with the registers of the interface."""

    def _map_registers(self) -> None:
        super()._map_registers()
        self._readers[POS_COMP_INT] = self._read_compare_interrupt
        self._writers[IF_CONFIGURATION] = self._write_interface
        self._writers[POS_COMP] = self._write_compare
        self._writers[POS_COMP_INT] = self._write_compare_interrupt

    @property
    def _step_dir(self) -> bool:
        """en_sd."""
        return bool(self._words[IF_CONFIGURATION] >> 5 & 1)

    @property
    def _direction(self) -> int:
        """inv_dir: -1 where it turns the motors round."""
        return -1 if self._words[IF_CONFIGURATION] & _INV_DIR else 1

    def _write_interface(self, data: int) -> None:
        self._words[IF_CONFIGURATION] = data
        self.chip[k.INVREF] = data & 1
        self.chip[k.HALF] = data >> 2 & 1
        self.chip[k.EN_SD] = data >> 5 & 1
        motor = (data >> 6 & 3) + 1
        self.chip[k.COMP_ON] = motor if motor <= self.model.axes else 0
        for index in range(self.model.axes):
            self._microstep(index)

    def _write_ustep_count(self, index: int, data: int) -> None:
        self.axes[index, k.SEQ] = data

    def _write_pulse_length(self, data: int) -> None:
        """STPDIV in the global parameters `data`."""
        self.chip[k.PULSE_LEN] = 16 * (1 + (data >> 8 & 0xF))

    # --- position compare ------------------------------------------------------------------------

    def _write_compare(self, data: int) -> None:
        self._words[POS_COMP] = data
        self.chip[k.COMP] = to_signed(data, 24)

    def _read_compare_interrupt(self) -> int:
        return int(self.chip[k.COMP_MASK]) << 8 | int(self.chip[k.COMP_FLAG])

    def _write_compare_interrupt(self, data: int) -> None:
        """Like the axis interrupts: 1 clears, and without the mask the flag is 0."""
        self.chip[k.COMP_MASK] = data >> 8
        self.chip[k.COMP_FLAG] &= ~data & data >> 8

    # --- pins ------------------------------------------------------------------------------------

    def describe_step_dirs(self) -> list[StepDirState]:
        """Those of every motor."""
        return [self.describe_step_dir(index) for index in range(self.model.axes)]

    def describe_step_dir(self, index: int) -> StepDirState:
        """The output pins of a motor as the API tells them."""
        interface = self._words[IF_CONFIGURATION]
        sent = self._get(index, k.SOUT)
        pulse_end = self._get(index, k.PULSE_END)
        level = sent & 1 if interface >> 2 & 1 else int(self.chip[k.CLOCK] < pulse_end)
        return StepDirState(
            enabled=self._step_dir,
            steps_sent=sent,
            steps_merged=self._get(index, k.MERGED),
            step_level=level ^ (interface >> 3 & 1),
            dir_level=int(self._get(index, k.DIR) < 0) ^ (interface >> 4 & 1),
            pulse_clocks=int(self.chip[k.PULSE_LEN]),
        )
