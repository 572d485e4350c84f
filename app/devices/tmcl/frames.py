"""Which command reads or writes a row of the table, whatever space it lives in."""

from __future__ import annotations

from ...links.tmcl import Request
from ...registers.model import Register, Space
from ...registers.tmcl.commands import BY_OPCODE, Opcode

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
    opcode, motor = _READS[register.space]
    return Request(address, opcode, register.address, motor)


def writing(address: int, register: Register, value: int) -> Request:
    """SAP, SGP, SIO or SCO. Raises ValueError for a value that 32 bits cannot hold."""
    return Request(address, _WRITES[register.space], register.address, _BANKS[register.space], value)


def written_by(request: Request) -> tuple[Space, int] | None:
    """Space and number of the row that a command by hand writes; None where it writes none."""
    for space, opcode in _WRITES.items():
        if request.opcode == opcode and request.motor == _BANKS[space]:
            return space, request.type
    return None


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
