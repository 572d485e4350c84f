"""The palette: everything there is, found and gone to by keys; nothing in it moves a motor, and Escape stops."""

from __future__ import annotations

import re
from collections.abc import Callable

import httpx
from playwright.sync_api import BrowserContext, Page, expect

from tests.e2e.chips import a_chip
from tests.e2e.conftest import PHONE
from tests.e2e.motor import wait_for

AXIS = "/devices/bench/axes/0"


def find(page: Page, text: str) -> None:
    expect(page.get_by_role("button", name="Find anything")).to_be_visible()
    page.keyboard.press("Control+k")
    entry = page.get_by_role("combobox", name="Find", exact=True)
    expect(entry).to_be_focused()
    entry.fill(text)


def first(page: Page, has: str) -> None:
    expect(page.get_by_role("dialog", name="Find").get_by_role("option").first).to_contain_text(has)


def test_a_register_a_page_and_the_help_are_found_by_keys_alone(page: Page, check_axe: Callable[[Page], None]) -> None:
    page.goto("/")
    find(page, "amax")
    first(page, "a_max")
    check_axe(page)
    page.keyboard.press("Enter")
    expect(page).to_have_url(re.compile(r"/registers\?find=a_max"))
    expect(page.get_by_role("textbox", name="Search registers")).to_have_value("a_max")
    find(page, "v max")  # on the page that shows another one already
    first(page, "v_max")
    page.keyboard.press("Enter")
    expect(page.get_by_role("textbox", name="Search registers")).to_have_value("v_max")
    find(page, "program")
    expect(page.get_by_role("option", name="Program not for a TMC428")).to_have_attribute(
        "data-combobox-disabled", "true"
    )
    page.keyboard.press("Control+k")
    expect(page.get_by_role("dialog")).to_have_count(0)
    find(page, "")
    expect(page.get_by_role("option")).to_have_text([re.compile("v_max"), re.compile("a_max")])  # the latest first
    with page.expect_popup() as opened:
        page.get_by_role("combobox", name="Find", exact=True).fill("back-emf")
        page.get_by_role("option", name=re.compile("Back-EMF.*Glossary")).click()
    expect(opened.value).to_have_url(re.compile(r"/help/glossary\.html#back-emf"))


def test_what_nobody_calls_so_is_told_and_an_axis_is_chosen(page: Page, api: httpx.Client) -> None:
    other = next(one for one in api.get("/devices").json() if one["id"] != "bench")
    page.goto("/console")
    find(page, "zzzzz")
    expect(page.get_by_text('Nothing here is called "zzzzz"')).to_be_visible()
    page.get_by_role("combobox", name="Find", exact=True).fill(other["name"])
    page.get_by_role("option", name=re.compile(f"{re.escape(other['name'])}.*Axis")).first.click()
    expect(page.get_by_role("combobox", name="Device and axis")).to_have_value(re.compile(re.escape(other["name"])))


def test_what_is_chosen_stays_chosen_while_devices_come_and_go(page: Page, api: httpx.Client) -> None:
    page.goto("/")
    find(page, "max")
    first(page, "a_max")
    page.keyboard.press("ArrowDown")
    chosen = page.locator("[data-combobox-selected]")
    expect(chosen).to_contain_text("v_max")
    with a_chip(api, "newcomer", "tmc428"):
        expect(page.get_by_text("3 of 3 connected")).to_be_visible()
        expect(chosen).to_contain_text("v_max")


def test_escape_stops_what_moves_while_it_is_open(page: Page, api: httpx.Client) -> None:
    page.goto("/")
    api.post(f"{AXIS}/rotate", json={"velocity": 500}).raise_for_status()
    try:
        expect(page.locator("body")).to_have_attribute("data-may-move", "true")
        find(page, "stop")
        first(page, "Stop all axes")
        page.keyboard.press("Escape")
        expect(page.get_by_role("dialog")).to_have_count(0)
        wait_for(lambda: not api.get(AXIS).json()["moving"], "stopped")
    finally:
        api.post("/stop").raise_for_status()


def test_on_a_phone_it_is_a_button_and_fits(new_context: Callable[..., BrowserContext]) -> None:
    page = new_context(viewport=PHONE).new_page()
    page.goto("/")
    page.get_by_role("button", name="Find", exact=True).click()
    page.get_by_role("combobox", name="Find", exact=True).fill("records")
    expect(page.get_by_role("option").first).to_be_visible()
    assert page.evaluate("document.documentElement.scrollWidth") <= 390


def test_layouts_and_macros_are_found_and_nothing_runs_by_that(page: Page, api: httpx.Client) -> None:
    steps = [{"do": "wait", "seconds": 1}]
    macro = {"format": "stepscope.macro", "version": 1, "name": "There and back", "steps": steps}
    kept = api.post("/macros", json={"document": macro}).raise_for_status().json()
    before = api.get("/devices/bench/macro-run").raise_for_status().json()["run"]
    try:
        page.goto("/")
        find(page, "there and back")
        first(page, "There and back")
        page.keyboard.press("Enter")
        expect(page).to_have_url(re.compile(r"/\?.*layout=macros"))
        expect(page.get_by_role("region", name="Macros")).to_contain_text("There and back")
        assert api.get("/devices/bench/macro-run").raise_for_status().json()["run"] == before
        find(page, "3d beside")
        first(page, "3D beside the scope")
        page.keyboard.press("Control+k")
    finally:
        api.delete(f"/macros/{kept['id']}").raise_for_status()
