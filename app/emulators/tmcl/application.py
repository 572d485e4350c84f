"""The program side of the module: memory, run state, accumulator, flags (FM-PD42-1241 3.3, 3.5.5, 3.6.36).

A program is stored and its run state kept, but nothing executes it: after RUN the state says "runs" and the counter
stays on the command that would come next. So nothing is ever shown as done that was not done. Open in all sources, and
decided here: where memory ends a download is answered with status 4, a protected memory with status 5, and a state of
"reset" lasts no time at all.
"""

from __future__ import annotations

from ...registers.tmcl.commands import BY_MNEMONIC, Status
from .eeprom import COMMAND_BYTES, PROGRAM_COMMANDS, Eeprom
from .refused import Refused, invalid_value, wrong_type

STOPPED, RUNS, STEPS = 0, 1, 2
INTERRUPTS = frozenset({0, 1, 2, 3, 15, 21, 27, 28, 39, 40, 41, 42})
"""Timers, position reached, StallGuard, deviation, stop switches, inputs (sister module's table; FM-PD42-1241's is
lost)."""
ALL_INTERRUPTS = 255
_ADD, _SUB, _MUL, _DIV, _MOD, _AND, _OR, _XOR, _NOT, _LOAD, _SWAP = range(11)
_ALL_FLAGS = 0
PROTECT_READ, PROTECT_WRITE = 1, 2


def wrapped(value: int) -> int:
    """An int of any size as the signed 32 bits that a register holds."""
    return (value + (1 << 31) & 0xFFFF_FFFF) - (1 << 31)


def calculate(operation: int, left: int, right: int) -> int:
    """`left` operation `right`, wrapped to 32 bits (FM-PD42-1241 3.6.14).

    Open, and decided here: logic is bitwise, a remainder has the sign of the dividend, division by zero is refused.
    Raises Refused: status 3 for an unknown operation, 4 for a division by zero.
    """
    if operation in (_DIV, _MOD):
        if right == 0:
            raise invalid_value()
        quotient = abs(left) // abs(right)
        quotient = quotient if (left < 0) == (right < 0) else -quotient
        return wrapped(quotient if operation == _DIV else left - quotient * right)
    if operation == _ADD:
        return wrapped(left + right)
    if operation == _SUB:
        return wrapped(left - right)
    if operation == _MUL:
        return wrapped(left * right)
    if operation == _AND:
        return left & right
    if operation == _OR:
        return left | right
    if operation == _XOR:
        return left ^ right
    raise wrong_type()


class Application:
    """Program memory and interpreter registers. Memory is the EEPROM's, all else is gone without power."""

    def __init__(self, eeprom: Eeprom) -> None:
        self.eeprom = eeprom
        self.power_on(autostart=False)

    def power_on(self, autostart: bool) -> None:
        """Everything as after switching on; `autostart` runs the program from its start (FM-PD42-1241 8.7)."""
        self.status = RUNS if autostart else STOPPED
        self.counter = 0
        self.pointer = 0
        self.downloading = False
        self.accumulator = 0
        self.x = 0
        self.error_flags: set[int] = set()
        self.interrupts: set[int] = set()

    # --- control commands ------------------------------------------------------------------------

    def stop(self) -> None:
        """Command 128."""
        self.status = STOPPED

    def run(self, how: int, address: int) -> None:
        """Command 129: type 0 from where the counter is, type 1 from `address`."""
        if how == 1:
            self.counter = _address(address)
        elif how != 0:
            raise wrong_type()
        self.status = RUNS

    def step(self) -> None:
        """Command 130. Nothing executes, so the counter stays."""
        self.status = STEPS

    def reset(self) -> None:
        """Command 131: counter, accumulator and X are 0, flags cleared."""
        self.status = STOPPED
        self.counter = self.accumulator = self.x = 0
        self.error_flags.clear()

    def enter_download(self, address: int, protection: int) -> None:
        """Command 132: from now on commands are stored, the first at `address`."""
        if protection & PROTECT_WRITE:
            raise Refused(Status.EEPROM_LOCKED)
        self.pointer = _address(address)
        self.status = STOPPED
        self.downloading = True

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
        self.pointer += 1

    def stored(self, address: int, protection: int) -> bytes:
        """Command 134: the seven bytes at `address`; zeros where nothing was stored."""
        if protection & PROTECT_READ:
            raise Refused(Status.EEPROM_LOCKED)
        return self.eeprom.program.get(_address(address), bytes(COMMAND_BYTES))

    def told(self, what: int) -> int:
        """Command 135. How types 0 and 1 are packed is open; here: state, wait flag, then 16 bits of place."""
        if what == 0:
            return self.status << 24 | self.pointer
        if what == 1:
            return self.status << 24 | self.counter
        if what == 2:
            return self.accumulator
        if what == 3:
            return self.x
        raise wrong_type()

    # --- commands of programs that also work in direct mode ---------------------------------------

    def calc(self, operation: int, operand: int) -> None:
        """CALC (FM-PD42-1241 3.6.14)."""
        if operation == _NOT:
            self.accumulator = ~self.accumulator
        elif operation == _LOAD:
            self.accumulator = operand
        else:
            self.accumulator = calculate(operation, self.accumulator, operand)

    def calcx(self, operation: int) -> None:
        """CALCX (FM-PD42-1241 3.6.26). Its results go to the accumulator, so NOT is taken to leave X alone."""
        if operation == _NOT:
            self.accumulator = ~self.x
        elif operation == _LOAD:
            self.x = self.accumulator
        elif operation == _SWAP:
            self.accumulator, self.x = self.x, self.accumulator
        else:
            self.accumulator = calculate(operation, self.accumulator, self.x)

    def clear_errors(self, flag: int) -> None:
        """CLE (FM-PD42-1241 3.6.29)."""
        if flag not in BY_MNEMONIC["CLE"].types.values():
            raise wrong_type()
        if flag == _ALL_FLAGS:
            self.error_flags.clear()
        else:
            self.error_flags.discard(flag)

    def switch_interrupt(self, number: int, on: bool) -> None:
        """EI and DI (FM-PD42-1241 3.6.30 and 3.6.31); 255 switches all of them."""
        if number not in INTERRUPTS and number != ALL_INTERRUPTS:
            raise wrong_type()
        if on:
            self.interrupts.add(number)
        else:
            self.interrupts.discard(number)


def _address(address: int) -> int:
    if not 0 <= address < PROGRAM_COMMANDS:
        raise invalid_value()
    return address
