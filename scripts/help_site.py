"""Builds the help: docs/ and the reference made of tables -> app/_help, skipped while the sources are unchanged.

    python scripts/help_site.py build [--force]

Needs the generator of the site, and what `reference_pages.py` needs; installs the first into our own .venv where it is
missing. Warnings (a link to nowhere, a page that no menu names) are errors.
"""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path

from built_folder import alone, bring, hash_of, is_built_from, replace

ROOT = Path(__file__).resolve().parent.parent
DOCS = ROOT / "docs"
TARGET = ROOT / "app" / "_help"
SOURCES = (
    "docs",
    "app/registers",
    "app/cli.py",
    "app/commands",
    "app/client/blocking.py",
    "web/src/api/openapi.json",
    "web/public/favicon.svg",
    "scripts/built_folder.py",
    "scripts/help_site.py",
    "scripts/reference_pages.py",
)
GENERATOR = "zensical>=0.0.73,<0.1"
NEEDS = ("pydantic", "pydantic-settings", "platformdirs", "typer")
"""Of stepscope's own dependencies those that the reference is made with."""

NOT_FOR_READERS = re.compile(r"<!-- do\n.*?-->\n|^# not run: .*\n", re.DOTALL | re.MULTILINE)
"""What tutorials mean to the test that does them (`tests/e2e/tutorials.py`)."""
SCRIPT = re.compile(r"<script>(.*?)</script>", re.DOTALL)


class HelpBuildError(Exception):
    """The help cannot be built here; the text says why and what to do."""


def is_there() -> bool:
    """Tell whether the sources of the help are in this tree."""
    return (DOCS / "zensical.toml").is_file()


def is_fresh() -> bool:
    """Tell whether app/_help was built from the sources as they are now."""
    return is_built_from(TARGET, sources_hash())


def sources_hash() -> str:
    """Return a hash over names and contents of all that the help is made of."""
    return hash_of(ROOT, _sources())


def _sources() -> Iterator[Path]:
    for name in SOURCES:
        place = ROOT / name
        found = sorted(place.rglob("*")) if place.is_dir() else [place]
        yield from (path for path in found if path.is_file() and "__pycache__" not in path.parts)


def build(*, force: bool = False) -> bool:
    """Build the help into app/_help; False if it was fresh already. Raises HelpBuildError."""
    if not is_there():
        raise HelpBuildError("docs/zensical.toml is not in this tree: nothing to build")
    with alone(DOCS):
        return _build_alone(force=force)


def _build_alone(*, force: bool) -> bool:
    if not force and is_fresh():
        return False
    sources = sources_hash()
    _require_generator()
    print("building the help", flush=True)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        shutil.copytree(DOCS, folder / "docs", ignore=shutil.ignore_patterns("zensical.toml", "examples"))
        shutil.copy(DOCS / "zensical.toml", folder)
        shutil.copy(ROOT / "web" / "public" / "favicon.svg", folder / "docs" / "assets")
        for page in (folder / "docs").rglob("*.md"):
            page.write_text(NOT_FOR_READERS.sub("", page.read_text()))
        make_reference(folder / "docs" / "reference")
        run_python(["-m", "zensical", "build", "--strict"], folder)
        (folder / "site" / "404.html").unlink()  # the server says by itself what is not there
        _scripts_to_files(folder / "site")
        replace(folder / "site", TARGET, {"sources": sources})
    return True


def _require_generator() -> None:
    if not bring("zensical", GENERATOR):
        raise HelpBuildError(f'the help is built with zensical: `pip install "{GENERATOR}"` in this environment')


def make_reference(folder: Path) -> None:
    """Write the pages of the reference into `folder`. Raises HelpBuildError."""
    # As a module of this folder: pip takes a checkout that is installed already off the path of its isolated build.
    run_python(["-m", "scripts.reference_pages", str(folder)], ROOT)


def run_python(arguments: Sequence[str], folder: Path) -> None:
    """Run Python with `arguments` in `folder`, this package on its path. Raises HelpBuildError with what it printed."""
    command = [sys.executable, *arguments]
    # Before what is there already: by it pip leads an isolated build to what it has installed for it.
    paths = [str(ROOT), *filter(None, [os.environ.get("PYTHONPATH")])]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(paths)}
    done = subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, check=False, timeout=300
    )
    if done.returncode:
        said = f"{done.stdout}{done.stderr}"
        raise HelpBuildError(f"python {' '.join(arguments)} ended with code {done.returncode}:\n{said}")


def _scripts_to_files(site: Path) -> None:
    """Move the scripts inside of pages into files: our pages run none that stands in them."""
    scripts = site / "assets" / "inline"
    scripts.mkdir()
    for page in sorted(site.rglob("*.html")):
        up = "../" * (len(page.relative_to(site).parts) - 1)

        def to_file(found: re.Match[str], up: str = up) -> str:
            name = hashlib.sha256(found[1].encode()).hexdigest()[:16] + ".js"
            (scripts / name).write_text(found[1])
            return f'<script src="{up}assets/inline/{name}"></script>'

        page.write_text(SCRIPT.sub(to_file, page.read_text()))


def main(arguments: Sequence[str]) -> int:
    """Run one command of the module's docstring."""
    try:
        match list(arguments):
            case ["build"] | ["build", "--force"]:
                build(force="--force" in arguments)
            case _:
                print(__doc__)
                return 2
    except (HelpBuildError, subprocess.CalledProcessError) as error:
        print(f"help: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
