"""The closed-loop page in a browser: set up, calibrated, stepped and loaded; its figures are the server's."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator

import httpx
import pytest
from playwright.sync_api import BrowserContext, Page, expect

from tests.e2e.closed_loop import COUNTS, Loop, a_loop
from tests.e2e.conftest import DESKTOP, PHONE, Errors
from tests.e2e.modules import select
from tests.e2e.motor import wait_for

PATIENCE_MS = 30_000
LONG_MS = 90_000
"""For a procedure of some seconds on a busy machine."""


@pytest.fixture(scope="module")
def chip(api: httpx.Client) -> Iterator[Loop]:
    with a_loop(api, "closed loop") as running:
        running.with_encoder()
        yield running


@pytest.fixture
def loop(page: Page, chip: Loop) -> Page:
    """The page with live samples."""
    select(page, chip.device)
    page.goto("/closed-loop")
    expect(page.get_by_test_id("link-readout").first).to_contain_text("live", timeout=PATIENCE_MS)
    expect(page.get_by_test_id("mode")).not_to_have_text("\N{EN DASH}", timeout=PATIENCE_MS)
    return page


def apply(page: Page) -> None:
    page.get_by_role("button", name="Apply", exact=True).click()
    expect(page.get_by_text("last apply")).to_be_visible(timeout=PATIENCE_MS)
    expect(page.get_by_text("refused")).to_have_count(0)


def fill(page: Page, name: str, value: object) -> None:
    field = page.get_by_test_id(f"field-{name}")
    field.fill(str(value))
    field.press("Enter")


def number(page: Page, test_id: str) -> float:
    text = re.sub(r"[^\d.\N{MINUS SIGN}]", "", page.get_by_test_id(test_id).inner_text())
    return float(text.replace("\N{MINUS SIGN}", "-")) if re.search(r"\d", text) else float("nan")


def calibrated(page: Page, chip: Loop) -> None:
    """Closed loop on, with gains that hold, whatever was before."""
    if chip.register("regulation_modus") == 1:
        return
    page.get_by_test_id("start-values").click()
    apply(page)
    page.get_by_test_id("calibrate").click()
    expect(page.get_by_test_id("calibration-state")).to_have_attribute("data-state", "done", timeout=LONG_MS)


def test_the_encoders_constant_is_shown_exactly_and_read_back(loop: Page, chip: Loop) -> None:
    lines = loop.get_by_test_id("encoder-lines")
    lines.fill("90")
    lines.press("Enter")
    # 51 200 microsteps a turn over 360 counts: no fraction of either kind is exact, and binary is nearer
    expect(loop.get_by_test_id("enc-const-exact")).to_contain_text("1280/9")
    expect(loop.get_by_test_id("enc-const-binary")).to_contain_text("0x008e38e4")
    expect(loop.get_by_test_id("enc-const-decimal")).to_contain_text("0x008e08ae")
    lines.fill(str(COUNTS // 4))
    lines.press("Enter")
    expect(loop.get_by_test_id("enc-const-exact")).to_contain_text("32/25")
    expect(loop.get_by_test_id("enc-const-decimal")).to_contain_text("no drift")
    apply(loop)
    assert chip.register("ENC_CONST") == 0x147AE
    expect(loop.get_by_test_id("enc-const-chip")).to_contain_text("0x000147ae", timeout=PATIENCE_MS)


def test_gains_are_staged_with_their_register_and_read_back(loop: Page, chip: Loop) -> None:
    held = chip.register("CL_BETA")
    fill(loop, "CL_BETA", 200)
    expect(loop.get_by_text("70.3°, not applied")).to_be_visible()
    assert chip.register("CL_BETA") == held
    loop.get_by_role("button", name="Review").click()
    changes = loop.get_by_role("dialog")
    expect(changes).to_contain_text("CL_BETA")
    expect(changes).to_contain_text("200")
    changes.get_by_role("button", name="Apply 1 edit").click()
    expect(changes.get_by_text("read back")).to_be_visible(timeout=PATIENCE_MS)
    changes.get_by_role("button", name="Close the changes").click()
    assert chip.register("CL_BETA") == 200
    expect(loop.get_by_test_id("load-dial")).to_contain_text("±70.3°", timeout=PATIENCE_MS)
    fill(loop, "CL_BETA", 512)
    expect(loop.get_by_text("0 to 511").first).to_be_visible()
    fill(loop, "CL_BETA", 255)
    apply(loop)
    # a register that cannot be read back says where its number is from
    fill(loop, "CL_DELTA_P", 65536)
    apply(loop)
    expect(loop.get_by_text("gain 1, as last written")).to_be_visible()


def test_calibration_finds_the_offset_and_switches_on(loop: Page, chip: Loop) -> None:
    chip.write("regulation_modus", 0)
    loop.get_by_test_id("start-values").click()
    apply(loop)
    loop.get_by_test_id("calibrate").click()
    state = loop.get_by_test_id("calibration-state")
    expect(state).to_have_attribute("data-state", "running", timeout=PATIENCE_MS)
    expect(state).to_have_attribute("data-state", "done", timeout=LONG_MS)
    told = re.search(
        r"([\N{MINUS SIGN}\d\u202f]+)$", loop.get_by_test_id("calibration-offset").locator("b").inner_text()
    )
    assert told is not None
    assert int(told[1].replace("\u202f", "").replace("\N{MINUS SIGN}", "-")) == chip.register("CL_OFFSET")
    expect(loop.get_by_test_id("mode")).to_have_text("Closed loop", timeout=PATIENCE_MS)
    wait_for(lambda: abs(number(loop, "deviation")) < 64, "the rotor is where it is wanted", 30)


def test_a_wrong_resolution_is_measured_and_put_right_by_a_press(loop: Page, chip: Loop) -> None:
    chip.write("regulation_modus", 0)
    loop.get_by_test_id("start-values").click()
    apply(loop)
    right = chip.register("ENC_CONST")
    chip.write("ENC_IN_RES", 4000)
    try:
        wrong = chip.register("ENC_CONST")  # ENC_IN_RES itself cannot be read back
        assert wrong != right
        expect(loop.get_by_test_id("calibration-way")).to_contain_text("28.8°")
        before = chip.axis()["position"]
        loop.get_by_test_id("calibrate").click()
        state = loop.get_by_test_id("calibration-state")
        expect(state).to_have_attribute("data-state", "failed", timeout=LONG_MS)
        offer = loop.get_by_test_id("encoder-offer")
        expect(offer).to_contain_text("Set: 4000")
        assert abs(chip.axis()["position"] - before) <= 4 * 256, "it has come back"
        assert chip.register("ENC_CONST") == wrong, "nothing is written before the press"
        offer.get_by_role("button", name="Write 40\u202f000 counts a turn").click()
        expect(offer).to_contain_text("Calibrate again", timeout=PATIENCE_MS)
        assert chip.register("ENC_CONST") == right
        loop.get_by_test_id("calibrate").click()
        expect(state).to_have_attribute("data-state", "done", timeout=LONG_MS)
        expect(offer).to_have_count(0)
    finally:
        chip.write("ENC_IN_RES", COUNTS)


def test_steps_lie_over_one_another_with_their_scores(loop: Page, chip: Loop) -> None:
    calibrated(loop, chip)
    for runs in (1, 2):
        loop.get_by_test_id("record-step").click()
        expect(loop.get_by_test_id("response-plot")).to_have_attribute("data-runs", str(runs), timeout=LONG_MS)
    rows = loop.get_by_test_id("scores").locator("tbody tr")
    expect(rows).to_have_count(2)
    score = chip.call("GET", "axes/0/step-response")["score"]
    newest = rows.first
    expect(newest.locator("[data-figure=RMS]")).to_have_text(f"{score['rms']:.2f}")
    expect(newest.locator("[data-figure=Peak]")).to_have_text(f"{score['peak']:.1f}")
    assert abs(score["final_error"]) < 256, "it has arrived"
    for view in ("Deviation", "Speed", "Load angle"):
        loop.get_by_text(view, exact=True).last.click()
        expect(loop.get_by_test_id("response-plot").locator("canvas")).to_be_visible()
    loop.get_by_role("button", name="Forget run 1").click()
    expect(rows).to_have_count(1)


def test_a_load_is_withstood_and_scored(loop: Page, chip: Loop) -> None:
    calibrated(loop, chip)
    loop.get_by_text("Disturbance", exact=True).click()
    loop.get_by_label("Load torque N·m").fill("0.05")
    loop.get_by_label("Load torque N·m").press("Enter")
    loop.get_by_test_id("record-load").click()
    expect(loop.get_by_test_id("response-plot")).to_have_attribute("data-runs", "1", timeout=LONG_MS)
    state = chip.call("GET", "axes/0/disturbance")
    assert max(torque or 0 for torque in state["recording"]["load_torque_nm"]) == pytest.approx(0.05)
    assert state["score"]["peak"] > 1
    assert chip.call("GET", "emulator")["load_torque_nm"] == pytest.approx(0), "the load is taken away again"


def test_without_the_server_it_says_so_and_keeps_its_place(loop: Page, errors: Errors) -> None:
    errors.expect("Failed to load resource|WebSocket|ERR_")
    loop.route("**/api/v1/**", lambda route: route.abort())
    expect(loop.get_by_test_id("disconnected")).to_be_visible(timeout=PATIENCE_MS)
    expect(loop.get_by_test_id("calibrate")).to_be_disabled()
    expect(loop.get_by_test_id("record-step")).to_be_disabled()


def test_other_devices_are_led_elsewhere(page: Page, api: httpx.Client) -> None:
    select(page, "bench")
    page.goto("/closed-loop")
    expect(page.get_by_text("Closed loop is not for bench")).to_be_visible(timeout=PATIENCE_MS)
    page.get_by_role("link", name="Registers of bench").click()
    expect(page).to_have_url(re.compile(r"/registers(\?|$)"))


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("size", [DESKTOP, PHONE], ids=["desktop", "phone"])
def test_accessible_in_every_size_and_scheme(
    new_context: Callable[..., BrowserContext],
    check_axe: Callable[[Page], None],
    chip: Loop,
    scheme: str,
    size: dict[str, int],
) -> None:
    context = new_context(viewport=size, color_scheme=scheme)
    select(context, chip.device)
    page = context.new_page()
    page.goto("/closed-loop")
    expect(page.get_by_test_id("mode")).not_to_have_text("\N{EN DASH}", timeout=PATIENCE_MS)
    for tab in ("Speed", "Current", "PID"):
        page.get_by_role("tab", name=tab).click()
        check_axe(page)
    assert page.evaluate("document.documentElement.scrollWidth <= window.innerWidth")
