"""What the module keeps without power: a small JSON file, or just memory.

Only what differs from factory settings is kept, so that an erased EEPROM is an empty file. A file is replaced as a
whole: whoever kills the process finds the old or the new state, never half of one.
"""

from __future__ import annotations

import contextlib
import json
import logging
import os
import shutil
from pathlib import Path

from ...registers.tmcl.commands import PROGRAM_COMMANDS, Status
from .refused import Refused

log = logging.getLogger("stepscope.emulators")

COMMAND_BYTES = 7
_FORMAT = 1


class Eeprom:
    """Global parameters of bank 0, axis parameters, user variables, coordinates and the program."""

    def __init__(self, path: Path | None = None) -> None:
        """An EEPROM in `path`, created with the first write. A file that cannot be read counts as erased."""
        self.path = path
        self.globals: dict[int, int] = {}
        self.axis: dict[int, int] = {}
        self.variables: dict[int, int] = {}
        self.coordinates: dict[int, int] = {}
        self.program: dict[int, bytes] = {}
        self.writes = 0
        """How often it was written since the module was made."""
        if path is not None and path.exists():
            try:
                self._take(json.loads(path.read_text(encoding="utf-8")))
            except (OSError, ValueError, TypeError, KeyError, AttributeError, ArithmeticError, RecursionError) as error:
                self._forget()
                aside = path.with_name(f"{path.name}.broken")
                with contextlib.suppress(OSError):
                    shutil.copyfile(path, aside)
                log.warning("the emulated EEPROM %s cannot be read, and is kept as %s: %s", path, aside, error)

    def save(self) -> None:
        """Write through to the file. Raises Refused (EEPROM locked) where the file cannot be written."""
        self.writes += 1
        if self.path is None:
            return
        text = json.dumps(
            {
                "format": _FORMAT,
                "globals": _keys(self.globals),
                "axis": _keys(self.axis),
                "variables": _keys(self.variables),
                "coordinates": _keys(self.coordinates),
                "program": {str(at): command.hex() for at, command in sorted(self.program.items())},
            },
            indent=1,
        )
        aside = self.path.with_name(self.path.name + ".new")
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            aside.write_text(text, encoding="utf-8")
            os.replace(aside, self.path)
        except OSError as error:
            log.warning("the emulated EEPROM %s cannot be written: %s", self.path, error)
            raise Refused(Status.EEPROM_LOCKED) from error

    def erase(self) -> None:
        """Back to factory settings."""
        self._forget()
        self.save()

    def _forget(self) -> None:
        self.globals.clear()
        self.axis.clear()
        self.variables.clear()
        self.coordinates.clear()
        self.program.clear()

    def _take(self, kept: dict[str, object]) -> None:
        if kept["format"] != _FORMAT:
            raise ValueError(f"format {kept['format']} is not {_FORMAT}")
        for name, numbers in (
            ("globals", self.globals),
            ("axis", self.axis),
            ("variables", self.variables),
            ("coordinates", self.coordinates),
        ):
            part = kept.get(name, {}) if name == "axis" else kept[name]  # files of before had none
            if not isinstance(part, dict):
                raise TypeError(f"{name} is no object")
            numbers.update({int(number): int(value) for number, value in part.items()})
        program = kept["program"]
        if not isinstance(program, dict):
            raise TypeError("program is no object")
        for at, text in program.items():
            command = bytes.fromhex(text)
            if len(command) != COMMAND_BYTES or not 0 <= int(at) < PROGRAM_COMMANDS:
                raise ValueError(f"command {at} is {len(command)} bytes long")
            self.program[int(at)] = command


def _keys(numbers: dict[int, int]) -> dict[str, int]:
    return {str(number): value for number, value in sorted(numbers.items())}
