"""The currents page in a browser: what the registers of a TMC5xxx make of the coils, and the other way."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Literal

import httpx
import pytest
from playwright.sync_api import BrowserContext, Page, expect

from tests.e2e import modules
from tests.e2e.conftest import PHONE, Errors
from tests.e2e.motor import Motor, select, wait_for

SENSE_OHM = 0.075
FULL_SCALE_V = 0.325
CLOCK_HZ = 16e6
SCHEMES: tuple[Literal["light", "dark"], ...] = ("light", "dark")


@contextmanager
def a_chip(api: httpx.Client, model: str) -> Iterator[Motor]:
    body = {"name": f"coils {model}", "model": model, "link": {"kind": "emulator"}}
    device = api.post("/devices", json=body).raise_for_status().json()["id"]
    try:
        wait_for(lambda: api.get(f"/devices/{device}").json()["state"] == "connected", "it is connected")
        yield Motor(api, device)
    finally:
        api.delete(f"/devices/{device}").raise_for_status()


@pytest.fixture(scope="module")
def chip(api: httpx.Client) -> Iterator[Motor]:
    with a_chip(api, "tmc5160") as motor:
        yield motor


@pytest.fixture
def currents(page: Page, chip: Motor) -> Page:
    """The page of a TMC5160 with known settings, live."""
    for name, value in {
        "IHOLD_IRUN": 0x0007_1408,
        "GLOBAL_SCALER": 128,
        "TPOWERDOWN": 10,
        "TPWMTHRS": 500,
        "TCOOLTHRS": 300,
        "THIGH": 50,
        "GCONF": 4,
    }.items():
        chip.write(name, value)
    select(page, chip)
    page.goto("/currents")
    expect(page.get_by_test_id("field-IRUN")).to_have_value("20")
    return page


def amperes(page: Page, test_id: str) -> float:
    return float(page.get_by_test_id(test_id).inner_text().replace("A rms", ""))


def rms(scale: int, scaler: int) -> float:
    """TMC5160 data sheet, 9: GLOBALSCALER / 256 * (CS + 1) / 32 * VFS / R_sense / sqrt(2)."""
    return scaler / 256 * (scale + 1) / 32 * FULL_SCALE_V / SENSE_OHM / math.sqrt(2)


def fill(page: Page, test_id: str, value: object) -> None:
    field = page.get_by_test_id(test_id)
    field.fill(str(value))
    field.press("Enter")


def apply(page: Page) -> None:
    page.get_by_role("button", name="Apply", exact=True).click()
    expect(page.get_by_text("last apply")).to_be_visible()
    expect(page.get_by_text("refused")).to_have_count(0)


def field(chip: Motor, register: str, name: str) -> int:
    path = f"/devices/{chip.device}/registers"
    found = chip.api.get(path, params={"kept": True}).raise_for_status().json()
    reading = next(each for each in found if each["name"] == register)
    return int(reading["fields"][name] if name else reading["value"])


def test_settings_are_told_as_currents(currents: Page) -> None:
    expect(currents.get_by_test_id("run-rms")).to_contain_text(re.compile(r"^\d"))
    assert amperes(currents, "run-rms") == pytest.approx(rms(20, 128), abs=6e-4)
    assert amperes(currents, "hold-rms") == pytest.approx(rms(8, 128), abs=6e-4)
    fill(currents, "field-IRUN", 31)
    wait_for(lambda: amperes(currents, "run-rms") == pytest.approx(rms(31, 128), abs=6e-4), "it follows")
    fill(currents, "sense-resistor", 150)
    wait_for(lambda: amperes(currents, "run-rms") == pytest.approx(rms(31, 64), abs=6e-4), "so does the resistor")
    plot = currents.get_by_role("img", name=re.compile("Coil current around a stop"))
    expect(plot.locator("canvas")).to_be_visible()


def test_a_wanted_current_goes_to_the_chip(currents: Page, chip: Motor) -> None:
    fill(currents, "sense-resistor", 75)
    fill(currents, "wanted-run", 1.5)
    fill(currents, "wanted-hold", 0.6)
    expect(currents.get_by_test_id("nearest").locator("tr[data-best=true]")).to_contain_text(re.compile(r"1\.[45]\d\d"))
    currents.get_by_test_id("use-wanted").click()
    expect(currents.get_by_test_id("use-wanted")).to_have_text("is set")
    assert field(chip, "GLOBAL_SCALER", "") == 128, "nothing goes out before Apply"
    apply(currents)
    run = rms(field(chip, "IHOLD_IRUN", "IRUN"), field(chip, "GLOBAL_SCALER", "") or 256)
    hold = rms(field(chip, "IHOLD_IRUN", "IHOLD"), field(chip, "GLOBAL_SCALER", "") or 256)
    assert run == pytest.approx(1.5, rel=0.02)
    assert hold == pytest.approx(0.6, rel=0.06)
    wait_for(lambda: amperes(currents, "run-rms") == pytest.approx(run, abs=6e-4), "the page tells it")


def test_thresholds_stand_on_one_axis_of_speeds(currents: Page, chip: Motor) -> None:
    # a shaft of 200 full steps: clocks between two of 51 200 positions
    rpm = 60 * CLOCK_HZ / 500 / 51_200
    expect(currents.get_by_test_id("rpm-TPWMTHRS")).to_have_value(re.compile(f"^{rpm:.4g}"))
    zones = currents.get_by_role("list", name="Chopper").get_by_role("listitem")
    expect(zones).to_have_text(["StealthChop", "SpreadCycle"])
    currents.get_by_test_id("field-vhighchm").check(force=True)
    expect(zones).to_have_text(["StealthChop", "SpreadCycle", "constant off time"])
    fill(currents, "rpm-TCOOLTHRS", 100)
    expect(currents.get_by_test_id("field-TCOOLTHRS")).to_have_value(f"{60 * CLOCK_HZ / 100 / 51_200:.0f}")
    knob = currents.get_by_role("slider", name="THIGH as a speed")
    box = knob.bounding_box()
    assert box is not None
    before = int(knob.get_attribute("aria-valuenow") or 0)
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    currents.mouse.move(x, y)
    currents.mouse.down()
    currents.mouse.move(x + 60, y, steps=4)
    currents.mouse.up()
    assert int(knob.get_attribute("aria-valuenow") or 0) > before
    knob.press("PageDown")
    knob.press("PageDown")
    assert int(knob.get_attribute("aria-valuenow") or 0) < before
    apply(currents)
    assert field(chip, "THIGH", "") > 50
    assert field(chip, "TCOOLTHRS", "") == 188
    assert field(chip, "CHOPCONF", "vhighchm") == 1


def test_a_threshold_that_ends_before_it_begins_is_told(currents: Page) -> None:
    fill(currents, "field-TCOOLTHRS", 20)
    expect(currents.get_by_text("CoolStep is never on")).to_be_visible()


def test_the_chopper_of_a_motor_has_reasons(currents: Page, chip: Motor) -> None:
    fill(currents, "motor-ohm", 1.65)
    fill(currents, "motor-mH", 2.8)
    toff = currents.get_by_test_id("hint-toff")
    expect(toff).to_contain_text("kHz")
    expect(toff).to_contain_text("DS-TMC5160")
    expect(currents.get_by_test_id("figure-current_limit")).to_contain_text("TSTEP")
    expect(currents.get_by_test_id("use-chopper")).to_contain_text("Use all")
    wanted = int(toff.locator("span span").nth(1).inner_text())
    currents.get_by_test_id("use-chopper").click()
    expect(currents.get_by_test_id("use-chopper")).to_have_text("all set")
    apply(currents)
    assert field(chip, "CHOPCONF", "toff") == wanted
    expect(toff).to_contain_text("is set")


def test_a_chip_with_two_axes_counts_velocities(page: Page, api: httpx.Client, errors: Errors) -> None:
    with a_chip(api, "tmc5072") as dual:
        select(page, dual)
        page.goto("/currents")
        fill(page, "rpm-VHIGH", 300)
        units = int(page.get_by_test_id("field-VHIGH").input_value())
        assert units % 256 == 0
        assert units * CLOCK_HZ / 2**24 == pytest.approx(300 / 60 * 51_200, rel=2e-3)
        expect(page.get_by_test_id("field-vsense")).to_be_visible()
        expect(page.get_by_test_id("field-TPOWERDOWN")).to_have_count(0)
        expect(page.get_by_test_id("run-rms")).to_contain_text(re.compile(r"^\d"))
        errors.expect("status of 40[49]")  # a look that is under way when the device goes


def test_a_modules_currents_and_chopper_are_its_parameters(
    page: Page, api: httpx.Client, check_axe: Callable[[Page], None]
) -> None:
    with modules.a_module(api) as device:

        def parameter(name: str) -> int:
            return int(api.get(f"/devices/{device}/registers/{name}").raise_for_status().json()["value"])

        modules.select(page, device)
        page.goto("/currents")
        expect(page.get_by_test_id("field-IRUN")).to_have_value("16")
        expect(page.get_by_test_id("run-rms")).to_contain_text(re.compile(r"^\d"))
        assert amperes(page, "run-rms") == pytest.approx(rms(16, 256), abs=6e-4)
        fill(page, "field-IHOLD", 4)
        fill(page, "rpm-TCOOLTHRS", 60)
        page.get_by_role("button", name="Use toff 4").click()
        page.get_by_role("button", name=re.compile(r"Use hstrt")).click()
        hstrt = int(page.get_by_test_id("hint-hstrt").locator(".mono").inner_text())
        expect(page.get_by_test_id("hint-pwm_autograd")).to_have_count(0)  # no parameter sets it
        assert parameter("standby_current") == 8, "nothing goes out before Apply"
        apply(page)
        assert parameter("standby_current") == 32
        assert parameter("smartenergy_threshold_speed") == 51_118  # 313 clocks a step: the nearest to 51,200
        assert parameter("chopper_off_time") == 4
        assert parameter("chopper_hysteresis_start") == hstrt + 1
        check_axe(page)
        page.goto("/connections")  # before the module is gone


def test_it_reckons_without_a_chip(
    new_context: Callable[..., BrowserContext], errors: Errors, check_axe: Callable[[Page], None]
) -> None:
    context = new_context(viewport=PHONE, color_scheme="dark")
    # no device at all: what a fresh server without its demo answers
    context.route("**/api/v1/devices", lambda route: route.fulfill(json=[]))
    page = context.new_page()
    page.goto("/currents")
    expect(page.get_by_text("On paper")).to_be_visible()
    expect(page.get_by_test_id("run-rms")).to_contain_text(re.compile(r"^\d"))
    page.locator("input[aria-label=Chip]").click()
    page.get_by_role("option", name="TMC5130").click()
    expect(page.get_by_test_id("field-internal_Rsense")).to_be_visible()
    page.get_by_test_id("field-internal_Rsense").check(force=True)
    expect(page.get_by_label("reference resistor")).to_be_visible()
    check_axe(page)
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    assert not errors.unexpected()


def test_it_is_open_to_everybody(currents: Page, check_axe: Callable[[Page], None]) -> None:
    expect(currents.get_by_test_id("hint-toff")).to_be_visible()
    for scheme in SCHEMES:
        currents.emulate_media(color_scheme=scheme)
        check_axe(currents)
