"""On which line of a TOML document each of its values stands.

`tomllib` of the standard library reads the document, and tells the line of what is no TOML; of what it has read it
tells none. No well-kept parser for Python does (tomlkit keeps the text of each item, not where it stands), so this
walks through the text once, for places alone: what a value is, and whether all of it is TOML, `tomllib` says. It goes
first, for it also refuses what is nested so deeply, or has keys of so many parts, that `tomllib` would take its time
over it.
"""

from __future__ import annotations

import contextlib
import re
import tomllib
from bisect import bisect_right

DEPTH_MAX = 8
"""Tables in tables, and parts of a key."""

Place = tuple[str | int, ...]
"""The way to a value: ("register", 2, "address")."""

_BLANK = re.compile(r"(?:[ \t\r\n]|#[^\n]*)*")
_SPACE = re.compile(r"[ \t]*")
_REST = re.compile(r"[^\n]*")
_BARE = re.compile(r"[A-Za-z0-9_-]+")
_SCALAR = re.compile(r"[^,\]}#\n]*")
_STRING = re.compile(
    r'"""(?:[^\\"]|\\[\s\S]|"{1,2}(?!"))*"{3,5}' r"|'''[\s\S]*?'{3,5}" r'|"(?:[^"\\\n]|\\[^\n])*"' r"|'[^'\n]*'"
)


class TooDeep(ValueError):
    """Nested too deeply; `line` says where."""

    def __init__(self, line: int) -> None:
        super().__init__(f"nested deeper than {DEPTH_MAX} levels")
        self.line = line


class Lines:
    """Lines of what a document holds, counted from 1. What is no TOML ends it there, without an error.

    Raises TooDeep.
    """

    def __init__(self, text: str) -> None:
        self._text = text
        self._at = 0
        self._ends = [found.start() for found in re.finditer("\n", text)]
        self._tables: dict[Place, int] = {}
        """How many tables each array of tables has so far."""
        self._of: dict[Place, int] = {(): 1}
        with contextlib.suppress(_NoToml):
            self._document()

    def of(self, place: Place) -> int:
        """The line of what stands at `place`; where nothing does, of what it would be in."""
        while place not in self._of:
            place = place[:-1]
        return self._of[place]

    @property
    def last(self) -> int:
        """The document's last line."""
        return self._line(max(len(self._text.rstrip()) - 1, 0))

    # --- the walk -------------------------------------------------------------------------------

    def _document(self) -> None:
        table: Place = ()
        while True:
            self._skip(_BLANK)
            if self._at >= len(self._text):
                return
            if self._text.startswith("[", self._at):
                table = self._header()
            else:
                self._entry(table)
            self._skip(_REST)

    def _header(self) -> Place:
        line = self._line(self._at)
        several = self._text.startswith("[[", self._at)
        self._at += 2 if several else 1
        *outer, last = self._key()
        self._expect("]]" if several else "]")
        place: Place = ()
        for key in outer:
            place = self._latest((*place, key))
        place = (*place, last)
        if several:
            self._tables[place] = self._tables.get(place, 0) + 1
            self._of.setdefault(place, line)
        place = self._latest(place)
        self._of[place] = line
        return place

    def _latest(self, place: Place) -> Place:
        """Of an array of tables its last one."""
        return (*place, self._tables[place] - 1) if place in self._tables else place

    def _entry(self, table: Place) -> None:
        line = self._line(self._at)
        place = table
        for key in self._key():
            place = (*place, key)
            self._of.setdefault(place, line)
        if len(place) > 2 * DEPTH_MAX:  # numbers of arrays among them
            raise TooDeep(line)
        self._expect("=")
        self._skip(_SPACE)
        self._value(place)

    def _key(self) -> list[str]:
        parts: list[str] = []
        line = self._line(self._at)
        while True:
            self._skip(_SPACE)
            found = _BARE.match(self._text, self._at) or _STRING.match(self._text, self._at)
            if found is None:
                raise _NoToml
            self._at = found.end()
            parts.append(found[0] if found[0][0] not in "\"'" else _decoded(found[0]))
            if len(parts) > DEPTH_MAX:
                raise TooDeep(line)
            self._skip(_SPACE)
            if not self._text.startswith(".", self._at):
                return parts
            self._at += 1

    def _value(self, place: Place, depth: int = 0) -> None:
        if depth > DEPTH_MAX:
            raise TooDeep(self._line(self._at))
        if found := _STRING.match(self._text, self._at):
            self._at = found.end()
        elif self._text.startswith("[", self._at):
            self._at += 1
            self._elements(place, depth)
        elif self._text.startswith("{", self._at):
            self._at += 1
            self._pairs(place, depth)
        else:
            self._skip(_SCALAR)

    def _elements(self, place: Place, depth: int) -> None:
        index = 0
        while not self._closed("]"):
            self._of[(*place, index)] = self._line(self._at)
            self._value((*place, index), depth + 1)
            index += 1
            self._comma("]")

    def _pairs(self, place: Place, depth: int) -> None:
        while not self._closed("}"):
            line, inner = self._line(self._at), place
            for key in self._key():
                inner = (*inner, key)
                self._of.setdefault(inner, line)
            self._expect("=")
            self._skip(_BLANK)
            self._value(inner, depth + 1)
            self._comma("}")

    def _closed(self, end: str) -> bool:
        self._skip(_BLANK)
        if self._text.startswith(end, self._at):
            self._at += 1
            return True
        if self._at >= len(self._text):
            raise _NoToml
        return False

    def _comma(self, end: str) -> None:
        self._skip(_BLANK)
        if self._text.startswith(",", self._at):
            self._at += 1
        elif not self._text.startswith(end, self._at):
            raise _NoToml

    def _expect(self, token: str) -> None:
        if not self._text.startswith(token, self._at):
            raise _NoToml
        self._at += len(token)

    def _skip(self, what: re.Pattern[str]) -> None:
        found = what.match(self._text, self._at)
        assert found is not None  # all of them match nothing, too
        self._at = found.end()

    def _line(self, at: int) -> int:
        return bisect_right(self._ends, at - 1) + 1


class _NoToml(Exception):
    """What comes is no TOML: `tomllib` tells what is wrong with it."""


def _decoded(key: str) -> str:
    """A key in quotes as the document has it."""
    try:
        decoded = tomllib.loads(f"key = {key}")["key"]
    except tomllib.TOMLDecodeError as error:
        raise _NoToml from error
    assert isinstance(decoded, str)
    return decoded
