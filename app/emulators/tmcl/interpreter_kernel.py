"""Commands of a program that touch nothing but the interpreter's own registers and user variables, compiled.

Both functions share this file because numba's disk cache only notices changes of the file that a function stands in.
Open in all sources, and decided here: logic is bitwise; results wrap to 32 bits; a remainder has the sign of the
dividend; CALCX NOT puts the inverted X into the accumulator; COMP leaves the zero flag alone, which follows every value
that comes into the accumulator; jumps out of the memory and divisions by zero are refused with status 4, unknown types
with status 3. Of later firmware's commands: the zero flag follows what comes into a variable, or into X, as well; NOT
inverts what is on the right (CALCV: the variable), COMP compares left with right; RST leaves interrupts alone.
"""

# numpy's stubs type a cell as Any; inside compiled code it is an int64 and nothing else.
# mypy: disable-error-code="no-any-return"

from __future__ import annotations

from typing import Any

import numpy as np

from ...kernels import Kernels
from ...registers.tmcl import commands

PC, ACCUMULATOR, X, FLAGS, DEPTH, STACK = 0, 1, 2, 3, 4, 5
"""Cells of the registers; `DEPTH` counts the entries of the stack."""
STACK_DEPTH = 8
"""Nested calls (FM-PD42-1241 3.6.18)."""
LATER = STACK + STACK_DEPTH
"""Whether the firmware knows the commands of later ones."""
CELLS = LATER + 1
EQUAL, LOWER, GREATER, ZERO, ETO, EAL, EDV, EPO = 1, 2, 4, 8, 16, 32, 64, 128
"""Flags (bits as in the maker's TMC562-EVAL header, which no module shows)."""
ERRORS = ETO | EAL | EDV | EPO
DONE, ELSEWHERE = 100, 0
"""What `execute` answers besides statuses of refusals: done, or a command that touches more than this."""

_SGP, _GGP, _CALC, _COMP, _JC, _JA, _CSUB, _RSUB = 9, 10, 19, 20, 21, 22, 23, 24
_CALCX, _AGP, _CLE = 33, 35, 36
_CALCVV, _CALCVA, _CALCAV, _CALCVX, _CALCXV, _CALCV, _RST, _DJNZ, _SIV, _GIV, _AIV = (
    40,
    41,
    42,
    43,
    44,
    45,
    48,
    49,
    55,
    56,
    57,
)
_CALL = 80
_USER_VARIABLES = 2
_ADD, _SUB, _MUL, _DIV, _MOD, _AND, _OR, _XOR, _NOT, _LOAD, _SWAP, _COMPARE = range(12)
_WRONG_TYPE, _INVALID_VALUE = 3, 4

PROGRAM_COMMANDS = commands.PROGRAM_COMMANDS
_KERNELS = Kernels(__file__, commands.__file__, plain=True)
_compiled, _inlined = _KERNELS.compiled, _KERNELS.inlined


def registers(later: bool = False) -> np.ndarray[Any, np.dtype[np.int64]]:
    """All at zero, but for the zero flag, which says so; `later` as in `LATER`."""
    cells = np.zeros(CELLS, dtype=np.int64)
    cells[FLAGS], cells[LATER] = ZERO, later
    return cells


@_inlined
def _wrap32(value: int) -> int:
    return ((value + 0x80000000) & 0xFFFFFFFF) - 0x80000000


@_inlined
def load(r: Any, value: int) -> None:
    """Put what comes into the accumulator there; the zero flag follows."""
    r[ACCUMULATOR] = value
    r[FLAGS] = r[FLAGS] & ~ZERO if value else r[FLAGS] | ZERO


@_inlined
def _result(operation: int, left: int, right: int) -> int:
    """Of ADD to XOR, with no division by zero."""
    if operation == _ADD:
        return _wrap32(left + right)
    if operation == _SUB:
        return _wrap32(left - right)
    if operation == _MUL:
        return _wrap32(left * right)
    if operation == _AND:
        return left & right
    if operation == _OR:
        return left | right
    if operation == _XOR:
        return left ^ right
    quotient = abs(left) // abs(right)
    if (left < 0) != (right < 0):
        quotient = -quotient
    return _wrap32(quotient if operation == _DIV else left - quotient * right)


@_inlined
def _calculate(r: Any, operation: int, right: int) -> int:
    if operation < 0 or operation > _XOR:
        return _WRONG_TYPE
    if right == 0 and operation in (_DIV, _MOD):
        return _INVALID_VALUE
    load(r, _result(operation, r[ACCUMULATOR], right))
    return DONE


@_inlined
def _compare(r: Any, left: int, right: int) -> None:
    r[FLAGS] = r[FLAGS] & ~(EQUAL | LOWER | GREATER) | (EQUAL if left == right else LOWER if left < right else GREATER)


@_inlined
def _put(r: Any, variables: Any, place: int, value: int) -> None:
    """Into a user variable, or into what the places below 0 stand for; the zero flag follows."""
    if place == -ACCUMULATOR:
        r[ACCUMULATOR] = value
    elif place == -X:
        r[X] = value
    else:
        variables[place] = value
    r[FLAGS] = r[FLAGS] & ~ZERO if value else r[FLAGS] | ZERO


@_inlined
def _holds(flags: int, condition: int) -> bool:
    if condition == 0:
        return flags & ZERO != 0
    if condition == 1:
        return flags & ZERO == 0
    if condition == 2:
        return flags & EQUAL != 0
    if condition == 3:
        return flags & EQUAL == 0
    if condition == 4:
        return flags & GREATER != 0
    if condition == 5:
        return flags & (GREATER | EQUAL) != 0
    if condition == 6:
        return flags & LOWER != 0
    if condition == 7:
        return flags & (LOWER | EQUAL) != 0
    return flags & (ETO << (condition - 8)) != 0


@_compiled
def _later(r: Any, variables: Any, opcode: int, type_: int, motor: int, value: int) -> int:
    """Commands of later firmware (TMCM-1290): as `execute`."""
    pc = r[PC] + 1
    if opcode >= _CALCVV and opcode <= _CALCV:
        if type_ < 0 or type_ > _COMPARE or (opcode == _CALCV and type_ == _SWAP):
            return _WRONG_TYPE
        if opcode == _CALCVV and (value < 0 or value > 255):
            return _INVALID_VALUE
        place = -ACCUMULATOR if opcode == _CALCAV else -X if opcode == _CALCXV else motor
        left = r[-place] if place < 0 else variables[place]
        if opcode == _CALCVV:
            other, right = value, variables[value]
        elif opcode == _CALCVA:
            other, right = -ACCUMULATOR, r[ACCUMULATOR]
        elif opcode == _CALCVX:
            other, right = -X, r[X]
        elif opcode == _CALCV:
            other, right = motor, left if type_ == _NOT else value
        else:
            other, right = motor, variables[motor]
        if type_ == _COMPARE:
            _compare(r, left, right)
        elif type_ == _NOT:
            _put(r, variables, place, ~right)
        elif type_ == _LOAD:
            _put(r, variables, place, right)
        elif type_ == _SWAP:
            _put(r, variables, other, left)
            _put(r, variables, place, right)
        elif right == 0 and type_ in (_DIV, _MOD):
            return _INVALID_VALUE
        else:
            _put(r, variables, place, _result(type_, left, right))
    elif opcode in (_SIV, _AIV):
        if r[X] >= 0 and r[X] <= 255:  # else the command is ignored
            variables[r[X]] = value if opcode == _SIV else r[ACCUMULATOR]
    elif opcode == _GIV:
        if r[X] >= 0 and r[X] <= 255:
            load(r, variables[r[X]])
    elif opcode == _DJNZ:
        if value < 0 or value >= PROGRAM_COMMANDS:
            return _INVALID_VALUE
        variables[type_] = _wrap32(variables[type_] - 1)
        if variables[type_] != 0:
            pc = value
    elif opcode == _RST:
        if value < 0 or value >= PROGRAM_COMMANDS:
            return _INVALID_VALUE
        for cell in range(LATER):
            r[cell] = 0
        r[FLAGS] = ZERO
        pc = value
    elif opcode == _CALL:
        if type_ < 0 or type_ > 11:
            return _WRONG_TYPE
        if _holds(r[FLAGS], type_) and r[DEPTH] < STACK_DEPTH:
            if value < 0 or value >= PROGRAM_COMMANDS:
                return _INVALID_VALUE
            r[STACK + r[DEPTH]] = pc
            r[DEPTH] += 1
            pc = value
    else:
        return ELSEWHERE
    r[PC] = pc
    return DONE


@_compiled
def execute(r: Any, variables: Any, opcode: int, type_: int, motor: int, value: int) -> int:
    """One command on the registers `r`, the program counter with it: `DONE`, `ELSEWHERE`, or why it is refused.

    What is not done has changed nothing.
    """
    pc = r[PC] + 1
    if opcode == _CALC:
        if type_ == _NOT:
            load(r, ~r[ACCUMULATOR])
        elif type_ == _LOAD:
            load(r, value)
        else:
            status: int = _calculate(r, type_, value)
            if status != DONE:
                return status
    elif opcode == _CALCX:
        if type_ == _NOT:
            load(r, ~r[X])
        elif type_ == _LOAD:
            r[X] = r[ACCUMULATOR]
        elif type_ == _SWAP:
            x = r[X]
            r[X] = r[ACCUMULATOR]
            load(r, x)
        else:
            status = _calculate(r, type_, r[X])
            if status != DONE:
                return status
    elif opcode == _COMP:
        _compare(r, r[ACCUMULATOR], value)
    elif opcode == _JC:
        if type_ < 0 or type_ > 11:
            return _WRONG_TYPE
        if _holds(r[FLAGS], type_):
            if value < 0 or value >= PROGRAM_COMMANDS:
                return _INVALID_VALUE
            pc = value
    elif opcode == _JA:
        if value < 0 or value >= PROGRAM_COMMANDS:
            return _INVALID_VALUE
        pc = value
    elif opcode == _CSUB:
        if r[DEPTH] < STACK_DEPTH:  # else the command is ignored (FM-PD42-1241 3.6.18)
            if value < 0 or value >= PROGRAM_COMMANDS:
                return _INVALID_VALUE
            r[STACK + r[DEPTH]] = pc
            r[DEPTH] += 1
            pc = value
    elif opcode == _RSUB:
        if r[DEPTH] > 0:  # else the command is ignored (FM-PD42-1241 3.6.19)
            r[DEPTH] -= 1
            pc = r[STACK + r[DEPTH]]
    elif opcode == _CLE:
        if type_ < 0 or type_ > 4:
            return _WRONG_TYPE
        r[FLAGS] &= ~ERRORS if type_ == 0 else ~(ETO << (type_ - 1))
    elif opcode == _GGP and motor == _USER_VARIABLES:
        load(r, variables[type_])
    elif opcode == _SGP and motor == _USER_VARIABLES:
        variables[type_] = value
    elif opcode == _AGP and motor == _USER_VARIABLES:
        variables[type_] = r[ACCUMULATOR]
    elif opcode >= _CALCVV and r[LATER]:
        return _later(r, variables, opcode, type_, motor, value)
    else:
        return ELSEWHERE
    r[PC] = pc
    return DONE


@_compiled
def run(r: Any, variables: Any, program: Any, most: int) -> int:
    """Up to `most` commands of `program` (rows of opcode, type, motor, value); how many were done.

    Ends before the first that `execute` does not do, and before the end of the memory.
    """
    for count in range(most):
        pc = r[PC]
        if pc >= PROGRAM_COMMANDS:
            return count
        if execute(r, variables, program[pc, 0], program[pc, 1], program[pc, 2], program[pc, 3]) != DONE:
            return count
    return most


def warm_up() -> None:
    """Compile both functions or load them from numba's cache."""
    run(registers(), np.zeros(256, dtype=np.int64), np.zeros((PROGRAM_COMMANDS, 4), dtype=np.int64), 1)
    execute(registers(), np.zeros(256, dtype=np.int64), 0, 0, 0, 0)
