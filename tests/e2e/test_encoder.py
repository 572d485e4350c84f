"""The encoder page in a browser: what it shows of an emulated motor is what the motor's physics are."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator

import httpx
import pytest
from playwright.sync_api import Page, expect

from tests.e2e import chips
from tests.e2e.conftest import DESKTOP, PHONE, Errors
from tests.e2e.motor import TURN, Motor, a_motor, select, wait_for, whole_run


@pytest.fixture(scope="module")
def motor(api: httpx.Client) -> Iterator[Motor]:
    with a_motor(api, "encoder motor") as running:
        yield running


@pytest.fixture
def encoder(page: Page, motor: Motor) -> Page:
    """The encoder page of a motor at rest, live."""
    motor.stop()
    motor.write("maximum_encoder_deviation", 0)
    select(page, motor)
    page.goto("/encoder")
    expect(page.get_by_test_id("link-readout").first).to_contain_text("live")
    return page


def number(page: Page, test_id: str) -> float:
    """A live number of the page; NaN while it shows a dash."""
    text = re.sub(r"[^\d.\N{MINUS SIGN}]", "", page.get_by_test_id(test_id).inner_text())
    return float(text.replace("\N{MINUS SIGN}", "-")) if re.search(r"\d", text) else float("nan")


def amplitude(page: Page, per_turn: int) -> float:
    text = page.locator(f"[data-testid=harmonics] tr[data-order='{per_turn}'] td").nth(2).inner_text()
    return float(text) if re.search(r"\d", text) else float("nan")


def test_a_slow_turn_shows_eccentricity_and_detent(encoder: Page, motor: Motor, errors: Errors) -> None:
    errors.expect("status of 409")  # `whole_run`
    eccentricity_deg = 0.4
    motor.emulator(encoder={"eccentricity_deg": eccentricity_deg})
    encoder.get_by_label("Speed rpm").fill("15")
    encoder.get_by_label("Speed rpm").press("Enter")
    whole_run(encoder, motor, "slow-turn")
    expect(encoder.get_by_test_id("angle-seen")).to_contain_text("100 % of the turn")
    expected = eccentricity_deg / 360 * TURN
    assert amplitude(encoder, 1) == pytest.approx(expected, rel=0.15)
    # detent torque over holding torque: some microsteps, far below the encoder's step of 50
    assert 2 < amplitude(encoder, 200) < 20
    assert amplitude(encoder, 3) < 5
    assert abs(number(encoder, "figure-peak")) > expected
    assert motor.axis()["moving"] is False


def test_each_view_draws_what_was_gathered(encoder: Page, motor: Motor) -> None:
    motor.rotate(2)
    expect(encoder.get_by_test_id("angle-seen")).to_contain_text("100 % of the turn", timeout=20_000)
    box = encoder.get_by_test_id("angle-view")
    expect(box.locator("path[d^='M'][fill='none']")).to_have_attribute("d", re.compile("Z$"))
    for view in ("Unrolled", "Full steps"):
        encoder.get_by_text(view, exact=True).click()
        canvas = box.locator("canvas")
        wait_for(lambda drawn=canvas: encoder.evaluate(DRAWN, drawn.element_handle()) > 500, view)  # type: ignore[misc]
    motor.stop()


DRAWN = """canvas => {
  const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  let coloured = 0;
  for (let at = 0; at < data.length; at += 4) {
    const pixel = data.subarray(at, at + 3);
    if (data[at + 3] > 100 && Math.max(...pixel) - Math.min(...pixel) > 60) coloured++;
  }
  return coloured;
}"""
"""How many pixels of a plot are of a trace: axes and grid are grey."""


def test_the_turn_is_stopped_by_its_button_and_by_leaving(encoder: Page, motor: Motor) -> None:
    button = encoder.get_by_test_id("slow-turn")
    button.click()
    wait_for(lambda: motor.axis()["velocity_pps"] > 0, "it turns")
    expect(button).to_have_text("Stop")
    button.click()
    wait_for(lambda: not motor.axis()["moving"], "stopped by the button", 5.0)
    expect(encoder.get_by_test_id("run-note")).to_have_attribute("data-phase", "stopped")
    button.click()
    wait_for(lambda: motor.axis()["velocity_pps"] > 0, "it turns again")
    encoder.goto("about:blank")
    wait_for(lambda: not motor.axis()["moving"], "the page is gone, the motor stands", 5.0)


def test_a_limit_is_staged_applied_and_read_back(encoder: Page, motor: Motor) -> None:
    field = encoder.get_by_test_id("limit-internal")
    expect(field).to_have_value("0")
    field.fill("2500")
    field.press("Enter")
    expect(encoder.get_by_text("1 not applied")).to_be_visible()
    assert motor.parameter("maximum_encoder_deviation") == 0
    encoder.get_by_test_id("apply").click()
    expect(encoder.get_by_text("No changes")).to_be_visible()
    assert motor.parameter("maximum_encoder_deviation") == 2500
    expect(field).to_have_value("2500")


def test_a_deviation_stop_is_told_with_its_cause(encoder: Page, motor: Motor) -> None:
    motor.write("maximum_encoder_deviation", 600)
    motor.emulator(blocked=True)
    try:
        motor.rotate(0.5)
        wait_for(lambda: "deviation" in motor.reasons()[:2], "the module stops for its deviation")
        expect(encoder.get_by_test_id("stops")).to_contain_text("Deviation too large")
    finally:
        motor.write("maximum_encoder_deviation", 0)
        motor.emulator(blocked=False)
        motor.stop()


def test_the_encoder_is_set_to_the_motor(encoder: Page, motor: Motor) -> None:
    wait_for(lambda: not math.isnan(number(encoder, "deviation-internal")), "a number is there")
    before = number(encoder, "deviation-internal")  # steps that an earlier test lost, perhaps
    motor.emulator(encoder={"slip_fullsteps": 3})
    wait_for(lambda: abs(number(encoder, "deviation-internal") - before) > 500, "the slip is seen")
    encoder.get_by_test_id("encoder-to-actual").click()
    wait_for(lambda: abs(number(encoder, "deviation-internal")) < 60, "the deviation is gone")
    assert abs(motor.axis()["deviation"]) < 60


def test_both_encoders_at_once(encoder: Page, motor: Motor) -> None:
    expect(encoder.get_by_test_id("encoder-external")).to_have_count(0)
    encoder.get_by_test_id("which-encoder").get_by_text("Both").click()
    state = motor.axis()
    wait_for(lambda: number(encoder, "encoder-external") == state["external_encoder_position"], "the external one")
    expect(encoder.get_by_test_id("limit-external")).to_be_visible()


def test_a_module_that_vanishes_is_unknown_and_comes_back(encoder: Page, motor: Motor, errors: Errors) -> None:
    errors.expect("status of (409|502|504)")
    motor.emulator(faults={"unplugged": True})
    try:
        expect(encoder.get_by_test_id("actual")).to_have_text("\N{EN DASH}", timeout=20_000)
        expect(encoder.get_by_test_id("slow-turn")).to_be_disabled()
    finally:
        motor.emulator(faults={"unplugged": False})
    expect(encoder.get_by_test_id("actual")).not_to_have_text("\N{EN DASH}", timeout=20_000)


def test_the_page_is_open_to_everybody(encoder: Page, check_axe: Callable[[Page], None]) -> None:
    for size in (DESKTOP, PHONE):
        encoder.set_viewport_size(size)
        for scheme in ("light", "dark"):
            encoder.emulate_media(color_scheme=scheme)
            expect(encoder.get_by_test_id("stop-all")).to_be_in_viewport(ratio=1)
            check_axe(encoder)
        sideways = encoder.evaluate("document.scrollingElement.scrollWidth - document.documentElement.clientWidth")
        assert sideways <= 0, f"{size} can be scrolled sideways by {sideways} px"


def test_a_chips_encoder_is_set_up_from_its_counts(
    page: Page, api: httpx.Client, check_axe: Callable[[Page], None]
) -> None:
    """The constant, its drift and its sign are what the registers get, and the encoder then follows the motor."""
    with chips.a_chip(api, "encoder chip") as chip:
        chips.set_up(chip)
        chips.select(page, chip)
        page.goto("/encoder")
        expect(page.get_by_text("The encoder is not told of until its resolution is set here.")).to_be_visible()
        counts = page.get_by_test_id("encoder-counts")
        counts.fill("40000")  # what the emulated one has
        counts.press("Enter")
        expect(page.get_by_test_id("encoder-lines")).to_have_value("10000")
        expect(page.get_by_test_id("enc-const-exact")).to_contain_text("32/25")
        expect(page.get_by_test_id("enc-const-decimal")).to_contain_text("no drift")
        page.get_by_test_id("use-decimal").click()
        page.get_by_test_id("index-use").click()
        page.get_by_role("option", name="latch each time").click()
        check_axe(page)
        assert chip.register("ENCMODE")["fields"]["enc_sel_decimal"] == 0, "nothing goes out before Apply"
        page.get_by_role("button", name="Apply", exact=True).click()
        wait_for(lambda: chip.register("ENC_CONST")["value"] == 65_536 + 2800, "applied")
        expect(page.get_by_text("last apply: 2 read back")).to_be_visible()
        fields = chip.register("ENCMODE")["fields"]
        assert (fields["enc_sel_decimal"], fields["clr_cont"], fields["latch_x_act"]) == (1, 1, 1)
        page.get_by_test_id("encoder-to-actual").click()
        wait_for(lambda: abs(number(page, "deviation-internal")) < 10, "the counter is that of the motor")
        chip.call("move", target=20_000, relative=True, unit="microsteps")
        wait_for(lambda: abs(number(page, "encoder-internal") - 20_000) < 20, "the encoder follows")
        page.get_by_label("counts the other way").press("Space")
        page.get_by_test_id("use-decimal").click()
        page.get_by_role("button", name="Apply", exact=True).click()
        wait_for(lambda: chip.register("ENC_CONST")["value"] == -2 * 65_536 + 7200, "applied with its sign")
        page.goto("/connections")  # before the chip is gone


def test_a_chip_without_an_encoder_says_so(page: Page, api: httpx.Client) -> None:
    with chips.a_chip(api, "no encoder", "tmc5031") as chip:
        chips.select(page, chip)
        page.goto("/encoder")
        expect(page.get_by_text("This page is for devices with an encoder")).to_be_visible()
        page.goto("/connections")  # before the chip is gone
