"""The input filters' page in a browser: waveforms as the rule has them, bounds, and INPUT_FILT_CONF written from it."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator

import httpx
import pytest
from playwright.sync_api import BrowserContext, Page, expect

from tests.e2e.closed_loop import Loop, a_loop
from tests.e2e.conftest import DESKTOP, PHONE
from tests.e2e.modules import select
from tests.e2e.motor import wait_for

PATIENCE_MS = 30_000
"""For whatever has to come from the server: the machine may be busy."""


@pytest.fixture(scope="module")
def chip(api: httpx.Client) -> Iterator[Loop]:
    with a_loop(api, "filtered") as running:
        yield running


@pytest.fixture
def filters(page: Page, chip: Loop) -> Page:
    """The page with a chip that filters nothing, its settings read."""
    chip.write("INPUT_FILT_CONF", 0)
    select(page, chip.device)
    page.goto("/filters")
    expect(page.get_by_test_id("group-ref")).to_contain_text("No filtering", timeout=PATIENCE_MS)
    return page


def bound(page: Page, name: str) -> str:
    return page.get_by_test_id(f"bound-{name}").locator("td").first.inner_text()


@pytest.mark.sheet("DS-TMC4361", "6.1.2")
def test_a_filter_is_chosen_by_what_it_does_and_written(filters: Page, chip: Loop) -> None:
    expect(filters.get_by_test_id("bound-always")).to_contain_text("62.5", timeout=PATIENCE_MS)
    filters.get_by_label("Sample rate of Reference switches, sr_ref").select_option("3")
    filters.get_by_label("Length of Reference switches, filt_l_ref").select_option("5")
    # 5 and 6 periods of 8 clocks of 62.5 ns
    expect(filters.get_by_test_id("bound-stopped")).to_contain_text("2.5\u202fµs", timeout=PATIENCE_MS)
    expect(filters.get_by_test_id("bound-always")).to_contain_text("3\u202fµs")
    expect(filters.get_by_test_id("bound-delay-max")).to_contain_text("47")
    expect(filters.get_by_test_id("stopped").first).to_be_attached()
    expect(filters.get_by_test_id("passed").first).to_be_attached()
    assert chip.register("INPUT_FILT_CONF") == 0, "nothing is written before Apply"
    filters.get_by_role("button", name="Apply", exact=True).click()
    expect(filters.get_by_text("last apply: 1 read back")).to_be_visible(timeout=PATIENCE_MS)
    assert chip.register("INPUT_FILT_CONF") == 5 << 12 | 3 << 8


@pytest.mark.sheet("DS-TMC4361", "6.1.3")
def test_figures_of_the_data_sheet_are_drawn_with_their_settings(filters: Page) -> None:
    for group, pin, figure in (("ref", "HOME_REF", "6.1"), ("s", "START", "6.2"), ("enc_in", "A_SCLK", "6.3")):
        filters.get_by_test_id(f"group-{group}").click()
        filters.get_by_text(f"Figure {figure}", exact=True).click()
        filters.get_by_role("button", name="Set them here").click()
        expect(filters.get_by_role("heading", name=f"Waveform at {pin}")).to_be_visible()
        expect(filters.get_by_test_id("passed").first).to_be_attached(timeout=PATIENCE_MS)
    filters.get_by_role("button", name="Discard all").click()
    expect(filters.get_by_text("No edits staged")).to_be_visible()


def test_a_waveform_is_drawn_by_hand_and_with_the_keys(filters: Page) -> None:
    waves = filters.get_by_test_id("waveforms")
    with filters.expect_response(lambda answer: answer.url.endswith("/calc/input-filter"), timeout=PATIENCE_MS):
        filters.get_by_label("Length of Reference switches, filt_l_ref").select_option("3")
    # What is counted below is what that length does, not what the length before it did.
    expect(filters.locator("[data-stale=false]").filter(has=waves).last).to_be_attached(timeout=PATIENCE_MS)
    box = waves.bounding_box()
    assert box is not None
    before = filters.get_by_test_id("stopped").count()
    y = box["y"] + 44
    filters.mouse.move(box["x"] + 0.93 * box["width"], y)
    filters.mouse.down()
    filters.mouse.move(box["x"] + 0.94 * box["width"], y, steps=3)
    filters.mouse.up()
    expect(filters.get_by_text("Drawn", exact=True)).to_be_visible()
    wait_for(lambda: filters.get_by_test_id("stopped").count() > before, "the pulse that was drawn does not pass")
    waves.focus()
    waves.press("Home")
    waves.press("ArrowRight")
    waves.press("Space")
    wait_for(lambda: filters.get_by_test_id("stopped").count() > before + 1, "nor does one clock from the keys")
    filters.get_by_role("button", name="Back to the example").click()
    wait_for(lambda: filters.get_by_test_id("stopped").count() == before, "the example is as it was")


def test_it_works_without_a_chip(page: Page, api: httpx.Client) -> None:
    page.route(re.compile(r"/api/v1/devices$"), lambda route: route.fulfill(json=[]))
    page.goto("/filters")
    expect(page.get_by_label("Clock fCLK MHz")).to_have_value("16", timeout=PATIENCE_MS)
    expect(page.get_by_test_id("bound-stopped")).to_be_visible(timeout=PATIENCE_MS)
    page.get_by_label("Clock fCLK MHz").fill("8")
    page.get_by_label("Clock fCLK MHz").press("Enter")
    # SR 1, FILT_L 1 of figure 6.1: one period of two clocks
    expect(page.get_by_test_id("bound-stopped")).to_contain_text("250\u202fns", timeout=PATIENCE_MS)


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("size", [DESKTOP, PHONE], ids=["desktop", "phone"])
def test_accessible_in_every_size_and_scheme(
    new_context: Callable[..., BrowserContext],
    check_axe: Callable[[Page], None],
    chip: Loop,
    scheme: str,
    size: dict[str, int],
) -> None:
    context = new_context(viewport=size, color_scheme=scheme)
    select(context, chip.device)
    page = context.new_page()
    page.goto("/filters")
    expect(page.get_by_test_id("bound-stopped")).to_be_visible(timeout=PATIENCE_MS)
    check_axe(page)
    assert page.evaluate("document.documentElement.scrollWidth <= window.innerWidth")
