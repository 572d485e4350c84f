"""The S-ramp designer in a browser: handles by mouse, finger and keys, and the ramp on an emulated TMC4361."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator
from typing import Any, Literal

import httpx
import pytest
from playwright.sync_api import BrowserContext, Locator, Page, expect

from tests.e2e.conftest import PHONE
from tests.e2e.motor import wait_for

STAGE = "s-stage"
REGISTERS = f"/devices/{STAGE}/registers"


@pytest.fixture
def stage(api: httpx.Client) -> Iterator[str]:
    """An emulated TMC4361, as it comes out of a reset."""
    body = {
        "name": STAGE,
        "model": "tmc4361",
        "link": {"kind": "emulator"},
        "axes": [{"name": "X", "travel_mm_per_rev": 8.0}],
    }
    api.post("/devices", json=body).raise_for_status()
    yield STAGE
    api.post("/stop").raise_for_status()
    api.delete(f"/devices/{STAGE}").raise_for_status()


def select(page: Page, device: str) -> Page:
    """`page`, which shows `device`."""
    chosen = json.dumps(json.dumps({"device": device, "axis": 0}))
    page.add_init_script(f"if (location.host) localStorage.setItem('stepscope.selection', {chosen})")
    return page


@pytest.fixture
def designer(stage: str, page: Page) -> Page:
    select(page, stage).goto("/sramp")
    expect(knob(page, "BOW1")).to_be_visible()
    return page


def knob(page: Page, parameter: str) -> Locator:
    return page.get_by_role("slider", name=re.compile(f"^{parameter},"))


def value(page: Page, parameter: str) -> float:
    return float(knob(page, parameter).get_attribute("aria-valuenow") or "nan")


def centre(handle: Locator) -> tuple[float, float]:
    handle.scroll_into_view_if_needed()
    box = handle.locator("span").first.bounding_box()
    assert box is not None
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def register(api: httpx.Client, name: str) -> int:
    return int(api.get(f"{REGISTERS}/{name}", params={"axis": 0}).raise_for_status().json()["value"])


def axis(api: httpx.Client) -> dict[str, Any]:
    state: dict[str, Any] = api.get(f"/devices/{STAGE}/axes/0").raise_for_status().json()
    return state


def send(page: Page) -> None:
    button = page.get_by_role("button", name="Send", exact=True)
    expect(button).to_be_enabled()
    button.click()
    expect(page.get_by_text("the chip holds this design")).to_be_visible()


def test_a_bow_is_dragged_and_the_ramp_follows(designer: Page) -> None:
    page = designer
    page.get_by_text("free", exact=True).click()
    before = {name: value(page, name) for name in ("BOW1", "BOW2")}
    took = page.get_by_role("list", name="Phases").locator("li").first
    expect(took).to_contain_text("B1")
    was = took.inner_text()
    x, y = centre(knob(page, "BOW1"))
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x, y + 10, steps=4)
    page.mouse.move(x, y + 22, steps=4)
    page.mouse.up()
    assert 0 < value(page, "BOW1") < before["BOW1"] * 0.8
    assert value(page, "BOW2") == before["BOW2"], "free: the others stay"
    expect(took).not_to_have_text(was)
    # the knob stands where it was let go, once the plot has come to rest
    expect(page.get_by_label(re.compile("^BOW1 in "))).to_have_value(re.compile(r"^\d"))


def test_equal_bows_go_together(designer: Page) -> None:
    page = designer
    page.get_by_text("all equal", exact=True).click()
    knob(page, "BOW3").focus()
    page.keyboard.press("Shift+ArrowRight")
    expect(knob(page, "BOW1")).to_have_attribute(
        "aria-valuenow", knob(page, "BOW3").get_attribute("aria-valuenow") or ""
    )
    assert len({value(page, f"BOW{number}") for number in (1, 2, 3, 4)}) == 1


def test_keys_step_a_handle_and_say_its_value(designer: Page) -> None:
    page = designer
    before = value(page, "VMAX")
    knob(page, "VMAX").focus()
    page.keyboard.press("ArrowUp")
    expect(knob(page, "VMAX")).to_have_attribute("aria-valuenow", f"{before * 1.01:.0f}")
    page.keyboard.press("Shift+ArrowDown")
    assert value(page, "VMAX") == pytest.approx(before * 1.01 * 0.9, rel=1e-3)
    expect(knob(page, "VMAX")).to_have_attribute("aria-valuetext", re.compile("pps$"))
    page.keyboard.press("End")
    expect(knob(page, "VMAX")).to_have_attribute("aria-valuenow", "8000000")
    expect(page.get_by_text("VMAX is above fCLK/4", exact=False)).to_be_visible()


def test_a_finger_drags_a_handle_without_scrolling(
    new_context: Callable[..., BrowserContext], stage: str, check_axe: Callable[[Page], None]
) -> None:
    page = select(new_context(viewport=PHONE, has_touch=True, is_mobile=True).new_page(), stage)
    page.goto("/sramp")
    before, scrolled = value(page, "AMAX"), page.evaluate("scrollY")
    x, y = centre(knob(page, "AMAX"))
    touch = page.context.new_cdp_session(page)
    for kind, to in (("touchStart", y), ("touchMove", y + 10), ("touchMove", y + 25), ("touchEnd", None)):
        points = [] if to is None else [{"x": x, "y": to}]
        touch.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
    expect(knob(page, "AMAX")).not_to_have_attribute("aria-valuenow", f"{before:.0f}")
    assert value(page, "AMAX") < before
    assert page.evaluate("scrollY") == scrolled
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    check_axe(page)


def test_nothing_is_sent_while_its_registers_are_awaited(designer: Page, api: httpx.Client) -> None:
    page, button = designer, designer.get_by_role("button", name="Send", exact=True)
    expect(button).to_be_enabled()
    page.route("**/calc/ramp", lambda _: None)
    knob(page, "AMAX").focus()
    page.keyboard.press("Shift+ArrowUp")
    expect(button).to_be_disabled()
    expect(page.get_by_role("button", name="Move with it")).to_be_disabled()
    page.unroute("**/calc/ramp")  # what was held goes on
    send(page)
    assert register(api, "AMAX") == 2_200_000 * 4


def test_what_is_sent_is_what_the_chip_holds(designer: Page, api: httpx.Client) -> None:
    page = designer
    field = page.get_by_label("VSTOP in pps")
    field.fill("0.92")
    field.press("Enter")
    expect(page.get_by_text(re.compile("^= 0.921875"))).to_be_visible()
    knob(page, "AMAX").focus()
    page.keyboard.press("Shift+ArrowUp")
    assert register(api, "AMAX") == 0, "nothing goes out before Send"
    send(page)
    assert register(api, "AMAX") == 2_200_000 * 4
    assert register(api, "VSTOP") == 236
    assert register(api, "VMAX") == 400_000 * 256
    assert register(api, "RAMPMODE") == 6
    assert not axis(api)["moving"], "a motor that stood in velocity mode was told to hold its place first"
    row = page.get_by_role("row").filter(has_text="AMAX")
    expect(row.locator("td").last).to_have_text(re.compile("8.800.000"))


def test_a_move_lies_over_its_ramp(designer: Page, api: httpx.Client) -> None:
    page = designer
    page.get_by_role("button", name="Move with it").click()
    expect(page.get_by_text("Moves from 0 to", exact=False)).to_be_visible()
    expect(page.get_by_text("measured", exact=True)).to_be_visible()
    wait_for(lambda: axis(api)["position_reached"] and not axis(api)["moving"], "the move is over")
    distance = axis(api)["position"]
    assert distance == 240_000
    page.get_by_role("button", name="There and back").click()
    end = page.get_by_role("button", name="End there and back")
    expect(end).to_be_visible()
    wait_for(lambda: axis(api)["moving"], "it goes there")
    end.click()
    expect(page.get_by_role("button", name="There and back", exact=True)).to_be_visible()


def test_the_chips_own_ramp_is_read(designer: Page, api: httpx.Client) -> None:
    page = designer
    send(page)
    for name, raw in (("AMAX", 40_000), ("DMAX", 80_000), ("VMAX", 256_000), ("BOW1", 1000)):
        api.put(f"{REGISTERS}/{name}", params={"axis": 0}, json={"value": raw}).raise_for_status()
    expect(page.get_by_text("4 values differ")).to_be_visible()
    page.get_by_role("button", name="Read from chip").click()
    expect(page.get_by_text("the chip holds this design")).to_be_visible()
    assert value(page, "VMAX") == 1000
    assert value(page, "DMAX") == 20_000
    page.locator("input[aria-label=Units]").click()
    page.get_by_role("option", name="mm").click()
    expect(page.get_by_label("VMAX in mm_per_s")).to_have_value("0.15625")


def test_a_ramp_beyond_its_motor_is_told(designer: Page) -> None:
    page = designer
    current = page.get_by_label("set current A")
    current.fill("0.1")
    current.press("Enter")
    expect(page.get_by_text(re.compile("too little torque")).first).to_be_visible()
    expect(page.get_by_text("trapezoid, same limits")).to_be_visible()


def test_a_design_that_cannot_be_says_which_limit(designer: Page, errors: Any) -> None:
    page = designer
    field = page.get_by_label(re.compile("^BOW1 in "))
    field.fill("2e7")
    field.press("Enter")
    expect(page.get_by_text(re.compile("to 16.777.215"))).to_be_visible()
    page.get_by_label("bows per clock³").check(force=True)
    expect(knob(page, "BOW1")).not_to_have_attribute("aria-valuemax", "16777215")
    field.fill("2e9")
    field.press("Enter")
    expect(page.get_by_text(re.compile("BOW1 is above 4095"))).to_be_visible()
    errors.expect("422")
    page.get_by_label("bows per clock³").uncheck(force=True)
    expect(page.get_by_role("alert").filter(has_text="BOW1")).to_be_visible()
    expect(page.get_by_role("button", name="Send", exact=True)).to_be_disabled()


def test_other_chips_are_sent_to_their_own_page(page: Page) -> None:
    page.goto("/sramp")
    expect(page.get_by_text("S-ramp is not for bench")).to_be_visible()
    page.get_by_role("link", name="Ramps of bench").click()
    expect(page).to_have_url(re.compile(r"/ramps(\?|$)"))


@pytest.mark.parametrize("path", ["/ramps", "/chain"])
def test_pages_of_other_chips_lead_away(stage: str, page: Page, path: str) -> None:
    select(page, stage).goto(path)
    expect(page.get_by_text(f"is not for {STAGE}")).to_be_visible()


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_it_is_accessible(
    stage: str, page: Page, scheme: Literal["light", "dark"], check_axe: Callable[[Page], None]
) -> None:
    page.emulate_media(color_scheme=scheme)
    select(page, stage).goto("/sramp")
    expect(knob(page, "BOW1")).to_be_visible()
    check_axe(page)
