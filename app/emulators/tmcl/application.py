"""The program side of the module: memory, registers, control commands (FM-PD42-1241 3.3, 3.5.5, 3.6.36).

What executes a program is `interpreter`. Open in all sources, and decided here: where memory ends a download is
answered with status 4, a protected memory with status 5; a state of "reset" lasts no time at all; entering download
mode stops a program, and none can be run or stepped in it (status 6); a reset also disables all interrupts and forgets
their vectors.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ...registers.tmcl.commands import PROGRAM_COMMANDS, Opcode, Status
from ...registers.tmcl.pd42_globals import VARIABLES
from . import interpreter_kernel as k
from .eeprom import COMMAND_BYTES, Eeprom
from .refused import Refused, invalid_value, wrong_type

STOPPED, RUNS, STEPS = 0, 1, 2
INTERRUPTS = frozenset({0, 1, 2, 3, 15, 21, 27, 28, 39, 40, 41, 42})
"""Timers, position reached, StallGuard, deviation, stop switches, inputs (sister module's table; FM-PD42-1241's is
lost)."""
ALL_INTERRUPTS = 255
PROTECT_READ, PROTECT_WRITE = 1, 2
_FLAG_NAMES = {
    k.ZERO: "ZERO", k.EQUAL: "EQUAL", k.LOWER: "LOWER", k.GREATER: "GREATER",
    k.ETO: "ETO", k.EAL: "EAL", k.EDV: "EDV", k.EPO: "EPO",
}  # fmt: skip


def wrapped(value: int) -> int:
    """An int of any size as the signed 32 bits that a register holds."""
    return (value + (1 << 31) & 0xFFFF_FFFF) - (1 << 31)


class Application:
    """Program memory and interpreter registers. Memory is the EEPROM's, all else is gone without power."""

    def __init__(self, eeprom: Eeprom, later: bool = False) -> None:
        """`later`: the firmware knows the commands of later ones."""
        self.eeprom = eeprom
        self._later = later
        self.registers = k.registers(later)
        """As `interpreter_kernel` counts its cells."""
        self.variables = np.zeros(VARIABLES, dtype=np.int64)
        """User variables, bank 2 of the global parameters."""
        self.code = np.zeros((PROGRAM_COMMANDS, 4), dtype=np.int64)
        """The program as rows of opcode, type, motor and value."""
        self.changed: Callable[[bool], None] = lambda fresh: None
        """Called when a control command has changed what the interpreter does; `fresh`: it begins anew."""
        self.enabled: Callable[[int], None] = lambda number: None
        """Hears the number of each interrupt that is enabled."""
        self.power_on(autostart=False)

    def power_on(self, autostart: bool) -> None:
        """Everything as after switching on; `autostart` runs the program from its start (FM-PD42-1241 8.7)."""
        self.pointer = 0
        self.downloading = False
        self.last_error = 0
        """Status of the latest command of a program that was refused; 0 for none."""
        self._load()
        self._clear()
        self.status = RUNS if autostart else STOPPED
        self.changed(True)

    @property
    def counter(self) -> int:
        """The program counter: of the command that comes next, or that waits."""
        return int(self.registers[k.PC])

    @counter.setter
    def counter(self, address: int) -> None:
        self.registers[k.PC] = address

    @property
    def accumulator(self) -> int:
        return int(self.registers[k.ACCUMULATOR])

    @property
    def x(self) -> int:
        return int(self.registers[k.X])

    @property
    def flags(self) -> list[str]:
        """Those that are set, by name."""
        return [name for bit, name in _FLAG_NAMES.items() if self.registers[k.FLAGS] & bit]

    @property
    def stack(self) -> list[int]:
        """Where subroutines return to, the innermost last."""
        return [int(address) for address in self.registers[k.STACK : k.STACK + int(self.registers[k.DEPTH])]]

    def load_accumulator(self, value: int) -> None:
        """What a command of a program has read; the zero flag follows (see `interpreter_kernel`)."""
        self.registers[k.ACCUMULATOR] = wrapped(value)
        self.registers[k.FLAGS] &= ~k.ZERO
        if not value:
            self.registers[k.FLAGS] |= k.ZERO

    def raise_flag(self, flag: int) -> None:
        """An error flag of `interpreter_kernel`."""
        self.registers[k.FLAGS] |= flag

    # --- control commands ------------------------------------------------------------------------

    def stop(self) -> None:
        """Command 128."""
        self.status = STOPPED
        self.changed(False)

    def run(self, how: int, address: int) -> None:
        """Command 129: type 0 from where the counter is, type 1 from `address`."""
        self._require_normal()
        if how == 1:
            self.counter = _address(address)
        elif how != 0:
            raise wrong_type()
        self.status = RUNS
        self.changed(how == 1)

    def step(self) -> None:
        """Command 130. The state stays "step" after the command is done."""
        self._require_normal()
        self.status = STEPS
        self.changed(False)

    def reset(self) -> None:
        """Command 131: counter, accumulator and X are 0, flags cleared."""
        self.status = STOPPED
        self._clear()
        self.changed(True)

    def enter_download(self, address: int, protection: int) -> None:
        """Command 132: from now on commands are stored, the first at `address`."""
        if protection & PROTECT_WRITE:
            raise Refused(Status.EEPROM_LOCKED)
        self.pointer = _address(address)
        self.status = STOPPED
        self.downloading = True
        self.changed(False)

    def leave_download(self) -> None:
        """Command 133. The program is in the EEPROM from here on."""
        if self.downloading:
            self.downloading = False
            self.eeprom.save()

    def store(self, command: bytes) -> None:
        """Put `command` (7 bytes) where the pointer is. What it says is not looked at before it runs."""
        if self.pointer >= PROGRAM_COMMANDS:
            raise invalid_value()
        self.eeprom.program[self.pointer] = command
        self.code[self.pointer] = _row(command)
        self.pointer += 1

    def erase(self) -> None:
        """Forget the program."""
        self.eeprom.program.clear()
        self._load()

    def stored(self, address: int, protection: int) -> bytes:
        """Command 134: the seven bytes at `address`; zeros where nothing was stored."""
        if protection & PROTECT_READ:
            raise Refused(Status.EEPROM_LOCKED)
        return self.eeprom.program.get(_address(address), bytes(COMMAND_BYTES))

    def told(self, what: int, waits: bool) -> int:
        """Command 135. How types 0 and 1 are packed is open; here: state, wait flag, then 16 bits of place."""
        if what == 0:
            return self.status << 24 | waits << 16 | self.pointer
        if what == 1:
            return self.status << 24 | waits << 16 | self.counter
        if what == 2:
            return self.accumulator
        if what == 3:
            return self.x
        raise wrong_type()

    # --- commands of programs that also work in direct mode ---------------------------------------

    def execute(self, opcode: Opcode, type_: int, value: int = 0, motor: int = 0) -> None:
        """CALC, CALCX or CLE in direct mode (FM-PD42-1241 3.6.14, 3.6.26, 3.6.29), or their kin: the counter stays."""
        counter = self.counter
        status = int(k.execute(self.registers, self.variables, int(opcode), type_, motor, value))
        if status != k.DONE:
            raise Refused(Status(status))
        self.counter = counter

    def switch_interrupt(self, number: int, on: bool) -> None:
        """EI and DI (FM-PD42-1241 3.6.30 and 3.6.31); 255 switches all of them."""
        if number not in INTERRUPTS and number != ALL_INTERRUPTS:
            raise wrong_type()
        if on:
            self.interrupts.add(number)
            self.enabled(number)
        else:
            self.interrupts.discard(number)

    def set_vector(self, number: int, address: int) -> None:
        """VECT (FM-PD42-1241 3.6.32)."""
        if number not in INTERRUPTS:
            raise wrong_type()
        self.vectors[number] = _address(address)

    # --- within ----------------------------------------------------------------------------------

    def _clear(self) -> None:
        self.registers[:] = k.registers(self._later)
        self.interrupts: set[int] = set()
        self.vectors: dict[int, int] = {}

    def _load(self) -> None:
        self.code[:] = 0
        for address, command in self.eeprom.program.items():
            self.code[address] = _row(command)

    def _require_normal(self) -> None:
        if self.downloading:
            raise Refused(Status.NOT_AVAILABLE)


def _row(command: bytes) -> tuple[int, int, int, int]:
    return command[0], command[1], command[2], int.from_bytes(command[3:7], "big", signed=True)


def _address(address: int) -> int:
    if not 0 <= address < PROGRAM_COMMANDS:
        raise invalid_value()
    return address
