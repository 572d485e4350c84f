"""Which command reads or writes a row of the table, whatever space it lives in; commands by their names."""

from __future__ import annotations

from ...errors import OutOfRange, UnknownThing
from ...links.tmcl import Request, as_value
from ...registers.model import Register, Space
from ...registers.tmcl.commands import BY_MNEMONIC, BY_OPCODE, Opcode

START, STOP, STATUS = 0, 1, 2
"""Types of RFS."""
WIDE_SHIFT = 4
"""Where the upper bits of an axis parameter's number stand in the motor byte."""

_READS = {
    Space.AXIS: (Opcode.GAP, 0),
    Space.GLOBAL_0: (Opcode.GGP, 0),
    Space.GLOBAL_2: (Opcode.GGP, 2),
    Space.GLOBAL_3: (Opcode.GGP, 3),
    Space.DIGITAL_IN: (Opcode.GIO, 0),
    Space.ANALOG_IN: (Opcode.GIO, 1),
    Space.OUTPUT: (Opcode.GIO, 2),
    Space.COORDINATE: (Opcode.GCO, 0),
}
_WRITES = {
    Space.AXIS: Opcode.SAP,
    Space.GLOBAL_0: Opcode.SGP,
    Space.GLOBAL_2: Opcode.SGP,
    Space.GLOBAL_3: Opcode.SGP,
    Space.OUTPUT: Opcode.SIO,
    Space.PULL_UP: Opcode.SIO,
    Space.COORDINATE: Opcode.SCO,
}
_BANKS = {space: bank for space, (_, bank) in _READS.items()} | {Space.PULL_UP: 0}


def reading(address: int, register: Register) -> Request:
    """GAP, GGP, GIO or GCO."""
    opcode, bank = _READS[register.space]
    return Request(address, opcode, *_place(register, bank))


def writing(address: int, register: Register, value: int) -> Request:
    """SAP, SGP, SIO or SCO. Raises ValueError for a value that 32 bits cannot hold."""
    return Request(address, _WRITES[register.space], *_place(register, _BANKS[register.space]), value)


def _place(register: Register, bank: int) -> tuple[int, int]:
    """Type and motor bytes of a row. Numbers of axis parameters from 256 on have their upper bits in the upper half of
    the motor byte, as modules with numbers of 12 bits want them (PyTrinamic)."""
    if register.space is not Space.AXIS:
        return register.address, bank
    return register.address & 0xFF, (register.axis or 0) | register.address >> 8 << WIDE_SHIFT


def written_by(request: Request) -> tuple[Space, int] | None:
    """Space and number of the row that a command by hand writes; None where it writes none."""
    for space, opcode in _WRITES.items():
        if request.opcode == opcode and request.motor == _BANKS[space]:
            return space, request.type
    return None


def request_of(address: int, command: int | str, type_: int | str, motor: int, value: int) -> Request:
    """A command by numbers or by TMCL's names. Raises UnknownThing, OutOfRange."""
    if isinstance(command, str):
        row = BY_MNEMONIC.get(command.strip().upper())
        if row is None:
            raise UnknownThing("TMCL command", command, list(BY_MNEMONIC))
    else:
        row = BY_OPCODE.get(command)
    if isinstance(type_, str):
        names = {} if row is None else row.types
        code = names.get(type_.strip().upper())
        if code is None:
            what = f"type of {command}" if row is None else f"type of {row.mnemonic or row.name}"
            raise UnknownThing(what, type_, list(names))
        type_ = code
    opcode = row.opcode if isinstance(command, str) and row is not None else command
    assert isinstance(opcode, int)
    for name, number in (("command", opcode), ("type", type_), ("motor", motor)):
        if not 0 <= number <= 255:
            raise OutOfRange(name, number, 0, 255, "one byte")
    try:
        return Request(address, opcode, type_, motor, as_value(value))
    except ValueError as error:
        raise OutOfRange("value", value, -(1 << 31), (1 << 32) - 1, "32 bits") from error


def spelled(request: Request) -> str:
    """As one writes it in a program: `MVP ABS, 0, 51200`."""
    row = BY_OPCODE.get(request.opcode)
    name = f"command {request.opcode}" if row is None else row.mnemonic or row.name
    names = {} if row is None else {code: word for word, code in row.types.items()}
    operands = [names.get(request.type, str(request.type)), str(request.motor), str(request.value)]
    unused = [] if row is None else [0] * (not (row.types or row.type)) + [2] * (not row.value)
    # All three where one that the command has no use for is there nevertheless: two could be read as others.
    if not (0 in unused and request.type) and not (2 in unused and request.value):
        operands = [operand for index, operand in enumerate(operands) if index not in unused]
    return f"{name} {', '.join(operands)}"
