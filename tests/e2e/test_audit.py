"""The audit log in a browser: as it happens, searched, filtered, followed to its register, and as a file."""

from __future__ import annotations

import csv
import re
from collections.abc import Callable
from pathlib import Path

import httpx
import pytest
from playwright.sync_api import BrowserContext, Locator, Page, expect

from tests.e2e.conftest import PHONE, Errors


@pytest.fixture
def word(request: pytest.FixtureRequest, api: httpx.Client) -> int:
    """A value that only this test writes: the log is that of the whole session."""
    value = 1000 + sum(str(request.node.name).encode()) % 900
    write(api, value)
    return value


def write(api: httpx.Client, value: int, axis: int = 1) -> httpx.Response:
    return api.put(f"/devices/bench/registers/a_threshold?axis={axis}", json={"value": value % 2048})


def entries(page: Page) -> Locator:
    return page.get_by_test_id("audit-entry")


def find(page: Page, text: str) -> None:
    """Search, and wait until what is shown answers it."""
    page.get_by_label("Search the audit log").fill(text)
    expect(page.locator("[data-testid=audit][aria-busy=true]")).to_have_count(0)


def test_what_is_done_appears_by_itself_newest_first(page: Page, api: httpx.Client, word: int) -> None:
    page.goto("/audit")
    first = entries(page).first
    expect(first).to_contain_text(str(word))
    write(api, word + 1)
    expect(first).to_contain_text(f"{word + 1}")
    expect(first).to_contain_text("Tester")
    expect(first).to_contain_text("done")
    assert write(api, 1 << 20 | 1, axis=9).status_code == 404
    expect(first).to_contain_text("refused")
    expect(first).to_contain_text("no axis is called")


def test_it_is_searched_and_filtered_and_all_of_it_comes_back(page: Page, api: httpx.Client, word: int) -> None:
    api.post("/devices/bench/axes/2/stop").raise_for_status()
    page.goto("/audit")
    find(page, f"threshold {word}")
    expect(entries(page)).to_have_count(1)
    expect(entries(page).first).to_contain_text("write")
    page.get_by_label("Action", exact=True).select_option("stop")
    expect(page.get_by_text("No entry has all of this")).to_be_visible()
    page.get_by_role("button", name="Show all").click()
    expect(page.get_by_label("Search the audit log")).to_have_value("")
    expect(entries(page).nth(1)).to_be_visible()
    page.get_by_label("Action", exact=True).select_option("stop")
    page.get_by_label("Device", exact=True).select_option("bench")
    page.get_by_label("Who", exact=True).select_option("Tester")
    page.get_by_label("Time", exact=True).select_option("last 15 min")
    expect(entries(page).first).to_contain_text("stop")
    expect(entries(page).filter(has_text="write")).to_have_count(0)
    page.get_by_role("button", name="Clear").click()
    expect(page.get_by_label("Action", exact=True)).to_have_value("")


def test_a_write_leads_to_its_register(page: Page, word: int) -> None:
    page.goto("/audit")
    find(page, str(word))
    entries(page).first.get_by_role("link").click()
    expect(page).to_have_url(re.compile(r"/registers\?find=is_agtat"))
    expect(page.get_by_label("Search registers")).to_have_value("is_agtat_is_aleat_is_v0_a_threshold")
    expect(page.get_by_role("row").filter(has_text="a_threshold").first).to_be_visible()


def test_older_ones_come_when_they_are_scrolled_to_and_new_ones_wait(page: Page, api: httpx.Client, word: int) -> None:
    writes = [{"name": "a_threshold", "axis": 1, "value": (word + number) % 2048} for number in range(64)]
    for _ in range(5):
        api.post("/devices/bench/registers", json={"writes": writes}).raise_for_status()
    page.goto("/audit")
    find(page, "threshold")
    expect(entries(page).nth(60)).to_be_attached()
    for _ in range(6):
        page.mouse.wheel(0, 20_000)
        page.wait_for_timeout(50)
    expect(entries(page).nth(310)).to_be_attached()
    page.evaluate("window.scrollTo(0, 1000)")
    shown = entries(page).first.inner_text()
    write(api, 2047)
    newer = page.get_by_role("button", name="1 new")
    expect(newer).to_be_visible()
    assert entries(page).first.inner_text() == shown
    newer.click()
    expect(entries(page).first).to_contain_text("2047")


def test_it_is_saved_as_csv_of_what_is_shown(page: Page, word: int, tmp_path: Path) -> None:
    page.goto("/audit")
    find(page, f"threshold {word}")
    expect(entries(page)).to_have_count(1)
    with page.expect_download() as download:
        page.get_by_role("link", name="CSV").click()
    download.value.save_as(tmp_path / "audit.csv")
    rows = list(csv.DictReader((tmp_path / "audit.csv").read_text().splitlines()))
    assert [row["subject"] for row in rows] == ["is_agtat_is_aleat_is_v0_a_threshold"]


def test_a_log_that_cannot_be_read_says_why_and_tries_again(page: Page, errors: Errors, word: int) -> None:
    errors.expect("503")
    problem = {
        "type": "/problems/store-unavailable",
        "title": "Nothing can be kept or looked up now",
        "status": 503,
        "detail": "the disk is full",
        "instance": None,
        "way_out": "make room on it",
        "facts": {},
    }
    page.route("**/api/v1/audit?*", lambda route: route.fulfill(status=503, json=problem))
    page.goto("/audit")
    said = page.get_by_role("alert", name="Reading the audit log")
    expect(said).to_contain_text("the disk is full")
    expect(said).to_contain_text("make room on it")
    page.unroute("**/api/v1/audit?*")
    page.get_by_role("button", name="Try again").click()
    expect(entries(page).first).to_be_visible()


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_it_fits_a_phone_and_anybody_can_use_it(
    new_context: Callable[..., BrowserContext], check_axe: Callable[[Page], None], word: int, scheme: str
) -> None:
    for size in ({}, {"viewport": PHONE}):
        page = new_context(color_scheme=scheme, **size).new_page()
        page.goto("/audit")
        expect(entries(page).first).to_be_visible()
        assert page.evaluate("document.documentElement.scrollWidth <= window.innerWidth")
        check_axe(page)
        page.keyboard.press("/")
        expect(page.get_by_label("Search the audit log")).to_be_focused()
        page.close()
