"""A folder of the package that is built from sources: when it is stale, and how it is replaced.

Standard library only: the build hook loads what uses this in an environment that has nothing else.
"""

from __future__ import annotations

import contextlib
import gzip
import hashlib
import importlib.util
import json
import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path

if sys.platform != "win32":
    import fcntl

ROOT = Path(__file__).resolve().parent.parent
STAMP = "build.json"
"""In the folder: the hash of the sources that it was built from."""
# What shrinks lies packed beside itself, so that the server sends it so without packing anything at run time.
PACKED = {".css", ".html", ".js", ".json", ".svg"}
WORTH_PACKING_BYTES = 1000


def bring(module: str, requirement: str) -> bool:
    """Fetch a tool into our own environment where it is missing; False where that is somebody else's to do."""
    if importlib.util.find_spec(module) is not None:
        return True
    if Path(sys.prefix) != ROOT / ".venv":
        return False
    pip = [sys.executable, "-m", "pip", "--disable-pip-version-check", "install", "-qq"]
    subprocess.run([*pip, "--constraint", str(ROOT / "constraints.txt"), requirement], check=True)
    importlib.invalidate_caches()
    return True


def hash_of(root: Path, files: Iterable[Path]) -> str:
    """Return a hash over contents of files, and their names below `root`."""
    digest = hashlib.sha256()
    for path in files:
        digest.update(path.relative_to(root).as_posix().encode())
        digest.update(b"\0")
        digest.update(hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()


def is_built_from(target: Path, sources: str) -> bool:
    """Tell whether `target` was built from the sources of that hash."""
    try:
        stamp: object = json.loads((target / STAMP).read_text())
    except (OSError, ValueError):
        return False
    return isinstance(stamp, dict) and stamp.get("sources") == sources


def gzip_of(plain: bytes) -> bytes:
    """Return `plain` packed by the standard library, the same bytes at any time."""
    return gzip.compress(plain, compresslevel=9, mtime=0)


@contextlib.contextmanager
def alone(sources: Path) -> Iterator[None]:
    """Wait until no other process builds from that folder: two at once would take each other's half away.

    Windows cannot lock a folder: nobody waits there.
    """
    if sys.platform == "win32":
        yield
        return
    folder = os.open(sources, os.O_RDONLY)
    try:
        fcntl.flock(folder, fcntl.LOCK_EX)
        yield
    finally:
        os.close(folder)


def replace(built: Path, target: Path, stamp: Mapping[str, str], pack: Callable[[bytes], bytes] = gzip_of) -> None:
    """Put what was built in place of `target`, packed to gzip's format by `pack`, with its stamp.

    Beside and renamed, so that a running server never serves half a page.
    """
    fresh, old = target.with_name(target.name + ".new"), target.with_name(target.name + ".old")
    for leftover in (fresh, old):
        shutil.rmtree(leftover, ignore_errors=True)
    shutil.copytree(built, fresh)
    _pack(fresh, pack)
    (fresh / STAMP).write_text(json.dumps(stamp, indent=1) + "\n")
    if target.exists():
        target.rename(old)
    fresh.rename(target)
    shutil.rmtree(old, ignore_errors=True)


def _pack(folder: Path, pack: Callable[[bytes], bytes]) -> None:
    for path in sorted(folder.rglob("*")):
        if path.suffix in PACKED and path.stat().st_size >= WORTH_PACKING_BYTES:
            path.with_name(path.name + ".gz").write_bytes(pack(path.read_bytes()))
