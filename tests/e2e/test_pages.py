"""Every page: it comes up, nobody is shut out, nothing is said on the console, at each size and in each scheme."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Literal
from urllib.parse import urlsplit

import pytest
from playwright.sync_api import Page, ViewportSize, expect

from tests.e2e.conftest import DESKTOP, PHONE
from tests.e2e.held import Held

PAGES = {
    "/": "Bench",
    "/registers": "Registers",
    "/ramps": "Ramps",
    "/velocity": "Velocity profile",
    "/microsteps": "Microsteps",
    "/chain": "Driver chain",
    "/connections": "Connections",
}

LOOKS: tuple[tuple[ViewportSize, Literal["light", "dark"]], ...] = (
    (DESKTOP, "light"),
    (DESKTOP, "dark"),
    (PHONE, "light"),
    (PHONE, "dark"),
)

BEYOND = """() => [...document.querySelectorAll("body *")]
  .filter((each) => each.getBoundingClientRect().right > document.documentElement.clientWidth)
  .slice(0, 5)
  .map((each) => `${each.tagName} ${each.className} ${each.textContent.slice(0, 40)}`)"""
"""What reaches beyond the right edge."""


@pytest.mark.parametrize("path", PAGES)
def test_a_page_is_open_to_everybody(page: Page, check_axe: Callable[[Page], None], path: str) -> None:
    page.goto(path)
    expect(page).to_have_title(f"{PAGES[path]} · stepscope")
    expect(page.get_by_role("heading", level=1)).to_be_attached()
    expect(page.get_by_label("Loading the page")).to_have_count(0)
    for size, scheme in LOOKS:
        page.set_viewport_size(size)
        page.emulate_media(color_scheme=scheme)
        expect(page.get_by_test_id("stop-all")).to_be_in_viewport(ratio=1)
        check_axe(page)
        sideways = page.evaluate("document.scrollingElement.scrollWidth - document.documentElement.clientWidth")
        assert sideways <= 0, f"{size} can be scrolled sideways by {sideways} px: {page.evaluate(BEYOND)}"


def test_pages_are_reached_by_menu_and_by_keyboard(page: Page) -> None:
    page.goto("/")
    for path, name in PAGES.items():
        page.get_by_role("navigation", name="Pages").get_by_role("link", name=name).click()
        expect(page).to_have_title(f"{name} · stepscope")
        assert urlsplit(page.url).path == path
    page.keyboard.press("Alt+2")
    expect(page).to_have_title("Registers · stepscope")


def test_an_unknown_address_leads_to_the_bench(page: Page) -> None:
    page.goto("/no/such/page")
    expect(page).to_have_title("Bench · stepscope")


def test_a_page_that_is_still_loading_says_so(page: Page, check_axe: Callable[[Page], None]) -> None:
    held = Held(page, re.compile(r"/assets/MicrostepsPage-.*\.js"))
    page.goto("/microsteps", wait_until="commit")  # it loads until the page is there
    expect(page.get_by_role("progressbar", name="Loading the page")).to_be_visible()
    check_axe(page)
    held.let_go()
    expect(page.get_by_role("heading", level=1)).to_be_attached()
    expect(page.get_by_label("Loading the page")).to_have_count(0)
