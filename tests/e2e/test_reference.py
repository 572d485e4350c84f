"""The bench of an emulated module in a browser: its reference search on the drawing, its motion, its emulated plant."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator

import httpx
import pytest
from playwright.sync_api import Page, expect

from tests.e2e.conftest import PHONE
from tests.e2e.motor import TURN, Motor, a_motor, select, wait_for

STAGE = {"left_at_fullsteps": -400, "right_at_fullsteps": 400, "home_from_fullsteps": -60, "home_to_fullsteps": -20}
"""A short stage [full steps]: its ends are soon met."""
BETWEEN_ENDS = 800 * 256


@pytest.fixture(scope="module")
def motor(api: httpx.Client) -> Iterator[Motor]:
    with a_motor(api, "search motor") as running:
        running.emulator(stage=STAGE)
        running.write("reference_search_speed", 2 * TURN)
        running.write("reference_switch_speed", TURN // 2)
        yield running


@pytest.fixture
def bench(page: Page, motor: Motor) -> Page:
    """The bench with the module in the hand, at rest between its switches, the search in view."""
    motor.api.request("DELETE", f"/devices/{motor.device}/axes/0/reference-search")
    motor.stop()
    motor.emulator(stage={"position_fullsteps": 100}, blocked=False, load_torque_nm=0)
    select(page, motor)
    page.goto("/")
    expect(page.get_by_test_id("link-readout").first).to_contain_text("live")
    page.get_by_role("tab", name="Zero").click()
    expect(page.get_by_test_id("search-fast")).to_have_value(str(2 * TURN))
    return page


def choose(page: Page, mode: int) -> None:
    page.get_by_test_id("search-mode").click()
    page.get_by_role("option", name=re.compile(f"^{mode} ")).click()


def state(page: Page) -> str | None:
    return page.get_by_test_id("search-state").get_attribute("data-state")


def shown(page: Page, test_id: str) -> int:
    text = re.sub(r"[^\d\N{MINUS SIGN}]", "", page.get_by_test_id(test_id).inner_text())
    return int(text.replace("\N{MINUS SIGN}", "-")) if re.search(r"\d", text) else 0


def test_a_search_between_both_ends_measures_the_stage(bench: Page, motor: Motor) -> None:
    choose(bench, 3)
    expect(bench.get_by_label("What the search does")).to_contain_text("the left switch closes")
    bench.get_by_test_id("reference-search").click()
    wait_for(lambda: state(bench) == "running", "it runs")
    expect(bench.get_by_test_id("stage")).to_contain_text(re.compile("search|edges"))
    wait_for(lambda: state(bench) == "done", "it is done", 40.0)
    assert shown(bench, "search-distance") == pytest.approx(BETWEEN_ENDS, rel=0.02)
    assert shown(bench, "search-last") != 0
    expect(bench.get_by_test_id("stage")).to_contain_text("Zero found")
    # The module tells of none: they are found between samples, of which a busy machine takes few, and the last come
    # behind the answer that it is done. Which they are is tested with `EdgeTrail`, where time is the test's.
    wait_for(lambda: int(bench.get_by_test_id("search-edges").get_attribute("data-edges") or 0) >= 1, "edges")
    assert abs(motor.axis()["position"]) < TURN / 10


def test_home_is_found_in_its_middle(bench: Page, motor: Motor) -> None:
    choose(bench, 5)
    bench.get_by_test_id("reference-search").click()
    wait_for(lambda: state(bench) == "running", "it runs")
    wait_for(lambda: state(bench) == "done", "it is done", 40.0)
    assert motor.emulator()["stage"]["position_fullsteps"] == pytest.approx(-40, abs=4)
    assert motor.axis()["position"] == pytest.approx(0, abs=64)


def test_a_search_is_aborted(bench: Page, motor: Motor) -> None:
    choose(bench, 2)
    bench.get_by_test_id("search-extra").check()
    bench.get_by_test_id("reference-search").click()
    wait_for(lambda: motor.axis()["moving"], "it moves")
    expect(bench.get_by_test_id("reference-search")).to_have_text("Abort")
    bench.get_by_test_id("reference-search").click()
    wait_for(lambda: not motor.axis()["moving"], "it stands", 5.0)
    wait_for(lambda: state(bench) == "aborted", "and says so")
    search = motor.api.get(f"/devices/{motor.device}/axes/0/reference-search").json()
    assert search["mode"] == 66


def test_moving_and_setting_zero(bench: Page, motor: Motor) -> None:
    here = motor.axis()["position"]
    bench.get_by_test_id("move-target").fill(str(here + 5000))
    bench.get_by_test_id("move-go").click()
    wait_for(lambda: motor.axis()["position"] == here + 5000 and not motor.axis()["moving"], "it is there")
    bench.get_by_test_id("set-zero").click()
    wait_for(lambda: motor.axis()["position"] == 0, "zero is here")
    assert motor.axis()["moving"] is False
    assert abs(motor.axis()["deviation"]) < 60


def test_the_emulated_plant_is_played_with(bench: Page, motor: Motor) -> None:
    bench.get_by_test_id("emulator-open").click()
    panel = bench.get_by_test_id("emulator")
    expect(panel.get_by_test_id("lost-steps")).to_have_text(re.compile(r"^\d+ steps|^.\d+ steps"))
    panel.get_by_test_id("blocked").click()
    wait_for(lambda: motor.emulator()["blocked"] is True, "the shaft is held")
    lost = motor.emulator()["truth"]["lost_fullsteps"]
    motor.rotate(0.5)
    wait_for(lambda: motor.emulator()["truth"]["lost_fullsteps"] != lost, "it loses steps")
    motor.stop()
    panel.get_by_test_id("blocked").click()
    wait_for(lambda: motor.emulator()["blocked"] is False, "the shaft is free")
    panel.get_by_test_id("supply").fill("12")
    panel.get_by_test_id("supply").press("Enter")
    wait_for(lambda: motor.emulator()["supply_v"] == 12, "the supply is lower")
    panel.get_by_label("Home switch of the stage").get_by_text("on").click()
    expect(bench.get_by_test_id("motion-card").get_by_label("home switch on")).to_be_visible()
    panel.get_by_label("Home switch of the stage").get_by_text("stage").click()
    motor.emulator(supply_v=24)


def test_the_scope_shows_what_a_module_has(bench: Page) -> None:
    scope = bench.get_by_test_id("scope")
    for row in ("Position", "Deviation", "Velocity", "Load value", "Switches"):
        expect(scope.get_by_role("heading", name=row)).to_be_visible()
    expect(scope.get_by_role("heading", name="Acceleration")).to_have_count(0)
    expect(scope.locator("[data-channel='encoder_position.0']")).to_have_text(re.compile(r"\d"))


def test_the_bench_is_open_to_everybody(bench: Page, check_axe: Callable[[Page], None]) -> None:
    bench.get_by_test_id("emulator-open").click()
    expect(bench.get_by_test_id("rotor-dial")).to_be_visible()
    for scheme in ("light", "dark"):
        bench.emulate_media(color_scheme=scheme)
        check_axe(bench)
    bench.set_viewport_size(PHONE)
    check_axe(bench)
    sideways = bench.evaluate("document.scrollingElement.scrollWidth - document.documentElement.clientWidth")
    assert sideways <= 0, f"can be scrolled sideways by {sideways} px"


def test_an_end_is_found_by_stall_and_drawn_as_other_searches_are(
    page: Page, api: httpx.Client, check_axe: Callable[[Page], None]
) -> None:
    ends = {"left_end_fullsteps": -300, "right_end_fullsteps": 2000}
    beyond = {"left_at_fullsteps": -3000, "right_at_fullsteps": 3000}
    with a_motor(api, "stalling motor", stage={**ends, **beyond}) as motor:
        select(page, motor)
        page.goto("/")
        expect(page.get_by_test_id("link-readout").first).to_contain_text("live")
        page.get_by_role("tab", name="Stall").click()
        steps = page.get_by_label("What the search does")
        expect(steps).to_contain_text("the motor stalls at the end")
        expect(steps).to_contain_text("it stalls again; this and the way back 2 times")
        page.get_by_test_id("stall-hits").fill("2")
        page.get_by_test_id("stall-hits").press("Enter")
        expect(steps).not_to_contain_text("times")
        page.get_by_test_id("stall-search").click()
        expect(page.get_by_test_id("stall-state")).to_have_attribute("data-state", "running")
        expect(page.get_by_test_id("search-hit")).to_have_count(2, timeout=60_000)
        expect(page.get_by_test_id("stall-state")).to_have_attribute("data-state", "done", timeout=30_000)
        expect(page.get_by_text(re.compile("Zero at the end of the stage"))).to_be_visible()
        at = motor.emulator()["stage"]["position_fullsteps"]
        assert at == pytest.approx(-300, abs=1), "the true place of zero"
        check_axe(page)
        page.goto("/connections")  # before the module is gone


def test_inputs_and_step_pulses_reach_the_module(bench: Page, motor: Motor, check_axe: Callable[[Page], None]) -> None:
    bench.get_by_role("button", name=re.compile("Emulator")).first.click()
    in1 = bench.get_by_role("switch", name="IN1")
    expect(in1).to_be_checked()  # open, and pulled up
    for level in (0, 1):
        in1.click()
        wait_for(lambda level=level: motor.emulator()["inputs"]["in1"] == level, f"IN1 is {level}")  # type: ignore[misc]
        assert motor.call("POST", "tmcl", {"command": "GIO", "type": 1, "motor": 0})["value"] == level
    analog = bench.get_by_label("Analog, AIN0")
    analog.fill("3000")
    analog.press("Enter")
    expect(bench.get_by_text("IN3 is 1")).to_be_visible()
    motor.write("step_direction_mode", 1)
    try:
        before = motor.axis()["position"]
        bench.get_by_role("button", name="Send pulses").click()
        wait_for(lambda: motor.axis()["position"] == before + 256, "the pulses were counted")
    finally:
        motor.write("step_direction_mode", 0)
    check_axe(bench)
