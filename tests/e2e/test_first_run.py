"""The page First run in a browser: from a chip as it comes out of its box to an axis that moves, and a profile."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator

import httpx
import pytest
from playwright.sync_api import Page, expect

from tests.e2e.chips import Chip, a_chip, select
from tests.e2e.conftest import PHONE
from tests.e2e.motor import press, wait_for

PATIENCE_MS = 30_000
MOTOR = "ldo-42sth48-1684ac"
PROFILE = "first run of the tests"


@pytest.fixture(scope="module")
def boxed(api: httpx.Client) -> Iterator[Chip]:
    """Nobody has set it up."""
    with a_chip(api, "boxed") as chip:
        yield chip
    for kept in api.get("/profiles", params={"search": PROFILE}).json()["profiles"]:
        api.delete(f"/profiles/{kept['id']}")


def shaft(chip: Chip) -> int:
    register = chip.api.get(f"/devices/{chip.device}/registers/GCONF").raise_for_status().json()
    return int(register["fields"]["shaft"])


def test_an_axis_is_set_up_step_by_step(page: Page, boxed: Chip, check_axe: Callable[[Page], None]) -> None:
    select(page, boxed)
    page.goto("/first-run")
    step = page.get_by_test_id("first-run-step")
    title = step.get_by_role("heading", level=2)

    expect(title).to_have_text("1. Wire")
    expect(step).to_contain_text("emulated in this server")
    page.get_by_role("button", name="Try the wire").click()
    told = page.get_by_test_id("link-trial")
    expect(told).to_contain_text(
        re.compile(r"frames, none lost; half of the answers came within [\d.]+\s.?s"), timeout=PATIENCE_MS
    )
    check_axe(page)
    page.get_by_role("button", name="Go on").click()

    expect(title).to_have_text("2. Motor")
    page.get_by_role("combobox", name="Motor", exact=True).fill("42sth48 1684")
    page.get_by_role("option", name=MOTOR, exact=True).click()
    expect(page.get_by_label("Rated current A")).to_have_value("1.68")
    page.get_by_label("Sense resistor Ω").fill("0.11")
    check_axe(page)
    page.get_by_role("button", name="This is the motor").click()

    expect(title).to_have_text("3. Current and ramp")
    changes = page.get_by_role("region", name="Changes")
    expect(changes).to_contain_text("IHOLD_IRUN", timeout=PATIENCE_MS)
    assert boxed.register("CHOPCONF")["fields"]["toff"] == 0, "nothing is written before it is asked for"
    step.get_by_role("button", name="Apply").click()
    expect(page.get_by_test_id("start-up-state")).to_contain_text("the axis can move now", timeout=PATIENCE_MS)
    assert boxed.register("CHOPCONF")["fields"]["toff"] > 0
    page.get_by_role("button", name="Put back what was before").click()
    wait_for(lambda: boxed.register("CHOPCONF")["fields"]["toff"] == 0, "it is as it was")
    step.get_by_role("button", name="Apply").click()
    expect(page.get_by_role("button", name="Put back what was before")).to_be_visible(timeout=PATIENCE_MS)
    page.get_by_role("button", name="Go on").click()

    expect(title).to_have_text("4. Limits")
    page.get_by_role("button", name="Set these limits").click()
    expect(title).to_have_text("5. Direction", timeout=PATIENCE_MS)
    device = boxed.api.get(f"/devices/{boxed.device}").raise_for_status().json()
    assert device["axes"][0]["limits"]["velocity_max_pps"] == 5 * 51_200

    page.get_by_role("button", name="It turned the other way").click()
    page.get_by_role("button", name="Reverse it").click()
    wait_for(lambda: shaft(boxed) == 1, "the motor is reversed")
    press(page.get_by_role("button", name="One turn forward"))
    wait_for(lambda: boxed.axis()["position"] == 51_200, "a turn")
    page.set_viewport_size(PHONE)
    check_axe(page)
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    page.get_by_role("button", name="It turned the right way").click()

    expect(title).to_have_text("6. Encoder")
    page.get_by_role("button", name="There is none").click()
    expect(title).to_have_text("7. Switches and zero")
    page.get_by_role("button", name="I press the left one").click()
    expect(page.get_by_test_id("switch-answer")).to_contain_text("Press the left switch now")
    boxed.emulator(axes=[{"axis": 0, "switches": {"right": True}}])
    expect(page.get_by_test_id("switch-answer")).to_contain_text("the two are swapped")
    expect(page.get_by_role("button", name="Swap them")).to_be_visible()
    boxed.emulator(axes=[{"axis": 0, "switches": {"right": "auto"}}])
    page.get_by_test_id("set-zero").click()
    wait_for(lambda: boxed.axis()["position"] == 0, "zero is here")
    page.get_by_role("button", name="Go on").click()

    expect(title).to_have_text("8. First move")
    page.get_by_role("button", name="Move one turn").click()
    wait_for(lambda: boxed.axis()["position"] == 51_200, "a turn")
    expect(page.get_by_role("img", name="Position over time, predicted and measured")).to_be_visible()
    expect(step.get_by_text("predicted µsteps")).to_be_visible()
    page.get_by_role("button", name="Go on").click()

    expect(title).to_have_text("9. Keep it")
    page.get_by_label("Name", exact=True).fill(PROFILE)
    page.get_by_role("button", name="Keep the profile").click()
    expect(page.get_by_role("status").filter(has_text="Kept, with")).to_be_visible(timeout=PATIENCE_MS)
    behind = page.get_by_role("list", name="What may be next").get_by_role("link")
    expect(behind).to_have_text(["Tune", "StallGuard", "Microsteps", "Bench"])
    expect(page.get_by_text("8 of 9 done").or_(page.get_by_text("9 of 9 done"))).to_be_visible()
    page.goto("/connections")  # before the chip is gone
