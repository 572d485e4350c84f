"""The help as it is built: nothing missing, nothing from elsewhere, no script that our pages would not run."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import help_site
import pytest
import reference_pages

from app.registers.catalog import MODELS

ROOT = Path(__file__).parent.parent
DOCS = ROOT / "docs"


@pytest.fixture(scope="module")
def site() -> Path:
    """With strict checks: a link to no page, or to no heading, fails the build."""
    help_site.build()
    return help_site.TARGET


@pytest.fixture(scope="module")
def reference() -> dict[str, str]:
    return reference_pages.pages()


def _menu() -> set[str]:
    def pages(entry: object) -> set[str]:
        if isinstance(entry, str):
            return {entry}
        inner = entry.values() if isinstance(entry, dict) else entry
        assert isinstance(inner, list | type({}.values()))
        return set().union(*map(pages, inner))

    return pages(tomllib.loads((DOCS / "zensical.toml").read_text())["project"]["nav"])


def test_every_page_is_in_the_menu(reference: dict[str, str]) -> None:
    written = {path.relative_to(DOCS).as_posix() for path in DOCS.rglob("*.md")}
    assert _menu() == written | {f"reference/{name}" for name in reference}


@pytest.mark.parametrize("name", MODELS)
def test_every_register_and_field_has_its_place(reference: dict[str, str], name: str) -> None:
    page = reference[f"registers/{name}.md"]
    shown = {row.name for row in reference_pages.collapsed(MODELS[name].table)}
    for row in shown:
        assert all(f"`{part}`" in page for part in row.split(" … "))
    for register in MODELS[name].table:
        in_a_series = any(
            re.sub(r"\d+", "", register.name) == re.sub(r"\d+", "", row.split(" … ")[0]) for row in shown if "…" in row
        )
        assert register.name in shown or in_a_series, register.name
        if register.name in shown:
            assert all(f"| `{part.name}` |" in page for part in register.fields), register.name


def test_registers_of_several_axes_and_long_tables_are_told_once() -> None:
    rows = {row.name: row for row in reference_pages.collapsed(MODELS["tmc428"].table)}
    assert [axis for axis, _ in rows["v_max"].places] == [0, 1, 2]
    (table,) = [row for name, row in rows.items() if "…" in name and "microstep" in row.first.group]
    assert len(table.places) == 32


def test_every_call_method_and_command_has_its_place(reference: dict[str, str]) -> None:
    assert "### `POST /api/v1/devices/{device}/axes/{axis}/move`" in reference["rest.md"]
    assert "| `target` | body | needed |" in reference["rest.md"]
    assert "## stepscope serve" in reference["command-line.md"]
    assert "| `--rate`" in reference["command-line.md"]
    assert "## move\n" in reference["python.md"]


def test_words_of_tables_are_text_and_not_markup() -> None:
    page = reference_pages.register_page(MODELS["tmc5160"])
    for line in page.splitlines():
        if line.startswith("| `"):
            assert line.replace("\\|", "").count("|") in (6, 7), line


def test_nothing_comes_from_elsewhere(site: Path) -> None:
    for page in site.rglob("*.html"):
        text = page.read_text()
        fetched = re.findall(r'<(?:script|img|link|iframe)[^>]*(?:src|href)="([^"]+)"', text)
        assert [each for each in fetched if re.match(r"(?:https?:)?//", each)] == [], page


def test_no_script_stands_in_a_page(site: Path) -> None:
    for page in site.rglob("*.html"):
        text = page.read_text()
        assert re.findall(r"<script(?![^>]*\bsrc=)(?![^>]*application/json)[^>]*>", text) == [], page
        assert re.search(r"\son\w+=\"", text) is None, page
        for script in re.findall(r'<script src="([^"]+)"', text):
            assert (page.parent / script).resolve().is_file(), script


def test_words_that_a_page_explains_are_in_the_glossary(site: Path) -> None:
    sources = "".join(path.read_text() for path in (ROOT / "web" / "src").rglob("*.tsx"))
    words = set(re.findall(r'<Term name="([^"]*)"', sources))
    assert {"encoder", "microstep", "soft-limit"} <= words
    glossary = (site / "glossary.html").read_text()
    assert {word for word in words if f'id="{word}"' not in glossary} == set()


def test_what_tutorials_mean_to_tests_is_not_shown(site: Path) -> None:
    for page in (site / "tutorials").glob("*.html"):
        assert "<!-- do" not in page.read_text()
        assert "not run:" not in page.read_text()


def test_a_change_of_any_source_makes_it_stale(site: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert help_site.is_fresh()
    monkeypatch.setattr(help_site, "SOURCES", (*help_site.SOURCES, "LICENSE"))
    assert not help_site.is_fresh()


def test_its_parts_find_what_an_isolated_build_has_brought(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """pip leads a build to its dependencies by PYTHONPATH."""
    brought, elsewhere = tmp_path / "brought", tmp_path / "elsewhere"
    brought.mkdir()
    elsewhere.mkdir()
    (brought / "brought_along.py").touch()
    monkeypatch.setenv("PYTHONPATH", str(brought))
    help_site.run_python(["-c", "import brought_along, app"], elsewhere)


def test_the_reference_is_made_where_pip_has_taken_the_checkout_off_the_path(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As it does in an isolated build in an environment that has the checkout installed already."""
    here = tmp_path / "sitecustomize.py"
    here.write_text(f"import sys\nsys.path[:] = [path for path in sys.path if path != {str(help_site.ROOT)!r}]\n")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    help_site.make_reference(tmp_path / "reference")
    assert (tmp_path / "reference" / "python.md").exists()
