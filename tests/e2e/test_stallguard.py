"""The StallGuard page in a browser: load over speed as it gathers, thresholds by hand, and what a stall does."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator

import httpx
import pytest
from playwright.sync_api import Locator, Page, Route, expect

from tests.e2e import chips
from tests.e2e.conftest import DESKTOP, PHONE, Errors
from tests.e2e.motor import TURN, Motor, a_motor, select, wait_for, whole_run

THRESHOLDS = ("stop_on_stall", "smartenergy_threshold_speed", "smartenergy_hysteresis_start", "smartenergy_hysteresis")


@pytest.fixture(scope="module")
def motor(api: httpx.Client) -> Iterator[Motor]:
    with a_motor(api, "load motor") as running:
        yield running


@pytest.fixture
def load(page: Page, motor: Motor) -> Page:
    """The StallGuard page of a motor at rest, live; every threshold off."""
    motor.stop()
    for name in THRESHOLDS:
        motor.write(name, 0)
    select(page, motor)
    page.goto("/stallguard")
    expect(page.get_by_test_id("link-readout").first).to_contain_text("live")
    expect(page.get_by_test_id("stop_on_stall")).to_have_value("0")
    return page


def samples(page: Page) -> int:
    return int(re.sub(r"\D", "", page.get_by_test_id("speed-samples").inner_text()))


def shown(page: Page, test_id: str) -> float:
    text = page.get_by_test_id(test_id).inner_text()
    return float(text) if re.fullmatch(r"[\d.]+", text) else float("nan")


def settled(page: Page) -> float:
    """The load value shown at speed, once it rises no more from 50 samples to the next 50."""
    latest = 0.0

    def rests() -> bool:
        nonlocal latest
        before, have = latest, samples(page)
        wait_for(lambda: samples(page) >= have + 50, "further samples")
        latest = shown(page, "load")
        return latest > 150 and abs(latest - before) < 0.03 * latest

    wait_for(rests, "a load value that rests")
    return latest


def sweep_of(page: Page, *, speeds: int, each_s: float) -> None:
    for label, value in (("From rpm", 60), ("To rpm", 180), ("Speeds", speeds), ("Each for s", each_s)):
        field = page.get_by_label(label, exact=True)
        field.fill(str(value))
        field.press("Enter")


def over(page: Page, plot: str) -> Locator:
    """The part of a plot that is drawn on, without its axes."""
    return page.get_by_role("img", name=plot).locator(".u-over")


def test_a_sweep_fills_the_plot_and_ends(load: Page, motor: Motor, errors: Errors) -> None:
    errors.expect("status of 409")  # `whole_run`
    load.get_by_test_id("clear-speed").click()
    wait_for(lambda: samples(load) == 0, "cleared: the page brings the samples of the last minutes with it")
    sweep_of(load, speeds=2, each_s=0.5)
    speeds = whole_run(load, motor, "sweep")
    assert max(speeds) > 0 > min(speeds), "there and back"
    assert samples(load) > 100
    # the page hears of the last of the motion a little later than this test
    wait_for(lambda: shown(load, "speed") == 0, "the page has all of it")
    load.get_by_test_id("clear-speed").click()
    wait_for(lambda: samples(load) == 0, "cleared")


def test_a_sweep_ends_with_its_button_and_with_the_page(load: Page, motor: Motor) -> None:
    load.get_by_test_id("sweep").click()
    wait_for(lambda: motor.axis()["moving"], "it turns")
    load.get_by_test_id("sweep").click()
    wait_for(lambda: not motor.axis()["moving"], "stopped", 5.0)
    load.get_by_test_id("sweep").click()
    wait_for(lambda: motor.axis()["moving"], "it turns again")
    load.goto("/connections")
    wait_for(lambda: not motor.axis()["moving"], "the page was loaded anew, and the motor stands", 5.0)


def test_a_sweep_goes_on_behind_another_page_and_is_told_there(load: Page, motor: Motor) -> None:
    told = load.get_by_test_id("run-under-way")
    sweep_of(load, speeds=8, each_s=3)  # long enough for a slow browser to go there and back
    load.get_by_test_id("sweep").click()
    wait_for(lambda: motor.axis()["moving"], "it turns")
    expect(told).to_have_count(0)
    load.get_by_role("navigation", name="Pages").get_by_role("link", name="Connections").first.click()
    expect(told).to_contain_text("still turns, part")
    for part in ("part 2", "part 3"):
        expect(told).to_contain_text(part, timeout=10_000)
        assert motor.axis()["moving"]
    told.get_by_role("link", name="StallGuard").click()
    expect(told).to_have_count(0)
    expect(load.get_by_test_id("run-note")).to_have_attribute("data-phase", "running")
    load.get_by_role("navigation", name="Pages").get_by_role("link", name="Connections").first.click()
    told.get_by_role("button", name="Stop").click()
    wait_for(lambda: not motor.axis()["moving"], "stopped from another page", 5.0)
    expect(told).to_have_count(0)


def test_a_sweep_behind_another_page_ends_where_the_motor_is_stuck(load: Page, motor: Motor) -> None:
    motor.write("stop_on_stall", 10_000)
    load.get_by_test_id("sweep").click()
    wait_for(lambda: motor.axis()["moving"], "it turns")
    load.get_by_role("navigation", name="Pages").get_by_role("link", name="Connections").first.click()
    told = load.get_by_test_id("run-under-way")
    expect(told).to_be_visible()
    try:
        motor.emulator(load_torque_nm=0.6)
        expect(told).to_have_count(0, timeout=10_000)
    finally:
        motor.emulator(load_torque_nm=0)
        motor.write("stop_on_stall", 0)
    wait_for(lambda: not motor.axis()["moving"], "nothing goes on pressing", 5.0)
    ended = load.get_by_test_id("run-ended")
    expect(ended).to_contain_text("no longer turns as begun. Ended: stall")
    load.get_by_role("navigation", name="Pages").get_by_role("link", name="StallGuard").first.click()
    expect(load.get_by_test_id("run-note")).to_have_attribute("data-phase", "stuck")
    load.get_by_role("navigation", name="Pages").get_by_role("link", name="Connections").first.click()
    expect(ended).to_have_count(0)  # it was seen


def test_a_sweep_that_the_server_ended_is_told_on_another_page(load: Page, motor: Motor, errors: Errors) -> None:
    """The beats of this tab come too late, as those of one that nobody looks at."""
    errors.expect("status of 409")  # they keep up nothing any more
    keeping = "**/axes/*/rotate"

    def hold_back(route: Route) -> None:
        if route.request.method == "PATCH":
            wait_for(lambda: not motor.axis()["moving"], "the server ends it by itself")
        route.continue_()

    load.get_by_test_id("sweep").click()
    wait_for(lambda: motor.axis()["moving"], "it turns")
    load.get_by_role("navigation", name="Pages").get_by_role("link", name="Connections").first.click()
    load.route(keeping, hold_back)
    ended = load.get_by_test_id("run-ended")
    expect(ended).to_contain_text("had heard nothing of this tab for", timeout=10_000)
    expect(load.get_by_test_id("run-under-way")).to_have_count(0)
    load.unroute(keeping, hold_back)
    ended.get_by_role("button", name="Close").click()
    expect(ended).to_have_count(0)


def test_a_threshold_is_typed_staged_and_read_back(load: Page, motor: Motor) -> None:
    field = load.get_by_test_id("smartenergy_hysteresis_start")
    field.fill("4")
    field.press("Enter")
    expect(load.get_by_text("more current below 128")).to_be_visible()
    assert motor.parameter("smartenergy_hysteresis_start") == 0
    load.get_by_test_id("apply").click()
    expect(load.get_by_text("No changes")).to_be_visible()
    assert motor.parameter("smartenergy_hysteresis_start") == 4
    load.get_by_test_id("smartenergy_hysteresis_start").fill("99")
    load.get_by_test_id("smartenergy_hysteresis_start").press("Enter")
    expect(load.get_by_text("0 to 15")).to_be_visible()
    assert motor.parameter("smartenergy_hysteresis_start") == 4


def test_a_threshold_is_dragged_in_the_plot(load: Page, motor: Motor) -> None:
    motor.write("smartenergy_threshold_speed", 5000)
    expect(load.get_by_test_id("smartenergy_threshold_speed")).to_have_value("5000", timeout=15_000)
    load.get_by_test_id("clear-speed").click()
    wait_for(lambda: samples(load) == 0, "cleared")
    load.wait_for_timeout(300)
    box = over(load, "Load value and current over speed").bounding_box()
    assert box is not None
    # before the first sample the plot goes to 10 000 pps: 5000 is in its middle
    load.mouse.move(box["x"] + box["width"] * 0.5, box["y"] + 150)
    load.mouse.down()
    load.mouse.move(box["x"] + box["width"] * 0.8, box["y"] + 150, steps=8)
    load.mouse.up()
    wanted = int(load.get_by_test_id("smartenergy_threshold_speed").input_value())
    assert wanted == pytest.approx(8000, abs=120)
    assert motor.parameter("smartenergy_threshold_speed") == 5000
    load.get_by_test_id("apply").click()
    # the chip counts clocks a step: what it can hold is near
    wait_for(lambda: motor.parameter("smartenergy_threshold_speed") == pytest.approx(wanted, rel=0.01), "applied")


def test_load_lowers_the_value_and_a_stall_is_told(load: Page, motor: Motor) -> None:
    motor.rotate(2)
    wait_for(lambda: motor.axis()["velocity_pps"] >= 2 * 0.99 * TURN, "at its speed")
    free = settled(load)
    motor.write("stop_on_stall", 50_000)
    motor.emulator(load_torque_nm=0.1)
    try:
        wait_for(lambda: shown(load, "load") < 0.85 * free, "load makes it smaller")
        motor.emulator(load_torque_nm=0.6)
        wait_for(lambda: "stall" in motor.reasons()[:2], "a stall stops the motor")
        expect(load.get_by_test_id("stops")).to_contain_text("Stall")
    finally:
        motor.emulator(load_torque_nm=0)
        motor.write("stop_on_stall", 0)
        motor.stop()


def test_the_page_is_open_to_everybody(load: Page, check_axe: Callable[[Page], None]) -> None:
    for size in (DESKTOP, PHONE):
        load.set_viewport_size(size)
        for scheme in ("light", "dark"):
            load.emulate_media(color_scheme=scheme)
            expect(load.get_by_test_id("stop-all")).to_be_in_viewport(ratio=1)
            check_axe(load)
        sideways = load.evaluate("document.scrollingElement.scrollWidth - document.documentElement.clientWidth")
        assert sideways <= 0, f"{size} can be scrolled sideways by {sideways} px"


@pytest.fixture
def chip(api: httpx.Client) -> Iterator[chips.Chip]:
    """An emulated TMC5160 that turns at 60 000 pps."""
    with chips.a_chip(api, "loaded chip") as running:
        chips.set_up(running)
        running.call("rotate", velocity=60_000)
        yield running


def test_a_chips_load_and_thresholds_are_in_its_registers(
    page: Page, chip: chips.Chip, check_axe: Callable[[Page], None]
) -> None:
    chips.select(page, chip)
    page.goto("/stallguard")
    wait_for(lambda: shown(page, "load") > 150, "a load value at speed")
    wait_for(lambda: samples(page) > 20, "it is gathered over speed")
    assert shown(page, "current") == 100
    for name, text in (("smartenergy_threshold_speed", "50000"), ("smartenergy_hysteresis_start", "4")):
        page.get_by_test_id(name).fill(text)
        page.get_by_test_id(name).press("Enter")
    expect(page.get_by_text("more current below 128")).to_be_visible()
    expect(page.get_by_text("register 320")).to_be_visible()
    assert chip.register("TCOOLTHRS")["value"] == 0, "nothing goes out before Apply"
    check_axe(page)
    page.get_by_role("button", name="Apply", exact=True).click()
    expect(page.get_by_text("last apply: 2 read back")).to_be_visible()
    assert chip.register("TCOOLTHRS")["value"] == 320
    assert chip.register("COOLCONF")["fields"]["semin"] == 4
    wait_for(lambda: shown(page, "current") <= 60, "CoolStep takes current back")
    expect(page.get_by_text("register 320, as last written")).to_be_visible()
    chip.write("COOLCONF", semin=0)
    chip.write("SW_MODE", sg_stop=1)
    chip.emulator(axes=[{"axis": 0, "load_torque_nm": 3.0}])
    expect(page.get_by_test_id("stops")).to_contain_text("Stall")
    wait_for(lambda: not chip.axis()["moving"], "a stall stops the motor")
    page.goto("/connections")  # before the chip is gone
