"""What the image leaves out of its packages, and what it never touches."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from types import ModuleType

import pytest

from tests.docker.test_files import DOCKER


def slim() -> ModuleType:
    """docker/slim.py, which is no part of a package."""
    spec = importlib.util.spec_from_file_location("slim", DOCKER / "slim.py")
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
        "pyarrow/libarrow.so.2600",
        "pyarrow/parquet.py",
    )
    gone: tuple[str, ...] = (
        "numpy/tests/test_core.py",
        "numpy/core.h",
        "scipy/_lib.pyx",
        "pyarrow/libarrow_flight.so.2600",
    )
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


def test_libraries_that_were_put_into_a_wheel_keep_their_symbols(tmp_path: Path) -> None:
    for name in ("numpy.libs/libopenblas.so", "numpy/_core/math.cpython-312.so", "llvmlite/libllvmlite.so"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_bytes(b"\x7fELF and more")
    (tmp_path / "llvmlite/a.sorting.ts").write_text("no library")
    assert {path.name for path in slim().libraries(tmp_path)} == {"math.cpython-312.so", "libllvmlite.so"}
