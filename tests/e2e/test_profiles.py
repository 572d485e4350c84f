"""Profiles in a browser: kept, compared, applied, handed on as files and scripts; what fails, and who is shut out."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from pathlib import Path

import httpx
import pytest
from playwright.sync_api import Page, expect

from tests.e2e.conftest import DESKTOP, PHONE, Errors
from tests.e2e.held import Held
from tests.e2e.modules import a_module, select

TRIED_WITHIN_MS = 60_000
"""A script is tried in the server before it is there."""


@pytest.fixture(autouse=True)
def module(api: httpx.Client) -> Iterator[str]:
    """Made before the page, so that it goes after the page. No profile is left behind."""
    with a_module(api) as device:
        yield device
    for profile in api.get("/profiles").raise_for_status().json()["profiles"]:
        api.delete(f"/profiles/{profile['id']}").raise_for_status()


@pytest.fixture
def drive(module: str, page: Page) -> str:
    select(page, module)
    return module


def speed(api: httpx.Client, device: str) -> int:
    return int(api.get(f"/devices/{device}/registers/ap4").raise_for_status().json()["value"])


def set_speed(api: httpx.Client, device: str, pps: int) -> None:
    api.put(f"/devices/{device}/registers/ap4", json={"value": pps}).raise_for_status()


def keep(api: httpx.Client, device: str, name: str, note: str = "") -> int:
    body = {"device": device, "name": name, "note": note}
    return int(api.post("/profiles", json=body).raise_for_status().json()["id"])


def test_what_was_captured_is_compared_and_brought_back(page: Page, api: httpx.Client, drive: str) -> None:
    before = speed(api, drive)
    page.goto("/profiles")
    expect(page.get_by_text("No profile yet")).to_be_visible()
    page.get_by_role("button", name="Capture drive").click()
    count = page.get_by_test_id("diff-count")
    expect(count).to_contain_text("No difference")
    expect(page.get_by_role("button", name="Nothing to apply")).to_be_disabled()

    set_speed(api, drive, 30_000)
    page.get_by_role("button", name="Compare again").click()
    expect(count).to_contain_text("1 difference")
    table = page.get_by_role("region", name="Differences")
    row = table.locator("tr[data-differs='true']")
    expect(row).to_contain_text("maximum_positioning_speed")
    expect(row.locator("td").nth(2)).to_contain_text("30 000")
    expect(row.locator("td").nth(3)).to_contain_text(f"{before // 1000} {before % 1000:03}")
    page.get_by_role("switch", name="Only differences").click()
    expect(table.locator("tr[data-differs='false']").first).to_be_visible()

    page.get_by_role("button", name="Apply 1 change").click()
    expect(page.get_by_text("The profile is in drive")).to_be_visible()
    expect(page.get_by_role("list", name="Steps").get_by_text("read back")).to_be_visible()
    expect(count).to_contain_text("No difference")
    assert speed(api, drive) == before


def test_two_profiles_beside_each_other(page: Page, api: httpx.Client, drive: str) -> None:
    keep(api, drive, "as it came")
    set_speed(api, drive, 20_000)
    slow = keep(api, drive, "slow")
    page.goto(f"/profiles?profile={slow}")
    page.get_by_role("combobox", name="Compare with").click()
    page.get_by_role("option", name="as it came").click()
    expect(page.get_by_test_id("diff-count")).to_contain_text("1 difference")
    heads = page.get_by_role("region", name="Differences").get_by_role("columnheader")
    expect(heads.nth(2)).to_have_text("as it came")
    expect(heads.nth(3)).to_have_text("slow")
    expect(page.get_by_role("button", name="Apply 1 change")).to_have_count(0)


def test_words_are_kept_searched_and_deleted(page: Page, api: httpx.Client, drive: str) -> None:
    keep(api, drive, "loud")
    number = keep(api, drive, "quiet")
    page.goto("/profiles")
    entries = page.get_by_role("list", name="Profiles").get_by_role("button")
    expect(entries).to_have_count(2)
    page.keyboard.press("/")
    page.keyboard.type("quiet")
    expect(entries).to_have_count(1)
    entries.first.press("Enter")
    expect(entries.first).to_have_attribute("aria-current", "true")
    page.get_by_label("Name", exact=True).fill("silent")
    page.get_by_label("Name", exact=True).press("Enter")
    page.get_by_label("Note").fill("for the night")
    page.get_by_label("Note").blur()
    page.get_by_label("Search profiles").fill("night")
    expect(entries.first).to_contain_text("silent")
    kept = api.get(f"/profiles/{number}").json()
    assert (kept["name"], kept["note"], kept["document"]["note"]) == ("silent", "for the night", "for the night")
    page.get_by_role("button", name="Delete").click()
    page.get_by_role("dialog").get_by_role("button", name="Keep").click()
    expect(page.get_by_role("dialog")).to_have_count(0)
    page.get_by_role("button", name="Delete").click()
    page.get_by_role("dialog").get_by_role("button", name="Delete").click()
    expect(page.get_by_text("Choose a profile")).to_be_visible()
    assert api.get("/profiles").json()["profiles"][0]["name"] == "loud"


def test_a_file_goes_out_and_comes_back(page: Page, api: httpx.Client, drive: str, tmp_path: Path) -> None:
    number = keep(api, drive, "to hand on", "as found")
    page.goto(f"/profiles?profile={number}")
    with page.expect_download() as told:
        page.get_by_role("button", name="Export").click()
    assert told.value.suggested_filename == "to-hand-on.json"
    file = tmp_path / "profile.json"
    told.value.save_as(file)
    assert json.loads(file.read_text())["note"] == "as found"
    api.delete(f"/profiles/{number}")
    page.goto("/profiles")
    page.locator("input[type=file]").set_input_files(file)
    expect(page.get_by_role("list", name="Profiles").get_by_role("button")).to_contain_text("to hand on")

    file.write_text("no JSON")
    page.locator("input[type=file]").set_input_files(file)
    expect(page.get_by_role("alert").filter(has_text="profile.json cannot be read")).to_be_visible()


def test_a_script_comes_with_what_its_trial_showed(page: Page, api: httpx.Client, drive: str) -> None:
    page.goto(f"/profiles?profile={keep(api, drive, 'quiet')}")
    tabs = page.get_by_role("tablist", name="Language")
    expect(tabs.get_by_role("tab")).to_have_count(4)
    tabs.get_by_role("tab", name="TMCL").click()
    seal = page.get_by_test_id("seal")
    expect(seal).to_contain_text("Checked on the emulator", timeout=TRIED_WITHIN_MS)
    expect(seal).to_contain_text("PD42-1241")
    expect(page.get_by_role("region", name="TMCL script")).to_contain_text(f"SAP 4, 0, {speed(api, drive)}")
    with page.expect_download() as told:
        seal.get_by_role("button", name="quiet.tmc").click()
    assert "SAP 4, 0," in Path(told.value.path()).read_text()
    page.keyboard.press("Tab")
    tabs.get_by_role("tab", name="TMCL").press("ArrowLeft")
    expect(page.get_by_role("region", name="C script")).to_contain_text("profile_quiet_apply", timeout=TRIED_WITHIN_MS)


def test_a_device_that_falls_silent_is_told(page: Page, api: httpx.Client, drive: str, errors: Errors) -> None:
    errors.expect("504|502|409")
    number = keep(api, drive, "quiet")
    set_speed(api, drive, 30_000)
    page.goto(f"/profiles?profile={number}")
    button = page.get_by_role("button", name="Apply 1 change")
    expect(button).to_be_enabled()
    devices = Held(page, "**/api/v1/devices")  # it hears that the device has failed only after it compared anew
    api.patch(f"/devices/{drive}/emulator", json={"faults": {"silence": True}}).raise_for_status()
    button.click()
    expect(page.get_by_role("alert").filter(has_text="Comparing with drive")).to_be_visible()
    told = page.get_by_role("alert").filter(has_text="Applying the profile")
    expect(told).to_be_visible()
    devices.let_go()
    expect(page.get_by_text("drive is failed: connect it")).to_be_visible()
    expect(told).to_be_visible()
    api.patch(f"/devices/{drive}/emulator", json={"faults": {"silence": False}}).raise_for_status()


def test_without_the_device_there_is_something_to_say(page: Page, api: httpx.Client, drive: str) -> None:
    number = keep(api, drive, "quiet")
    api.post(f"/devices/{drive}/disconnect").raise_for_status()
    page.goto(f"/profiles?profile={number}")
    expect(page.get_by_text("connect it to see what this profile would change")).to_be_visible()
    expect(page.get_by_role("button", name="Capture drive")).to_be_disabled()
    expect(page.get_by_role("tablist", name="Language")).to_be_visible()


def test_nobody_is_shut_out(page: Page, api: httpx.Client, check_axe: Callable[[Page], None]) -> None:
    # A short profile: axe looks at every word of its script, in each size and scheme.
    document = api.get("/devices/slider/profile").raise_for_status().json()
    next(each for each in document["registers"] if each["name"] == "V_MAX")["value"] = 300
    number = api.post("/profiles", json={"document": document, "name": "slow", "note": "a note"}).json()["id"]
    page.goto(f"/profiles?profile={number}")
    page.get_by_role("tab", name="C", exact=True).click()
    expect(page.get_by_test_id("seal")).to_be_visible(timeout=TRIED_WITHIN_MS)
    expect(page.get_by_test_id("diff-count")).to_contain_text("1 difference")
    for size, scheme in ((DESKTOP, "light"), (DESKTOP, "dark"), (PHONE, "light"), (PHONE, "dark")):
        page.set_viewport_size(size)
        page.emulate_media(color_scheme="dark" if scheme == "dark" else "light")
        check_axe(page)
        sideways = page.evaluate("document.scrollingElement.scrollWidth - document.documentElement.clientWidth")
        assert sideways <= 0, f"{size} can be scrolled sideways by {sideways} px"
