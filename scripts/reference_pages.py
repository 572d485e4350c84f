"""The reference part of the help: Markdown made of register tables, the API's schema, the command line and the client.

    python -m scripts.reference_pages FOLDER

Needs no more than the tables do (pydantic) and typer: a wheel is built in an environment that has nothing else.
"""

from __future__ import annotations

import ast
import json
import re
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import groupby
from pathlib import Path
from typing import Any

from app.registers.catalog import MODELS
from app.registers.entry import Model
from app.registers.model import Bits, Field, Register

ROOT = Path(__file__).resolve().parent.parent

SCHEMA = ROOT / "web" / "src" / "api" / "openapi.json"
CLIENT = ROOT / "app" / "client" / "blocking.py"
SERIES_FROM = 8
"""So many rows of one shape whose names count on (tables in RAM, user variables) are told once."""


def pages() -> dict[str, str]:
    """Every page by its place below `reference/`."""
    made = {f"registers/{model.name}.md": register_page(model) for model in MODELS.values()}
    made["registers/index.md"] = register_index(MODELS.values())
    made["rest.md"] = rest_page(json.loads(SCHEMA.read_text()))
    made["command-line.md"] = command_line_page()
    made["python.md"] = client_page(CLIENT.read_text())
    return made


# --- registers --------------------------------------------------------------------------------------


@dataclass
class Row:
    """Rows of a table that differ in axis and address, or in a number of their name, alone."""

    first: Register
    name: str
    places: list[tuple[int | None, int]] = field(default_factory=list)
    """Axis and address of each."""


def register_index(models: Iterable[Model]) -> str:
    """The page that lists all models."""
    lines = ["# Registers and parameters", "", "Made from the tables that drivers and emulators work with.", ""]
    lines += ["| model | what it is | axes | registers |", "|---|---|---|---|"]
    lines += [
        f"| [{model.title}]({model.name}.md) | {model.summary} | {model.axes} | {len(model.table)} |"
        for model in models
    ]
    return _text(lines)


def register_page(model: Model) -> str:
    """All registers of a chip, or parameters of a module, by group."""
    things = "parameters" if model.kind == "module" else "registers"
    lines = [f"# {model.title} {things}", "", f"{_sentence(model.description)} {_sentence(model.summary)}", ""]
    rows = collapsed(model.table)
    for group, members in groupby(sorted(rows, key=lambda row: _groups(rows).index(row.first.group)), _group_of):
        found = list(members)
        lines += [
            f"## {_title(group)}",
            "",
            "| name | address | access | bits | after power-on |",
            "|---|---|---|---|---|",
        ]
        lines += [_summary(row) for row in found]
        for row in found:
            lines += ["", *_detail(row)]
        lines.append("")
    return _text(lines)


def collapsed(table: Iterable[Register]) -> list[Row]:
    """Rows of one shape made one: the same register of several axes, and long series of numbered ones."""
    by_shape: dict[tuple[Any, ...], Row] = {}
    for register in table:
        key = (register.space, register.name, *_shape(register))
        row = by_shape.setdefault(key, Row(register, register.name))
        row.places.append((register.axis, register.address))
    series: dict[tuple[Any, ...], list[Row]] = {}
    for row in by_shape.values():
        if len(row.places) == 1 and re.search(r"\d", row.name):
            series.setdefault((row.first.space, _unnumbered(row.name), *_shape(row.first)), []).append(row)
    dropped: set[int] = set()
    for members in series.values():
        if len(members) >= SERIES_FROM:
            head = members[0]
            head.name = f"{head.name} … {members[-1].name}"
            head.places = [place for member in members for place in member.places]
            dropped |= {id(member) for member in members[1:]}
    return [row for row in by_shape.values() if id(row) not in dropped]


def _shape(register: Register) -> tuple[Any, ...]:
    fields = tuple((_unnumbered(part.name), part.lsb, part.width) for part in register.fields)
    return register.width, register.access, register.group, register.when, fields


def _unnumbered(name: str) -> str:
    return re.sub(r"\d+", "#", name)


def _group_of(row: Row) -> str:
    return row.first.group


def _groups(rows: Sequence[Row]) -> list[str]:
    return list(dict.fromkeys(row.first.group for row in rows))


def _summary(row: Row) -> str:
    register = row.first
    reset = "" if register.reset is None else f"{register.reset:#x}" if register.fields else str(_reset(register))
    return f"| {_code(row.name)} | {_addresses(row)} | {register.access} | {register.width} | {reset} |"


def _reset(register: Register) -> int:
    assert register.reset is not None
    return register.decode(register.reset)


def _addresses(row: Row) -> str:
    space = "" if row.first.alias == "" else f"{row.first.space.value} "
    told = [f"{address:#04x}" if not space else str(address) for _, address in row.places]
    if len(told) >= SERIES_FROM:
        return f"{space}{told[0]} … {told[-1]}"
    if len(told) == 1:
        return f"{space}{told[0]}"
    return space + ", ".join(f"{where} (axis {axis})" for where, (axis, _) in zip(told, row.places, strict=True))


def _detail(row: Row) -> Iterator[str]:
    register = row.first
    yield f"### {_plain(row.name)}"
    yield ""
    yield _sentence(_plain(register.help)) + _when(register)
    yield from _facts(register)
    if register.values and not register.fields:
        yield ""
        yield from (f"- {value}: {_cell(meaning)}" for value, meaning in register.values.items())
    if register.fields:
        yield ""
        yield "| field | bits | access | reset | values | meaning |"
        yield "|---|---|---|---|---|---|"
        yield from (_field_line(part) for part in sorted(register.fields, key=lambda part: -part.lsb))


def _facts(register: Register) -> Iterator[str]:
    facts = [] if register.fields else [f"Range {register.minimum} to {register.maximum}{_unit(register)}."]
    if register.write_note:
        facts.append(_sentence(f"Writing: {_plain(register.write_note)}"))
    if register.read_clears:
        facts.append("Reading it changes it.")
    if register.stored:
        facts.append(f"Kept in EEPROM: {register.stored}.")
    if register.behaviour:
        facts.append(_sentence(f"The emulator keeps it and does not act on it: {_plain(register.behaviour)}"))
    facts.append(f"Source: {_plain(register.source)}.")
    yield ""
    yield " ".join(facts)


def _field_line(part: Field) -> str:
    bits = f"{part.lsb}" if part.width == 1 else f"{part.lsb + part.width - 1}:{part.lsb}"
    values = "<br>".join(f"{value}: {_cell(meaning)}" for value, meaning in part.values.items())
    values = values or ("" if part.width == 1 else f"{part.minimum} to {part.maximum}{_unit(part)}")
    reset = "" if part.reset is None else str(part.reset)
    meaning = _cell(_sentence(_plain(part.help)) + _when(part))
    return f"| {_code(part.name)} | {bits} | {part.access} | {reset} | {values} | {meaning} |"


def _unit(bits: Bits) -> str:
    return f" {bits.unit}" if bits.unit else ""


def _when(bits: Bits) -> str:
    return f" Holds with: {_plain(bits.when)}." if bits.when else ""


# --- REST -------------------------------------------------------------------------------------------


def rest_page(schema: Mapping[str, Any]) -> str:
    """Every call, by subject: what it takes, what it answers, and who may make it."""
    lines = ["# REST", "", "Made from the server's own schema, which it answers at `/openapi.json`. Errors are", ""]
    lines[-2] += " `application/problem+json`, with the range, the names or the way out in them."
    calls: dict[str, list[tuple[str, str, Mapping[str, Any]]]] = {}
    for path, methods in schema["paths"].items():
        for method, call in methods.items():
            if isinstance(call, dict) and "operationId" in call:
                calls.setdefault((call.get("tags") or ["other"])[0], []).append((method.upper(), path, call))
    for subject, members in calls.items():
        lines += [f"## {_title(subject)}", ""]
        for method, path, call in members:
            lines += [f"### `{method} {path}`", "", _paragraphs(call.get("description") or call.get("summary", "")), ""]
            lines += [*_call_facts(call, schema), ""]
    return _text(lines)


def _call_facts(call: Mapping[str, Any], schema: Mapping[str, Any]) -> Iterator[str]:
    role = call.get("x-required-role")
    if role:
        yield f"Needs the role `{role}`."
        yield ""
    taken = [(each["name"], each["in"], each.get("required", False), each) for each in call.get("parameters", [])]
    body = _resolved(call.get("requestBody", {}).get("content", {}).get("application/json", {}).get("schema"), schema)
    required = body.get("required", [])
    taken += [(name, "body", name in required, each) for name, each in body.get("properties", {}).items()]
    if taken:
        yield "| takes | in | | what it is |"
        yield "|---|---|---|---|"
        for name, place, needed, each in taken:
            told = _cell(_plain(each.get("description") or each.get("schema", {}).get("description", "")))
            yield f"| `{name}` | {place} | {'needed' if needed else ''} | {_type(each.get('schema', each))} {told} |"
        yield ""
    answers = call.get("responses", {})
    yield (
        "Answers "
        + "; ".join(f"{status}: {_cell(each.get('description', ''))}" for status, each in answers.items())
        + "."
    )


def _resolved(what: Mapping[str, Any] | None, schema: Mapping[str, Any]) -> Mapping[str, Any]:
    if not what:
        return {}
    name = what.get("$ref", "").rpartition("/")[2]
    return schema["components"]["schemas"].get(name, what) if name else what


def _type(what: Mapping[str, Any]) -> str:
    if "$ref" in what:
        return f"`{what['$ref'].rpartition('/')[2]}`."
    if "anyOf" in what:
        return " or ".join(_type(each).rstrip(".") for each in what["anyOf"]) + "."
    if "const" in what:
        return f"`{json.dumps(what['const'])}`."
    if "enum" in what:
        return ", ".join(f"`{value}`" for value in what["enum"]) + "."
    bounds = [f"{word} {what[key]:g}" for key, word in BOUNDS.items() if key in what]
    return " ".join([what.get("type", "any"), *bounds]) + "."


BOUNDS = {"minimum": ">=", "exclusiveMinimum": ">", "maximum": "<=", "exclusiveMaximum": "<"}


# --- command line and client ------------------------------------------------------------------------


def command_line_page() -> str:
    """Every command with its arguments and options."""
    import typer.main

    from app.cli import cli

    lines = ["# Command line", "", "`stepscope COMMAND --help` prints the same.", ""]
    lines += _command_lines("stepscope", typer.main.get_command(cli))
    return _text(lines)


def _command_lines(name: str, command: Any) -> Iterator[str]:
    if name != "stepscope":
        yield f"## {name}" if name.count(" ") == 1 else f"### {name}"
        yield ""
    if command.help:
        yield _paragraphs(command.help)
        yield ""
    shown = [each for each in command.params if not getattr(each, "hidden", False)]
    if shown and name != "stepscope":
        yield "| argument or option | what it is |"
        yield "|---|---|"
        for each in shown:
            is_option = each.param_type_name == "option"
            names = ", ".join(f"`{one}`" for one in (each.opts if is_option else [each.name.upper()]))
            yield f"| {names} | {_cell(_plain(getattr(each, 'help', None) or ''))} |"
        yield ""
    for inner, one in getattr(command, "commands", {}).items():
        if not one.hidden:
            yield from _command_lines(f"{name} {inner}", one)


def client_page(source: str) -> str:
    """The methods of `Bench`, from its source."""
    tree = ast.parse(source)
    bench = next(each for each in tree.body if isinstance(each, ast.ClassDef) and each.name == "Bench")
    lines = ["# Python client", "", _paragraphs(ast.get_docstring(bench) or ""), ""]
    lines += ["`AsyncBench` has the same methods, awaited.", "", "```python", "from stepscope import Bench", "```", ""]
    for method in bench.body:
        if isinstance(method, ast.FunctionDef) and not method.name.startswith("_"):
            kind = [ast.unparse(each) for each in method.decorator_list]
            answer = f" -> {ast.unparse(method.returns)}" if method.returns else ""
            lines += [f"## {method.name}", "", "```python"]
            lines += [f"@{each}" for each in kind]
            lines += [f"{method.name}({ast.unparse(method.args).removeprefix('self').lstrip(', ')}){answer}", "```", ""]
            lines += [_paragraphs(ast.get_docstring(method) or ""), ""]
    return _text(lines)


# --- Markdown ---------------------------------------------------------------------------------------


def _text(lines: Iterable[str]) -> str:
    return "\n".join(lines).rstrip() + "\n"


def _plain(text: str) -> str:
    """Words of a table as Markdown: what it would take for markup stands as it is."""
    return re.sub(r"([\\*_<>\[\]#])", r"\\\1", text)


def _code(name: str) -> str:
    return " … ".join(f"`{part}`" for part in name.split(" … "))


def _cell(text: str) -> str:
    return re.sub(r"\s+", " ", text).replace("|", "\\|").strip()


def _sentence(text: str) -> str:
    text = text.strip()
    text = text[:1].upper() + text[1:]
    return text if not text or text[-1] in ".!?" else f"{text}."


def _title(text: str) -> str:
    return text[:1].upper() + text[1:]


def _paragraphs(text: str) -> str:
    """A docstring: its code stays code, the rest is text."""
    text = re.sub(r"(?<!`)(https?://[^\s,;]+)", r"`\1`", text.replace("\b", "").strip())
    parts = re.split(r"(`[^`]*`)", text)
    return "".join(part if part.startswith("`") else _plain(part) for part in parts)


def main(arguments: Sequence[str]) -> int:
    """Write the pages into a folder."""
    (folder,) = map(Path, arguments)
    for name, text in pages().items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
