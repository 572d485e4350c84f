"""Register maps of this server: files in the folder `register-maps` of its data directory, put there by hand or by us.

What the folder holds is scanned on demand: a map that was dropped in is there then, one that was changed is
read again, one that is gone is forgotten. But a map that a connected device was made of stays as it was until that is
disconnected, whatever happens to its file.
"""

from __future__ import annotations

import contextlib
import os
import stat
import tempfile
import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from ..errors import StoreUnavailable, UnknownThing, UsageError, WrongState
from ..registers.maps.csv_import import read_csv
from ..registers.maps.findings import Finding, UnreadableMap
from ..registers.maps.reader import BYTES_MAX, NAME, RegisterMap, read

FOLDER = "register-maps"
KEPT_MAX = 100
"""Maps; files beyond that are passed over, in the order of their names."""

Stamp = tuple[int, int, int]
Users = Mapping[str, Mapping[str, bool]]
"""By name of a map, the ids of the devices that are made of it, and whether each is connected, or tries to be."""
OTHERWISE = "its file says something else by now: disconnect, and it is taken over"


@dataclass(frozen=True, slots=True)
class StoredMap:
    """A file of the folder.

    found : what it says, or why it cannot be read. behind : why a device goes by `found` although its file says
    something else by now; empty where it does not
    """

    name: str
    path: Path
    bytes: int
    found: RegisterMap | UnreadableMap
    behind: str = ""


class RegisterMaps:
    """The folder. `reserved` tells names that are those of other models.

    Safe to use from several threads: reading a large map takes some tenths of a second, which no stop may wait for.
    """

    def __init__(self, data_dir: Path, reserved: Callable[[str], bool]) -> None:
        self.folder = data_dir / FOLDER
        self._reserved = reserved
        self._kept: dict[str, tuple[Stamp, StoredMap]] = {}
        self._turn = threading.RLock()
        self.passed_over: list[str] = []
        """Files that are no maps by their names, or too many, for people."""

    def scan(self, users: Users) -> list[StoredMap]:
        """What the folder holds now, by name. Raises StoreUnavailable where it cannot be looked into."""
        with self._turn:
            self._scan(users)
            return [kept for _, kept in self._kept.values()]

    def content(self, name: str) -> bytes:
        """The file as it is. Raises UnknownThing, StoreUnavailable."""
        with self._turn:
            if name not in self._kept:
                raise UnknownThing("register map", name, list(self._kept))
            path = self._kept[name][1].path
        try:
            with path.open("rb") as file:
                return file.read(BYTES_MAX)
        except OSError as error:
            raise _unavailable(error) from error

    def put(self, name: str, content: bytes, users: Users, *, csv: bool = False, dry_run: bool = False) -> StoredMap:
        """Keep a map, instead of the one of that name; a table becomes a map.

        Raises UnreadableMap with every mistake, UsageError for a name that cannot be, WrongState where a connected
        device uses it or there are too many, StoreUnavailable. Then nothing has changed.
        """
        self.require_name(name)
        if csv:
            found, text = read_csv(name, content)
            content = text.encode()
        else:
            found = read(name, content)
        path = self.folder / f"{name}.toml"
        with self._turn:
            self._scan(users)
            if connected := [device for device, connected in users.get(name, {}).items() if connected]:
                raise WrongState(f"{_use(connected, name)}, which stays as it is for that long", "disconnect first")
            if name not in self._kept and len(self._kept) >= KEPT_MAX:
                raise WrongState(f"{KEPT_MAX} register maps are kept already", "delete some of them")
            if dry_run:
                return StoredMap(name, path, len(content), found)
            try:
                self._write(path, content)
            except OSError as error:
                raise _unavailable(error) from error
            self._scan(users)
            return self._kept[name][1]

    def delete(self, name: str, users: Users) -> None:
        """Raises UnknownThing; WrongState while there are devices that are made of it, connected or not."""
        with self._turn:
            self._scan(users)
            if name not in self._kept:
                raise UnknownThing("register map", name, list(self._kept))
            if users.get(name):
                raise WrongState(_use(list(users[name]), name), "remove it first")
            try:
                self._kept[name][1].path.unlink(missing_ok=True)
            except OSError as error:
                raise _unavailable(error) from error
            self._scan(users)

    def require_name(self, name: str) -> None:
        """Raises UsageError for a name that no map can have."""
        if not NAME.fullmatch(name):
            raise UsageError(
                f"a register map is called by small letters, digits and dashes, 40 at most, not {name[:60]!r}"
            )
        if self._reserved(name):
            raise UsageError(f"{name} is a model already: give the register map another name")

    # --- inside ---------------------------------------------------------------------------------

    def _scan(self, users: Users) -> None:
        try:
            paths = sorted(self.folder.glob("*.toml"))
        except OSError as error:
            raise _unavailable(error) from error
        self.passed_over = []
        seen: dict[str, tuple[Stamp, StoredMap]] = {}
        for path in paths:
            try:
                stamp = self._stamp(path, room=len(seen) < KEPT_MAX)
            except UsageError as error:
                self.passed_over.append(f"{path.name[:60]}: {error}")
            except OSError as error:
                self.passed_over.append(f"{path.name[:60]}: {error.strerror or error}")
            else:
                seen[path.stem] = self._seen(path, stamp, users.get(path.stem, {}))
        for name, (stamp, kept) in self._kept.items():
            if name not in seen and users.get(name) and isinstance(kept.found, RegisterMap):
                seen[name] = stamp, replace(kept, behind="its file is gone")
        self._kept = dict(sorted(seen.items()))

    def _stamp(self, path: Path, *, room: bool) -> Stamp:
        """What changes as the file does. Raises UsageError for what is no map, OSError."""
        if not room:
            raise UsageError(f"there are {KEPT_MAX} maps already")
        self.require_name(path.stem)
        state = path.stat()
        if not stat.S_ISREG(state.st_mode):
            raise UsageError("it is no file")
        return state.st_mtime_ns, state.st_size, state.st_ino

    def _seen(self, path: Path, stamp: Stamp, users: Mapping[str, bool]) -> tuple[Stamp, StoredMap]:
        name = path.stem
        known = self._kept.get(name)
        if known is not None and known[0] == stamp and known[1].behind in ("", OTHERWISE):
            return known[0], replace(known[1], behind="")
        if known is None or not users or not isinstance(known[1].found, RegisterMap):
            return stamp, StoredMap(name, path, stamp[1], self._read(name, path))
        if any(users.values()):
            return known[0], replace(known[1], behind=OTHERWISE)
        found = self._read(name, path)
        if isinstance(found, UnreadableMap):
            return known[0], replace(known[1], behind=f"its file cannot be read: {found}"[:400])
        return stamp, StoredMap(name, path, stamp[1], found)

    @staticmethod
    def _read(name: str, path: Path) -> RegisterMap | UnreadableMap:
        try:
            with path.open("rb") as file:
                return read(name, file.read(BYTES_MAX + 1))
        except UnreadableMap as error:
            return error
        except OSError as error:
            return UnreadableMap(name, [Finding(1, "", error.strerror or str(error))])

    def _write(self, path: Path, content: bytes) -> None:
        self.folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        handle, temporary = tempfile.mkstemp(prefix=f"{path.name}.", suffix=".tmp", dir=self.folder)
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(content)
                file.flush()
                os.fsync(file.fileno())
            Path(temporary).replace(path)
        except BaseException:
            with contextlib.suppress(OSError):
                Path(temporary).unlink()
            raise


def _use(devices: Sequence[str], name: str) -> str:
    return f"{', '.join(devices)} {'uses' if len(devices) == 1 else 'use'} the register map {name}"


def _unavailable(error: OSError) -> StoreUnavailable:
    return StoreUnavailable(
        f"the folder of register maps cannot be used: {error.strerror or error}", "look after the data directory"
    )
