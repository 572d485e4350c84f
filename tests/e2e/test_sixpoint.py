"""The SixPoint designer in a browser: values in chip units, handles, rivals, and the ramp on an emulated chip."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator

import httpx
import pytest
from playwright.sync_api import Locator, Page, expect

from tests.e2e.chips import Chip, a_chip, select
from tests.e2e.conftest import DESKTOP, PHONE, Errors
from tests.e2e.modules import a_module
from tests.e2e.modules import select as select_module
from tests.e2e.motor import wait_for


@pytest.fixture
def chip(api: httpx.Client) -> Iterator[Chip]:
    """An emulated TMC5160, as it comes out of a reset."""
    with a_chip(api, "six points") as running:
        yield running


@pytest.fixture
def designer(chip: Chip, page: Page) -> Page:
    select(page, chip)
    page.goto("/sixpoint")
    expect(knob(page, "V1")).to_be_visible()
    return page


def knob(page: Page, parameter: str) -> Locator:
    return page.get_by_role("slider", name=re.compile(f"^{parameter},"))


def value(page: Page, parameter: str) -> float:
    return float(knob(page, parameter).get_attribute("aria-valuenow") or "nan")


def enter(page: Page, label: str, text: str) -> None:
    field = page.get_by_label(label, exact=True)
    field.fill(text)
    field.press("Enter")


def send(page: Page) -> None:
    button = page.get_by_role("button", name="Send", exact=True)
    expect(button).to_be_enabled()
    button.click()
    expect(page.get_by_text("the chip holds this design")).to_be_visible()


def took(page: Page, phase: str) -> str:
    return page.get_by_role("list", name="Phases").get_by_role("listitem").filter(has_text=phase).first.inner_text()


def test_a_value_is_typed_in_either_unit(designer: Page) -> None:
    page = designer
    enter(page, "AMAX in pps2", "1e6")
    expect(page.get_by_label("AMAX in chip units")).to_have_value("8590")
    expect(page.get_by_label("DMAX in chip units")).to_have_value("8590")  # up = down
    expect(page.get_by_text(re.compile(r"^= 1.000.008"))).to_have_count(2)
    page.get_by_text("free", exact=True).click()
    enter(page, "DMAX in chip units", "65535")
    expect(page.get_by_label("DMAX in pps2")).to_have_value(re.compile(r"^76292\d\d"))
    enter(page, "DMAX in chip units", "65536")
    expect(page.get_by_text(re.compile("0 to 65.535"))).to_be_visible()
    expect(page.get_by_label("AMAX in chip units")).to_have_value("8590")
    page.locator("input[aria-label=Units]").click()
    page.get_by_role("option", name="rpm").click()
    expect(page.get_by_label("VMAX in rpm")).to_have_value("234.375")


def test_a_handle_is_dragged_and_the_ramp_follows(designer: Page) -> None:
    page = designer
    before, was = value(page, "V1"), took(page, "A1")
    handle = knob(page, "V1")
    handle.scroll_into_view_if_needed()
    box = handle.locator("span").first.bounding_box()
    assert box is not None
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x, y + 12, steps=4)
    page.mouse.move(x, y + 30, steps=4)
    page.mouse.up()
    assert 0 < value(page, "V1") < before * 0.8
    wait_for(lambda: took(page, "A1") != was, "the phase is shorter")
    knob(page, "A1").focus()
    slope = value(page, "A1")
    page.keyboard.press("Shift+ArrowUp")
    assert value(page, "A1") == pytest.approx(slope * 1.1, rel=1e-3)
    assert value(page, "D1") == value(page, "A1")


def test_questionable_values_are_told(designer: Page) -> None:
    page = designer
    enter(page, "VSTOP in chip units", "0")
    expect(page.get_by_text("VSTOP is 0", exact=False)).to_be_visible()
    enter(page, "VSTART in pps", "5000")
    enter(page, "VSTOP in pps", "1000")
    expect(page.get_by_text("is below VSTART", exact=False)).to_be_visible()
    enter(page, "VSTOP in pps", "5000")
    expect(page.get_by_text("is below VSTART", exact=False)).to_have_count(0)
    enter(page, "V1 in chip units", "0")
    expect(page.get_by_text("no part in it: V1 is 0")).to_have_count(2)
    enter(page, "D1 in chip units", "0")
    expect(page.get_by_text("D1 is 0", exact=False)).to_be_visible()
    enter(page, "VMAX in pps", "9e6")
    expect(page.get_by_text(re.compile("to 7.999.512"))).to_be_visible()


def test_rivals_are_timed_against_it(designer: Page) -> None:
    page = designer
    bars = page.get_by_role("region", name="Time")
    expect(bars.get_by_text("trapezoid, V1 = 0")).to_be_visible()
    page.get_by_role("button", name="Keep to compare").click()
    expect(bars.get_by_text("as fast")).to_be_visible()
    knob(page, "AMAX").focus()
    page.keyboard.press("Shift+ArrowUp")
    earlier = bars.get_by_role("listitem").filter(has_text="earlier design")
    expect(earlier).to_contain_text("saved")
    page.get_by_role("button", name="Forget the earlier").click()
    expect(earlier).to_have_count(0)
    enter(page, "set current A", "0.05")
    expect(page.get_by_text(re.compile("too little torque")).first).to_be_visible()


def test_what_is_sent_is_what_the_chip_gets(designer: Page, chip: Chip, api: httpx.Client) -> None:
    """The registers that the calculator names for the same design are those that arrive."""
    page = designer
    enter(page, "VMAX in pps", "150000")
    enter(page, "TZEROWAIT in ms", "10")
    assert chip.register("VMAX")["value"] == 0, "nothing goes out before Send"
    send(page)
    assert chip.register("VMAX")["value"] == round(150_000 * 2**24 / 16e6)
    assert chip.register("TZEROWAIT")["value"] == 313
    assert chip.register("VSTOP")["value"] == 10
    assert not chip.axis()["moving"]
    row = page.get_by_role("row").filter(has_text="VMAX")
    expect(row.locator("td").last).to_have_text(re.compile("157.286"))
    names = ("vstart", "a1", "v1", "amax", "vmax", "dmax", "d1", "vstop")
    wished = {name: page.get_by_label(re.compile(f"^{name.upper()} in pps")) for name in names}
    parameters = {name: float(field.input_value()) for name, field in wished.items()}
    body = {"model": "sixpoint", "parameters": {**parameters, "clock_hz": 16e6}, "distance": 1000, "samples": 2}
    for told in api.post("/calc/ramp", json=body).raise_for_status().json()["registers"]:
        if told["name"] != "TZEROWAIT":
            assert chip.register(told["name"])["value"] == told["raw"], told["name"]


def test_a_move_lies_over_its_ramp_and_the_ramp_is_read_back(designer: Page, chip: Chip) -> None:
    page = designer
    page.get_by_role("button", name="Move with it").click()
    expect(page.get_by_text("Moves from 0 to", exact=False)).to_be_visible()
    expect(page.locator("main").get_by_text("CHOPCONF.toff is 0", exact=False)).to_be_visible()
    expect(page.get_by_text("measured", exact=True)).to_be_visible()
    wait_for(lambda: chip.axis()["position_reached"] and not chip.axis()["moving"], "the move is over")
    assert chip.axis()["position"] == 70_000
    chip.write("V1", 60_000)
    chip.write("AMAX", 9000)
    expect(page.get_by_text("2 values differ")).to_be_visible()
    page.get_by_role("button", name="Read from chip").click()
    expect(page.get_by_text("the chip holds this design")).to_be_visible()
    expect(page.get_by_label("V1 in chip units")).to_have_value("60000")
    # a rotation and a stop leave the design as it is, and the motor where it stands
    page.get_by_text("velocity", exact=True).click()
    page.get_by_role("button", name="Rotate with it").click()
    wait_for(lambda: chip.axis()["velocity_pps"] > 100_000, "it turns")
    page.get_by_role("button", name="Stop axis").click()
    wait_for(lambda: not chip.axis()["moving"], "it stands")
    expect(page.get_by_text("told to hold its place", exact=False)).to_have_count(0)
    page.get_by_role("radiogroup", name="Ramp mode").get_by_text("positioning").click()
    enter(page, "VMAX in chip units", "100000")
    expect(page.get_by_text("told to hold its place", exact=False)).to_be_visible()
    before = chip.axis()["position"]
    send(page)
    assert chip.register("RAMPMODE")["value"] == 0
    assert chip.axis()["position"] == before


def test_a_modules_ramp_is_read_and_sent_as_its_parameters(
    page: Page, api: httpx.Client, check_axe: Callable[[Page], None]
) -> None:
    with a_module(api) as device:

        def parameter(name: str) -> int:
            return int(api.get(f"/devices/{device}/registers/{name}").raise_for_status().json()["value"])

        select_module(page, device)
        page.goto("/sixpoint")
        expect(page.get_by_label("VMAX in chip units")).to_have_value("53687")  # 51,200 pps, as it comes
        expect(page.get_by_text("the chip holds this design")).to_be_visible()
        enter(page, "VMAX in pps", "100000")
        enter(page, "AMAX in chip units", "1718")
        assert parameter("maximum_acceleration") == 51_200, "nothing goes out before Send"
        send(page)
        assert parameter("maximum_positioning_speed") == 100_000
        assert parameter("maximum_acceleration") == parameter("maximum_deceleration") == 200_002
        check_axe(page)
        enter(page, "Distance in microsteps", "5000000")  # at its speed for longer than anything here takes
        expect(page.get_by_role("button", name="Move with it")).to_be_enabled()
        page.get_by_role("button", name="Move with it").click()
        axis = f"/devices/{device}/axes/0"
        wait_for(lambda: api.get(axis).json()["velocity_pps"] > 60_000, "the emulated motor is faster than before")
        page.get_by_role("button", name="Stop axis").click()
        wait_for(lambda: not api.get(axis).json()["moving"], "it stands")
        page.goto("/connections")  # before the module is gone


def test_without_a_device_it_designs_all_the_same(page: Page, check_axe: Callable[[Page], None]) -> None:
    """The demo bench has other chips: those are sent to their own page, and nothing is selected here."""
    page.route(re.compile("/api/v1/devices$"), lambda route: route.fulfill(json=[]))
    page.goto("/sixpoint")
    expect(knob(page, "V1")).to_be_visible()
    expect(page.get_by_text("No device: add a TMC5160", exact=False)).to_be_visible()
    expect(page.get_by_role("button", name="Send", exact=True)).to_be_disabled()
    check_axe(page)


def test_a_design_that_cannot_be_says_why(designer: Page, errors: Errors) -> None:
    page = designer
    errors.expect("422")
    page.get_by_text("free", exact=True).click()
    enter(page, "DMAX in chip units", "0")
    expect(page.get_by_role("alert").filter(has_text="d_max is 0")).to_be_visible()


def test_the_page_is_open_to_everybody(designer: Page, check_axe: Callable[[Page], None]) -> None:
    for size in (DESKTOP, PHONE):
        designer.set_viewport_size(size)
        for scheme in ("light", "dark"):
            designer.emulate_media(color_scheme=scheme)
            check_axe(designer)
        sideways = designer.evaluate("document.scrollingElement.scrollWidth - document.documentElement.clientWidth")
        assert sideways <= 0, f"{size} can be scrolled sideways by {sideways} px"
