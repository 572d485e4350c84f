"""The wheel as somebody installs it: one package called `stepscope`, beside whatever is called `app` elsewhere."""

from __future__ import annotations

import os
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from app.store.database_file import MIGRATIONS

ROOT = Path(__file__).parent.parent


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder for sys.path, with what the wheel brings and nothing else."""
    folder = tmp_path_factory.mktemp("wheel")
    subprocess.run(
        [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder)],
        cwd=ROOT,
        env={**os.environ, "STEPSCOPE_NO_WEB": "1"},
        check=True,
        capture_output=True,
    )
    (wheel,) = folder.glob("*.whl")
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(folder / "site")
    return folder / "site"


def run(installed: Path, folder: Path, *arguments: str) -> str:
    """What Python says with those arguments, in `folder`."""
    done = subprocess.run(
        [sys.executable, *arguments],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(installed)},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_it_brings_one_package(installed: Path) -> None:
    assert {path.name for path in installed.iterdir() if not path.name.endswith(".dist-info")} == {"stepscope"}
    assert (installed / "stepscope" / "py.typed").exists()
    (metadata,) = installed.glob("*.dist-info")
    assert "stepscope.cli:main" in (metadata / "entry_points.txt").read_text()


def test_a_script_beside_a_folder_called_app_imports_the_client(installed: Path, tmp_path: Path) -> None:
    (tmp_path / "app").mkdir()
    (tmp_path / "app" / "__init__.py").write_text("HERE = 1\n")
    script = tmp_path / "script.py"
    script.write_text(
        "import app, stepscope\n"
        "from stepscope import AsyncBench, Bench, Refused\n"
        "import stepscope.client as client\n"
        "assert Bench is client.Bench\n"
        "print(app.HERE, stepscope.__file__, Bench.__module__)\n"
    )
    here, file, module = run(installed, tmp_path, str(script)).split()
    assert (here, module) == ("1", "stepscope.client.blocking")
    assert Path(file).is_relative_to(installed)


def test_everything_in_it_can_be_imported(installed: Path, tmp_path: Path) -> None:
    names = [
        ".".join(path.relative_to(installed).with_suffix("").parts)
        for path in sorted((installed / "stepscope").rglob("*.py"))
        if "migrations" not in path.parts and path.name != "spidev_port.py"
    ]
    assert len(names) > 400
    code = f"import importlib, sys\nfor name in {names!r}: importlib.import_module(name.removesuffix('.__init__'))\n"
    code += "assert not [name for name in sys.modules if name == 'app' or name.startswith('app.')]\n"
    run(installed, tmp_path, "-W", "error::ImportWarning", "-c", code)


def test_the_command_line_runs(installed: Path, tmp_path: Path) -> None:
    assert "stepscope 0." in run(installed, tmp_path, "-m", "stepscope.cli", "--version")


def test_a_database_is_made_by_the_steps_that_the_wheel_brings(installed: Path, tmp_path: Path) -> None:
    migrations = installed / "stepscope" / "store" / "migrations"
    steps = {path.relative_to(MIGRATIONS) for path in MIGRATIONS.rglob("*.py")}
    assert len(steps) >= 4
    assert steps <= {path.relative_to(migrations) for path in migrations.rglob("*.py")}
    program = "from pathlib import Path\nfrom stepscope.store.database import Database\n"
    program += "from stepscope.store.database_file import MIGRATIONS\n"
    program += "d = Database(Path('data')); d.open(); print(MIGRATIONS, d.problem)"
    assert run(installed, tmp_path, "-W", "error", "-c", program).split() == [str(migrations), "None"]
