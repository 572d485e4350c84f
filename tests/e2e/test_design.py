"""From the page to the chip: registers, ramps and microstep tables that are designed in a browser arrive."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from typing import Any

import httpx
import pytest
from playwright.sync_api import BrowserContext, Page, expect

from tests.e2e.held import Held

REGISTERS = "/devices/bench/registers"
V_MAX, PAIR = f"{REGISTERS}/V_MAX", f"{REGISTERS}/PMUL_PDIV"
TABLE = "/devices/bench/microstep-table"
X = {"axis": 0}


def value(api: httpx.Client, register: str) -> int:
    answer: dict[str, Any] = api.get(register, params=X).raise_for_status().json()
    return int(answer["value"])


@pytest.fixture(autouse=True)
def as_it_was(api: httpx.Client) -> Iterator[None]:
    """Put back what the tests write."""
    registers = ("V_MAX", "A_MAX", "PMUL_PDIV", "PULSE_DIV_RAMP_DIV_USRS")
    before = {name: value(api, f"{REGISTERS}/{name}") for name in registers}
    table = api.get(TABLE).raise_for_status().json()
    yield
    api.post("/stop").raise_for_status()
    for name, old in before.items():
        api.put(f"{REGISTERS}/{name}", params=X, json={"value": old}).raise_for_status()
    api.put(TABLE, json={"values": table["values"]}).raise_for_status()


def stage_v_max(page: Page, text: str) -> None:
    page.goto("/registers")
    page.get_by_label("Search registers").fill("v_max")
    page.get_by_role("button", name=re.compile("^Edit v_max", re.IGNORECASE)).first.click()
    entry = page.get_by_label(re.compile("^New value of v_max", re.IGNORECASE)).first
    entry.fill(text)
    entry.press("Enter")


def test_a_register_edit_waits_until_it_is_applied(page: Page, api: httpx.Client) -> None:
    before = value(api, V_MAX)
    stage_v_max(page, "777")
    expect(page.get_by_text("edit staged")).to_be_visible()
    assert value(api, V_MAX) == before
    page.get_by_role("button", name="Apply", exact=True).click()
    expect(page.get_by_text("edit staged")).to_have_count(0)
    assert value(api, V_MAX) == 777


def test_a_value_out_of_range_is_refused_with_the_range(page: Page, api: httpx.Client) -> None:
    before = value(api, V_MAX)
    stage_v_max(page, "2048")
    expect(page.get_by_role("alert").filter(has_text="2047")).to_be_visible()
    expect(page.get_by_text("edit staged")).to_have_count(0)
    assert value(api, V_MAX) == before


def test_what_one_browser_writes_another_shows(
    page: Page, new_context: Callable[..., BrowserContext], api: httpx.Client
) -> None:
    other = new_context().new_page()
    other.goto("/registers")
    other.get_by_label("Search registers").fill("v_max")
    row = other.get_by_role("row").filter(has_text=re.compile("v_max", re.IGNORECASE)).first
    expect(row).to_contain_text(str(value(api, V_MAX)))
    stage_v_max(page, "888")
    page.get_by_role("button", name="Apply", exact=True).click()
    expect(row).to_contain_text("888")


def test_a_designed_ramp_is_sent_with_its_pair(page: Page, api: httpx.Client) -> None:
    pair = value(api, PAIR)
    reads = Held(page, re.compile(r"/devices/bench/registers\?"))
    page.goto("/ramps")
    field = page.get_by_label(re.compile("^a_max in chip units", re.IGNORECASE))
    present = value(api, f"{REGISTERS}/A_MAX")
    wanted = present * 2
    expect(field).not_to_have_value(str(present))
    field.focus()
    # What is typed before the chip is read would go with another ramp than the chip's.
    expect(field).not_to_be_focused()
    reads.let_go()
    expect(field).to_have_value(str(present))
    field.fill(str(wanted))
    field.press("Enter")
    send = page.get_by_role("button", name="Send", exact=True)
    expect(send).to_be_enabled()
    send.click()
    expect(page.get_by_text("the chip holds this design")).to_be_visible()
    assert value(api, f"{REGISTERS}/A_MAX") == wanted
    assert value(api, PAIR) != pair, "twice the acceleration needs another pair"


def test_a_microstep_table_goes_to_a_running_motor(page: Page, api: httpx.Client) -> None:
    before = api.get(TABLE).raise_for_status().json()["values"]
    api.post("/devices/bench/axes/0/rotate", json={"velocity": 2000}).raise_for_status()
    page.goto("/microsteps")
    page.get_by_role("button", name="Presets").click()
    page.get_by_role("menuitem").last.click()
    send = page.get_by_role("button", name="Send to chip")
    expect(send).to_be_enabled()
    send.click()
    expect(page.get_by_text("the same as the design").or_(send.and_(page.locator(":disabled")))).to_be_visible()
    assert api.get(TABLE).raise_for_status().json()["values"] != before
    assert api.get("/devices/bench/axes/0").raise_for_status().json()["moving"]


def test_current_scales_are_drawn_over_the_ramp_and_staged(page: Page, api: httpx.Client) -> None:
    register = f"{REGISTERS}/is_agtat_is_aleat_is_v0_a_threshold"
    before = value(api, register)
    reads = Held(page, re.compile(r"/devices/bench/registers\?"))
    page.goto("/ramps")
    rest = page.get_by_test_id("field-is_v0")
    expect(rest).to_be_disabled()  # what is typed before the chip was read would be lost
    reads.let_go()
    expect(rest).to_have_value(re.compile(r"^[1-8]$"))
    wanted = 2 if rest.input_value() != "2" else 3
    rest.fill(str(wanted))
    rest.press("Enter")
    expect(page.get_by_test_id("scale-times")).to_contain_text("accelerating")
    expect(page.get_by_text("edit staged")).to_be_visible()
    assert value(api, register) == before
    page.get_by_role("button", name="Apply", exact=True).click()
    expect(page.get_by_text("edit staged")).to_have_count(0)
    assert value(api, register) >> 12 & 7 == wanted
    api.put(register, params=X, json={"value": before}).raise_for_status()


def test_v_min_is_judged_against_the_motor_and_set_to_what_is_suggested(page: Page) -> None:
    page.goto("/ramps")
    table = page.get_by_test_id("start-stop")
    expect(table).to_contain_text("The motor can stop dead from", timeout=30_000)
    use = page.get_by_test_id("use-v-min")
    expect(use).to_have_text(re.compile(r"^v_min \d+$"))
    use.click()
    expect(use).to_be_disabled()
    expect(table).to_contain_text(re.compile(r"(49|50)\s% of that"))
    expect(page.get_by_text("v_min keeps every step")).to_be_visible()
