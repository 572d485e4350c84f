"""Parameters of a module in a browser: staged, applied, read back; EEPROM; what reading would clear."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import httpx
import pytest
from playwright.sync_api import BrowserContext, Locator, Page, ViewportSize, expect

from tests.e2e.conftest import DESKTOP, PHONE, Errors
from tests.e2e.modules import a_module, select


@pytest.fixture(autouse=True)
def module(api: httpx.Client) -> Iterator[str]:
    """Made before the page, so that it goes after the page: nobody asks for a device that is gone."""
    with a_module(api) as device:
        yield device


@pytest.fixture
def drive(module: str, page: Page) -> str:
    select(page, module)
    return module


def value(api: httpx.Client, device: str, name: str) -> int:
    return int(api.get(f"/devices/{device}/registers/{name}").raise_for_status().json()["value"])


def row(page: Page, name: str) -> Locator:
    return page.locator(f"[data-row$='/{name}']")


def find(page: Page, text: str) -> None:
    page.get_by_label("Search parameters").fill(text)


def test_a_speed_is_typed_in_turns_and_read_back(page: Page, api: httpx.Client, drive: str) -> None:
    page.goto("/parameters")
    find(page, "ap 4")
    speed = row(page, "maximum_positioning_speed")
    expect(speed).to_contain_text("AP 4")
    expect(speed).to_contain_text("1 rps")
    speed.focus()
    page.keyboard.press("Enter")
    page.get_by_label("New value of Maximum positioning speed").fill("2 rps")
    page.keyboard.press("Enter")
    expect(speed).to_have_attribute("data-staged", "true")
    assert value(api, drive, "ap4") == 51_200, "nothing is sent before Apply"
    page.get_by_role("button", name="Apply", exact=True).click()
    expect(page.get_by_text("1 read back")).to_be_visible()
    expect(speed).to_have_attribute("data-staged", "false")
    expect(speed).to_contain_text("2 rps")
    assert value(api, drive, "ap4") == 102_400


def test_a_value_out_of_range_is_refused_while_it_is_typed(page: Page, drive: str) -> None:
    page.goto("/parameters")
    find(page, "ap 4")
    row(page, "maximum_positioning_speed").dblclick()
    page.get_by_label("New value of Maximum positioning speed").fill("8000000")
    expect(page.get_by_role("alert").filter(has_text="takes 0 to 7999774")).to_be_visible()
    page.keyboard.press("Enter")
    expect(row(page, "maximum_positioning_speed")).to_have_attribute("data-staged", "false")


def test_names_and_flags_are_chosen_in_the_row(page: Page, api: httpx.Client, drive: str) -> None:
    page.goto("/parameters")
    find(page, "relative positioning")
    page.get_by_label("Relative positioning option").select_option("1")
    find(page, "swap")
    swap = page.get_by_label("Swap limit switches")
    expect(swap).to_be_enabled()  # a row that was not shown before is read first
    swap.press("Space")
    page.get_by_role("button", name="Review").click()
    changes = page.get_by_role("tabpanel", name="Changes")
    expect(changes).to_contain_text("last target")
    page.get_by_role("button", name="Apply 2 edits").click()
    expect(page.get_by_text("2 read back")).to_be_visible()
    assert value(api, drive, "ap127") == 1
    assert value(api, drive, "ap14") == 1


def test_what_reading_clears_is_read_only_when_asked_for(page: Page, api: httpx.Client, drive: str) -> None:
    page.goto("/parameters")
    find(page, "extended error")
    flags = row(page, "extended_error_flags")
    expect(flags).to_contain_text("reading it clears it")
    asked = [frame["text"] for frame in frames(api, drive) if frame["text"].startswith("GAP 207")]
    page.get_by_role("button", name="Read and clear").click()
    expect(flags).to_contain_text("stallguard stop")
    now = [frame["text"] for frame in frames(api, drive) if frame["text"].startswith("GAP 207")]
    assert (len(asked), len(now)) == (0, 1)


def frames(api: httpx.Client, device: str) -> list[dict[str, str]]:
    answer = api.get(f"/devices/{device}/frames", params={"limit": 2000}).raise_for_status().json()
    found: list[dict[str, str]] = answer["frames"]
    return found


def test_a_variable_goes_to_the_eeprom_and_back(page: Page, api: httpx.Client, drive: str) -> None:
    api.put(f"/devices/{drive}/registers/user_variable_3", json={"value": 42}).raise_for_status()
    page.goto("/parameters")
    find(page, "user variable 3")
    variable = row(page, "user_variable_3")
    expect(variable).to_contain_text("42")
    page.get_by_role("button", name="Store User variable 3 in EEPROM", exact=True).click()
    expect(variable).to_contain_text("EEPROM 42")
    api.put(f"/devices/{drive}/registers/user_variable_3", json={"value": 7}).raise_for_status()
    page.get_by_role("button", name="Restore User variable 3 from EEPROM", exact=True).click()
    expect(variable.get_by_text("42", exact=True).first).to_be_visible()
    assert value(api, drive, "user_variable_3") == 42


def test_folded_subjects_are_not_asked_for(page: Page, api: httpx.Client, drive: str) -> None:
    page.goto("/parameters")
    expect(row(page, "actual_position")).to_contain_text("0")
    seen = api.get(f"/devices/{drive}/frames", params={"limit": 2000}).json()["next"]
    with page.expect_response(lambda answer: "/registers?" in answer.url):
        pass  # one more look of the page
    later = api.get(f"/devices/{drive}/frames", params={"after": seen, "limit": 2000}).json()["frames"]
    asked = [frame["text"] for frame in later]
    assert any(text.startswith("GAP 0, 0") for text in asked)
    assert not any(text.startswith("GGP 200, 2") for text in asked)
    page.get_by_role("button", name="User variables").first.click()
    expect(row(page, "user_variable_200")).to_contain_text("0")


def test_a_lost_module_shows_its_values_as_old_and_edits_wait(
    page: Page, api: httpx.Client, drive: str, errors: Errors
) -> None:
    errors.expect("status of 409")  # a look that is under way when the connection goes
    page.goto("/parameters")
    expect(row(page, "target_position")).to_contain_text("0")
    api.post(f"/devices/{drive}/disconnect").raise_for_status()
    expect(page.get_by_text("is not connected. Edits can be staged now")).to_be_visible()
    expect(page.locator("table")).to_have_attribute("data-old", "true")
    find(page, "relative positioning")
    page.get_by_label("Relative positioning option").select_option("1")
    expect(page.get_by_text("waiting for the connection")).to_be_visible()
    page.get_by_role("main").get_by_role("button", name="Connect").click()
    expect(page.locator("table")).to_have_attribute("data-old", "false")
    page.get_by_role("button", name="Apply", exact=True).click()
    expect(page.get_by_text("1 read back")).to_be_visible()


def test_a_chip_has_no_parameters_and_the_page_says_where_to_go(page: Page, drive: str) -> None:
    page.goto("/parameters")
    page.goto("/registers")
    expect(page.get_by_text("Registers is not for drive")).to_be_visible()
    page.get_by_role("link", name="Parameters of drive").click()
    expect(page).to_have_title("Parameters · stepscope")
    expect(row(page, "target_position")).to_be_visible()


def test_the_page_is_open_to_everybody(page: Page, drive: str, check_axe: Callable[[Page], None]) -> None:
    page.goto("/parameters")
    expect(row(page, "target_position")).to_contain_text("0")
    for size in (DESKTOP, PHONE):
        page.set_viewport_size(size)
        for scheme in ("light", "dark"):
            page.emulate_media(color_scheme=scheme)
            expect(row(page, "target_position")).to_be_visible()
            check_axe(page)
        sideways = page.evaluate("document.scrollingElement.scrollWidth - document.documentElement.clientWidth")
        assert sideways <= 0


NOTHING_BELOW = """() => {
  const root = document.documentElement;
  const scrolls = (node) => ['auto', 'scroll'].includes(getComputedStyle(node).overflowY);
  const clips = (node) => getComputedStyle(node).overflowY !== 'visible';
  const shown = (node) => {
    const box = node.getBoundingClientRect();
    return node.checkVisibility({ opacityProperty: true, visibilityProperty: true }) && box.width > 1 && box.height > 1;
  };
  const bottomWithin = (node, end) => {
    let bottom = node.getBoundingClientRect().bottom;
    for (let at = node.parentElement; at && at !== end; at = at.parentElement) {
      if (getComputedStyle(at).position === 'fixed') return -Infinity;
      if (clips(at) && at !== document.body) bottom = Math.min(bottom, at.getBoundingClientRect().bottom);
    }
    return bottom;
  };
  // a bar that stays at the lower edge covers the end of the window
  const bars = [...document.querySelectorAll('body *')]
    .map((node) => [getComputedStyle(node).position, node.getBoundingClientRect()])
    .filter(([position, box]) => position === 'fixed' && box.width >= innerWidth - 1 && box.top > innerHeight / 2)
    .map(([, box]) => box.top);
  const floor = Math.min(innerHeight, ...bars);
  return [root, ...document.querySelectorAll('body *')]
    .filter((node) => (node === root || scrolls(node)) && node.scrollHeight > node.clientHeight + 1)
    .map((node) => {
      node.scrollTop = node.scrollHeight;
      const end = node === root ? floor : node.getBoundingClientRect().top + node.clientTop + node.clientHeight;
      const leaves = [...node.querySelectorAll('*')].filter((leaf) => leaf.childElementCount === 0 && shown(leaf));
      const last = Math.max(...leaves.map((leaf) => bottomWithin(leaf, node)));
      return { node: node.className || node.tagName, nothing: end - last, scrolled: node.scrollTop };
    });
}"""
"""Scrolls all that scrolls to its end: how much lies there below the last thing that can be seen [px]."""


@pytest.mark.parametrize("size", [DESKTOP, PHONE], ids=["desktop", "phone"])
def test_the_page_ends_where_its_content_ends(
    new_context: Callable[..., BrowserContext], module: str, size: ViewportSize
) -> None:
    context = new_context(viewport=size)
    select(context, module)
    page = context.new_page()
    page.goto("/parameters")
    expect(row(page, "target_position")).to_be_visible()
    closed = page.locator("[data-subject] button[aria-expanded=false][data-row^='group ']")
    for left in range(closed.count(), 0, -1):
        expect(closed).to_have_count(left)
        closed.first.click()
    expect(closed).to_have_count(0)
    page.locator("[data-row]").last.scroll_into_view_if_needed()
    ends = page.evaluate(NOTHING_BELOW)
    assert any(end["scrolled"] > 1000 for end in ends), "the list is longer than the window"
    # below the last thing is the padding around it, on a phone with the place of the bar of staged edits
    assert [end for end in ends if end["nothing"] > 100] == []
    if size is DESKTOP:
        assert page.evaluate("document.documentElement.scrollHeight - document.documentElement.clientHeight") == 0
