"""Reading our own scripts back: what they write, where nothing is there that could run them.

Each reader knows the language only as far as we write it, and refuses a line that it does not know: a script that
says something else than we meant fails here, too.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from urllib.parse import unquote

from ...devices.core.results import WriteItem
from ...links import datagram32, datagram40, tmcl
from ...links.datagram_uart import UartForm
from ...links.spi_access import TaggedAccess
from ...links.spi_datagram import Request, encode
from ...links.tmcl_text import Command, parse_line
from ...registers.catalog import Model
from ...registers.spi_format import SpiFormat
from ...registers.tmcl.commands import Opcode

_REMARK = re.compile(r"/\*.*?\*/", re.DOTALL)
_ENTRY = re.compile(r"\s*\{([^{}]*)\},\s*")
_ARRAY = re.compile(r"static const struct \w+_write \w+_part_\d+\[\] = \{\n(.*?)\n\};", re.DOTALL)
_NUMBER = re.compile(r"(-?)(0x[0-9A-F]+|\d+)u?( - 1)?")
_PUT = re.compile(r"put '([A-Za-z0-9_%]+)' '(?:\?axis=(\d+))?' '([^']*)'(?:\s+#.*)?")


def frames_of_c(text: str, family: Model) -> list[bytes]:
    """The frames that the arrays of a header mean, in their order. Raises ValueError."""
    plain = _REMARK.sub(" ", text)
    frames = []
    for array in _ARRAY.finditer(plain):
        for line in array[1].splitlines():
            entry = _ENTRY.fullmatch(line)
            if entry is None:
                raise ValueError(f"no entry of an array: {line!r}")
            frames.append(_frame(family, [_number(part.strip()) for part in entry[1].split(",")]))
    return frames


def _frame(family: Model, numbers: list[int]) -> bytes:
    if family.kind == "module":
        command, type_, motor, value = numbers
        return tmcl.Request(1, command, type_, motor, value).encode()
    address, word = numbers
    if family.uart_alone:
        return UartForm().write(address, word)
    if isinstance(family.spi, SpiFormat):
        return encode(family.spi, Request(address, write=True, data=word))
    if family.spi is not None:
        return TaggedAccess(family.spi).write_frame(address, word)
    if family.datagram_bits == 32:
        return datagram32.Request(address, False, word).encode()
    return datagram40.write(address, word)


def _number(text: str) -> int:
    found = _NUMBER.fullmatch(text)
    if found is None:
        raise ValueError(f"no number: {text!r}")
    sign, digits, less_one = found.groups()
    return (-1 if sign else 1) * int(digits, 0) - (1 if less_one else 0)


def commands_of_tmcl(text: str) -> Iterator[Command]:
    """The commands of a program up to its STOP. Raises UsageError for a line that is none, ValueError without STOP."""
    for line in text.split("\n"):
        if line.strip() and not line.lstrip().startswith("//"):
            command = parse_line(line)
            if command[0] == Opcode.STOP:
                return
            yield command
    raise ValueError("the program has no STOP")


def writes_of_curl(text: str) -> list[WriteItem]:
    """What each call writes, in their order. Raises ValueError."""
    writes = []
    for line in text.split("\n"):
        if line.startswith("put "):
            found = _PUT.fullmatch(line)
            if found is None:
                raise ValueError(f"no call: {line!r}")
            name, axis, body = found.groups()
            writes.append(WriteItem(unquote(name), None if axis is None else int(axis), **json.loads(body)))
    return writes
