"""The extended positions that outlive a run: `positions.json` in the data directory.

Numbers of 64 bits are text there, since most readers of JSON end at 2^53, and fractions are "n/d", exactly.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

from .document import Entries, Entry, writable

FILE_NAME = "positions.json"
FORMAT = "stepscope-positions"
VERSION = 1

Gear = tuple[int, int, int]
"""Microsteps per turn of the motor, teeth on the motor, teeth on the driven shaft."""


@dataclass(frozen=True, slots=True)
class SavedPosition:
    """One watched axis as it was at a look. Positions in microsteps.

    device : the connection's id; `model` and `link` are its own, so that another chip is not taken for it
    count, bits : what the counter showed, and how many bits it has
    seen_unix_s : when the counter was read, at the earliest, Unix time [s]
    lost : why the position was not trusted, "" where it was
    microsteps_per_turn, gear, zero : None, None, 0 of an axis that is not rotary
    compare : the position that the compare register is for; None for none
    """

    device: str
    model: str
    link: str
    axis: int
    bits: int
    count: int
    position: int
    seen_unix_s: float
    lost: str = ""
    microsteps_per_turn: Fraction | None = None
    gear: Gear | None = None
    zero: int = 0
    compare: int | None = None

    @property
    def key(self) -> tuple[str, int]:
        return self.device, self.axis


@dataclass(frozen=True, slots=True)
class LoadedPositions:
    """What was found. `warnings` are for people: what could not be read, and where it is kept now."""

    positions: list[SavedPosition]
    warnings: list[str]


class PositionStore:
    """Loads and saves positions. Those of devices that this program does not have stay in the file."""

    def __init__(self, data_dir: Path) -> None:
        self._entries = Entries(data_dir / FILE_NAME, "positions", FORMAT, VERSION, name="device")
        self._ours: set[tuple[str, int]] = set()
        """What this program has saved or loaded: what of it is gone, it has given up."""

    @property
    def path(self) -> Path:
        return self._entries.path

    def load(self) -> LoadedPositions:
        """All that can be read. Raises nothing for a broken file: it is set aside, and a warning tells."""
        entries, warnings = self._entries.read_or(self._entries.document.kept_as)
        positions: list[SavedPosition] = []
        for entry in entries:
            try:
                positions.append(_position(entry))
            except (TypeError, ValueError, KeyError, ArithmeticError) as error:
                warnings.append(f"{self.path}: position of {entry.get('device', '?')!r} left out: {error!r}")
        if entries and warnings:
            warnings.append(f"{self.path}: the file as it was is kept as {self._entries.document.kept_as()}")
        self._ours = {position.key for position in positions}
        return LoadedPositions(positions, warnings)

    def save(self, positions: Sequence[SavedPosition]) -> None:
        """Make the file hold `positions`, and what another program put there. Raises OSError."""
        ours = {position.key for position in positions}
        with self._entries.document.locked():
            found, _ = self._entries.read_or(self._entries.document.set_aside)
            others = [entry for entry in found if _key(entry) not in ours | self._ours and writable(entry)]
            self._entries.write([*(_entry(position) for position in positions), *others])
        self._ours = ours


def _key(entry: Entry) -> tuple[str, int] | None:
    device, axis = entry.get("device"), entry.get("axis")
    return (device, axis) if isinstance(device, str) and isinstance(axis, int) else None


def _entry(saved: SavedPosition) -> Entry:
    turn = saved.microsteps_per_turn
    return {
        "device": saved.device,
        "model": saved.model,
        "link": saved.link,
        "axis": saved.axis,
        "counter_bits": saved.bits,
        "count": saved.count,
        "position": str(saved.position),
        "seen_unix_s": saved.seen_unix_s,
        "doubt": saved.lost,
        "microsteps_per_turn": None if turn is None else str(turn),
        "gear": None if saved.gear is None else list(saved.gear),
        "zero": str(saved.zero),
        "compare": None if saved.compare is None else str(saved.compare),
    }


def _position(entry: Entry) -> SavedPosition:
    turn, gear, compare = entry["microsteps_per_turn"], entry["gear"], entry["compare"]
    seen = entry["seen_unix_s"]
    if isinstance(seen, bool) or not isinstance(seen, int | float):
        raise TypeError(f"seen_unix_s is a number, not {seen!r}")
    return SavedPosition(
        device=_text(entry, "device"),
        model=_text(entry, "model"),
        link=_text(entry, "link"),
        axis=_whole(entry["axis"]),
        bits=_whole(entry["counter_bits"]),
        count=_whole(entry["count"]),
        position=_whole(_text(entry, "position")),
        seen_unix_s=float(seen),
        lost=_text(entry, "doubt"),
        microsteps_per_turn=None if turn is None else Fraction(_text(entry, "microsteps_per_turn")),
        gear=None if gear is None else _gear(gear),
        zero=_whole(_text(entry, "zero")),
        compare=None if compare is None else _whole(_text(entry, "compare")),
    )


def _text(entry: Entry, key: str) -> str:
    value = entry[key]
    if not isinstance(value, str):
        raise TypeError(f"{key} is text, not {value!r}")
    return value


def _whole(value: object) -> int:
    if isinstance(value, bool) or not isinstance(value, int | str):
        raise TypeError(f"{value!r} is no whole number")
    return int(value)


def _gear(value: object) -> Gear:
    if not isinstance(value, list) or len(value) != 3:
        raise TypeError(f"a gear is three numbers, not {value!r}")
    per_turn, motor, driven = (_whole(part) for part in value)
    return per_turn, motor, driven
