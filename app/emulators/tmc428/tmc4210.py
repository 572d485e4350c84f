"""The emulated TMC4210: step/direction output and position compare around one axis."""

from __future__ import annotations

from functools import partial

from ...registers.catalog import MODELS
from ...registers.model import to_signed
from ...registers.tmc428.tmc4210 import TYPE_VERSION
from . import kernel as k
from .chip import CLK2_DIV_RESET, GLOBAL, LAST_INDEX, SWITCHES, Chip
from .options import EmulatorOptions
from .state import StepDirState

IF_CONFIGURATION, POS_COMP, POS_COMP_INT, TYPE = 0x34, 0x35, 0x36, 0x39
RAM = 0x40
_RAM_MASK = 0x3F3F
_SDO_INT = 1 << 1


class Tmc4210(Chip):
    """The chip, a step/direction driver and its stage."""

    kind = k.TMC4210_KIND

    def __init__(self, options: EmulatorOptions) -> None:
        super().__init__(MODELS["tmc4210"], options, options.driver_microsteps)
        for address in range(RAM, RAM + 64):
            self._masks[address] = _RAM_MASK

    def _reset(self) -> None:
        self._words[TYPE] = TYPE_VERSION
        self._write_global(CLK2_DIV_RESET)
        self._write_interface(0)

    def _map_registers(self) -> None:
        super()._map_registers()
        self._readers[LAST_INDEX] = partial(self._get, 0, k.SEQ)
        self._writers[LAST_INDEX] = self._write_ustep_count
        self._readers[POS_COMP_INT] = self._read_compare_interrupt
        self._readers[SWITCHES] = self._read_switches
        self._writers[IF_CONFIGURATION] = self._write_interface
        self._writers[POS_COMP] = self._write_compare
        self._writers[POS_COMP_INT] = self._write_compare_interrupt
        self._writers[GLOBAL] = self._write_global
        for address in range(RAM, RAM + 64):
            # It has the RAM of its family, initialised, readable, and without any effect (DS-TMC4210 5.2.3, 5.3).
            self._writers[address] = partial(self._write_ram, address)

    def exchange(self, word: int, clock: int) -> int:
        blocked = self._words[IF_CONFIGURATION] & _SDO_INT
        reply = super().exchange(word, clock)
        if blocked:  # the output pin is nINT and nothing else (DS-TMC4210 5.2.2.2)
            return 0 if reply >> 31 else 0xFFFF_FFFF
        return reply

    def _write_ram(self, address: int, data: int) -> None:
        self._words[address] = data

    def _microstep(self, index: int) -> None:
        """The pointer counts steps (it has no usrs to widen them); the motor follows the step output."""
        interface = self._words[IF_CONFIGURATION]
        self.axes[index, k.INC] = 1
        # Without en_sd no step leaves the chip (DS-TMC4210 1.4).
        self.axes[index, k.MINC] = 0 if not interface >> 5 & 1 else -1 if interface >> 4 & 1 else 1

    def _write_ustep_count(self, data: int) -> None:
        self.axes[0, k.SEQ] = data

    def _write_interface(self, data: int) -> None:
        self._words[IF_CONFIGURATION] = data
        self.chip[k.INVREF] = data & 1
        self.chip[k.HALF] = data >> 2 & 1
        self.chip[k.EN_SD] = data >> 5 & 1
        self.chip[k.COMP_ON] = data >> 6 & 3 == 0  # the other motors do not exist here
        self._microstep(0)

    def _write_compare(self, data: int) -> None:
        self._words[POS_COMP] = data
        self.chip[k.COMP] = to_signed(data, 24)

    def _read_compare_interrupt(self) -> int:
        return int(self.chip[k.COMP_MASK]) << 8 | int(self.chip[k.COMP_FLAG])

    def _write_compare_interrupt(self, data: int) -> None:
        """Like the axis interrupts: 1 clears, and without the mask the flag is 0."""
        self.chip[k.COMP_MASK] = data >> 8
        self.chip[k.COMP_FLAG] &= ~data & data >> 8

    def _read_switches(self) -> int:
        return self._get(0, k.SR) | self._get(0, k.SL) << 1 | int(self.chip[k.GPIN]) << 3

    def _write_global(self, data: int) -> None:
        self._words[GLOBAL] = data
        self.chip[k.PULSE_LEN] = 16 * (1 + (data >> 8 & 0xF))
        self.chip[k.MOT1R] = data >> 21 & 1

    def describe_step_dir(self) -> StepDirState:
        """The output pins as the API tells them."""
        interface = self._words[IF_CONFIGURATION]
        sent = int(self.chip[k.SOUT])
        level = sent & 1 if interface >> 2 & 1 else int(self.chip[k.CLOCK] < self.chip[k.PULSE_END])
        return StepDirState(
            enabled=bool(interface >> 5 & 1),
            steps_sent=sent,
            steps_merged=int(self.chip[k.MERGED]),
            step_level=level ^ (interface >> 3 & 1),
            dir_level=int(self.axes[0, k.DIR] < 0) ^ (interface >> 4 & 1),
            pulse_clocks=int(self.chip[k.PULSE_LEN]),
        )
