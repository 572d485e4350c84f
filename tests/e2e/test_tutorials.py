"""Each tutorial of the help, done step by step on a server that was started for the first time."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, BrowserContext
from server_process import ServerProcess

from tests.e2e.conftest import Errors
from tests.e2e.pictures import hold
from tests.e2e.tutorials import DOCS, PICTURES, TUTORIALS, Reader, pictures_of, steps_of

SPARING = "if (location.protocol !== 'about:') localStorage['stepscope.scope'] ??= '{\"rateHz\":100}'"
"""The scope begins with 100 Hz instead of 500, which is a tenth of what a browser and its server work for a page."""
ALL = [TUTORIALS / name for name in re.findall(r"tutorials/([\w-]+\.md)", (DOCS / "zensical.toml").read_text())]
"""In the order of the menu: the first is the first that a newcomer does."""
PICTURED = [DOCS / "how" / "workspace.md"]
"""How-to pages that are done in a browser likewise."""


@pytest.fixture(scope="module")
def first_start(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ServerProcess]:
    with ServerProcess(tmp_path_factory.mktemp("first")) as running:
        yield running


@pytest.fixture(scope="module")
def seat(browser: Browser, first_start: ServerProcess) -> Iterator[BrowserContext]:
    """One person reads them all."""
    context = browser.new_context(
        base_url=first_start.url, viewport={"width": 1280, "height": 800}, reduced_motion="reduce"
    )
    context.set_default_timeout(15_000)
    context.add_init_script(SPARING)
    yield context
    context.close()


@pytest.fixture
def reader(seat: BrowserContext, first_start: ServerProcess, errors: Errors, tmp_path: Path) -> Iterator[Reader]:
    seat.on("console", errors.on_console)
    seat.on("weberror", errors.on_error)
    page = seat.new_page()
    yield Reader(page, first_start.url, tmp_path)
    page.close()
    seat.remove_listener("console", errors.on_console)
    seat.remove_listener("weberror", errors.on_error)


@pytest.mark.parametrize("tutorial", [*ALL, *PICTURED], ids=lambda path: path.stem)
def test_what_a_tutorial_says_can_be_done(tutorial: Path, reader: Reader, errors: Errors, tmp_path: Path) -> None:
    reader.follow(tutorial)
    if reader.run_again:
        errors.expect(r"status of 409.*/rotate\)")
    assert errors.unexpected() == []
    assert reader.taken == pictures_of(tutorial.read_text()), "each picture is shown where it is taken"
    for name in reader.taken:
        hold(tmp_path / f"{name}.png", PICTURES / f"{name}.png")


def test_no_picture_is_left_over() -> None:
    shown = {name for tutorial in [*ALL, *PICTURED] for name in pictures_of(tutorial.read_text())}
    assert {path.stem for path in PICTURES.glob("*.png")} == shown


def test_every_tutorial_does_something() -> None:
    assert set(ALL) == set(TUTORIALS.glob("*.md"))
    for tutorial in ALL:
        assert len(list(steps_of(tutorial.read_text()))) > 3, tutorial
