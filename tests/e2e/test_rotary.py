"""The rotary page in a browser: an axis that turns for ever, and moves beyond what its chip can count."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator
from fractions import Fraction
from typing import Any, Literal

import httpx
import pytest
from playwright.sync_api import BrowserContext, Page, expect

from tests.e2e.chips import a_chip, set_up
from tests.e2e.chips import select as select_chip
from tests.e2e.conftest import PHONE, Errors
from tests.e2e.modules import select as select_device
from tests.e2e.motor import TURN, Motor, a_motor, select, wait_for

GEAR_TURN = Fraction(TURN * 7, 3)
PIECE_428 = 1 << 22
"""A move of a TMC428, whose counter has 24 bits, is made in pieces of so many microsteps."""
LONG_MS = 60_000
SCHEMES: tuple[Literal["light", "dark"], ...] = ("light", "dark")
MINUS = "\N{MINUS SIGN}"


@pytest.fixture(scope="module")
def table(api: httpx.Client) -> Iterator[Motor]:
    """A module with an encoder, to be watched."""
    with a_motor(api, "rotary table") as motor:
        motor.write("maximum_positioning_speed", 2 * TURN)
        yield motor


@pytest.fixture
def fresh(table: Motor) -> Motor:
    """The same at rest, and watched by nobody."""
    table.stop()
    table.api.delete(f"/devices/{table.device}/axes/0/extended-position").raise_for_status()
    return table


@pytest.fixture
def rotary(page: Page, fresh: Motor) -> Page:
    select(page, fresh)
    page.goto("/rotary")
    expect(page.get_by_test_id("state")).to_have_text("not watched")
    return page


def extended(motor: Motor) -> dict[str, Any]:
    path = f"/devices/{motor.device}/axes/0/extended-position"
    state: dict[str, Any] = motor.api.get(path).raise_for_status().json()
    return state


def put(motor: Motor, **change: Any) -> None:
    motor.call("PUT", "axes/0/extended-position", change)


def number(text: str) -> int:
    """What a text of the page says, without the spaces that group its digits."""
    return int(re.sub(r"[^\d-]", "", text.replace("\N{MINUS SIGN}", "-")))


def shown(page: Page, test_id: str) -> int:
    return number(page.get_by_test_id(test_id).inner_text())


def watch(page: Page, microsteps: object = TURN) -> None:
    fill(page, "per-turn", microsteps)
    page.get_by_test_id("watch").click()
    expect(page.get_by_test_id("state")).to_have_text("stands")


def fill(page: Page, test_id: str, value: object) -> None:
    field = page.get_by_test_id(test_id)
    field.fill(str(value))
    field.press("Tab")


def arrived(motor: Motor) -> dict[str, Any]:
    wait_for(lambda: extended(motor)["state"] == "idle", "the axis is there", 30)
    return extended(motor)


def drag_to(page: Page, angle_deg: float) -> None:
    """Drag the hand of the dial from where it is, along the rim, to an angle."""
    dial = page.locator("svg:has([role=slider])")
    dial.scroll_into_view_if_needed()
    box = dial.bounding_box()
    assert box is not None
    middle, radius = (box["x"] + box["width"] / 2, box["y"] + box["height"] / 2), 162 / 400 * box["width"]

    def place(angle: float) -> tuple[float, float]:
        turn = math.radians(angle)
        return middle[0] + radius * math.sin(turn), middle[1] - radius * math.cos(turn)

    page.mouse.move(*place(3))
    page.mouse.down()
    for part in range(1, 9):
        page.mouse.move(*place(angle_deg * part / 8))
    page.mouse.up()


def test_an_axis_is_watched_and_turned_by_its_hand(rotary: Page, table: Motor) -> None:
    watch(rotary)
    here = extended(table)["actual"]
    hand = rotary.get_by_role("slider", name="Target angle")
    drag_to(rotary, 90)
    expect(hand).to_have_attribute("aria-valuenow", "90")
    assert extended(table)["state"] == "idle", "nothing moves before Go"
    target = shown(rotary, "preview-target")
    assert target - here == shown(rotary, "preview-steps")
    rotary.get_by_test_id("go-angle").click()
    there = arrived(table)
    assert there["actual"] == target
    assert there["angle_deg"] == pytest.approx(90, abs=0.01)
    expect(rotary.get_by_test_id("dial-angle")).to_have_text("90.00°")
    expect(rotary.get_by_test_id("actual")).to_have_text(re.compile(rf"^{''.join(f'{d}.?' for d in str(target))}$"))


def test_the_way_is_shown_before_and_gone_after(rotary: Page, table: Motor) -> None:
    watch(rotary)
    for way, degrees in (("+ only", 330), (f"{MINUS} only", -30), ("shortest", -30)):
        expect(rotary.get_by_test_id("state")).to_have_text("stands")
        rotary.get_by_test_id("zero-here").click()
        expect(rotary.get_by_test_id("dial-angle")).to_have_text("0.00°")
        rotary.get_by_text(way, exact=True).click()
        fill(rotary, "target-angle", 330)
        sign = "+" if degrees > 0 else MINUS
        expect(rotary.get_by_test_id("preview-way")).to_have_text(f"{sign}{abs(degrees)}.0°")
        here = extended(table)["actual"]
        steps = shown(rotary, "preview-steps")
        assert steps == pytest.approx(degrees * TURN / 360, abs=1)
        rotary.get_by_test_id("go-angle").click()
        expect(rotary.get_by_test_id("preview-way")).to_have_text("\N{EN DASH}")  # the hand was put back: it was sent
        assert extended(table)["target"] == here + steps, "it goes the way that was shown"
        arrived(table)


def test_keys_turn_the_hand_and_send_it(rotary: Page, table: Motor) -> None:
    watch(rotary)
    hand = rotary.get_by_role("slider", name="Target angle")
    hand.focus()
    rotary.keyboard.press("Home")
    rotary.keyboard.press("PageUp")
    rotary.keyboard.press("Shift+ArrowRight")
    rotary.keyboard.press("ArrowLeft")
    expect(hand).to_have_attribute("aria-valuenow", "39")
    expect(hand).to_have_attribute("aria-valuetext", "39.00 degrees")
    rotary.keyboard.press("Enter")
    wait_for(lambda: extended(table)["target"] is not None, "it was sent")
    assert arrived(table)["angle_deg"] == pytest.approx(39, abs=0.01)


def test_a_hand_let_go_moves_at_once_where_that_is_wanted(rotary: Page, table: Motor) -> None:
    watch(rotary)
    rotary.get_by_label("go when the hand is let go").check(force=True)
    drag_to(rotary, 200)
    wait_for(lambda: extended(table)["target"] is not None, "it was sent")
    assert arrived(table)["angle_deg"] == pytest.approx(200, abs=0.01)
    rotary.get_by_label("go when the hand is let go").uncheck(force=True)


def test_a_gear_is_an_exact_fraction(rotary: Page, table: Motor) -> None:
    rotary.get_by_text("gear", exact=True).click()
    fill(rotary, "motor-steps", TURN)
    fill(rotary, "motor-teeth", 3)
    fill(rotary, "driven-teeth", 7)
    expect(rotary.get_by_test_id("turn-length")).to_have_text(re.compile("^119.466 2/3$"))
    rotary.get_by_test_id("watch").click()
    expect(rotary.get_by_test_id("state")).to_have_text("stands")
    assert Fraction(extended(table)["rotary"]["microsteps_per_turn"]) == GEAR_TURN
    # a position that no browser's number can hold, and the angle after 3 * 10^13 turns
    far = int(GEAR_TURN * 3 * 10**13) + 1
    fill(rotary, "set-actual-value", far)
    rotary.get_by_test_id("set-actual").click()
    wait_for(lambda: extended(table)["actual_text"] == str(far), "it is set")
    expect(rotary.get_by_test_id("dial-turns")).to_have_text(re.compile(r"^30.000.000.000.000$"))
    expect(rotary.get_by_test_id("dial-angle")).to_have_text("0.00°")
    wait_for(lambda: shown(rotary, "actual") == far, "all digits are shown")


def test_whole_turns_end_at_the_same_place(rotary: Page, table: Motor) -> None:
    watch(rotary)
    before = extended(table)
    fill(rotary, "whole-turns", 2)
    rotary.get_by_role("button", name="Turn back by whole turns").click()
    wait_for(lambda: extended(table)["target"] == before["actual"] - 2 * TURN, "it turns back")
    after = arrived(table)
    assert after["turns"] == before["turns"] - 2
    assert after["angle_deg"] == before["angle_deg"]


def test_the_encoder_has_a_hand_of_its_own_and_what_was_is_drawn(rotary: Page, table: Motor) -> None:
    watch(rotary)
    expect(rotary.get_by_test_id("encoder-hand")).to_be_visible()
    wait_for(lambda: re.search(r"\d", rotary.get_by_test_id("encoder-angle").inner_text()) is not None, "it is read")
    angle = float(rotary.get_by_test_id("encoder-angle").inner_text())
    apart = (angle - extended(table)["angle_deg"] + 180) % 360 - 180
    assert abs(apart) < 5
    expect(rotary.get_by_role("img", name="Turns over time").locator("canvas")).to_be_visible()
    rotary.locator("input[aria-label='Time span']").click()
    with rotary.expect_response(re.compile("history.seconds=600")) as answer:
        rotary.get_by_role("option", name="10 min").click()
    assert any(angle is not None for angle in answer.value.json()["encoder_angle_deg"])
    rotary.get_by_text("angle", exact=True).click()
    expect(rotary.get_by_role("img", name="Angle over time").locator("canvas")).to_be_visible()


def test_a_lost_position_says_why_and_is_confirmed_or_given_up(rotary: Page, table: Motor) -> None:
    watch(rotary)
    table.write("actual_position", 4711)
    alert = rotary.get_by_test_id("untrusted")
    expect(alert).to_contain_text("position counter")
    expect(rotary.get_by_test_id("state")).to_have_text("lost")
    expect(rotary.get_by_role("slider", name="Target angle")).to_have_attribute("aria-disabled", "true")
    rotary.get_by_test_id("confirm").click()
    expect(alert).to_have_count(0)
    assert extended(table)["trusted"]
    rotary.get_by_test_id("forget").click()
    expect(rotary.get_by_test_id("state")).to_have_text("not watched")
    assert not extended(table)["watching"]


def test_a_turn_that_cannot_be_is_refused(rotary: Page) -> None:
    field = rotary.get_by_test_id("per-turn")
    for text in ("0", "-5", "1/0", "abc"):
        field.fill(text)
        expect(field).not_to_have_attribute("aria-invalid", "true")
        field.press("Tab")
        expect(field).to_have_attribute("aria-invalid", "true")


# --- a long move, of a chip that counts to 2^24 ---------------------------------------------------


@pytest.fixture(scope="module")
def winch(api: httpx.Client) -> Iterator[Motor]:
    """A TMC428 at its greatest speed, that lives four times as fast as we do.

    Faster, a busy machine would look at its counter of 24 bits too late, and lose it: as it should.
    """
    body = {"name": "winch", "model": "tmc428", "link": {"kind": "emulator"}}
    device = api.post("/devices", json=body).raise_for_status().json()["id"]
    motor = Motor(api, device)
    try:
        wait_for(lambda: api.get(f"/devices/{device}").json()["state"] == "connected", "it is connected")
        ramp = {"pulse_div": 0, "ramp_div": 5, "a_max": 100}
        pair = api.post("/calc/pmul-pdiv", json=ramp).raise_for_status().json()
        for name, value in {**ramp, "pmul": pair["pmul"], "pdiv": pair["pdiv"], "v_min": 1, "v_max": 2047}.items():
            motor.write(name, value)
        motor.emulator(time_scale=4)
        yield motor
    finally:
        api.post("/stop")
        api.delete(f"/devices/{device}").raise_for_status()


def test_a_long_move_goes_piece_by_piece(page: Page, winch: Motor) -> None:
    select(page, winch)
    page.goto("/rotary")
    page.get_by_test_id("watch").click()
    expect(page.get_by_test_id("state")).to_have_text("stands")
    here = extended(winch)["actual"]
    target = here + 2 * PIECE_428 + 77
    fill(page, "long-target", target)
    expect(page.get_by_test_id("long-preview")).to_contain_text(re.compile("pieces\\s*3"))
    page.get_by_test_id("go-long").click()
    expect(page.get_by_test_id("state")).to_have_text("on its way")
    pieces = page.get_by_test_id("pieces").get_by_role("listitem")
    expect(pieces).to_have_count(3)
    expect(page.get_by_test_id("pieces-done")).to_contain_text(re.compile("[1-9] of 3"), timeout=LONG_MS)
    assert shown(page, "distance-left") <= 2 * PIECE_428
    expect(page.get_by_test_id("target")).to_have_text(re.compile(rf"^{''.join(f'{d}.?' for d in str(target))}$"))
    expect(page.get_by_test_id("state")).to_have_text("stands", timeout=LONG_MS)
    assert extended(winch)["actual"] == target


def test_a_long_move_is_stopped(page: Page, winch: Motor) -> None:
    put(winch, microsteps_per_turn=3200)
    select(page, winch)
    page.goto("/rotary")
    fill(page, "long-target", "-2^50")
    page.get_by_test_id("go-long").click()
    expect(page.get_by_test_id("state")).to_have_text("on its way")
    expect(page.get_by_test_id("time-left")).to_contain_text(re.compile("d|years"), timeout=LONG_MS)
    expect(page.get_by_test_id("pieces")).to_contain_text("more")
    page.get_by_test_id("stop-move").click()
    expect(page.get_by_test_id("state")).not_to_have_text("on its way", timeout=LONG_MS)
    wait_for(lambda: not winch.axis()["moving"], "the motor stands")


def test_positions_beyond_64_bits_are_refused(page: Page, winch: Motor) -> None:
    put(winch, microsteps_per_turn=3200)
    select(page, winch)
    page.goto("/rotary")
    fill(page, "long-target", "2^63")
    expect(page.get_by_text("beyond 64 bits", exact=False)).to_be_visible()
    expect(page.get_by_test_id("go-long")).to_be_disabled()
    fill(page, "long-target", "-2^63")
    expect(page.get_by_test_id("long-exact")).to_have_text(re.compile(f"^{MINUS}9.223.372.036.854.775.808$"))


# --- how it looks ---------------------------------------------------------------------------------


def test_a_finger_turns_the_hand_on_the_rim_and_scrolls_on_the_face(
    new_context: Callable[..., BrowserContext], fresh: Motor, errors: Errors, check_axe: Callable[[Page], None]
) -> None:
    put(fresh, microsteps_per_turn=TURN)
    context = new_context(viewport=PHONE, has_touch=True, is_mobile=True)
    select(context, fresh)
    page = context.new_page()
    page.goto("/rotary")
    expect(page.get_by_test_id("state")).to_have_text("stands")
    dial = page.locator("svg:has([role=slider])")
    dial.scroll_into_view_if_needed()
    box = dial.bounding_box()
    assert box is not None
    middle_x, middle_y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    touch = context.new_cdp_session(page)

    def touched(*at: tuple[float, float]) -> None:
        for kind, place in zip(("touchStart", *["touchMove"] * (len(at) - 1)), at, strict=True):
            points = [{"x": place[0], "y": place[1]}]
            touch.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
        touch.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})

    hand = page.get_by_role("slider", name="Target angle")
    rim = 162 / 400 * box["width"]
    before, scrolled = extended(fresh)["target"], page.evaluate("scrollY")
    touched((middle_x + rim, middle_y), (middle_x + rim, middle_y + 20), (middle_x, middle_y + rim))
    expect(hand).to_have_attribute("aria-valuenow", "180")
    assert page.evaluate("scrollY") == scrolled
    touched((middle_x, middle_y - 0.24 * box["width"]), (middle_x + 40, middle_y - 0.24 * box["width"]))
    expect(hand).to_have_attribute("aria-valuenow", "180")
    assert extended(fresh)["target"] == before
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    check_axe(page)
    assert not errors.unexpected()


def test_a_position_beyond_the_counter_is_compared_and_one_is_latched(page: Page, api: httpx.Client) -> None:
    with a_chip(api, "comparing") as chip:
        set_up(chip)
        path = f"/devices/{chip.device}/axes/0/extended-position"
        api.put(path, json={"microsteps_per_turn": TURN}).raise_for_status()
        select_chip(page, chip)
        page.goto("/rotary")
        expect(page.get_by_test_id("state")).to_have_text("stands")
        expect(page.get_by_test_id("compare-off")).to_be_disabled()

        fill(page, "compare", 5_000_000_000)
        expect(page.get_by_test_id("compare-state")).to_contain_text("X_COMPARE waits")
        fill(page, "compare", 20_000)
        expect(page.get_by_test_id("compare-state")).to_contain_text("X_COMPARE holds it")
        assert chip.register("X_COMPARE")["value"] == 20_000
        api.put(path, json={"target": 20_000}).raise_for_status()
        wait_for(lambda: api.get(path).json()["state"] == "idle", "it is there", 30)
        assert chip.emulator()["position_compare"]["output"]

        page.get_by_test_id("read-latched").click()
        expect(page.get_by_test_id("latched")).to_have_text("0")  # no switch has latched anything

        page.get_by_test_id("compare-off").click()
        expect(page.get_by_test_id("compare-state")).to_have_count(0)
        expect(page.get_by_test_id("compare")).to_have_value("")


def test_it_is_open_to_everybody(rotary: Page, check_axe: Callable[[Page], None]) -> None:
    check_axe(rotary)
    watch(rotary)
    fill(rotary, "target-angle", 77.5)
    for scheme in SCHEMES:
        rotary.emulate_media(color_scheme=scheme)
        check_axe(rotary)


def test_a_device_that_is_away_says_so(page: Page, fresh: Motor) -> None:
    put(fresh, microsteps_per_turn=TURN)
    select(page, fresh)
    page.goto("/rotary")
    expect(page.get_by_test_id("state")).to_have_text("stands")
    fresh.call("POST", "disconnect", {})
    try:
        expect(page.get_by_test_id("condition-bar")).to_contain_text("is not connected")
        expect(page.get_by_role("slider", name="Target angle")).to_have_attribute("aria-disabled", "true")
        expect(page.get_by_test_id("go-long")).to_be_disabled()
    finally:
        fresh.call("POST", "connect", {})


def test_a_position_compare_is_an_event_too(page: Page, api: httpx.Client) -> None:
    made = api.post("/devices", json={"name": "compared", "model": "tmc4210", "link": {"kind": "emulator"}})
    device = made.raise_for_status().json()["id"]
    try:
        wait_for(lambda: api.get(f"/devices/{device}").json()["state"] == "connected", "it is connected")
        mask = f"/devices/{device}/registers/POS_COMP_INT_4210"
        select_device(page, device)
        page.goto("/rotary")
        box = page.get_by_test_id("compare-event")
        expect(box).not_to_be_checked(timeout=30_000)
        box.click()
        expect(box).to_be_checked()
        assert api.get(mask).json()["fields"]["M"] == 1
    finally:
        api.delete(f"/devices/{device}")
