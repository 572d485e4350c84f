"""The emulated TMC429: a TMC428 with step/direction outputs for its three motors, and a position compare.

What is in its RAM after power-on is inferred: the sheet says a default for a chain of TMC23x and TMC24x (DS-TMC429
1.5.5), here the one that its examples write (11.4.2, 11.5). The pause of a pulse after a change of direction (10.1) is
not emulated.
"""

from __future__ import annotations

import math
from functools import partial

from ...calc.driver_chain.chain import build_chain
from ...calc.driver_chain.ram_words import unpack_words
from ...calc.microsteps.table import design_table
from ...registers.tmc428.tmc4210 import TYPE_VERSION
from . import kernel as k
from .chip import DIVIDERS, GLOBAL, LAST_INDEX
from .options import EmulatorOptions
from .sequencer import increment
from .step_dir import TYPE, StepDirChip
from .tmc428 import STAGE_UNITS, Tmc428

DRIVERS = ("tmc236", "tmc236", "tmc236")
_CELLS = 64


class Tmc429(StepDirChip, Tmc428):
    """The chip, its three drivers and their stages.

    With en_sd the motors follow the step outputs, each step as wide as a microstep of the step/direction drivers; no
    datagram leaves for the chain then, and multiplexed switches are not sampled (DS-TMC429 p. 43).
    """

    name = "tmc429"

    def _units(self, options: EmulatorOptions) -> int:
        """Fine enough for microsteps of either kind."""
        return math.lcm(STAGE_UNITS, options.driver_microsteps)

    def _power_on_ram(self) -> list[int]:
        chain = list(unpack_words(build_chain(DRIVERS).ram_words))
        return [*chain, *[0] * (_CELLS - len(chain)), *design_table().values]

    def _reset(self) -> None:
        super()._reset()
        self._words[TYPE] = TYPE_VERSION
        self._write_interface(0)

    def _map_registers(self) -> None:
        super()._map_registers()
        for index in range(self.model.axes):
            self._readers[index << 4 | LAST_INDEX] = partial(self._get, index, k.SEQ)
            self._writers[index << 4 | LAST_INDEX] = partial(self._write_ustep_count, index)

    def _write_interface(self, data: int) -> None:
        self._settle_datagrams()
        self.chip[k.EN_REFR] = data >> 8 & 1
        super()._write_interface(data)

    def _write_global(self, data: int) -> None:
        super()._write_global(data)
        self._write_pulse_length(data)

    def _microstep(self, index: int) -> None:
        """A step of the sequencer is a step of the motor, as wide as usrs says or the step/direction driver."""
        width = increment(self._words[index << 4 | DIVIDERS] & 7)
        self.axes[index, k.INC] = width
        if self._step_dir:
            moved = self._direction * self.stage_units // self.options.driver_microsteps
        else:
            turned = self._words[GLOBAL] >> 4 & 1
            moved = (-width if turned else width) * self.stage_units // STAGE_UNITS
        self.axes[index, k.MINC] = moved
