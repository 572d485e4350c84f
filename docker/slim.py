"""Takes out of an environment what a container never uses: tests, headers, symbols, and unused parts.

What is left out of requirements.txt altogether is in scripts/lock.py.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

TESTS = {"tests"}
SOURCES = {".a", ".h", ".hpp", ".pxd", ".pxi", ".pyi", ".pyx"}
UNUSED = {
    "pyarrow": ("*flight*", "*_s3*", "_pyarrow_cpp_tests*", "include", "src"),
    "viser": ("client/src", "client/package-lock.json"),
}
"""Arrow Flight, Amazon S3, tests and headers, which recordings need none of; what the page of viser is built of."""
ELF = b"\x7fELF"
REPACKED = ".libs"
"""Folders of libraries that auditwheel has put into a wheel: `strip` breaks what it has rewritten."""


def main(folder: Path) -> None:
    """Do it, and say what it brought."""
    before = size_bytes(folder)
    (packages,) = folder.glob("lib/python*/site-packages")
    for path in unused(packages):
        if path.is_dir() and not path.is_symlink():
            shutil.rmtree(path)
        else:
            path.unlink(missing_ok=True)
    for library in libraries(packages):
        subprocess.run(["strip", "--strip-unneeded", str(library)], check=True)
    print(f"{before / 1e6:.0f} MB before, {size_bytes(folder) / 1e6:.0f} MB now")


def unused(packages: Path) -> Iterator[Path]:
    """Files and folders that nothing here imports or loads, the outermost only."""
    for path in sorted(packages.rglob("*")):
        if (path.is_dir() and path.name in TESTS) or path.suffix in SOURCES:
            yield path
    for package, patterns in UNUSED.items():
        for pattern in patterns:
            yield from sorted((packages / package).glob(pattern))


def libraries(packages: Path) -> Iterator[Path]:
    """Libraries that may be stripped."""
    for path in sorted(packages.rglob("*.so*")):
        inside = path.relative_to(packages).parts[0]
        if path.is_file() and not path.is_symlink() and not inside.endswith(REPACKED):
            with path.open("rb") as file:
                if file.read(len(ELF)) == ELF:
                    yield path


def size_bytes(folder: Path) -> int:
    """All files of it [bytes]."""
    return sum(path.stat().st_size for path in folder.rglob("*") if path.is_file() and not path.is_symlink())


if __name__ == "__main__":
    main(Path(sys.argv[1]))
