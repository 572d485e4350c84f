"""Commands of a program that touch nothing but the interpreter's own registers and user variables, compiled.

Both functions share this file because numba's disk cache only notices changes of the file that a function stands in.
Open in all sources, and decided here: logic is bitwise; results wrap to 32 bits; a remainder has the sign of the
dividend; CALCX NOT puts the inverted X into the accumulator; COMP leaves the zero flag alone, which follows every value
that comes into the accumulator; jumps out of the memory and divisions by zero are refused with status 4, unknown types
with status 3.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ...kernels import Kernels
from ...registers.tmcl.commands import PROGRAM_COMMANDS

PC, ACCUMULATOR, X, FLAGS, DEPTH, STACK = 0, 1, 2, 3, 4, 5
"""Cells of the registers; `DEPTH` counts the entries of the stack."""
STACK_DEPTH = 8
"""Nested calls (FM-PD42-1241 3.6.18)."""
CELLS = STACK + STACK_DEPTH
EQUAL, LOWER, GREATER, ZERO, ETO, EAL, EDV, EPO = 1, 2, 4, 8, 16, 32, 64, 128
"""Flags (bits as in the maker's TMC562-EVAL header, which no module shows)."""
ERRORS = ETO | EAL | EDV | EPO
DONE, ELSEWHERE = 100, 0
"""What `execute` answers besides statuses of refusals: done, or a command that touches more than this."""

_SGP, _GGP, _CALC, _COMP, _JC, _JA, _CSUB, _RSUB = 9, 10, 19, 20, 21, 22, 23, 24
_CALCX, _AGP, _CLE = 33, 35, 36
_USER_VARIABLES = 2
_ADD, _SUB, _MUL, _DIV, _MOD, _AND, _OR, _XOR, _NOT, _LOAD, _SWAP = range(11)
_WRONG_TYPE, _INVALID_VALUE = 3, 4

_KERNELS = Kernels(__file__)
_compiled, _inlined = _KERNELS.compiled, _KERNELS.inlined


def registers() -> np.ndarray[Any, np.dtype[np.int64]]:
    """All at zero, but for the zero flag, which says so."""
    cells = np.zeros(CELLS, dtype=np.int64)
    cells[FLAGS] = ZERO
    return cells


@_inlined
def _wrap32(value: int) -> int:
    return ((value + 0x80000000) & 0xFFFFFFFF) - 0x80000000


@_inlined
def _load(r: Any, value: int) -> None:
    r[ACCUMULATOR] = value
    r[FLAGS] = r[FLAGS] & ~ZERO if value else r[FLAGS] | ZERO


@_inlined
def _calculate(r: Any, operation: int, right: int) -> int:
    left = r[ACCUMULATOR]
    if operation == _ADD:
        _load(r, _wrap32(left + right))
    elif operation == _SUB:
        _load(r, _wrap32(left - right))
    elif operation == _MUL:
        _load(r, _wrap32(left * right))
    elif operation in (_DIV, _MOD):
        if right == 0:
            return _INVALID_VALUE
        quotient = abs(left) // abs(right)
        if (left < 0) != (right < 0):
            quotient = -quotient
        _load(r, _wrap32(quotient if operation == _DIV else left - quotient * right))
    elif operation == _AND:
        _load(r, left & right)
    elif operation == _OR:
        _load(r, left | right)
    elif operation == _XOR:
        _load(r, left ^ right)
    else:
        return _WRONG_TYPE
    return DONE


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
def execute(r: Any, variables: Any, opcode: int, type_: int, motor: int, value: int) -> int:
    """One command on the registers `r`, the program counter with it: `DONE`, `ELSEWHERE`, or why it is refused.

    What is not done has changed nothing.
    """
    pc = r[PC] + 1
    if opcode == _CALC:
        if type_ == _NOT:
            _load(r, ~r[ACCUMULATOR])
        elif type_ == _LOAD:
            _load(r, value)
        else:
            status: int = _calculate(r, type_, value)
            if status != DONE:
                return status
    elif opcode == _CALCX:
        if type_ == _NOT:
            _load(r, ~r[X])
        elif type_ == _LOAD:
            r[X] = r[ACCUMULATOR]
        elif type_ == _SWAP:
            x = r[X]
            r[X] = r[ACCUMULATOR]
            _load(r, x)
        else:
            status = _calculate(r, type_, r[X])
            if status != DONE:
                return status
    elif opcode == _COMP:
        left = r[ACCUMULATOR]
        r[FLAGS] = r[FLAGS] & ~(EQUAL | LOWER | GREATER) | (
            EQUAL if left == value else LOWER if left < value else GREATER
        )
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
        _load(r, variables[type_])
    elif opcode == _SGP and motor == _USER_VARIABLES:
        variables[type_] = value
    elif opcode == _AGP and motor == _USER_VARIABLES:
        variables[type_] = r[ACCUMULATOR]
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
