"""What a start brings in, and what it leaves to those who need it: imports are most of the time that a start takes."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
NOT_YET = frozenset(
    {
        "alembic",
        "httpx",
        "numba",
        "optuna",
        "prometheus_client",
        "pyarrow",
        "pytrinamic",
        "rich",
        "scipy",
        "sqlalchemy",
        "viser",
    }
)
"""For a changed database, scripts, emulators, studies, scrapes, recordings, listed models, terminals, the database, the
twin."""
OF_THE_SERVER = NOT_YET | {"fastapi", "numpy", "uvicorn"}


def brought_in(code: str) -> set[str]:
    """The packages that a process has imported at the end of `code`."""
    code += "\nimport sys; print(*{name.partition('.')[0] for name in sys.modules})"
    done = subprocess.run(
        [sys.executable, "-P", "-c", code],
        cwd=ROOT,
        env={"PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )
    assert done.returncode == 0, done.stderr
    return set(done.stdout.splitlines()[-1].split())


def test_the_servers_modules_bring_in_nothing_that_only_some_need() -> None:
    brought = brought_in("import app.main, app.serving")
    assert "fastapi" in brought
    assert brought & NOT_YET == set()


def test_the_page_is_served_before_the_program_is_imported() -> None:
    code = "import sys, app.serving; assert not {'app.main', 'app.api.app'} & sys.modules.keys()"
    assert brought_in(code) & {"fastapi", "numpy", "sqlalchemy"} == set()


def test_a_database_that_is_up_to_date_is_opened_without_alembic(tmp_path: Path) -> None:
    opened = (
        "from pathlib import Path; from app.store.database import Database;"
        f" base = Database(Path({str(tmp_path)!r})); base.open(); assert base.problem is None; base.close()"
    )
    assert "alembic" in brought_in(opened), "it is made"
    assert "alembic" not in brought_in(opened)


@pytest.mark.parametrize("arguments", [["--version"], ["--help"], ["devices", "--help"], ["serve", "--help"]])
def test_the_command_line_tells_of_itself_without_the_server(arguments: list[str]) -> None:
    code = f"import contextlib, app.cli\nwith contextlib.suppress(SystemExit):\n    app.cli.cli({arguments!r})"
    assert brought_in(code) & (OF_THE_SERVER - {"rich"}) == set()  # which writes the help
