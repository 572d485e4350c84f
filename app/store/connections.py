"""The connections that outlive a run: `connections.json` in the data directory, meant to be read by people too."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from pydantic import TypeAdapter

from ..deferred import DEFERRED
from ..devices.core.config import AxisSettings, DeviceConfig, unique_slug
from ..errors import BenchError
from .document import Entries, Entry, writable

FILE_NAME = "connections.json"
FORMAT = "stepscope-connections"
VERSION = 1

NOT_ONE = (BenchError, TypeError, ValueError, KeyError, ArithmeticError, AttributeError)
"""What an entry raises that is no connection, whatever was written into it."""
_axes = TypeAdapter(list[AxisSettings], config=DEFERRED)


@dataclass(frozen=True, slots=True)
class Loaded:
    """What was found. `warnings` are for people: what could not be read, and where it is kept now."""

    configs: list[DeviceConfig]
    warnings: list[str]


class ConnectionStore:
    """Loads and saves connections. Two programs on one directory do not lose each other's."""

    def __init__(self, data_dir: Path) -> None:
        self._entries = Entries(data_dir / FILE_NAME, "connections", FORMAT, VERSION)
        self._base: dict[str, Entry] = {}
        """What the file held when we last saw it: tells our own changes from another program's."""
        self._kept_back: list[Entry] = []
        """What this program cannot use, for a later start or another program that can."""

    @property
    def path(self) -> Path:
        return self._entries.path

    def load(self) -> Loaded:
        """All connections that can be read. Raises nothing for a broken file: it is set aside, and a warning tells."""
        entries, warnings = self._entries.read_or(self._entries.document.kept_as)
        configs: list[DeviceConfig] = []
        unreadable: list[Entry] = []
        for entry in entries:
            try:
                configs.append(_config(entry))
            except NOT_ONE as error:
                unreadable.append(entry)
                why = " ".join(str(error).split())
                warnings.append(f"{self.path}: connection {entry.get('name', '?')!r} left out: {why}")
        if unreadable:
            warnings.append(f"{self.path}: the file as it was is kept as {self._entries.document.kept_as()}")
        self._base = _keyed([*(_entry(config) for config in configs), *unreadable])
        return Loaded(configs, warnings)

    def keep_back(self, config: DeviceConfig) -> None:
        """Leave `config` in the file although it is not among those to be saved.

        For a link that this program has no use for: of a kind it does not know, or with options of another version.
        """
        self._kept_back.append(_entry(config))

    def save(self, configs: Sequence[DeviceConfig]) -> None:
        """Make the file hold `configs`, what was kept back, and what another program put there. Raises OSError."""
        ours = _keyed([*self._kept_back, *(_entry(config) for config in configs if not config.demo)])
        with self._entries.document.locked():
            found, _ = self._entries.read_or(self._entries.document.set_aside)
            theirs = _keyed(_whole(entry) for entry in found if writable(entry))
            kept = {key: self._kept(key, entry, theirs.get(key)) for key, entry in ours.items()}
            # What we never had is another server's; what we had and removed goes, unless another server changed it.
            kept |= {key: entry for key, entry in theirs.items() if key not in ours and entry != self._base.get(key)}
            self._entries.write(list(kept.values()))
            self._base = ours

    def _kept(self, key: str, ours: Entry, theirs: Entry | None) -> Entry:
        """Of two versions the one that was changed since we last looked; ours, where both were."""
        return theirs if theirs is not None and ours == self._base.get(key) else ours


def _keyed(entries: Iterable[Entry]) -> dict[str, Entry]:
    """Entries by a key that stays the same as long as the name does."""
    keyed: dict[str, Entry] = {}
    for entry in entries:
        keyed[unique_slug(str(entry.get("name", "")), keyed)] = entry
    return keyed


def _entry(config: DeviceConfig) -> Entry:
    return {
        "name": config.name,
        "model": config.model,
        "link": dict(config.link),
        "clock_hz": config.clock_hz,
        "axes": [asdict(axis) for axis in config.axes],
        **({"start_up": True} if config.start_up else {}),
    }


def _whole(entry: Entry) -> Entry:
    """An entry with all its keys, as we write it: people leave out what goes without saying."""
    try:
        return _entry(_config(entry))
    except NOT_ONE:
        return entry


def _config(entry: Entry) -> DeviceConfig:
    unknown = set(entry) - {"name", "model", "link", "clock_hz", "axes", "start_up"}
    if unknown:
        raise ValueError(f"unknown keys {', '.join(sorted(unknown))}")
    name, model, link = entry["name"], entry["model"], entry["link"]
    axes, clock_hz = entry.get("axes", []), entry.get("clock_hz", 0.0)
    if not isinstance(name, str) or not isinstance(model, str) or not isinstance(link, dict):
        raise TypeError("name and model are text, link is an object")
    if not isinstance(link.get("kind"), str):
        raise TypeError("the kind of a link is text")
    if not isinstance(axes, list) or not isinstance(clock_hz, int | float) or isinstance(clock_hz, bool):
        raise TypeError("axes is a list, clock_hz a number")
    if not all(isinstance(axis, dict) for axis in axes):
        raise TypeError("each axis is an object")
    if not writable(entry):
        raise ValueError("it has text that is none")
    settings = [AxisSettings.of(axis) for axis in axes]
    _axes.validate_json(json.dumps([asdict(axis) for axis in settings]), strict=True)
    started = entry.get("start_up", False)
    if not isinstance(started, bool):
        raise TypeError("start_up is true or false")
    return DeviceConfig(name, model, link, float(clock_hz), tuple(settings), start_up=started)
