"""What every file that outlives a run needs: taking turns with other programs, and a name to set it aside under."""

from __future__ import annotations

import contextlib
import os
import sys
from collections.abc import Iterator
from datetime import UTC, datetime
from fnmatch import fnmatch
from pathlib import Path

if sys.platform != "win32":
    import fcntl


@contextlib.contextmanager
def exclusive(path: Path) -> Iterator[None]:
    """Keep other programs that ask the same from `path` meanwhile. Its directory is made. Raises OSError.

    Not for one thread twice: it would wait for itself.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    # A file of its own: what is replaced or set aside would take a lock on itself along.
    with path.with_name(path.name + ".lock").open("w") as lock:
        if sys.platform != "win32":
            fcntl.flock(lock, fcntl.LOCK_EX)
        yield


class DirectoryInUse(OSError):
    """Another server works on the data directory; the text says which, and what to do."""


class BadTokenFile(OSError):
    """A token cannot be read from its file, nor kept there; the text says why, and what to do."""


@contextlib.contextmanager
def one_server(data_dir: Path, address: str) -> Iterator[None]:
    """Keep a second server from `data_dir` meanwhile: it would delete what this one is writing. Raises DirectoryInUse.

    The lock ends with the process, however that ends. A directory that cannot be written is not locked: nothing is
    kept in it. `address` is what a second server tells its user.
    """
    path = data_dir / "server.lock"
    try:
        data_dir.mkdir(parents=True, exist_ok=True)
        lock = path.open("a+", encoding="utf-8")
    except OSError:
        yield
        return
    with lock:
        if sys.platform != "win32":
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError as error:
                lock.seek(0)
                other = lock.read(200).strip() or "another stepscope"
                raise DirectoryInUse(
                    f"{data_dir} is in use by {other}; stop that one, or give this one another --data-dir"
                ) from error
        with contextlib.suppress(OSError):  # a full disk: locked all the same
            lock.truncate(0)
            lock.write(f"the stepscope at {address} (process {os.getpid()})")
            lock.flush()
        yield


def aside_name(path: Path) -> Path:
    """A name beside `path` that nothing has yet, for a file that cannot be read."""
    stamp = datetime.now(UTC).strftime("%Y%m%d-%H%M%S")
    number = 0
    while True:
        suffix = f"-{number}" if number else ""
        aside = path.with_name(f"{path.stem}.broken-{stamp}{suffix}{path.suffix}")
        if not aside.exists():
            return aside
        number += 1


OTHERS = 0o077
"""Rights of everybody but the owner."""
OURS = (
    "connections*",
    "positions*",
    "tokens*",
    "stepscope.*",
    "server.lock",
    "recordings",
    "emulators",
    "unfinished-*",
    "register-maps",
    "layouts",
    "macros",
)
"""What a data directory of stepscope holds, as patterns."""


def kept_token(path: Path, new: str) -> str:
    """What stands in the file, or `new` in a file made with it, for its owner alone.

    Raises BadTokenFile where it cannot be read or made, or is empty.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with contextlib.suppress(FileExistsError), path.open("x", encoding="utf-8") as file:
            path.chmod(0o600)
            file.write(new + "\n")
        token = path.read_text(encoding="utf-8").strip()
    except (OSError, UnicodeDecodeError) as error:
        raise BadTokenFile(f"the token cannot be kept in {path}: {error}; name another file: --token-file") from error
    if not token:
        raise BadTokenFile(f"{path} has no token in it: delete it, and the next start makes one")
    return token


def make_private(data_dir: Path) -> list[str]:
    """Let nobody but its owner into `data_dir`, which is made: it has tokens and what everybody did.

    Returns, for people, what was open to others and is no more, or could not be changed. A directory that holds other
    things too is left as it is: only our own files in it are closed.
    """
    if os.name != "posix":
        return []
    told: list[str] = []
    try:
        data_dir.mkdir(mode=0o700, parents=True, exist_ok=True)
        entries = list(data_dir.iterdir())
        ours = [each for each in entries if any(fnmatch(each.name, pattern) for pattern in OURS)]
        closed = [each.name for each in ours if not each.is_symlink() and _close(each)]
        if closed:
            told.append(f"in {data_dir}, others could read {', '.join(sorted(closed))}: now its owner alone can")
        if len(ours) == len(entries):
            if _close(data_dir):
                told.append(f"{data_dir} was open to others: now its owner alone can look into it")
        elif data_dir.stat().st_mode & OTHERS:
            told.append(f"{data_dir} holds other things too and stays open to others: give stepscope one of its own")
    except OSError as error:  # of another user, read-only: that must not keep the server from starting
        told.append(f"{data_dir} cannot be closed to others: {error.strerror or error}")
    return told


def _close(path: Path) -> bool:
    """Take from `path` what others may do with it; whether there was anything to take. Raises OSError."""
    mode = path.stat().st_mode
    if not mode & OTHERS:
        return False
    path.chmod(mode & 0o7777 & ~OTHERS)
    return True
