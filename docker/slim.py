"""Takes out of an environment what a container never uses: tests, headers, symbols, unused parts, second copies.

What is left out of requirements.txt altogether is in scripts/lock.py.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

TESTS = {"tests"}
SOURCES = {".a", ".c", ".cpp", ".h", ".hpp", ".pxd", ".pxi", ".pyi", ".pyx"}
UNUSED = {
    "pyarrow": (
        *("*flight*", "*_s3*", "_pyarrow_cpp_tests*", "include", "src"),
        *("_substrait*", "_orc*", "_azurefs*", "_gcsfs*", "_hdfs*", "*_parquet_encryption*", "_dataset*", "_acero*"),
        *("_feather*", "_json*", "_compute*", "compute.py"),
    ),
    "viser": ("client/src", "client/package-lock.json", "_icons/*.zip"),
    "numba": ("cuda", "pycc", "testing"),
    "numpy": ("_core/_simd.*", "_core/*_tests.*"),
    "scipy": (
        *("cluster", "datasets", "fftpack", "io", "misc", "odr", "signal", "stats/_unuran", "_lib/cobyqa"),
        *("_lib/pyprima", "stats/_sobol_direction_numbers.npz", "special/_test_internal.*"),
    ),
    "sqlalchemy": (
        "testing",
        "ext/asyncio",
        "ext/mypy",
        *(f"dialects/{name}" for name in ("mssql", "mysql", "oracle")),
    ),
    "alembic": ("testing",),
    "zstandard": ("_cffi*", "backend_cffi.py"),
    "optuna": ("visualization", "testing"),
    "pydantic": ("v1",),
    "": ("*.dist-info/RECORD",),
}
"""Of recordings: Arrow Flight, stores in clouds, data sets, Substrait, ORC, Feather, JSON, calculations, encryption,
tests and headers; what the page of viser is built of, and icons for its own panels; graphics cards and compilers ahead
of time; NumPy's tests of itself; parts of SciPy that its statistics stand without; databases but SQLite and one that
alembic imports; a second way into Zstandard; plots of Optuna's own; Pydantic as it was before; what an uninstallation
would need."""
NAMED_ONLY = ("pyarrow", "libarrow.so.*", ("libarrow_substrait.so.*", "libarrow_dataset.so.*", "libarrow_acero.so.*"))
"""Libraries that each module of a package names and none of those that are left calls: they become links to one that is
loaded anyway, else the loader would miss them."""
LEXERS = ("pygments/lexers", {"__init__.py", "_mapping.py", "python.py", "special.py"})
"""Python alone is shown in colours, in tracebacks."""
PACKED = ("stepscope", ".gz")
"""What the build has packed is kept only so: the server unpacks it for who takes no gzip."""
ELF = b"\x7fELF"
SHARED_BYTES_MIN = 100_000
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
    link_what_is_only_named(packages)
    share(packages)
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
    package, packed = PACKED
    for path in sorted((packages / package).rglob(f"*{packed}")):
        yield path.with_name(path.name.removesuffix(packed))
    lexers, kept = LEXERS
    yield from (path for path in sorted((packages / lexers).glob("*.py")) if path.name not in kept)


def link_what_is_only_named(packages: Path) -> None:
    """Have the loader find `NAMED_ONLY` without their code."""
    package, loaded, named = NAMED_ONLY
    for target in (packages / package).glob(loaded):
        for pattern in named:
            for path in (packages / package).glob(pattern):
                path.unlink()
                path.symlink_to(target.name)


def share(packages: Path) -> None:
    """Make one file and links of libraries that are there several times: wheels hold no links."""
    found: dict[tuple[int, str], Path] = {}
    for path in sorted(packages.rglob("*.so*")):
        if not path.is_file() or path.is_symlink() or path.stat().st_size < SHARED_BYTES_MIN:
            continue
        first = found.setdefault((path.stat().st_size, hashlib.sha256(path.read_bytes()).hexdigest()), path)
        if first != path:
            path.unlink()
            path.symlink_to(os.path.relpath(first, path.parent))


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
