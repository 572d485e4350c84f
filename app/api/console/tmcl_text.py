"""From the body of a request, fields by name or a line as in a program, to the four numbers of a TMCL command."""

from __future__ import annotations

from ...links.tmcl import as_value
from ...links.tmcl_text import Command, opcode_of, parse_line, type_of
from ...registers.tmcl.commands import BY_OPCODE
from .schemas import TmclFields, TmclLine


def command_of(body: TmclFields | TmclLine) -> Command:
    """The command that a request means. Raises UsageError (a line that is none), UnknownThing, OutOfRange."""
    if isinstance(body, TmclLine):
        return parse_line(body.line)
    opcode = body.command if isinstance(body.command, int) else opcode_of(body.command)
    return opcode, type_of(BY_OPCODE.get(opcode), body.type), body.motor, as_value(body.value)
