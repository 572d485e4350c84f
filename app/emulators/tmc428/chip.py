"""What the emulated TMC428 and TMC4210 share: time, power, the 32-bit datagram and the axis registers.

A chip here knows clocks, not seconds. The status byte of a reply and the data of a read are as of the
falling edge of the chip select; a write takes effect after that (DS-TMC428 6.2).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from functools import partial

import numpy as np

from ...registers.catalog import Model
from ...registers.model import to_signed
from . import kernel as k
from . import stage
from .options import EmulatorOptions, StageOptions
from .recording import record

_WORD = 0xFF_FFFF
ADDRESSES = 128

# Registers of an axis, by the low four address bits (DS-TMC428 Table 7-2; DS-TMC4210 5.3).
(X_TARGET, X_ACTUAL, V_MIN, V_MAX, V_TARGET, V_ACTUAL, A_MAX, A_ACTUAL) = range(8)
(CURRENT, PMUL_PDIV, MODE, INTERRUPT, DIVIDERS, DX_REF, X_LATCHED, LAST_INDEX) = range(8, 16)
POWER_DOWN, SWITCHES, GLOBAL = 0x38, 0x3E, 0x3F
CLK2_DIV_RESET = 15 << 8
"""The only register bits that are set after power-on: clk2_div of a TMC428, STPDIV of a TMC4210 (DS-TMC428 7.3)."""

VELOCITY_MODE, HOLD_MODE = 2, 3
FASTEST = 2047


class Chip(ABC):
    """One chip with its stages. `exchange` answers a 32-bit word at a clock count that never goes back."""

    kind: int

    def __init__(self, model: Model, options: EmulatorOptions, stage_units: int) -> None:
        self.model = model
        self.options = options
        self.stage_units = stage_units
        self.axes = np.zeros((model.axes, k.AXIS_COLUMNS), dtype=np.int64)
        self.chip = np.zeros(k.CHIP_CELLS + (k.LOG_CELLS if options.drivers else 0), dtype=np.int64)
        self.powered_down = False
        self.power_cycles = 0
        self._offset = 0
        self._asleep_since = 0
        self._clock = 0
        self._words = [0] * ADDRESSES
        self._masks = [0] * ADDRESSES
        for register in model.table:
            self._masks[register.address] = register.mask & _WORD
        self._readers: list[Callable[[], int]] = [partial(self._word, address) for address in range(ADDRESSES)]
        self._writers: list[Callable[[int], None] | None] = [None] * ADDRESSES
        self._map_registers()
        for index in range(model.axes):
            given = options.stages[index] if index < len(options.stages) else StageOptions()
            stage.place(self.axes[index], given, stage_units)
        self._power_on()

    # --- power and time --------------------------------------------------------------------------

    def _power_on(self) -> None:
        """All registers 0 but the divider (DS-TMC428 6.1); carriages and inputs are not the chip's."""
        mechanics = self.axes[:, stage.KEPT_WITHOUT_POWER].copy()
        general_input = self.chip[k.GPIN]
        self.axes[:] = 0
        self.chip[:] = 0
        self.axes[:, stage.KEPT_WITHOUT_POWER] = mechanics
        self.axes[:, k.PMUL] = 128
        self.axes[:, k.PSH] = 3
        self.axes[:, k.DIR] = 1
        self.axes[:, k.GDIR] = 1
        self.axes[:, k.STOPT] = -k.NEVER
        self.chip[k.GPIN] = general_input
        self.chip[k.NAXES] = self.model.axes
        self.chip[k.KIND] = self.kind
        self._words = [0] * ADDRESSES
        self.powered_down = False
        self._reset()
        k.refresh(self.axes, self.chip)

    def power_cycle(self, clock: int) -> None:
        """Off and on at clock count `clock`: its own clocks count from here."""
        self.advance(clock)
        self.power_cycles += 1
        self._offset = clock
        self._power_on()

    def advance(self, clock: int) -> int:
        """Catch up to `clock` clocks of the outside; returns the status byte. In power-down nothing moves."""
        if self.powered_down:
            clock = self._asleep_since
        status: int = k.advance(self.axes, self.chip, clock - self._offset)
        return status

    def record(self, clocks: k.Cells) -> k.Cells:
        """Catch up to the last of `clocks` of the outside, which rise: by each the steps sent, a column an axis."""
        sent = np.zeros((len(clocks), self.model.axes), dtype=np.int64)
        if self.powered_down:
            sent[:] = self.axes[:, k.NET]
        else:
            record(self.axes, self.chip, clocks - self._offset, sent)
        return sent

    @property
    def quiet(self) -> bool:
        """Nothing happens until a register is written."""
        if self.powered_down:
            return True
        chip, axes = self.chip, self.axes
        sending = chip[k.BUSY] or chip[k.REQ] or chip[k.CU]
        return not sending and bool((axes[:, k.STEADY] != 0).all()) and not axes[:, k.V8].any()

    def exchange(self, word: int, clock: int) -> int:
        """The 32-bit reply to a 32-bit datagram at `clock` clocks of the outside."""
        if self.powered_down:  # the falling edge of the chip select wakes the chip (DS-TMC428 9.5)
            self.powered_down = False
            self._offset += clock - self._asleep_since
            k.refresh(self.axes, self.chip)
        status = self.advance(clock)
        self._clock = clock
        address = word >> 25
        data = 0
        if word >> 24 & 1:
            data = self._readers[address]()
        else:
            writer = self._writers[address]
            if writer is not None:
                writer(word & self._masks[address])
                k.refresh(self.axes, self.chip)
        return status << 24 | data

    @property
    def general_input(self) -> bool:
        """Level of the general purpose input."""
        return bool(self.chip[k.GPIN])

    def set_general_input(self, level: bool) -> None:
        """Put a level on the general purpose input (the TMC428 has none: nothing happens)."""
        self.chip[k.GPIN] = level

    def refresh(self) -> None:
        """After a change outside the chip; a chip without clocks does not notice yet."""
        if not self.powered_down:
            k.refresh(self.axes, self.chip)

    # --- registers -------------------------------------------------------------------------------

    @abstractmethod
    def _reset(self) -> None:
        """Power-on values of what the subclass adds."""

    @abstractmethod
    def _microstep(self, index: int) -> None:
        """Take over the sequencer's and the stage's increments of an axis."""

    def _map_registers(self) -> None:
        for index in range(self.model.axes):
            base = index << 4
            readers: dict[int, Callable[[int], int]] = {
                X_ACTUAL: self._read_x_actual,
                V_TARGET: self._read_v_target,
                V_ACTUAL: self._read_v_actual,
                A_ACTUAL: self._read_a_actual,
                MODE: self._read_mode,
                INTERRUPT: self._read_interrupt,
                PMUL_PDIV: self._read_pmul_pdiv,
                X_LATCHED: self._read_x_latched,
            }
            writers: dict[int, Callable[[int, int], None]] = {
                X_TARGET: self._write_x_target,
                X_ACTUAL: self._write_x_actual,
                V_MIN: partial(self._write_plain, V_MIN, k.VMIN),
                V_MAX: partial(self._write_plain, V_MAX, k.VMAX),
                A_MAX: partial(self._write_plain, A_MAX, k.AMAX),
                DX_REF: partial(self._write_plain, DX_REF, k.DX),
                V_TARGET: self._write_v_target,
                V_ACTUAL: self._write_v_actual,
                PMUL_PDIV: self._write_pmul_pdiv,
                MODE: self._write_mode,
                INTERRUPT: self._write_interrupt,
                DIVIDERS: self._write_dividers,
                X_LATCHED: self._arm_latch,
            }
            for register, reader in readers.items():
                self._readers[base | register] = partial(reader, index)
            for register, writer in writers.items():
                self._writers[base | register] = partial(writer, index)
        self._writers[POWER_DOWN] = self._power_down

    def _word(self, address: int) -> int:
        return self._words[address]

    def _get(self, index: int, column: int) -> int:
        return int(self.axes.item(index, column))

    def _read_x_actual(self, index: int) -> int:
        return self._get(index, k.X) & _WORD

    def _read_v_target(self, index: int) -> int:
        return self._get(index, k.VT) & 0xFFF

    def _read_v_actual(self, index: int) -> int:
        # Sign and magnitude inside: 0 reads back for anything between -1 and 1 (DS-TMC428 8.6).
        v8 = self._get(index, k.V8)
        return (v8 >> 8 if v8 >= 0 else -(-v8 >> 8)) & 0xFFF

    def _read_a_actual(self, index: int) -> int:
        """Mean of the last four ramp ticks, fraction dropped.

        The sheets say only that the read-out is smoothed (DS-TMC428 8.8); over how long is our choice.
        """
        total = sum(self._get(index, column) for column in (k.A0, k.A1, k.A2, k.A3))
        return (total // 4 if total >= 0 else -(-total // 4)) & 0xFFF

    def _read_mode(self, index: int) -> int:
        return self._words[index << 4 | MODE] | self._get(index, k.LP) << 16

    def _read_interrupt(self, index: int) -> int:
        return self._get(index, k.MASK) << 8 | self._get(index, k.FLAGS)

    def _read_pmul_pdiv(self, index: int) -> int:
        return self._words[index << 4 | PMUL_PDIV] | 0x8000

    def _read_x_latched(self, index: int) -> int:
        return self._get(index, k.XL) & _WORD

    def _write_plain(self, register: int, column: int, index: int, data: int) -> None:
        self._words[index << 4 | register] = data
        self.axes[index, column] = data

    def _write_x_target(self, index: int, data: int) -> None:
        self._words[index << 4 | X_TARGET] = data
        self.axes[index, k.XT] = to_signed(data, 24)

    def _write_x_actual(self, index: int, data: int) -> None:
        self.axes[index, k.X] = to_signed(data, 24)

    def _write_v_target(self, index: int, data: int) -> None:
        self.axes[index, k.VT] = to_signed(data, 12)

    def _write_v_actual(self, index: int, data: int) -> None:
        """Only in HOLD_MODE, unless the options say otherwise; hidden bits become 0. The magnitude has 11 bits, so
        -2048 becomes -2047."""
        axis = self.axes[index]
        in_velocity_mode = axis[k.MODE] == VELOCITY_MODE and self.options.v_actual_writable == "velocity-mode"
        if axis[k.MODE] != HOLD_MODE and not in_velocity_mode:
            return
        v8 = max(to_signed(data, 12), -FASTEST) * 256
        if v8 == 0 and axis[k.V8] != 0:
            axis[k.STOPT] = self.chip[k.TICK]
        axis[k.V8] = v8
        axis[k.STOPPING] = 0

    def _write_pmul_pdiv(self, index: int, data: int) -> None:
        self._words[index << 4 | PMUL_PDIV] = data
        self.axes[index, k.PMUL] = 128 | data >> 8
        self.axes[index, k.PSH] = 3 + (data & 0xF)

    def _write_mode(self, index: int, data: int) -> None:
        data &= 0xFFFF  # lp is read-only
        self._words[index << 4 | MODE] = data
        axis = self.axes[index]
        axis[k.MODE] = data & 3
        axis[k.DISL] = data >> 8 & 1
        axis[k.DISR] = data >> 9 & 1
        axis[k.SOFT] = data >> 10 & 1
        axis[k.REFR] = data >> 11 & 1

    def _write_interrupt(self, index: int, data: int) -> None:
        """Masks are set, flags cleared by a 1; a flag without its mask is 0 (DS-TMC428 8.13)."""
        axis = self.axes[index]
        axis[k.MASK] = data >> 8
        axis[k.FLAGS] &= ~data & data >> 8

    def _write_dividers(self, index: int, data: int) -> None:
        axis = self.axes[index]
        previous = int(axis[k.PD])
        self._words[index << 4 | DIVIDERS] = data
        axis[k.RD] = data >> 8 & 0xF
        axis[k.PD] = data >> 12 & 0xF
        self._microstep(index)
        if int(axis[k.PD]) != previous and axis[k.MODE] in (VELOCITY_MODE, HOLD_MODE):
            self._force_microstep(index)

    def _force_microstep(self, index: int) -> None:
        """Changing pulse_div outside RAMP_MODE may force an internal microstep (DS-TMC428 8.14).

        The sheet says neither when nor where to. Our choice: from an odd microstep position the sequencer
        goes on by one in the last direction, the driver sees it, and x_actual does not count it; from an
        even one nothing happens. SOFT_MODE counts as RAMP_MODE here.
        """
        axis = self.axes[index]
        if int(axis[k.SEQ]) // int(axis[k.INC]) & 1:
            axis[k.SEQ] = (axis[k.SEQ] + axis[k.DIR] * axis[k.INC]) & 0xFF
            axis[k.MECH] += axis[k.DIR] * axis[k.MINC]
            axis[k.STEPS] += 1
            self.chip[k.REQ] = 1
            if self.chip[k.EN_SD]:
                axis[k.SOUT] += 1
                axis[k.NET] += axis[k.DIR]

    def _arm_latch(self, index: int, _data: int) -> None:
        self.axes[index, k.LP] = 1

    def _power_down(self, _data: int) -> None:
        self.powered_down = True
        self._asleep_since = self._clock
