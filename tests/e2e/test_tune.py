"""The page Tune in a browser: a first look at an axis, its cure by a click, then a faster ramp, taken and undone."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from typing import Any

import httpx
import pytest
from playwright.sync_api import Page, Route, expect

from app.api.studies.schemas import StudyInfo
from app.studies.chopper.found import ChopperFound, ChopperTried
from app.studies.document import StudyDocument
from app.studies.record import Figures, Finding, StudyRecord, Trial
from app.studies.stallguard.found import StallFound
from tests.e2e.chips import Chip, a_chip, select
from tests.e2e.conftest import PHONE
from tests.e2e.modules import a_module
from tests.e2e.motor import wait_for

LONG_MS = 90_000
START = {"velocity_pps": 100_000, "acceleration_pps2": 400_000, "counts_per_rev": 4000, "stops": False}
"""The encoder of an emulated chip has 40 000."""


@pytest.fixture(scope="module")
def slide(api: httpx.Client) -> Iterator[Chip]:
    with a_chip(api, "tuned slide") as chip:
        api.post(f"/devices/{chip.device}/start-up", json=START).raise_for_status()
        chip.emulator(time_scale=4.0)
        yield chip


def test_an_axis_is_looked_at_set_right_and_made_faster(
    page: Page, slide: Chip, check_axe: Callable[[Page], None]
) -> None:
    select(page, slide)
    page.goto("/tune")
    plan = page.get_by_test_id("plan")
    expect(plan).to_contain_text("twice 1 turn there and back")
    expect(plan).to_contain_text("It sets, and sets back: VMAX")
    before = slide.register("VMAX")["value"]

    page.get_by_test_id("begin").press("Enter")
    verdict = page.get_by_test_id("verdict")
    expect(verdict).to_contain_text("1 to be set right: encoder", timeout=LONG_MS)
    check_axe(page)
    page.get_by_role("button", name=re.compile("40,000 counts a turn")).click()
    expect(page.get_by_test_id("begin")).to_be_enabled(timeout=LONG_MS)

    page.get_by_role("radio", name="Faster").check()
    expect(plan).to_contain_text("settings: 2 times there and back")
    expect(plan).not_to_contain_text("settings on an emulated twin")
    expect(plan).to_contain_text("Not tried on an emulated twin first: the axis was not identified")
    page.get_by_role("combobox", name="Motor").fill("tronxy-42SHDC4080Z1-25B")  # whole, before the list has it
    expect(plan).to_contain_text("settings on an emulated twin")
    page.get_by_label("Try on an emulated twin first").press("Space")
    expect(plan).not_to_contain_text("on an emulated twin")
    fill(page, {"Distance": "0.25", "Settings tried at most": "3"})
    expect(plan).to_contain_text("up to 3 settings")
    page.get_by_test_id("begin").click()
    expect(page.get_by_role("progressbar", name="How far the study is")).to_be_visible(timeout=LONG_MS)
    expect(verdict).to_contain_text("% faster", timeout=LONG_MS)
    assert slide.register("VMAX")["value"] == before
    lines = page.get_by_role("figure", name="All settings and figures of each trial")
    for name in ("speed", "acceleration", "time"):
        expect(lines.get_by_text(name, exact=True)).to_be_visible()
    lines.get_by_role("img").press("ArrowRight")
    expect(lines.get_by_role("status")).to_contain_text(re.compile(r"Trial \d+, the best, held: speed .*pps, .*time"))
    expect(page.get_by_role("heading", name="The move")).to_be_visible()
    wide = page.viewport_size
    assert wide is not None
    expect(page.get_by_test_id("begin")).to_be_enabled(timeout=LONG_MS)
    page.set_viewport_size(PHONE)  # what was begun, or picked, stays above the long form
    result, form = verdict.bounding_box(), page.get_by_test_id("begin").bounding_box()
    assert result is not None
    assert form is not None
    assert result["y"] < form["y"]
    page.set_viewport_size(wide)

    page.get_by_role("button", name="Take the best").click()
    wait_for(lambda: slide.register("VMAX")["value"] > before, "the best setting is taken")
    page.get_by_role("button", name="Undo").click()
    wait_for(lambda: slide.register("VMAX")["value"] == before, "the setting is as before")
    check_axe(page)
    page.goto("/stallguard")
    page.get_by_role("link", name="Find the threshold by itself").click()
    expect(page.get_by_test_id("missing")).to_contain_text("stop_confirmed")
    expect(plan).to_contain_text("slowly to the left until it stands at the stop")
    page.get_by_label("A hard stop is there").press("Space")
    expect(page.get_by_test_id("missing")).to_have_count(0)
    check_axe(page)
    page.set_viewport_size(PHONE)
    expect(verdict).to_be_visible()
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    page.goto("/connections")  # before the chip is gone


def test_the_microsteps_page_leads_to_a_calibration_by_the_encoder(page: Page, slide: Chip) -> None:
    select(page, slide)
    page.goto("/microsteps")
    page.get_by_role("link", name="By the encoder").click()
    expect(page.get_by_role("radio", name="More exact")).to_be_checked()
    expect(page.get_by_test_id("plan")).to_contain_text("the microstep table of axis 0")


def test_moves_by_hand_are_scored_ranked_taken_and_undone(
    page: Page, slide: Chip, check_axe: Callable[[Page], None]
) -> None:
    select(page, slide)
    page.goto("/tune")
    page.get_by_role("radio", name="By hand").check()
    field = page.get_by_label("Times", exact=True)
    field.fill("1")
    field.press("Tab")
    rows = page.get_by_test_id("move")
    begin = page.get_by_test_id("begin")
    plain = slide.register("VMAX")["value"]
    for count, speed in ((1, plain), (2, plain // 2)):
        slide.write("VMAX", speed)
        expect(begin).to_be_enabled(timeout=LONG_MS)
        begin.click()
        expect(rows).to_have_count(count, timeout=LONG_MS)
    ranked = page.get_by_role("table", name="Moves by hand, the best first")
    expect(ranked.get_by_role("columnheader", name="speed [pps]")).to_be_visible()
    expect(page.get_by_role("img", name="time over speed of each trial")).to_be_visible()
    rows.first.get_by_role("button", name="Take").click()
    preview = page.get_by_role("region", name="What taking it sets")
    expect(preview).to_contain_text("speed [pps]")
    preview.get_by_role("button", name="Take it").click()
    wait_for(lambda: slide.register("VMAX")["value"] == plain, "the faster move's setting is taken")
    page.get_by_role("button", name="Undo", exact=True).click()
    wait_for(lambda: slide.register("VMAX")["value"] == plain // 2, "the setting is as before")
    # a move that somebody else makes is noticed, too: it stands with those of its own distance
    watch = page.get_by_label("Score every move of this axis")
    watch.press("Space")
    expect(page.get_by_text("On: 0 moves were scored since.")).to_be_visible()
    slide.call("move", target=slide.axis()["position"] + 5120)
    expect(page.get_by_text("On: 1 move was scored since.")).to_be_visible(timeout=LONG_MS)
    distances = page.get_by_label("Of moves by")
    expect(distances).to_have_value("5120", timeout=LONG_MS)
    expect(rows).to_have_count(1)
    distances.select_option("51200")
    expect(rows).to_have_count(2)
    watch.press("Space")
    expect(page.get_by_text("On: 1 move")).to_have_count(0)
    check_axe(page)
    page.set_viewport_size(PHONE)
    expect(rows).to_have_count(2)
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    page.goto("/connections")  # before the chip is gone


def fill(page: Page, fields: dict[str, str]) -> None:
    for label, value in fields.items():
        field = page.get_by_role("textbox", name=label, exact=label == "Distance")
        field.fill(value)
        field.press("Tab")


def test_a_stop_gets_through_while_what_was_measured_is_fitted(page: Page, api: httpx.Client) -> None:
    options: dict[str, Any] = {
        "motor": {"rotor_teeth": 50, "viscous_nms": 0.002, "holding_torque_nm": 0.45},
        "load": {"inertia_kgm2": 2e-5, "friction_nm": 0.01},
        "encoder": {"lines": 10_000},
    }
    with a_chip(api, "machine", **options) as chip:
        start = {"velocity_pps": 51_200, "acceleration_pps2": 256_000, "counts_per_rev": 40_000, "stops": False}
        api.post(f"/devices/{chip.device}/start-up", json=start).raise_for_status()
        chip.write("IHOLD_IRUN", IHOLD=16, IRUN=31, IHOLDDELAY=1)
        before = {name: chip.register(name)["value"] for name in ("VMAX", "AMAX", "IHOLD_IRUN")}
        select(page, chip)
        page.goto("/tune")
        page.get_by_role("radio", name="Know motor and machine").check()
        fill(page, {"Speed of the slow turns": "0.5", "Hops": "8"})
        page.get_by_test_id("begin").click()
        verdict = page.get_by_test_id("verdict")
        expect(verdict).to_contain_text("what was measured is fitted", timeout=LONG_MS)
        page.get_by_test_id("stop-all").click()
        expect(verdict).to_contain_text("ended by another command to this axis: stop")
        expect(page.get_by_role("button", name="Stop, and set back")).to_have_count(0)
        all_of_them = api.get("/studies").raise_for_status().json()["studies"]
        (study,) = (each["id"] for each in all_of_them if each["device"] == chip.device)
        ended = api.get(f"/studies/{study}").raise_for_status().json()
        assert (ended["state"], ended["identified"], ended["left"]) == ("aborted", None, [])
        assert {name: chip.register(name)["value"] for name in before} == before
        page.goto("/connections")  # before the chip is gone


def test_stealthchop_is_found_told_taken_and_undone(
    page: Page, api: httpx.Client, check_axe: Callable[[Page], None]
) -> None:
    options: dict[str, Any] = {
        "motor": {"rotor_teeth": 50, "detent_torque_nm": 0.005},
        "encoder": {"lines": 10_000},
        "supply_v": 36.0,
    }
    with a_chip(api, "quiet axis", load={"inertia_kgm2": 5e-6}, full_scale_a=2.1, **options) as chip:
        start = {"velocity_pps": 51_200, "acceleration_pps2": 256_000, "counts_per_rev": 40_000, "stops": False}
        api.post(f"/devices/{chip.device}/start-up", json=start).raise_for_status()
        chip.write("IHOLD_IRUN", IHOLD=12, IRUN=25, IHOLDDELAY=1)
        for tunes in (0, 1):
            chip.write("PWMCONF", PWM_OFS=90, PWM_GRAD=0, pwm_autoscale=tunes, pwm_autograd=tunes)
        chip.write("TPWMTHRS", round(16e6 / (1.5 * 51_200)))
        chip.write("GCONF", en_pwm_mode=1)
        chip.emulator(time_scale=5.0)
        select(page, chip)
        page.goto("/tune")
        page.get_by_role("radio", name="Silent by StealthChop").check()
        plan = page.get_by_test_id("plan")
        expect(plan).to_contain_text("It sets, and sets back: VMAX, AMAX, DMAX")
        # A motor by its name fills in what is known of it; what is typed afterwards counts.
        page.get_by_role("combobox", name="Motor").press_sequentially("tronxy-42SHDC4080Z1-25B")
        expect(page.get_by_test_id("motor")).to_contain_text("not checked")
        expect(page.get_by_role("textbox", name="Holding torque")).not_to_have_value("")
        check_axe(page)
        told = {"Resistance of one coil": "2.3", "Inductance of one coil": "4.4"}
        told |= {"Run current as it is set now": "1.22", "Supply of the motor": "36"}
        fill(page, {**told, "Holding torque": "0.45", "Rated current": "1.5", "Up to a speed of": "1"})
        expect(plan).to_contain_text("up to 1 turn a second")
        expect(page.get_by_test_id("begin")).to_be_enabled()
        check_axe(page)
        page.get_by_test_id("begin").click()
        table = page.get_by_role("table", name="Settings of StealthChop")
        expect(table).to_contain_text("before", timeout=LONG_MS)
        verdict = page.get_by_test_id("verdict")
        expect(verdict).to_contain_text(re.compile(r"PWM_OFS \d+.*instead of PWM_OFS 90"), timeout=LONG_MS)
        expect(page.get_by_role("img", name="Jolt over switch-over speed")).to_be_visible()
        lines = page.get_by_role("figure", name="All settings and figures of each trial")
        lines.get_by_role("img").press("ArrowDown")
        best_told = re.compile(r"Trial \d+, the best, held: PWM_OFS \d+, PWM_GRAD \d+, switch-over .*turns/s, jolt")
        expect(lines.get_by_role("status")).to_contain_text(best_told)
        before = chip.register("PWMCONF")["value"]
        page.get_by_role("button", name="Take the best").click()
        wait_for(lambda: chip.register("PWMCONF")["value"] != before, "the new amplitudes are taken")
        page.get_by_role("button", name="Undo").click()
        wait_for(lambda: chip.register("PWMCONF")["value"] == before, "the amplitudes are as before")
        check_axe(page)
        page.set_viewport_size(PHONE)
        expect(verdict).to_be_visible()
        assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
        page.goto("/connections")  # before the chip is gone


def test_coolstep_is_told_of_as_soon_as_it_is_looked_for(
    page: Page, slide: Chip, api: httpx.Client, check_axe: Callable[[Page], None]
) -> None:
    start = {**START, "counts_per_rev": 40_000}
    api.post(f"/devices/{slide.device}/start-up", json=start).raise_for_status()
    select(page, slide)
    page.goto("/tune")
    page.get_by_role("radio", name="Cooler").check()
    fill(page, {"Load cycle: there and back": "0.1", "Margin of speed": "0", "Cycles that may lose": "20"})
    plan = page.get_by_test_id("plan")
    expect(plan).to_contain_text("CoolStep at the run current that was found")
    expect(plan).to_contain_text("14 cycles")
    page.get_by_role("combobox", name="Motor").fill("tronxy-42SHDC4080Z1-25B")
    expect(plan).to_contain_text(re.compile(r"\d+ currents on an emulated twin"))
    expect(plan).to_contain_text("how many amperes a full scale is, is not known")
    page.get_by_test_id("begin").click()
    expect(page.get_by_role("table", name="Currents that were tried")).to_be_visible(timeout=LONG_MS)
    expect(page.get_by_test_id("verdict")).to_have_attribute("data-outcome", re.compile("better|same"), timeout=LONG_MS)
    card = page.get_by_role("region", name="CoolStep")
    expect(card).to_contain_text("There is none")
    expect(page.get_by_role("region", name="Found")).to_contain_text("could not be tried: how many amperes")
    check_axe(page)
    page.goto("/connections")  # before the chip is gone


@pytest.mark.timeout(300)  # some 250 real moves: no search by halves makes them fewer
def test_coolstep_is_found_told_taken_and_undone(
    page: Page, api: httpx.Client, check_axe: Callable[[Page], None]
) -> None:
    # It accelerates hard and moves on with little: what CoolStep is for.
    options: dict[str, Any] = {
        "motor": {"rotor_teeth": 50, "viscous_nms": 0.002, "holding_torque_nm": 0.45},
        "load": {"inertia_kgm2": 3e-4, "friction_nm": 0.02},
        "encoder": {"lines": 10_000},
        "full_scale_a": 1.5,
    }
    with a_chip(api, "uneven axis", **options) as chip:
        start = {"velocity_pps": 160_000, "acceleration_pps2": 2_500_000, "counts_per_rev": 40_000, "stops": False}
        api.post(f"/devices/{chip.device}/start-up", json=start).raise_for_status()
        chip.write("IHOLD_IRUN", IHOLD=20, IRUN=31, IHOLDDELAY=1)
        chip.emulator(time_scale=10.0)
        select(page, chip)
        page.goto("/tune")
        page.get_by_role("radio", name="Cooler").check()
        fill(page, {"Margin of speed": "0", "Cycles that may lose": "20"})
        fill(page, {"Resistance of one coil": "2.3", "Run current as it is set now": "1.06"})
        plan = page.get_by_test_id("plan")
        expect(plan).to_contain_text("14 cycles")
        expect(plan).to_contain_text(re.compile(r"It sets, and sets back: .*IHOLD_IRUN.*COOLCONF"))
        page.get_by_test_id("begin").click()
        tried = page.get_by_role("table", name="Settings of CoolStep that were tried")
        expect(tried).to_contain_text("held", timeout=LONG_MS)
        verdict = page.get_by_test_id("verdict")
        expect(verdict).to_contain_text(re.compile(r"With CoolStep \(SEMIN \d+"), timeout=2 * LONG_MS)
        card = page.get_by_role("region", name="CoolStep")
        expect(card).to_contain_text(re.compile(r"SEMIN \d+, SEMAX .*less heat of the coils.*10 pairs.*about.*W"))
        expect(card).not_to_contain_text("There is none")
        lines = card.get_by_role("figure", name="All settings of CoolStep that were tried")
        lines.get_by_role("img").press("ArrowRight")
        expect(lines.get_by_role("status")).to_contain_text(re.compile(r"Trial \d+, .*: SEMIN \d+, SEMAX \d+, "))
        check_axe(page)
        before = {name: chip.register(name)["value"] for name in ("IHOLD_IRUN", "COOLCONF")}
        assert before["COOLCONF"] & 15 == 0
        page.get_by_role("button", name="Take the best").click()
        wait_for(lambda: chip.register("COOLCONF")["value"] & 15 > 1, "CoolStep is taken")
        told = re.search(r"SEMIN (\d+)", card.inner_text())
        assert told is not None
        assert chip.register("COOLCONF")["value"] & 15 == int(told[1])
        assert chip.register("TCOOLTHRS")["value"] > 0
        page.get_by_role("button", name="Undo").click()
        wait_for(
            lambda: {name: chip.register(name)["value"] for name in before} == before, "the settings are as before"
        )
        page.set_viewport_size(PHONE)
        expect(verdict).to_be_visible()
        assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
        page.goto("/connections")  # before the chip is gone


def test_a_module_is_made_faster_with_a_bound_of_its_lost_steps(
    page: Page, api: httpx.Client, check_axe: Callable[[Page], None]
) -> None:
    with a_module(api, "tuned module") as device:
        module = Chip(api, device)
        module.emulator(time_scale=8.0)

        def speed() -> int:
            return int(module.register("maximum_positioning_speed")["value"])

        select(page, module)
        page.goto("/stallguard")
        page.get_by_role("link", name="Find the threshold by itself").click()
        plan = page.get_by_test_id("plan")
        expect(plan).to_contain_text("It sets, and sets back: maximum_positioning_speed")
        page.get_by_role("radio", name="Faster").check()
        fill(page, {"Distance": "0.25", "Settings tried at most": "3"})
        bound = page.get_by_label("Moves that may lose a step, at most")
        bound.fill("10")
        bound.press("Tab")
        expect(plan).to_contain_text("19 more with the best setting alone")
        before = speed()
        page.get_by_test_id("begin").click()
        verdict = page.get_by_test_id("verdict")
        # 29 moves of the new setting, and ten with its margin
        expect(verdict).to_contain_text("no step lost in 39 runs", timeout=LONG_MS)
        assert speed() == before
        page.get_by_role("button", name="Take the best").click()
        wait_for(lambda: speed() > before, "the best setting is taken")
        page.get_by_role("button", name="Undo").click()
        wait_for(lambda: speed() == before, "the setting is as before")
        check_axe(page)
        page.goto("/connections")  # before the module is gone


def test_a_chip_without_an_encoder_is_made_faster_by_its_switch(
    page: Page, api: httpx.Client, check_axe: Callable[[Page], None]
) -> None:
    stage = {"left_at_fullsteps": 0.0, "right_at_fullsteps": 700.0, "start_fullsteps": 20.4}
    with a_chip(api, "old stage", "tmc428", stages=[stage]) as chip:
        start = {"velocity_pps": 10_000, "acceleration_pps2": 100_000}
        api.post(f"/devices/{chip.device}/start-up", json=start).raise_for_status()
        before = chip.register("v_max")["value"] // 4
        chip.write("v_max", before)
        chip.emulator(time_scale=4.0)
        select(page, chip)
        page.goto("/tune")
        # Only what can be had without an encoder is offered.
        expect(page.get_by_role("radio")).to_have_count(3)
        expect(page.get_by_text("Other goals need an encoder")).to_be_visible()
        page.get_by_role("radio", name="Torque known").check()
        expect(page.get_by_label("Lost steps are seen by")).to_have_value("left switch")
        expect(page.get_by_test_id("plan")).to_contain_text("to the edge of the switch after each run")
        expect(page.get_by_test_id("missing")).to_contain_text("its speed is limited")
        check_axe(page)
        page.get_by_role("radio", name="Faster").check()
        seen_by = page.get_by_label("Lost steps are seen by")
        expect(seen_by).to_have_value("left switch")
        plan = page.get_by_test_id("plan")
        expect(plan).to_contain_text("v_max, a_max, pmul_pdiv of axis 0")
        seen_by.select_option("encoder")
        expect(page.get_by_test_id("missing")).to_contain_text("encoder")
        seen_by.select_option("left switch")
        fill(page, {"Distance": "0.25", "Settings tried at most": "2"})
        expect(plan).to_contain_text("to the left switch")
        check_axe(page)
        page.get_by_test_id("begin").click()
        verdict = page.get_by_test_id("verdict")
        expect(verdict).to_contain_text("pair 1", timeout=LONG_MS)
        expect(page.get_by_role("heading", name="The move")).to_be_visible()
        page.get_by_role("button", name="Stop, and set back").click()
        expect(verdict).to_contain_text("stopped", timeout=LONG_MS)
        assert chip.register("v_max")["value"] == before
        check_axe(page)
        page.goto("/connections")  # before the chip is gone


def test_settings_of_ones_own_are_searched_and_proved(
    page: Page, api: httpx.Client, check_axe: Callable[[Page], None]
) -> None:
    with a_chip(api, "own settings") as chip:
        started = {**START, "counts_per_rev": 40_000}
        api.post(f"/devices/{chip.device}/start-up", json=started).raise_for_status()
        chip.emulator(time_scale=4.0)
        select(page, chip)
        page.goto("/tune")
        page.get_by_role("radio", name="As you say").check()
        expect(page.get_by_test_id("begin")).to_be_disabled()
        setting = page.get_by_role("combobox", name="Setting to be searched")
        setting.fill("ramp.accel")
        page.get_by_role("option", name="ramp.acceleration").click()
        group = page.get_by_role("group", name="ramp.acceleration")
        expect(group).to_contain_text("now 400")
        expect(page.get_by_role("combobox", name="And another setting")).to_have_value("")
        plan = page.get_by_test_id("plan")
        fill(page, {"Distance": "0.25", "Settings tried at most": "3"})
        page.get_by_label("What is to be better").select_option("less: time until it rests")
        expect(plan).to_contain_text("ramp.acceleration")
        check_axe(page)
        page.get_by_test_id("begin").click()
        bar = page.get_by_role("progressbar", name="How far the study is")
        expect(bar).to_be_visible(timeout=LONG_MS)
        expect(bar).to_have_count(0, timeout=2 * LONG_MS)
        verdict = page.get_by_test_id("verdict")
        expect(verdict).to_contain_text(re.compile("time until it rests|stays as it is"))
        expect(page.get_by_role("img", name=re.compile("Time until it rests of each trial"))).to_be_visible()
        check_axe(page)
        page.set_viewport_size(PHONE)
        assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
        page.goto("/connections")  # before the chip is gone


CHOPPERS = [
    ChopperTried(
        off=off, blank=1, hysteresis=hysteresis, ripple_fullsteps=ripple, by_speed_fullsteps=[ripple], chopper_hz=40e3
    )
    for off, hysteresis, ripple in ((3, 0, 0.03), (4, 1, 0.029), (2, 4, 0.023))
]
KEPT: dict[str, dict[str, Any]] = {
    "chopper": {
        "study": {"kind": "chopper", "speeds_rps": [1.0], "resistance_ohm": 2.3, "inductance_h": 4.4e-3}
        | {"run_current_a": 1.5, "supply_v": 36.0},
        "settings": [{"TOFF": one.off, "TBL": one.blank, "hysteresis": one.hysteresis} for one in CHOPPERS],
        "found": {"chopper": ChopperFound(speeds_rps=[1.0], before=CHOPPERS[0], tried=CHOPPERS, chosen=CHOPPERS[2])},
        "units": {"TOFF": "", "TBL": "", "hysteresis": ""},
    },
    "stallguard": {
        "study": {"kind": "stallguard", "within_fullsteps": 400.0},
        "settings": [{"threshold": level, "filter": 0, "armed from": 9e4} for level in (-60, -52, -44)],
        "found": {"stallguard": StallFound(generation=2, run_fullsteps=200.0, push_fullsteps=8.0)},
        "units": {"threshold": "", "filter": "0/1", "armed from": "pps"},
    },
}
"""Studies that are over: both would take a browser test half a minute. How they are made, their own tests tell."""


@pytest.mark.parametrize(
    ("kind", "name", "told"),
    [
        ("chopper", "All settings and figures of each trial", "TOFF 2, TBL 1, hysteresis 4, ripple .*full steps"),
        ("stallguard", "Settings that were tried on held-out runs", "threshold .44, filter 0"),
    ],
)
def test_trials_of_a_study_that_was_kept_are_drawn_and_told(
    page: Page, slide: Chip, check_axe: Callable[[Page], None], kind: str, name: str, told: str
) -> None:
    kept = KEPT[kind]
    document = {"device": slide.device, "axis": 0, "study": kept["study"]}
    long = "mean of all speeds and of both ways"
    record = StudyRecord(
        id="20260101-000000",
        document=StudyDocument.model_validate(document),
        state="done",
        phase="over",
        started_unix_s=1.8e9,
        units=kept["units"],
        trials=[
            Trial(number=number, setting=setting, registers=[], state=state, figures=Figures(runs=30 - number))
            for number, (setting, state) in enumerate(
                zip(kept["settings"], ("infeasible", "feasible", "feasible"), strict=True)
            )
        ],
        best=2,
        improved=True,
        verdict="it is calmer",
        findings=[Finding(name="69 % of the current", text="the resonance is there with it", value=-1.766, unit=long)],
        **kept["found"],
    ).model_dump(mode="json")

    own = {"kind": kind, "title": kind, "device": slide.device, "axis": 0, "setting": {}}
    listed = {name: record.get(name) for name in StudyInfo.model_fields} | own

    def with_it(route: Route) -> None:
        route.fulfill(json={**route.fetch().json(), "studies": [listed]})

    page.route("**/api/v1/studies", with_it)
    page.route(f"**/api/v1/studies/{record['id']}", lambda route: route.fulfill(json=record))
    select(page, slide)
    page.goto("/tune")
    lines = page.get_by_role("figure", name=name)
    lines.get_by_role("img").press("ArrowDown")
    expect(lines.get_by_role("status")).to_contain_text(re.compile(f"Trial 2, the best, held: {told}"))
    lines.get_by_role("img").press("ArrowUp")
    expect(lines.get_by_role("status")).to_contain_text(re.compile("Trial 1, "))
    if kind == "chopper":
        expect(page.get_by_role("img", name="Ripple of each trial")).to_be_visible()
        expect(page.get_by_role("img", name="Ripple over hysteresis")).to_be_visible()
    check_axe(page)
    page.set_viewport_size(PHONE)
    expect(lines).to_be_visible()
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    # What was found and how much it is were one upon the other on a phone.
    found = page.get_by_role("listitem").filter(has_text="69 % of the current")
    words, figure = found.get_by_text("69 % of the current").bounding_box(), found.get_by_text(long).bounding_box()
    assert words is not None
    assert figure is not None
    assert words["height"] < 40, "on one line"
    assert figure["y"] >= words["y"] + words["height"] or figure["x"] >= words["x"] + words["width"]


def test_the_plan_of_one_goal_is_not_shown_for_another(page: Page, slide: Chip) -> None:
    """What a first look does stood below another goal until the server answered."""
    select(page, slide)
    page.goto("/tune")
    plan = page.get_by_test_id("plan")
    expect(plan).to_contain_text("twice 1 turn there and back")
    page.route("**/studies/plan", lambda route: None)  # never answered
    page.get_by_role("radio", name="Faster").check()
    expect(plan).to_have_count(0)
    expect(page.get_by_test_id("begin")).to_be_disabled()
    page.unroute("**/studies/plan")
    fill(page, {"Distance": "0.25"})
    expect(plan).to_contain_text("settings: 2 times there and back")
