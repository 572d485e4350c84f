"""Events of a chip below the bench's scope: a row for each that occurred, with its marks; on a phone a list."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import httpx
import pytest
from playwright.sync_api import BrowserContext, Page, expect

from tests.e2e.closed_loop import Loop, a_loop
from tests.e2e.conftest import DESKTOP, PHONE
from tests.e2e.modules import select
from tests.e2e.motor import wait_for

PATIENCE_MS = 30_000


@pytest.fixture(scope="module")
def chip(api: httpx.Client) -> Iterator[Loop]:
    with a_loop(api, "eventful") as running:
        running.with_encoder()
        yield running


@pytest.fixture
def bench(page: Page, chip: Loop) -> Page:
    select(page, chip.device)
    page.goto("/")
    expect(page.get_by_test_id("events")).to_be_visible(timeout=PATIENCE_MS)
    return page


def there_and_back(chip: Loop) -> None:
    """A short move, and wait for its end."""
    chip.call("POST", "axes/0/move", {"target": 2000, "relative": True, "unit": "microsteps"})
    wait_for(lambda: not chip.axis()["moving"], "the move is over")
    chip.call("POST", "axes/0/move", {"target": -2000, "relative": True, "unit": "microsteps"})
    wait_for(lambda: not chip.axis()["moving"], "and the one back")


def told(chip: Loop, event: str) -> int:
    """How often the server's timeline has it."""
    return sum(event in entry["names"] for entry in chip.call("GET", "axes/0/events")["events"])


def times(page: Page, event: str) -> int:
    row = page.locator(f"[data-event={event}] .num")
    return int(row.inner_text()) if row.count() else 0


@pytest.mark.sheet("DS-TMC4361", "7.2")
def test_what_the_chip_tells_gets_a_row(bench: Page, chip: Loop) -> None:
    chip.register("EVENTS")  # reading clears: while the bit of an earlier end is set, another end sets nothing
    before = told(chip, "TARGET_REACHED")
    there_and_back(chip)
    # a bit that is set again before it was looked at is one event: at least one of both ends is told
    wait_for(lambda: told(chip, "TARGET_REACHED") > before, "the server has seen an end", 30)
    wait_for(lambda: times(bench, "TARGET_REACHED") == told(chip, "TARGET_REACHED"), "the page counts as it does", 30)
    assert bench.get_by_test_id("event-count").inner_text().endswith("seen"), "nothing was lost"


def test_a_mark_tells_its_event_under_the_pointer_and_with_the_keys(bench: Page, chip: Loop) -> None:
    there_and_back(chip)
    expect(bench.locator("[data-event=TARGET_REACHED]")).to_be_visible(timeout=PATIENCE_MS)
    bench.get_by_role("button", name="Pause").click()
    lanes = bench.get_by_test_id("event-lanes")
    lanes.focus()
    lanes.press("ArrowLeft")
    tip = bench.get_by_test_id("event-tip")
    expect(tip).to_be_visible()
    expect(tip).to_contain_text(" s")
    name = tip.locator("b").inner_text()
    left = tip.evaluate("node => parseFloat(node.style.left)")
    top = tip.evaluate("node => parseFloat(node.style.top)")
    bench.mouse.move(0, 0)
    lanes.blur()
    expect(tip).to_have_count(0)
    lanes.hover(position={"x": left, "y": top + 9})
    expect(tip.locator("b")).to_have_text(name)


def test_a_switch_that_stops_the_motor_is_seen(bench: Page, chip: Loop) -> None:
    chip.call("PATCH", "emulator", {"switches": {"left": True}})
    try:
        chip.write("stop_left_en", 1)
        chip.write("pol_stop_left", 1)
        chip.call("POST", "axes/0/rotate", {"velocity": -20_000, "unit": "pps"})
        expect(bench.locator("[data-event=STOPL_EVENT]")).to_be_visible(timeout=PATIENCE_MS)
    finally:
        chip.call("PATCH", "emulator", {"switches": {"left": "auto"}})
        chip.write("stop_left_en", 0)
        chip.stop()


def test_as_a_list_on_a_phone(
    new_context: Callable[..., BrowserContext], check_axe: Callable[[Page], None], chip: Loop
) -> None:
    there_and_back(chip)
    context = new_context(viewport=PHONE)
    select(context, chip.device)
    page = context.new_page()
    page.goto("/")
    entries = page.get_by_test_id("event-list").locator("li")
    expect(entries.first).to_be_attached(timeout=PATIENCE_MS)
    expect(page.get_by_test_id("event-list")).to_contain_text("TARGET_REACHED", timeout=PATIENCE_MS)
    check_axe(page)
    assert page.evaluate("document.documentElement.scrollWidth <= window.innerWidth")


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_accessible_as_timeline_and_as_list(
    new_context: Callable[..., BrowserContext], check_axe: Callable[[Page], None], chip: Loop, scheme: str
) -> None:
    there_and_back(chip)
    context = new_context(viewport=DESKTOP, color_scheme=scheme)
    select(context, chip.device)
    page = context.new_page()
    page.goto("/")
    expect(page.get_by_test_id("event-lanes")).to_be_visible(timeout=PATIENCE_MS)
    check_axe(page)
    page.get_by_text("List", exact=True).click()
    expect(page.get_by_test_id("event-list")).to_be_visible()
    check_axe(page)


@pytest.mark.sheet("DS-TMC4361", "7.2")
def test_the_registers_page_does_not_read_events_away(page: Page, chip: Loop) -> None:
    select(page, chip.device)
    page.goto("/registers")
    row = page.locator("tr[data-row='0/EVENTS']")
    expect(row).to_contain_text("not polled", timeout=PATIENCE_MS)
    row.click()
    expect(page.get_by_text("Reading clears it, so this page does not poll it.")).to_be_visible()
    # one word, three names: who is meant when
    page.locator("tr[data-row='0/X_LATCH']").click()
    help_text = page.get_by_role("complementary")
    expect(help_text).to_contain_text("REV_CNT when read, if circular_cnt_as_xlatch is on; X_RANGE when written")
    expect(page.locator("tr[data-row='0/REV_CNT']")).to_contain_text("if circular_cnt_as_xlatch is on")
    expect(page.locator("tr[data-row='0/SPI_SWITCH_VEL']")).to_contain_text("stored only")
