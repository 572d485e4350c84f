"""How commands of a program go on to another: what a debugger has to know of each."""

from __future__ import annotations

from enum import Enum

from .instructions import Command

_JC, _JA, _CSUB, _RSUB, _WAIT, _STOP, _RETI = 21, 22, 23, 24, 27, 28, 38
_STILL = frozenset({6, 10, 15, 19, 20, 25, 26, 31, 33, 36, 37})
"""Commands that read or calculate (FM-PD42-1241 3.6): they move no motor."""


class Flow(Enum):
    """What comes after a command."""

    GOES_ON = "the next command"
    JUMPS = "another address, or the same again"
    CALLS = "a subroutine"
    RETURNS = "whoever called it"
    WAITS = "the next command, once something has happened"
    ENDS = "nothing"


_FLOWS = {
    _JC: Flow.JUMPS,
    _JA: Flow.JUMPS,
    _CSUB: Flow.CALLS,
    _RSUB: Flow.RETURNS,
    _WAIT: Flow.WAITS,
    _STOP: Flow.ENDS,
    _RETI: Flow.JUMPS,
}


def flow_of(command: Command) -> Flow:
    """By its opcode (FM-PD42-1241 3.6.16 to 3.6.21, 3.6.33)."""
    return _FLOWS.get(command.opcode, Flow.GOES_ON)


def may_move(command: Command) -> bool:
    """Whether it may set a motor in motion or stop one; also of opcodes that nobody here knows."""
    return command.opcode not in _STILL and command.opcode not in _FLOWS
