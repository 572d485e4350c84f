"""Machine code is kept where it can be, good as long as its sources hold the same text; nowhere is no failure."""

from __future__ import annotations

import ast
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
DECORATORS = {"compiled", "inlined", "_compiled", "_inlined"}
KERNEL = """
import os, pathlib
if "READ_ONLY" in os.environ:  # root may write anywhere, and there is no other user on every machine
    asked, folder = os.access, pathlib.Path(__file__).parent
    os.access = lambda path, mode: folder not in pathlib.Path(path).parents and asked(path, mode)
    import numba.core.caching as caching
    caching.CompileResultCacheImpl._locator_classes.remove(caching.InTreeCacheLocator)

from app.kernels import Kernels, all_compiled, kept_in, tell_compiled
from constants import STEP
compiled = Kernels(__file__, "constants.py").compiled

@compiled
def more(x: int) -> int:
    return x + STEP

was = all_compiled()
value = more(1)
tell_compiled()
print(value, sum(more.stats.cache_hits.values()), kept_in() is not None, was)
"""


def run(folder: Path, **environment: str) -> list[str]:
    """What a fresh process says: the value, functions taken from disk, whether anything is kept, whether all was."""
    done = subprocess.run(
        [sys.executable, "-P", "kernel.py"],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": f"{ROOT}:{folder}", "PYTHONDONTWRITEBYTECODE": "1", **environment},
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.split()


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "kernel.py").write_text(KERNEL)
    (tmp_path / "constants.py").write_text("STEP = 1\n")
    return tmp_path


def test_a_copy_with_other_times_is_taken_from_disk_and_another_text_is_not(folder: Path) -> None:
    cache = {"NUMBA_CACHE_DIR": str(folder / "cache")}
    assert run(folder, **cache) == ["2", "0", "True", "False"]
    for name in ("kernel.py", "constants.py"):
        os.utime(folder / name, (1e9, 1e9))
    assert run(folder, **cache) == ["2", "1", "True", "True"]
    (folder / "constants.py").write_text("STEP = 2\n")
    assert run(folder, **cache) == ["3", "0", "True", "False"]


def test_where_nothing_may_be_written_it_is_compiled_all_the_same(folder: Path) -> None:
    (folder / "__pycache__").write_text("no folder")  # even root cannot write into it
    assert run(folder, XDG_CACHE_HOME=str(folder / "kernel.py")) == ["2", "0", "False", "False"]


def test_a_read_only_installation_keeps_it_in_the_users_folder(folder: Path) -> None:
    (folder / "__pycache__").write_text("no folder")
    home = {"XDG_CACHE_HOME": str(folder / "home")}
    assert run(folder, **home) == ["2", "0", "True", "False"]
    assert run(folder, **home) == ["2", "1", "True", "True"]


def test_machine_code_beside_sources_that_may_only_be_read_is_taken(folder: Path) -> None:
    """As in an image, where another user has compiled it, or the root is read-only; and nothing is written there."""
    assert run(folder) == ["2", "0", "True", "False"]
    for name in ("kernel.py", "constants.py"):
        os.utime(folder / name, (1e9, 1e9))  # a layer of an image
    kept = sorted((folder / "__pycache__").iterdir())
    read_only = {"XDG_CACHE_HOME": str(folder / "home"), "READ_ONLY": "1"}
    assert run(folder, **read_only) == ["2", "1", "True", "True"]
    assert sorted((folder / "__pycache__").iterdir()) == kept
    assert not (folder / "home").exists()
    (folder / "constants.py").write_text("STEP = 2\n")
    assert run(folder, **read_only) == ["3", "0", "True", "False"]
    assert (folder / "home").exists(), "what was compiled of another text is passed over"
    assert sorted((folder / "__pycache__").iterdir()) == kept


def is_compiled(node: ast.AST) -> bool:
    return isinstance(node, ast.FunctionDef) and any(
        isinstance(one, ast.Name) and one.id in DECORATORS for one in node.decorator_list
    )


def calls_from_python(tree: ast.AST, private: set[str], here: set[str], modules: set[str]) -> list[str]:
    """Names of `private` that plain code calls in one of `modules`, and of `here` that it calls as they are."""
    found: list[str] = []
    for node in ast.iter_child_nodes(tree):
        if is_compiled(node):
            continue
        if isinstance(node, ast.Call):
            match node.func:
                case ast.Attribute(value=ast.Name(id=owner), attr=name) if name in private and owner in modules:
                    found.append(name)
                case ast.Name(id=name) if name in here:
                    found.append(name)
        found += calls_from_python(node, private, here, modules)
    return found


def imported(tree: ast.AST) -> set[str]:
    """Names that a file imports, modules among them."""
    nodes = [node for node in ast.walk(tree) if isinstance(node, ast.Import | ast.ImportFrom)]
    return {name.asname or name.name for node in nodes for name in node.names}


def test_compiled_code_that_has_no_way_in_from_python_is_called_by_compiled_code_only() -> None:
    """Its name begins with an underscore; a call from Python would end the process."""
    files = [*ROOT.glob("app/**/*.py"), *ROOT.glob("tests/**/*.py")]
    trees = {file: ast.parse(file.read_text(encoding="utf-8")) for file in files}
    private = {
        file: {node.name for node in tree.body if isinstance(node, ast.FunctionDef) and is_compiled(node)}
        for file, tree in trees.items()
    }
    private = {file: {name for name in names if name.startswith("_")} for file, names in private.items()}
    everywhere = set().union(*private.values())
    assert "_tick" in everywhere
    called = {
        str(file.relative_to(ROOT)): names
        for file, tree in trees.items()
        if (names := calls_from_python(tree, everywhere, private[file] | (everywhere & imported(tree)), imported(tree)))
    }
    assert called == {}


CALLER = """
import sys
from app.kernels import Kernels
from inner import doubled, halved
kernels = Kernels(__file__, "inner.py")

@kernels.compiled
def sum_of(x: int) -> int:
    return doubled(x) + halved(x)

assert "numba" not in sys.modules, "numba comes with a module that nobody has called yet"
print(sum_of(6), len(sum_of.signatures), len(doubled.signatures))
"""
INNER = """
from app.kernels import Kernels
kernels = Kernels(__file__)

@kernels.compiled
def doubled(x: int) -> int:
    return 2 * x

@kernels.inlined
def halved(x: int) -> int:
    return x // 2
"""


def test_numba_comes_with_the_first_call_and_compiles_callees_with_their_caller(tmp_path: Path) -> None:
    (tmp_path / "kernel.py").write_text(CALLER)
    (tmp_path / "inner.py").write_text(INNER)
    assert run(tmp_path, NUMBA_CACHE_DIR=str(tmp_path / "cache")) == ["15", "1", "1"]
