"""A register map out of a spreadsheet: a row a register, or a field of the register above it; with the same checks."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterator, Mapping
from typing import Any

from .findings import Finding, UnreadableMap
from .lines import Place
from .reader import RegisterMap, checked, text_of
from .shapes import REGISTERS_MAX

COLUMNS = {
    "register": "its name",
    "field": "name of a field of the register above: then the row is about that",
    "address": "",
    "axis": "",
    "lsb": "lowest bit of a field",
    "width": "",
    "access": "",
    "reset": "",
    "signed": "",
    "unit": "",
    "minimum": "",
    "maximum": "",
    "values": "0=off; 1=on",
    "group": "",
    "volatile": "",
    "read_clears": "",
    "role": "",
    "help": "",
}
"""What a head may name, in any order; what it does not is left at its default."""
ROWS_MAX = 33 * REGISTERS_MAX
_NUMBERS = frozenset({"address", "axis", "lsb", "width", "reset"})
_FLAGS = frozenset({"signed", "volatile", "read_clears"})
_TRUE, _FALSE = frozenset({"1", "true", "yes", "x"}), frozenset({"0", "false", "no"})
_OF_FIELDS = frozenset({"lsb", "width", "access", "signed", "unit", "minimum", "maximum", "values", "role", "help"})


def read_csv(name: str, content: bytes) -> tuple[RegisterMap, str]:
    """The map in a table with a head, and the same as TOML. Raises UnreadableMap with all that is wrong.

    Columns are parted by commas, semicolons or tabs. What a table cannot tell is as usual: datagrams of 40 bits on SPI,
    and as many axes as are named.
    """
    text = text_of(name, content)
    head = text.split("\n", 1)[0]
    sheet = _Sheet(max(",;\t", key=head.count))
    try:
        registers = list(sheet.registers(text))
    except csv.Error as error:
        raise UnreadableMap(name, [*sheet.findings, Finding(sheet.line, "", f"no CSV: {error}")]) from error
    if sheet.findings and not registers:
        raise UnreadableMap(name, sheet.findings)
    axes = 1 + max((entry["axis"] for entry in registers if isinstance(entry.get("axis"), int)), default=-1)
    data: dict[str, Any] = {"format": 1, "title": name, "axes": axes, "spi": {}, "register": registers}
    try:
        found = checked(name, data, sheet.line_of)
    except UnreadableMap as error:
        rest = [Finding(each["line"], each["where"], each["what"]) for each in error.findings]
        raise UnreadableMap(name, [*sheet.findings, *rest]) from error
    if sheet.findings:
        raise UnreadableMap(name, sheet.findings)
    return found, toml_of(data)


class _Sheet:
    """Reads rows, and remembers which line each came from."""

    def __init__(self, delimiter: str) -> None:
        self._delimiter = delimiter
        self._lines: dict[Place, int] = {}
        self.findings: list[Finding] = []
        self.line = 1

    def line_of(self, place: Place) -> int:
        """The line of a register or field; of anything in one, that of the row."""
        for length in range(len(place), 0, -1):
            if place[:length] in self._lines:
                return self._lines[place[:length]]
        return 1

    def registers(self, text: str) -> Iterator[dict[str, Any]]:
        reader = csv.reader(io.StringIO(text, newline=""), delimiter=self._delimiter, strict=True)
        head = [column.strip().casefold() for column in next(reader, [])]
        unknown = [column for column in head if column not in COLUMNS]
        if unknown or not {"register", "address"} <= set(head) or len(set(head)) < len(head):
            what = f"{unknown[0][:40]!r} is no column" if unknown else "the first line names the columns, each once"
            self._say(f"{what}; there are {', '.join(COLUMNS)}, and register and address have to be there")
            return
        self.line = reader.line_num + 1
        latest: dict[str, Any] | None = None
        index = -1
        for cells in self._rows(reader):
            row = {column: cell.strip() for column, cell in zip(head, cells, strict=False) if cell.strip()}
            if not row:
                continue
            if len(cells) > len(head) and any(cell.strip() for cell in cells[len(head) :]):
                self._say(f"{len(cells)} cells, and {len(head)} columns")
            if "field" not in row:
                if latest is not None:
                    yield latest
                index += 1
                if index >= REGISTERS_MAX:
                    self._say(f"more than {REGISTERS_MAX} registers")
                    return
                latest = self._entry(row, "register")
                self._lines["register", index] = self.line
            elif latest is None:
                self._say("a field has to stand below its register")
            elif row.get("register", latest.get("name")) != latest.get("name"):
                self._say(f"field {row['field'][:40]} is not below its register {row['register'][:40]}")
            else:
                fields = latest.setdefault("field", [])
                self._lines["register", index, "field", len(fields)] = self.line
                kept = {key: cell for key, cell in row.items() if key in _OF_FIELDS or key == "field"}
                fields.append(self._entry(kept, "field"))
        if latest is not None:
            yield latest

    def _rows(self, reader: Iterator[list[str]]) -> Iterator[list[str]]:
        """Each row, `line` being its first one. Raises csv.Error."""
        for cells in reader:
            yield cells
            self.line = reader.line_num + 1  # type: ignore[attr-defined]  # of csv's reader, whose type has no name

    def _say(self, what: str) -> None:
        self.findings.append(Finding(self.line, "", what))

    def _entry(self, row: Mapping[str, str], named: str) -> dict[str, Any]:
        """A row as the table that stands for it in TOML. What is no number stays text, which the check refuses."""
        entry: dict[str, Any] = {"name": row.get(named, "")}
        for column, cell in row.items():
            if column in _NUMBERS:
                entry[column] = _number(cell)
            elif column in _FLAGS:
                folded = cell.casefold()
                entry[column] = True if folded in _TRUE else False if folded in _FALSE else cell
            elif column == "values":
                pairs = (pair.partition("=") for pair in cell.split(";") if pair.strip())
                entry["values"] = {key.strip(): value.strip() for key, _, value in pairs}
            elif column not in ("register", "field", "minimum", "maximum"):
                entry[column] = cell
        limits = [row.get("minimum"), row.get("maximum")]
        if limits != [None, None]:
            entry["range"] = [_number(limit or "") for limit in limits]
        return entry


def _number(cell: str) -> int | str:
    """A whole number as people write it: 33, 0x21."""
    try:
        return int(cell, 0)
    except ValueError:
        pass
    try:
        return int(cell)  # 007
    except ValueError:
        return cell


def toml_of(data: Mapping[str, Any]) -> str:
    """A map as its file."""
    lines = [f"{key} = {_value(value)}" for key, value in data.items() if not isinstance(value, dict | list)]
    lines += [f"\n[{key}]" for key, value in data.items() if isinstance(value, dict)]
    for register in data["register"]:
        lines += ["", "[[register]]", *_pairs(register, "")]
        for part in register.get("field", ()):
            lines += ["", "  [[register.field]]", *_pairs(part, "  ")]
    return "\n".join(lines) + "\n"


def _pairs(entry: Mapping[str, Any], indent: str) -> list[str]:
    return [f"{indent}{key} = {_value(value)}" for key, value in entry.items() if key != "field"]


def _value(value: object) -> str:
    match value:
        case bool():
            return "true" if value else "false"
        case int():
            return str(value)
        case list():
            return f"[{', '.join(_value(each) for each in value)}]"
        case Mapping():
            return f"{{ {', '.join(f'{json.dumps(key)} = {_value(each)}' for key, each in value.items())} }}"
        case _:
            return json.dumps(str(value), ensure_ascii=False).replace("\x7f", "\\u007f")
