"""What the firmware does with a TMC2660 in the second slot, behind a TMC4361: every datagram is a cover datagram of it.

Source: boards/TMC2660_eval.c of TMC-EvalSystem and tmc/ic/TMC2660 of TMC-API. The board's own step generator is there
and at rest: no command reaches it while the first slot has a motion controller. Its parameters 50 and 51 are known to
the firmware, and its status is told by function 2.
Open there, and decided here: an answer by cover datagram is the 20 bits that the driver sends, with none behind them.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from types import MappingProxyType

from ...registers.model import to_signed
from .functions import Parameters, Read, Write
from .refusal import invalid_value, wrong_type
from .registers import ChipRegisters

COVER_LOW, COVER_DRV_LOW = 0x6C, 0x6E
"""Of the TMC4361."""
RESPONSES, LATEST, WRITTEN = 3, 3, 1 << 3
"""How many kinds of answers there are; the address of the latest one; what registers that are written have besides."""
DRVCTRL, CHOPCONF, SMARTEN, SGCSCONF, DRVCONF = 0x8, 0xC, 0xD, 0xE, 0xF
WORD, STATUS = 0xF_FFFF, 0xFF
RDSEL_SHIFT = 4
PRESETS: Mapping[int, int] = MappingProxyType(
    {DRVCONF: 0xE_F040, DRVCTRL: 0, CHOPCONF: 0x9_1935, SMARTEN: 0xA_0000, SGCSCONF: 0xD_0505}
)
"""What a reset writes, in this order."""
CURRENT = (SGCSCONF, 0, 5)
MRES = (DRVCTRL, 0, 4)
FIELDS: Mapping[int, tuple[int, int, int]] = MappingProxyType(
    {160: (DRVCTRL, 9, 1), 161: (DRVCTRL, 8, 1), 162: (CHOPCONF, 15, 2), 163: (CHOPCONF, 14, 1), 164: (CHOPCONF, 11, 2),
     165: (CHOPCONF, 7, 4), 166: (CHOPCONF, 4, 3), 167: (CHOPCONF, 0, 4), 168: (SMARTEN, 15, 1), 169: (SMARTEN, 13, 2),
     170: (SMARTEN, 8, 4), 171: (SMARTEN, 5, 2), 172: (SMARTEN, 0, 4), 173: (SGCSCONF, 16, 1), 174: (SGCSCONF, 8, 7),
     175: (DRVCONF, 14, 2), 176: (DRVCONF, 12, 2), 177: (DRVCONF, 10, 1), 178: (DRVCONF, 8, 2), 179: (DRVCONF, 6, 1),
     183: (DRVCONF, 7, 1), 184: (CHOPCONF, 13, 1), 185: (DRVCONF, 16, 1)}
)  # fmt: skip
"""Axis parameters that are a field: register, lowest bit, width."""
COOLSTEP_CURRENT, LOAD_UPPER, LOAD = (2, 10, 5), (2, 15, 5), (1, 10, 10)
STEP_HZ = 1 << 17
STEP_STATUS_AT_REST = 0x10
"""Of the step generator: at its target."""
CURRENT_AT_FIRST = 5


class Tmc2660Board(Parameters):
    """`DriverFunctions` of a TMC2660 behind the TMC4361 whose registers these are."""

    board_id = 1

    def __init__(self, registers: ChipRegisters) -> None:
        self._registers = registers
        self._words: dict[int, int] = {}
        self._by_upper_bits = True
        kept = {6: CURRENT_AT_FIRST, 7: CURRENT_AT_FIRST, 50: 0, 51: STEP_HZ, 181: 0, 182: 0}
        self._kept = kept
        known: dict[int, tuple[Read, Write | None]] = {
            number: (partial(kept.__getitem__, number), partial(kept.__setitem__, number)) for number in kept
        }
        known |= {
            number: (partial(self._field, *place), partial(self._set_field, *place)) for number, place in FIELDS.items()
        }
        known |= {
            6: (known[6][0], self._set_current),
            7: (known[7][0], self._keep_current),
            29: (lambda: 0, None),
            140: (lambda: 8 - self._field(*MRES), self._set_resolution),
            174: (lambda: to_signed(self._field(*FIELDS[174]), FIELDS[174][2]), known[174][1]),
            180: (partial(self._field, *COOLSTEP_CURRENT), None),
            206: (self._load, None),
            208: (lambda: self._words.get(LATEST, 0) & STATUS, None),
        }
        super().__init__(known)

    def reset(self) -> None:
        """Write what the firmware writes after a reset."""
        for address, word in PRESETS.items():
            self.write(address, word)
        self._by_upper_bits = True

    def user_function(self, number: int, value: int) -> int:
        """Command 145. Function 0 would have registers written all the time, which changes nothing that can be seen."""
        if number == 1:
            self._by_upper_bits = value == 0
        elif number == 2:
            return STEP_STATUS_AT_REST
        elif number != 0:
            raise wrong_type()
        return value

    # --- registers -------------------------------------------------------------------------------

    def write(self, address: int, value: int) -> None:
        """Write 20 bits; an address without the bit of those that are written is ignored."""
        address &= 0xFF
        if address & WRITTEN:
            self._send((address & 7) << 17 | value & WORD)

    def read(self, address: int) -> int:
        """What was written, or an answer of the driver's that shows what is asked for."""
        address &= 0xF
        if address < RESPONSES:
            asking = self._words.get(DRVCONF, 0) & ~(3 << RDSEL_SHIFT) | address << RDSEL_SHIFT
            for _ in (1, 2):
                self._send(asking)
        return self._words.get(address, 0)

    def _send(self, datagram: int) -> None:
        self._registers.write(COVER_LOW, datagram)
        answer = self._registers.read(COVER_DRV_LOW) & WORD
        self._words[min(datagram >> RDSEL_SHIFT & 3, LATEST)] = answer
        self._words[LATEST] = answer
        register = datagram >> 17 & 7 if datagram >> 18 else 0
        self._words[WRITTEN | register] = datagram

    def _field(self, address: int, shift: int, width: int) -> int:
        return self.read(address) >> shift & (1 << width) - 1

    def _set_field(self, address: int, shift: int, width: int, value: int) -> None:
        mask = (1 << width) - 1 << shift
        self.write(address, self.read(address) & ~mask | value << shift & mask)

    # --- parameters of their own kind ------------------------------------------------------------

    def _set_current(self, value: int) -> None:
        self._keep_current(value)
        self._set_field(*CURRENT, value)

    def _keep_current(self, value: int) -> None:
        """Run and standby current are one behind a motion controller."""
        self._kept[6] = self._kept[7] = value

    def _set_resolution(self, microsteps: int) -> None:
        if microsteps not in (1 << power for power in range(9)):
            raise invalid_value()
        self._set_field(*MRES, 9 - microsteps.bit_length())

    def _load(self) -> int:
        return self._field(*LOAD_UPPER) << 5 if self._by_upper_bits else self._field(*LOAD)
