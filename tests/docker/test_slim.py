"""What the image leaves out of its packages, and what it never touches."""

from __future__ import annotations

import ast
import importlib.util
import subprocess
import sys
from fnmatch import fnmatch
from pathlib import Path
from types import ModuleType

import pytest

from tests.docker.test_files import DOCKER, ROOT


def slim() -> ModuleType:
    return module_of("slim")


def module_of(name: str) -> ModuleType:
    """A program in docker/, which is no part of a package."""
    spec = importlib.util.spec_from_file_location(name, DOCKER / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_tests_headers_and_unused_libraries_go_and_what_is_imported_stays(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    kept: tuple[str, ...] = (
        "numpy/core.py",
        "numpy/testing/__init__.py",
        "numpy-2.4.6.dist-info/METADATA",
        "pyarrow/libarrow.so.2600",
        "pyarrow/parquet.py",
        "pygments/lexers/python.py",
        "sqlalchemy/dialects/sqlite/base.py",
        "sqlalchemy/ext/compiler.py",
        "stepscope/_web/assets/index-abc.js.gz",
        "stepscope/_web/logo.png",
    )
    gone: tuple[str, ...] = (
        "numpy/tests/test_core.py",
        "numpy/core.h",
        "scipy/_lib.pyx",
        "pyarrow/libarrow_flight.so.2600",
    )
    gone += ("pyarrow/_compute.cpython-312.so", "pyarrow/compute.py")
    gone += ("pygments/lexers/perl.py", "scipy/io/matlab.py", "sqlalchemy/testing/engines.py")
    gone += ("stepscope/_web/assets/index-abc.js", "numba/_lapack.c")
    gone += ("numpy-2.4.6.dist-info/RECORD", "scipy/_lib/cobyqa/main.py")
    gone += ("pyarrow/include/arrow/api.h", "pyarrow/libarrow_s3.so.2600", "pyarrow/_s3fs.cpython-312.so")
    for name in (*kept, *gone):
        path = tmp_path / "lib/python3.12/site-packages" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(b"")
    module = slim()
    monkeypatch.setattr(module, "libraries", lambda packages: ())  # these are none that `strip` would know
    module.main(tmp_path)
    packages = tmp_path / "lib/python3.12/site-packages"
    assert {str(path.relative_to(packages)) for path in packages.rglob("*") if path.is_file()} == set(kept)


def test_libraries_that_are_only_named_are_links_that_the_loader_finds(tmp_path: Path) -> None:
    for name in ("libarrow.so.2600", "libarrow_acero.so.2600", "libarrow_compute.so.2600", "libarrow_dataset.so.2600"):
        (tmp_path / "pyarrow" / name).parent.mkdir(exist_ok=True)
        (tmp_path / "pyarrow" / name).write_bytes(b"\x7fELF" + name.encode())
    slim().link_what_is_only_named(tmp_path)
    links = {path.name: str(path.readlink()) for path in (tmp_path / "pyarrow").iterdir() if path.is_symlink()}
    assert links == dict.fromkeys(("libarrow_acero.so.2600", "libarrow_dataset.so.2600"), "libarrow.so.2600")


def test_a_library_that_is_there_twice_is_kept_once(tmp_path: Path) -> None:
    for name in ("pyarrow/libarrow_python.so", "pyarrow/libarrow_python.so.2600", "other.libs/libarrow_python.so"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_bytes(b"\x7fELF" * 100_000)
    (tmp_path / "pyarrow/another.so").write_bytes(b"\x7fELX" * 100_000)
    slim().share(tmp_path)
    links = {path.name: path.readlink() for path in tmp_path.rglob("*.so*") if path.is_symlink()}
    assert links == {
        "libarrow_python.so": Path("../other.libs/libarrow_python.so"),
        "libarrow_python.so.2600": Path("../other.libs/libarrow_python.so"),
    }
    assert all(path.read_bytes().startswith(b"\x7fELF") for path in tmp_path.rglob("libarrow_python*"))
    assert slim().size_bytes(tmp_path) == 2 * 400_000


def test_libraries_that_were_put_into_a_wheel_keep_their_symbols(tmp_path: Path) -> None:
    for name in ("numpy.libs/libopenblas.so", "numpy/_core/math.cpython-312.so", "llvmlite/libllvmlite.so"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_bytes(b"\x7fELF and more")
    (tmp_path / "llvmlite/a.sorting.ts").write_text("no library")
    assert {path.name for path in slim().libraries(tmp_path)} == {"math.cpython-312.so", "libllvmlite.so"}


def test_a_part_that_is_missed_only_when_it_is_needed_is_missed_by_the_trial(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "half").mkdir()
    (tmp_path / "half" / "__init__.py").write_text("from . import whole\n")
    (tmp_path / "half" / "whole.py").touch()
    monkeypatch.syspath_prepend(tmp_path)
    works = module_of("works")
    asks = tmp_path / "asks.py"
    asks.write_text("import can\n\ndef late():\n    from half import whole\n")
    works.import_what_it_needs(asks)
    asks.write_text("def late():\n    from half import left_out\n")
    with pytest.raises(ModuleNotFoundError, match="left_out"):
        works.import_what_it_needs(asks)


def test_nothing_of_ours_imports_what_the_image_leaves_out() -> None:
    left_out = {f"{name}/{part}".removesuffix(".py") for name, parts in slim().UNUSED.items() if name for part in parts}
    imported: set[str] = set()
    for path in (ROOT / "app").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Import):
                imported |= {each.name for each in node.names}
            elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
                imported |= {f"{node.module}.{each.name}" for each in node.names}
    folders = {name: Path(name.replace(".", "/")) for name in imported}
    missed = [
        (name, part)
        for name, folder in folders.items()
        for part in left_out
        if any(fnmatch(above.as_posix(), part) for above in (folder, *folder.parents))
    ]
    assert missed == []
    assert {"scipy.stats", "pyarrow.csv"} <= imported


def test_what_the_image_is_tried_by_works_where_all_is_there() -> None:
    done = subprocess.run([sys.executable, str(DOCKER / "works.py")], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "all that they use, work" in done.stdout
