"""Commands that look at the drive as they go, compiled together with it: interpreter and motor in one loop.

A program that polls its position reads it every few commands; were each reading a way out of compiled code, such a loop
would run 25 times as fast as real time instead of a thousand times.
"""

# numpy's stubs type a cell as Any; inside compiled code it is an int64 or a float64 and nothing else.
# mypy: disable-error-code="no-any-return"

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

import numpy as np

from ...kernels import Kernels
from ...registers.tmcl import commands
from ..drive import kernel as motor
from . import interpreter_kernel as k

NOT_HERE, TARGET, POSITION, SPEED, REACHED, HOME, RIGHT, LEFT, CURRENT, LOAD = range(10)
READ_HERE: Mapping[int, int] = MappingProxyType(
    {0: TARGET, 1: POSITION, 3: SPEED, 8: REACHED, 9: HOME, 10: RIGHT, 11: LEFT, 180: CURRENT, 206: LOAD}
)
"""What is read of the drive's cells, by the number of the axis parameter."""
_GAP = 6
_PROGRAM_COMMANDS = commands.PROGRAM_COMMANDS

_KERNELS = Kernels(__file__, k.__file__, motor.__file__, commands.__file__, plain=True)
_compiled, _inlined = _KERNELS.compiled, _KERNELS.inlined


@_inlined
def _shown(x: int, bits: int) -> int:
    """A count of the drive as a counter of `bits` bits shows it."""
    half = 1 << (bits - 1)
    return ((x + half) & ((half << 1) - 1)) - half


@_compiled
def _read(s: Any, f: Any, what: int, bits: int, unit: float, units: float) -> int:
    """What a parameter shows; a speed is `units` / `unit` of the user's for each of the chip's."""
    if what == POSITION:
        return _shown(s[motor.X], bits)
    if what == TARGET:
        return _shown(s[motor.XT], bits)
    if what == SPEED:
        speed = int((abs(s[motor.V]) >> motor.VELOCITY_BITS) * units / unit + 0.5)
        return speed if s[motor.V] >= 0 else -speed
    if what == REACHED:
        return 1 if s[motor.X] == s[motor.XT] else 0
    if what == HOME:
        return motor.physical(s, f) >> 2 & 1
    if what == RIGHT:
        return motor.ramp_stat(s) >> 1 & 1
    if what == LEFT:
        return motor.ramp_stat(s) & 1
    if what == CURRENT:
        return motor.driver_stat(s) >> 16 & 0x1F
    return motor.driver_stat(s) & 0x3FF


@_compiled
def run(
    r: Any, variables: Any, program: Any, here: Any, s: Any, f: Any, table: Any,
    bits: int, unit: float, units: float, due: int, cost: int, until: int,
) -> tuple[int, int]:  # fmt: skip
    """Commands that are due before `until`, each at its time, the drive with them; (events, when the next is due).

    here : what to read by axis parameter, `NOT_HERE` for what only the firmware can tell
    due, cost, until : when the first command is due, what each takes, where to end [clocks]

    Ends before a command that cannot be done here, and with an event that is watched for: the command after it is not
    done then.
    """
    while due < until:
        events = motor.advance(s, f, table, due)
        if events:
            return events, due
        pc = r[k.PC]
        if pc >= _PROGRAM_COMMANDS:
            break
        if program[pc, 0] == _GAP:
            what = here[program[pc, 1]]
            if what == NOT_HERE or program[pc, 2] != 0:
                break
            k.load(r, _read(s, f, what, bits, unit, units))
            r[k.PC] = pc + 1
        elif k.execute(r, variables, program[pc, 0], program[pc, 1], program[pc, 2], program[pc, 3]) != k.DONE:
            break
        due += cost
    return 0, due


def warm_up() -> None:
    """Compile it or load it from disk."""
    drive = (
        np.zeros(motor.INTEGERS, dtype=np.int64),
        np.zeros(motor.REALS, dtype=np.float64),
        np.zeros(motor.TABLE, dtype=np.float64),
    )
    program = np.zeros((_PROGRAM_COMMANDS, 4), dtype=np.int64)
    run(
        k.registers(),
        np.zeros(256, dtype=np.int64),
        program,
        np.zeros(256, dtype=np.int64),
        *drive,
        32,
        1.0,
        1.0,
        0,
        1,
        0,
    )
