"""A driver behind a TMC428: added as a device, and written by the fields of its registers on the chain page."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator

import httpx
import pytest
from playwright.sync_api import Page, expect

from tests.e2e.conftest import Errors


@pytest.fixture
def driven(api: httpx.Client, errors: Errors) -> Iterator[str]:
    """A controller with three drivers on its chain, and the second of them as a device; the controller's id."""
    errors.expect("status of 40[49]")
    drivers = [{"driver": "tmc2660"}] * 3
    made = api.post(
        "/devices", json={"name": "chained", "model": "tmc428", "link": {"kind": "emulator", "drivers": drivers}}
    )
    controller = made.raise_for_status().json()["id"]
    chain = {"drivers": [{"driver": "tmc2660"}] * 3}
    api.put(f"/devices/{controller}/driver-chain", json=chain).raise_for_status()
    link = {"kind": "cover", "device": controller, "axis": 1}
    driver = api.post("/devices", json={"name": "middle", "model": "tmc2660", "link": link}).raise_for_status().json()
    assert driver["state"] == "connected", driver["problem"]
    yield controller
    for device in (driver["id"], controller):
        api.delete(f"/devices/{device}").raise_for_status()


def test_a_register_is_composed_of_fields_and_the_answer_told_by_name(
    page: Page, api: httpx.Client, driven: str, check_axe: Callable[[Page], None]
) -> None:
    stored = json.dumps({"device": driven, "axis": 0})
    page.add_init_script(
        f"if (location.protocol !== 'about:') localStorage.setItem('stepscope.selection', {json.dumps(stored)})"
    )
    page.goto("/chain")
    card = page.get_by_role("region", name="Cover datagram")
    # A list closes where what comes above it pushes its field out of sight.
    for strip in ("Chain as designed", "Chain in the chip"):
        expect(page.get_by_label(strip)).to_be_visible()
    card.get_by_label("Register").click()
    page.get_by_role("option", name="SGCSCONF").click()
    card.get_by_label("CS", exact=True).fill("21")
    card.get_by_label("CS", exact=True).press("Enter")
    expect(card.get_by_role("img", name="datagram 11000000000000010101")).to_be_visible()
    card.get_by_role("button", name="Send").click()
    expect(card.get_by_role("status")).to_contain_text("STST")
    kept = api.get("/devices/middle/registers?kept=true").raise_for_status().json()
    assert {one["name"]: one["fields"] for one in kept}["SGCSCONF"]["CS"] == 21
    check_axe(page)


def test_the_emulator_panel_acts_on_the_motor_of_the_chosen_driver(
    page: Page, api: httpx.Client, driven: str, check_axe: Callable[[Page], None]
) -> None:
    stored = json.dumps({"device": driven, "axis": 0})
    page.add_init_script(
        f"if (location.protocol !== 'about:') localStorage.setItem('stepscope.selection', {json.dumps(stored)})"
    )
    page.goto("/")
    page.get_by_role("button", name="Emulator").click()
    panel = page.get_by_test_id("emulator")
    choice = panel.get_by_role("radiogroup", name="Driver of the chain")
    expect(choice.locator("label")).to_have_count(3)
    choice.locator("label").nth(1).click()
    panel.get_by_label("Shaft blocked").click()
    expect(panel.get_by_label("Shaft blocked")).to_be_checked()
    panel.get_by_label("Bridges at").fill("160")
    panel.get_by_label("Bridges at").press("Enter")
    hot = panel.get_by_label("Bridges at")
    expect(hot).to_have_value("160")
    check_axe(page)
    drivers = api.get(f"/devices/{driven}/emulator").raise_for_status().json()["driver_chain"]["drivers"]
    assert [one["load"]["blocked"] for one in drivers] == [False, True, False]
    assert [one["motor"]["temperature_c"] >= 160 for one in drivers] == [False, True, False]
