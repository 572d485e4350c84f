"""Reads a CSV that an oscilloscope or another instrument has exported: times and channels with their units.

The layouts that it knows are in docs/instrument-files.md, each with its source: Rigol, Siglent, Keysight, Tektronix,
LeCroy, and any table with a time column and units in its header. Cells are divided by `;`, tab or `,`; with the former
two a decimal comma is understood. What is missing is NaN, never 0.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...errors import UsageError

FloatArray = NDArray[np.float64]
FILE_MAX_BYTES = 32 << 20
ROWS_MAX, CHANNELS_MAX, HEADER_LINES_MAX, CELL_MAX = 2_000_000, 16, 200, 60
HOLE = 9.9e37
"""Keysight's and Tektronix' number for a sample that is not there, and everything above."""
MISSING = ("", "-", "--", "---", "nan", "NaN", "NAN", "null", "NULL", "None", "N/A", "n/a", "inf", "-inf", "Inf")
_SECONDS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "ps": 1e-12, "min": 60.0, "h": 3600.0}
_WORDS = {
    "second": "s",
    "seconds": "s",
    "sec": "s",
    "sekunden": "s",
    "millisecond": "ms",
    "milliseconds": "ms",
    "volt": "V",
    "volts": "V",
    "ampere": "A",
    "amperes": "A",
    "amp": "A",
    "amps": "A",
    "watt": "W",
    "watts": "W",
    "degree": "deg",
    "°": "deg",
    "°c": "°C",
}
_UNITS = re.compile(r"[munkM]?(V|A|W|s|Hz|Nm|m|g|Ohm)|deg|rad|°C|%|rpm|pps|mm|mm/s|m/s|m/s\^2|counts|usteps|dB|1")
_NUMBER = re.compile(r"\s*[-+]?(\d+([.,]\d*)?|[.,]\d+)([eE][-+]?\d+)?\s*")
_TIME = re.compile(r"(time|zeit|temps|tiempo|tempo|tijd|t|x|x-axis|timestamp|seconds?)\b|time_", re.IGNORECASE)
_UNIT_BEHIND = re.compile(r"(?P<name>.*?)\s*(?:[(\[](?P<unit>[^()\[\]]{0,12})[)\]]|/\s+(?P<slash>\S{1,8}))\s*")
_START = re.compile(r"t0\s*=\s*([^\s,]+)", re.IGNORECASE)
_STEP = re.compile(r"tInc\s*=\s*([^\s,]+)", re.IGNORECASE)


_NO_CHANNEL = re.compile(r"(Start|Increment)$|(t0|tInc)\s*=", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class InstrumentTable:
    """What the file holds.

    names, units : of each channel; a name is there once
    time_s : [rows], rising [s]
    columns : [channels, rows]; NaN where a cell is missing
    instrument : its maker's model, where the file tells it
    notes : what was assumed, in words
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    time_s: FloatArray
    columns: FloatArray
    instrument: str
    notes: tuple[str, ...]


def read_table(content: bytes) -> InstrumentTable:
    """Raises UsageError, which names line and column, for what is no such file or is too large."""
    lines = _decoded(content).splitlines()
    if any(line.startswith("Record Length,") and _is_sideways(line) for line in lines[:3]):
        return _sideways(lines)
    delimiter = _delimiter(lines)
    first = _first_row(lines, delimiter)
    header = [_cells(line, delimiter) for line in lines[:first]]
    width = max(len(_cells(lines[first], delimiter)), len(_stripped(header[-1])) if header else 0)
    table = _numbers(lines, first, delimiter, width)
    return _told(header, table, lines, first)


def _decoded(content: bytes) -> str:
    if content[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return content.decode("utf-16", errors="replace")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        return content.decode("cp1252", errors="replace")  # what instruments with Windows write


def _cells(line: str, delimiter: str) -> list[str]:
    return [cell.strip() for cell in next(csv.reader([line.lstrip("#")], delimiter=delimiter), [])]


def _stripped(cells: list[str]) -> list[str]:
    """Without the empty ones at its end: instruments put a delimiter behind the last."""
    while len(cells) > 1 and cells[-1] == "":
        cells = cells[:-1]
    return cells


def _is_number(cell: str) -> bool:
    return _NUMBER.fullmatch(cell) is not None


def _is_row(cells: Sequence[str]) -> bool:
    """Whether these are numbers, and at least one beside the first."""
    known = [cell for cell in cells if cell not in MISSING]
    return len(cells) > 1 and len(known) > 0 and cells[0] in known and all(map(_is_number, known))


def _delimiter(lines: Sequence[str]) -> str:
    tail = [line for line in lines[: HEADER_LINES_MAX + 50] if line.strip()][-40:]
    return max((";", "\t", ","), key=lambda each: sum(_is_row(_cells(line, each)) for line in tail))


def _first_row(lines: Sequence[str], delimiter: str) -> int:
    for number, line in enumerate(lines[: HEADER_LINES_MAX + 1]):
        if _is_row(_cells(line, delimiter)):
            return number
    if not any(line.strip() for line in lines):
        raise UsageError("the file is empty")
    raise UsageError(
        f"none of the first {min(len(lines), HEADER_LINES_MAX)} lines is a row of numbers with a time and a value"
    )


def _numbers(lines: Sequence[str], first: int, delimiter: str, width: int) -> FloatArray:
    """[columns, rows]."""
    if len(lines) - first > ROWS_MAX:
        raise UsageError(f"{len(lines) - first} rows, at most {ROWS_MAX} are read: export fewer")
    if width > CHANNELS_MAX + 1:
        raise UsageError(f"line {first + 1}: {width} columns, at most {CHANNELS_MAX + 1} are read")
    import pyarrow as pa
    import pyarrow.csv

    text = "\n".join(lines[first:]).encode()
    names = [str(number) for number in range(width)]
    comma = delimiter != "," and any("," in line for line in lines[first : first + 100])
    try:
        found = pyarrow.csv.read_csv(
            io.BytesIO(text),
            pyarrow.csv.ReadOptions(use_threads=False, column_names=names, block_size=1 << 22),
            pyarrow.csv.ParseOptions(delimiter=delimiter),
            pyarrow.csv.ConvertOptions(
                column_types=dict.fromkeys(names, pa.float64()),
                null_values=list(MISSING),
                decimal_point="," if comma else ".",
            ),
        )
        table = np.stack([column.to_numpy() for column in found.columns]).astype(np.float64, copy=False)
    except pa.ArrowInvalid:  # rows of different lengths, or what is no number: slower, and it tells where
        table = np.array(list(_rows(lines, first, delimiter, width))).T
    return np.where(np.abs(table) >= HOLE, np.nan, table)


def _rows(lines: Sequence[str], first: int, delimiter: str, width: int) -> Iterator[list[float]]:
    for number, line in enumerate(lines[first:], first + 1):
        if not line.strip():
            continue
        cells = _stripped(_cells(line, delimiter))
        if len(cells) > width:
            raise UsageError(f"line {number}: {len(cells)} columns, {width} in the lines before")
        yield [
            _value(cell, f"line {number}, column {at}", delimiter)
            for at, cell in enumerate(cells + [""] * (width - len(cells)), 1)
        ]


def _value(cell: str, where: str, delimiter: str = ",") -> float:
    if cell in MISSING:
        return float("nan")
    try:
        return float(cell if delimiter == "," else cell.replace(",", "."))
    except ValueError:
        raise UsageError(f"{where}: {cell[:CELL_MAX]!r} is no number") from None


def _told(header: list[list[str]], table: FloatArray, lines: Sequence[str], first: int) -> InstrumentTable:
    """Names, units and times of a table of numbers, by what stands above it."""
    start, step = _even(header)
    header = [cells for cells in header if any(cells)]
    notes: list[str] = []
    width = len(table)
    said = {cells[0].casefold().rstrip(":"): cells[1:] for cells in header if len(cells) > 1}
    titles, units = _titles(header, width, said)
    if start is not None and step is not None:
        has_count = bool(titles) and _TIME.match(titles[0]) is not None
        time_s = start + step * np.arange(table.shape[1], dtype=np.float64)
        values, titles, units = (table[1:], titles[1:], units[1:]) if has_count else (table, titles, units)
    else:
        at = next((number for number, title in enumerate(titles) if _TIME.match(title)), 0)
        unit = units[at] if at < len(units) else ""
        unit = unit if unit in _SECONDS else unit.casefold()  # Tektronix: S
        if unit == "":
            notes.append("no unit of time stands in its header: taken as seconds")
        elif unit not in _SECONDS:
            raise UsageError(f"line {first}, column {at + 1}: time is in {unit!r}, known are {', '.join(_SECONDS)}")
        time_s = table[at] * _SECONDS.get(unit, 1.0)
        values = np.delete(table, at, axis=0)
        titles, units = ([each for number, each in enumerate(of) if number != at] for of in (titles, units))
        _require_times(time_s, at, lines, first)
        time_s = _evened(time_s, notes)
    kept = [number for number in range(len(values)) if _name_of(titles, number) or not np.isnan(values[number]).all()]
    kept = [number for number in kept if not _NO_CHANNEL.match(_name_of(titles, number))]
    if not kept or len(time_s) < 2:
        raise UsageError("a channel is two rows at least, each with a time and a value")
    names = _once([_name_of(titles, number) or f"column {number + 2}" for number in kept])
    return InstrumentTable(
        names,
        tuple(units[number] if number < len(units) else "" for number in kept),
        np.asarray(time_s, dtype=np.float64),
        values[kept],
        next((said[key][0] for key in ("model number", "model", "frame") if said.get(key)), "")[:CELL_MAX],
        tuple(notes),
    )


def _titles(header: list[list[str]], width: int, said: dict[str, list[str]]) -> tuple[list[str], list[str]]:
    """The name and the unit of each column, as far as they are told."""
    if not header:
        return [], []
    last = header[-1]
    words = [_unit(cell) for cell in last]
    counted = last[0].casefold() == "sequence"  # Rigol: times are start and increment
    if len(header) > 1 and (counted or words[0] in _SECONDS):  # units have a line of their own
        names, units = header[-2], ["s" if counted else words[0], *words[1:]]
    else:
        parted = [_parted(cell) for cell in last]
        names, units = [name for name, _ in parted], [unit for _, unit in parted]
    if names[0].casefold() == "source":  # Siglent, Tektronix: "Source,CH1,CH2" above "Second,Volt,Volt"
        names = ["time", *names[1:]]
    units = (units + [""] * width)[:width]
    for key in ("horizontal units", "xunits"):
        if key in said and units[0] == "":
            units[0] = _unit(said[key][0])
    of = [_unit(cell.rpartition(":")[2]) for cell in said.get("vertical units", said.get("yunits", [])) if cell]
    if of and not any(units[1:]):
        units = [units[0], *(of * width if len(of) == 1 else of + [""] * width)][:width]
    return names[:width], units


def _parted(cell: str) -> tuple[str, str]:
    """`Current [A]` as its name and its unit."""
    found = _UNIT_BEHIND.fullmatch(cell)
    if found and found["name"]:
        return found["name"].strip(), _unit(found["unit"] or found["slash"] or "")
    if cell == "time_s":
        return "time", "s"
    if re.fullmatch(r"CH\d[VA]", cell):  # Rigol MSO5000
        return cell[:-1], cell[-1]
    unit = _unit(cell)
    return (cell, unit if unit in _SECONDS and cell.casefold() in _WORDS else "")


def _unit(text: str) -> str:
    text = text.strip().strip("()[]").replace("µ", "u").replace("μ", "u")
    unit = _WORDS.get(text.casefold(), text)
    return unit if _UNITS.fullmatch(unit) or unit in _SECONDS else text[:12]


def _name_of(titles: Sequence[str], number: int) -> str:
    name = titles[number] if number < len(titles) else ""
    return f"CH{name}" if name.isdecimal() else name[:CELL_MAX]  # Keysight numbers them


def _once(names: Sequence[str]) -> tuple[str, ...]:
    """Each name once: a second `CH1` is `CH1 (2)`."""
    result: list[str] = []
    for name in names:
        count, own = 1, name
        while own in result:
            count += 1
            own = f"{name} ({count})"
        result.append(own)
    return tuple(result)


def _even(header: list[list[str]]) -> tuple[float | None, float | None]:
    """Start and step of times that are not in the rows [s]: Rigol's."""
    for index, cells in enumerate(header):
        text = ",".join(cells)
        start, step = _START.search(text), _STEP.search(text)
        if start and step:
            return _value(start[1].rstrip("s"), "t0"), _value(step[1].rstrip("s"), "tInc")
        if "Start" in cells and "Increment" in cells and index + 1 < len(header):
            row = [*header[index + 1], *[""] * len(cells)]
            where = f"line {index + 2}, column"
            start_s, step_s = (
                _value(row[at], f"{where} {at + 1}") for at in (cells.index("Start"), cells.index("Increment"))
            )
            return start_s, step_s
    return None, None


def _require_times(time_s: FloatArray, at: int, lines: Sequence[str], first: int) -> None:
    """Raises UsageError where one is missing or before the one above."""
    wrong = np.flatnonzero(~np.isfinite(time_s) | (np.diff(time_s, prepend=-np.inf) < 0))
    if not len(wrong):
        return
    row = int(wrong[0])
    number = [number for number, line in enumerate(lines[first:], first + 1) if line.strip()][row]
    what = "no time" if not np.isfinite(time_s[row]) else f"{time_s[row]:g} s is before {time_s[row - 1]:g} s above it"
    raise UsageError(f"line {number}, column {at + 1}: {what}")


def _evened(time_s: FloatArray, notes: list[str]) -> FloatArray:
    """Times of too few digits for their step, some of which are equal, as even ones."""
    if len(time_s) < 2 or np.all(np.diff(time_s) > 0):
        return time_s
    if time_s[-1] <= time_s[0]:
        raise UsageError("all times are the same")
    notes.append("its times have too few digits, some are equal: taken as even from the first to the last")
    return np.linspace(time_s[0], time_s[-1], len(time_s), dtype=np.float64)


def _is_sideways(line: str) -> bool:
    cells = _cells(line, ",")
    return len(cells) >= 5 and _is_number(cells[3]) and _is_number(cells[4])


def _sideways(lines: Sequence[str]) -> InstrumentTable:
    """Tektronix TDS1000/2000: what the file is of stands to the left of the first rows, in columns 1 and 2."""
    said: dict[str, str] = {}
    rows = []
    for number, line in enumerate(lines, 1):
        if not line.strip():
            continue
        cells = _cells(line, ",")
        if cells[0]:
            said[cells[0].casefold()] = cells[1]
        if len(cells) < 5:
            raise UsageError(f"line {number}: {len(cells)} columns, 5 are a time and a value")
        rows.append([_value(cells[at], f"line {number}, column {at + 1}") for at in (3, 4)])
    table = np.array(rows).T
    header = [["time", said.get("source", "CH1")]]
    header = [
        ["Horizontal Units", said.get("horizontal units", "s")],
        ["Vertical Units", said.get("vertical units", "V")],
        ["Model", said.get("model number", "")],
        *header,
    ]
    table = np.where(np.abs(table) >= HOLE, np.nan, table)
    return _told(header, table, lines, 0)
