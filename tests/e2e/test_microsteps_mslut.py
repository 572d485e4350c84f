"""The microstep page for tables of one-bit differences: without a device, and into an emulated TMC4361."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator

import httpx
import pytest
from playwright.sync_api import Locator, Page, expect
from server_process import ServerProcess

from app.calc.microsteps.mslut import POWER_ON, decode
from app.calc.microsteps.mslut_waves import Formula, wanted_wave
from tests.e2e.session import a_client
from tests.e2e.test_pages import LOOKS

TABLE = "/devices/wave/microstep-table"


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ServerProcess]:
    """A server of these tests alone: without devices at first, which the demo always has."""
    with ServerProcess(tmp_path_factory.mktemp("mslut"), "--no-demo", start_within_s=180) as running:
        yield running


@pytest.fixture(scope="module")
def api(server: ServerProcess) -> Iterator[httpx.Client]:
    with a_client(server.url, timeout_s=20) as client:
        yield client


@pytest.fixture
def chip(api: httpx.Client) -> Iterator[str]:
    """An emulated TMC4361, able to move, gone after the test."""
    body = {"name": "wave", "model": "tmc4361", "link": {"kind": "emulator"}}
    api.post("/devices", json=body).raise_for_status()
    # positioning first: in velocity mode a VMAX turns the motor at once
    ramp = {"RAMPMODE": 0b101, "VMAX": 20_000 * 256, "AMAX": 200_000 * 4, "DMAX": 200_000 * 4}
    for register, value in ramp.items():
        api.put(f"/devices/wave/registers/{register}", json={"value": value}).raise_for_status()
    yield TABLE
    api.post("/stop").raise_for_status()
    api.delete("/devices/wave").raise_for_status()


def for_a_tmc4361(page: Page) -> None:
    page.goto("/microsteps")
    page.get_by_text(", 256 differences").click()
    expect(page.get_by_role("heading", name="Wave")).to_be_visible()


def preset(page: Page, name: str) -> None:
    page.get_by_role("button", name="Presets").click()
    page.get_by_role("menuitem", name=name).click()


def verdict(page: Page) -> Locator:
    return page.get_by_role("status").filter(has_text=re.compile("encod", re.IGNORECASE))


def register(page: Page, name: str) -> Locator:
    return page.get_by_role("row").filter(has=page.get_by_role("rowheader", name=name, exact=True))


def spike(page: Page, entry: int) -> None:
    """Lift one entry by 30, with the keys."""
    page.get_by_text("one entry").click()
    page.get_by_role("slider", name=re.compile(r"^Entry \d+$")).focus()
    for _ in range(entry // 10):
        page.keyboard.press("Shift+ArrowRight")
    for _ in range(3):
        page.keyboard.press("PageUp")


def test_a_wave_is_designed_without_a_device(page: Page) -> None:
    for_a_tmc4361(page)
    expect(verdict(page)).to_contain_text("Encodable, exactly, in 2 of 4 segments")
    preset(page, "Linearity correction 100 (firmware)")
    expect(verdict(page)).to_contain_text("in 3 of 4 segments")
    expect(register(page, "MSLUT[0]")).to_contain_text("A492487E")
    expect(register(page, "MSLUTSEL")).to_contain_text("FFA20659")
    expect(page.get_by_role("button", name="Send to chip")).to_be_disabled()
    ripple = page.get_by_label("Torque ripple that it cancels")
    ripple.fill("5")
    ripple.press("Enter")
    expect(page.get_by_label("f, the linearity exponent").last).to_have_value("1.15")


def test_a_wave_that_cannot_be_encoded_is_marked_and_the_nearest_taken(page: Page) -> None:
    for_a_tmc4361(page)
    expect(verdict(page)).to_contain_text("Encodable")
    spike(page, 100)
    expect(verdict(page)).to_contain_text("Cannot be encoded at entry 100: it differs by +31 from the one before")
    expect(register(page, "MSLUTSEL")).to_have_count(0)
    at_most = page.get_by_text(re.compile("nearest: .* at most"))
    squares = at_most.inner_text()
    page.get_by_role("combobox", name="Nearest by").click()
    page.get_by_role("option", name="smallest worst distance").click()
    expect(at_most).not_to_have_text(squares)
    page.get_by_role("button", name="Take the nearest").click()
    expect(verdict(page)).to_contain_text("Encodable, exactly")
    expect(register(page, "MSLUTSEL")).to_be_visible()
    page.get_by_role("button", name="Undo").click()
    expect(verdict(page)).to_contain_text("Cannot be encoded at entry 100")


def test_the_curve_is_bent_with_the_pointer(page: Page) -> None:
    for_a_tmc4361(page)
    expect(verdict(page)).to_contain_text("Encodable")
    box = page.locator("svg[data-tool]").bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 3)
    page.mouse.down()
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 3 + 12, steps=4)
    page.mouse.up()
    expect(page.get_by_text("drawn by hand")).to_be_visible()
    expect(verdict(page)).to_contain_text("ncod")
    page.get_by_role("button", name="Undo").click()
    expect(page.get_by_text("drawn by hand")).to_have_count(0)


def test_a_wave_comes_in_as_text(page: Page) -> None:
    for_a_tmc4361(page)
    page.get_by_role("button", name="Paste").click()
    text = page.get_by_label("Wave as text")
    text.fill("1 2 3")
    expect(page.get_by_text("here are 3 numbers")).to_be_visible()
    words = (*POWER_ON.words, POWER_ON.select, POWER_ON.start)
    text.fill(" ".join(f"0x{word:08X}" for word in words))
    page.get_by_role("button", name="Use this wave").click()
    expect(page.get_by_text("drawn by hand")).to_be_visible()
    expect(register(page, "MSLUT[0]")).to_contain_text("AAAAB554")


def test_an_asymmetric_harmonic_says_what_a_table_can_hold(page: Page) -> None:
    for_a_tmc4361(page)
    amplitude = page.get_by_role("textbox", name="Harmonic 3 %", exact=True).or_(
        page.get_by_role("textbox", name="Harmonic 3", exact=True)
    )
    amplitude.fill("5")
    amplitude.press("Enter")
    expect(verdict(page)).to_contain_text("Encodable")
    phase = page.get_by_label("Phase of harmonic 3")
    phase.fill("90")
    phase.press("Enter")
    expect(verdict(page)).to_contain_text("phase 0 or 180 degrees")


def test_a_wave_goes_to_the_chip_and_the_motor_shows_it(page: Page, api: httpx.Client, chip: str) -> None:
    page.goto("/microsteps")
    expect(page.get_by_text("the power-on wave is taken to be there")).to_be_visible()
    preset(page, "Linearity correction 100 (firmware)")
    send = page.get_by_role("button", name="Send to chip")
    expect(send).to_be_enabled()
    expect(page.get_by_text(re.compile(r"\d+ of 256 values differ"))).to_be_visible()
    send.click()
    expect(page.get_by_text("Ten registers written")).to_be_visible()
    expect(page.get_by_text("this wave was written")).to_be_visible()
    held = api.get(chip).raise_for_status().json()
    assert held["written"] is True
    assert held["values"] == list(wanted_wave(Formula(exponent=1.1, grid="whole_step")).wave.values)
    page.get_by_role("button", name="Shuttle").click()
    shown = page.get_by_text(re.compile(r"The motor has shown (\d{2,}) of 1024 positions, all as the table has them"))
    expect(shown).to_be_visible()
    page.get_by_role("button", name="Stop", exact=True).click()


def test_what_the_chip_holds_comes_back_to_the_page(page: Page, api: httpx.Client, chip: str) -> None:
    wave = wanted_wave(Formula(sigma=0.5, grid="opposite")).wave
    api.put(chip, json={"values": list(wave.values), "mirror": wave.mirror}).raise_for_status()
    page.goto("/microsteps")
    expect(page.get_by_text(re.compile(r"\d+ of 256 values differ"))).to_be_visible()
    page.get_by_role("button", name="Read from chip").click()
    expect(page.get_by_text("this wave was written")).to_be_visible()
    assert decode(POWER_ON).values != wave.values


def test_it_is_open_to_everybody(page: Page, check_axe: Callable[[Page], None], chip: str) -> None:
    page.goto("/microsteps")
    expect(verdict(page)).to_contain_text("Encodable")
    spike(page, 100)
    expect(verdict(page)).to_contain_text("Cannot be encoded")
    for (size, scheme), view in zip(LOOKS, ("period, 1024", "quarter, 256") * 2, strict=True):
        page.set_viewport_size(size)
        page.emulate_media(color_scheme=scheme)
        page.get_by_text(view).click()
        check_axe(page)
        sideways = page.evaluate("document.scrollingElement.scrollWidth - document.documentElement.clientWidth")
        assert sideways <= 0, f"{size} can be scrolled sideways by {sideways} px"
