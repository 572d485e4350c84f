"""Undo in a browser: designs and staged edits by keys, what was written by a preview, the history that lists both."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator

import httpx
import pytest
from playwright.sync_api import BrowserContext, Locator, Page, expect

from tests.e2e.chips import Chip, a_chip, select, set_up
from tests.e2e.conftest import PHONE
from tests.e2e.motor import wait_for


@pytest.fixture
def chip(api: httpx.Client) -> Iterator[Chip]:
    """An emulated TMC5160 with a ramp."""
    with a_chip(api, "undone") as running:
        set_up(running)
        yield running


def held(chip: Chip, name: str) -> int:
    return int(chip.register(name)["value"])


def open_history(page: Page) -> Locator:
    page.get_by_role("button", name="History", exact=True).click()
    drawer = page.get_by_role("dialog", name="History")
    expect(drawer).to_be_visible()
    return drawer


def knob(page: Page, parameter: str) -> Locator:
    return page.get_by_role("slider", name=re.compile(f"^{parameter},"))


def value(page: Page, parameter: str) -> float:
    return float(knob(page, parameter).get_attribute("aria-valuenow") or "nan")


def test_a_drag_is_one_entry_and_keys_take_it_back(chip: Chip, page: Page, check_axe: Callable[[Page], None]) -> None:
    select(page, chip)
    page.goto("/sixpoint")
    expect(knob(page, "V1")).to_be_visible()
    field = page.get_by_label("VMAX in chip units", exact=True)
    field.fill("90000")
    field.press("Enter")
    field.press("Tab")
    box = knob(page, "V1").bounding_box()
    assert box is not None
    before = value(page, "V1")
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    page.mouse.down()
    for step in range(1, 9):
        page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2 + 4 * step)
    page.mouse.up()
    after = value(page, "V1")
    assert after != before
    drawer = open_history(page)
    steps = drawer.get_by_role("region", name="On this page").get_by_role("listitem")
    expect(steps).to_have_count(3)  # the drag, VMAX, and how it began
    check_axe(page)
    page.keyboard.press("Escape")
    expect(drawer).to_have_count(0)
    page.keyboard.press("Control+z")
    expect(page.get_by_text(re.compile("^Undone: Design"))).to_be_visible()
    assert value(page, "V1") == before
    page.keyboard.press("Control+Shift+z")
    expect(knob(page, "V1")).to_have_attribute("aria-valuenow", re.compile(re.escape(f"{after:g}"[:4])))


def test_a_staged_edit_is_undone_and_a_text_keeps_its_own_undo(chip: Chip, page: Page) -> None:
    select(page, chip)
    page.goto("/registers?find=VMAX")
    expect(page.get_by_text("No edits staged")).to_be_visible()
    page.get_by_role("button", name=re.compile("^Edit VMAX")).first.click()
    entry = page.get_by_label("New value of VMAX")
    entry.fill("4321")
    entry.press("Control+z")
    expect(entry).not_to_have_value("4321")
    entry.fill("4321")
    entry.press("Enter")
    expect(page.get_by_text("edit staged")).to_be_visible()
    page.locator("h1").first.click()
    page.keyboard.press("Control+z")
    expect(page.get_by_text("No edits staged")).to_be_visible()
    page.keyboard.press("Control+Shift+z")
    expect(page.get_by_text("edit staged")).to_be_visible()
    page.get_by_role("button", name="Apply").click()
    wait_for(lambda: held(chip, "VMAX") == 4321, "it was written")
    expect(page.get_by_text("last apply")).to_be_visible()
    page.locator("h1").first.click()
    page.keyboard.press("Control+z")  # of what was written it shows what that would write
    preview = page.get_by_role("region", name="Preview")
    expect(preview.get_by_role("checkbox", name="VMAX, axis 0")).to_be_checked()
    assert held(chip, "VMAX") == 4321
    preview.get_by_role("button", name="Put back 1").click()
    wait_for(lambda: held(chip, "VMAX") == 100_000, "it is put back")


def test_what_was_written_is_put_back_after_a_preview_that_asks_about_others(
    chip: Chip, page: Page, check_axe: Callable[[Page], None]
) -> None:
    select(page, chip)
    vmax, amax = held(chip, "VMAX"), held(chip, "AMAX")
    page.goto("/registers")
    chip.write("AMAX", 777)
    chip.write("VMAX", 4321)
    drawer = open_history(page)
    drawer.get_by_role("button", name="As it was before write AMAX").first.click()
    preview = drawer.get_by_role("region", name="Preview")
    expect(preview.get_by_role("checkbox", name="VMAX, axis 0")).to_be_checked()
    preview.get_by_role("checkbox", name="VMAX, axis 0").uncheck()
    check_axe(page)
    preview.get_by_role("button", name="Put back 1").click()
    expect(preview.get_by_text("It is put back")).to_be_visible()
    assert (held(chip, "AMAX"), held(chip, "VMAX")) == (amax, 4321)
    preview.get_by_role("button", name="Back to the list").click()
    expect(drawer.get_by_test_id("device-history").get_by_role("listitem").first).to_contain_text("undo before entry")
    drawer.get_by_role("button", name="Undo write VMAX").first.click()
    preview.get_by_role("button", name="Put back 1").click()
    expect(preview.get_by_text("It is put back")).to_be_visible()
    assert held(chip, "VMAX") == vmax


def test_a_profile_that_was_applied_is_undone_from_the_audit_log(chip: Chip, page: Page, api: httpx.Client) -> None:
    select(page, chip)
    page.goto("/registers?find=VMAX")
    vmax = held(chip, "VMAX")
    profile = api.get(f"/devices/{chip.device}/profile").json()
    profile["registers"] = [{"name": "VMAX", "axis": 0, "value": 999}]
    api.put(f"/devices/{chip.device}/profile", json=profile).raise_for_status()
    page.goto("/audit")
    page.get_by_role("button", name=re.compile("^Undo apply profile")).first.click()
    preview = page.get_by_role("region", name="Preview")
    preview.get_by_role("button", name="Put back 1").click()
    expect(preview.get_by_text("It is put back")).to_be_visible()
    assert held(chip, "VMAX") == vmax


def test_on_a_phone_the_history_is_found(
    chip: Chip, new_context: Callable[..., BrowserContext], check_axe: Callable[[Page], None]
) -> None:
    chip.write("VMAX", 4321)
    page = new_context(viewport=PHONE).new_page()
    select(page, chip)
    page.goto("/registers")
    page.get_by_role("button", name="Find", exact=True).click()
    page.get_by_role("combobox", name="Find", exact=True).fill("history")
    page.get_by_role("option", name=re.compile("Open the history")).click()
    drawer = page.get_by_role("dialog", name="History")
    drawer.get_by_role("button", name="Undo write VMAX").first.click()
    expect(drawer.get_by_role("checkbox", name="VMAX, axis 0")).to_be_checked()
    check_axe(page)
