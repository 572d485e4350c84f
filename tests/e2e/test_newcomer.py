"""The first minute: an empty data directory, a browser that was never here, three clicks at most."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect
from server_process import ServerProcess

from tests.e2e.newcomer import CLICKS_AT_MOST, MOVED, arrive, until
from tests.e2e.pictures import hold
from tests.e2e.tutorials import DOCS


def test_a_motor_moves_with_its_prediction_on_top_after_three_clicks_at_most(browser: Browser, tmp_path: Path) -> None:
    """How many seconds that takes is a row of the bench (`newcomer`): a machine that runs tests has other work."""
    picture = tmp_path / "bench.png"

    def look(page: Page) -> None:
        expect(page.get_by_role("button", name="End demo motion")).to_be_visible()
        page.screenshot(path=picture)
        for link in page.get_by_label("Demo").get_by_role("link").all():
            expect(link).to_be_in_viewport(ratio=1)  # what to do next is not cut off

    met = arrive(browser, tmp_path / "data", look)
    assert 0 < met.clicks <= CLICKS_AT_MOST
    assert met.residual < 100, "the prediction is that of this move"
    hold(picture, DOCS / "images" / "bench.png")  # the README's


FOLDERS = "import app.main, app.kernels as k, json; print(json.dumps([str(one.folder) for one in k._kernels]))"


def machine_code_alone(cache: Path) -> None:
    """Fill `cache` with what was compiled here, without the mark that says so: a start takes each piece for a job."""
    here, there = (
        json.loads(subprocess.check_output([sys.executable, "-c", FOLDERS], env={**os.environ, **more}))
        for more in ({}, {"NUMBA_CACHE_DIR": str(cache)})
    )
    for source, target in {*zip(here, there, strict=True)}:
        shutil.copytree(source, target, ignore=shutil.ignore_patterns("*.pyc", "*.compiled"), dirs_exist_ok=True)


def test_a_first_start_tells_how_far_it_is_and_a_motor_moves_meanwhile(
    browser: Browser, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    machine_code_alone(tmp_path / "cache")
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "cache"))
    with ServerProcess(tmp_path / "data") as server:
        context = browser.new_context(base_url=server.url)
        page = context.new_page()
        # As by a server that is still starting: the page asks again.
        page.route("**/health/details", lambda route: route.abort(), times=1)
        fetched: list[str] = []
        page.on("request", lambda request: fetched.append(request.url))
        page.goto("/")
        note = page.get_by_test_id("first-start")
        expect(note).to_contain_text(re.compile(r"First start: \d+ of \d+ emulators"), timeout=60_000)
        assert not [url for url in fetched if "restStyles" in url], "a first load is no larger for it"
        page.get_by_role("button", name="Start demo motion").click()
        until(page, MOVED)
        bar = note.get_by_role("progressbar")
        expect(bar).to_have_attribute("aria-valuenow", re.compile(r"^[1-9]"), timeout=60_000)
        expect(note).to_contain_text(re.compile(r"First start: [1-9]\d* of"))
        context.close()
