"""The emulated TMC4210: step/direction output and position compare around one axis."""

from __future__ import annotations

from functools import partial

from ...registers.catalog import MODELS
from ...registers.tmc428.tmc4210 import TYPE_VERSION
from . import kernel as k
from .chip import CLK2_DIV_RESET, GLOBAL, LAST_INDEX, SWITCHES
from .options import EmulatorOptions
from .step_dir import IF_CONFIGURATION, TYPE, StepDirChip

RAM = 0x40
_RAM_MASK = 0x3F3F
_SDO_INT = 1 << 1


class Tmc4210(StepDirChip):
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
        self._writers[LAST_INDEX] = partial(self._write_ustep_count, 0)
        self._readers[SWITCHES] = self._read_switches
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
        self.axes[index, k.INC] = 1
        # Without en_sd no step leaves the chip (DS-TMC4210 1.4).
        self.axes[index, k.MINC] = self._direction if self._step_dir else 0

    def _read_switches(self) -> int:
        return self._get(0, k.SR) | self._get(0, k.SL) << 1 | int(self.chip[k.GPIN]) << 3

    def _write_global(self, data: int) -> None:
        self._words[GLOBAL] = data
        self._write_pulse_length(data)
        self.chip[k.MOT1R] = data >> 21 & 1
