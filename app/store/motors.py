"""The user's own motors: a file in the data directory."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import asdict, fields
from pathlib import Path

from ..calc.motors.data_base import Motor
from ..errors import StoreUnavailable, UnknownThing, UsageError
from .document import Entries, Entry

KEPT_MAX = 1000

log = logging.getLogger("stepscope.motors")


class OwnMotors:
    """Motors by name, each write on disk when it returns. Safe to use from several threads."""

    def __init__(self, data_dir: Path) -> None:
        self._file = Entries(data_dir / "motors.json", "motors", "stepscope-motors", 1)

    def all(self) -> Sequence[Motor]:
        """By name. What the file has and cannot be a motor is left out, and stays in it until the next write."""
        entries, problems = self._file.read_or(self._file.document.kept_as)
        for problem in problems:
            log.warning("%s", problem)
        return sorted(filter(None, map(_motor, entries)), key=lambda motor: motor.name.casefold())

    def put(self, motor: Motor) -> None:
        """Keep a motor, instead of the one of that name. Raises StoreUnavailable; UsageError at KEPT_MAX."""
        with self._file.document.locked():
            others = [each for each in self.all() if each.name != motor.name]
            if len(others) >= KEPT_MAX:
                raise UsageError(f"{KEPT_MAX} motors are kept already: delete one")
            self._write([*others, motor])

    def delete(self, name: str) -> None:
        """Forget a motor. Raises UnknownThing, StoreUnavailable."""
        with self._file.document.locked():
            kept = self.all()
            left = [each for each in kept if each.name != name]
            if len(left) == len(kept):
                raise UnknownThing("motor of your own", name, [each.name for each in kept])
            self._write(left)

    def _write(self, motors: Sequence[Motor]) -> None:
        entries = [{key: value for key, value in asdict(each).items() if key != "source"} for each in motors]
        try:
            self._file.path.parent.mkdir(parents=True, exist_ok=True)
            self._file.write(entries)
        except OSError as error:
            raise StoreUnavailable(
                f"the motor is not kept: {error}", "see to the disk of the data directory"
            ) from error


def _motor(entry: Entry) -> Motor | None:
    names = {each.name for each in fields(Motor)} - {"source"}
    try:
        motor = Motor(**{key: value for key, value in entry.items() if key in names})  # type: ignore[arg-type]
        sound = isinstance(motor.name, str) and motor.rated_current_a > 0 and motor.full_steps_per_rev > 0
    except TypeError:
        return None
    return motor if sound else None
