"""What is entered is what is sent: every digit of it, whatever a field or a preview shows of it meanwhile."""

from __future__ import annotations

import re
from collections.abc import Iterator

import httpx
import pytest
from playwright.sync_api import Page, expect

from tests.e2e.chips import Chip, a_chip, select, set_up
from tests.e2e.conftest import Errors
from tests.e2e.motor import wait_for


@pytest.fixture
def wide(api: httpx.Client) -> Iterator[Chip]:
    """A TMC5160 at 256 microsteps: its positions have 32 bits."""
    with a_chip(api, "wide") as chip:
        set_up(chip)
        yield chip


@pytest.fixture
def bench(page: Page, wide: Chip, errors: Errors) -> Page:
    errors.expect("status of 40[49]")  # a look that is under way when the device goes
    select(page, wide)
    page.goto("/")
    expect(page.get_by_test_id("link-readout").first).to_contain_text("live", timeout=20_000)
    return page


def target(chip: Chip) -> int:
    return int(chip.axis()["target_position"])


def test_a_position_of_eight_digits_arrives_as_typed(bench: Page, wide: Chip) -> None:
    field = bench.get_by_test_id("move-target")
    for text, wanted in (("12345678", 12345678), ("-2147483", -2147483), ("1.234567k", 1235), ("98765431", 98765431)):
        field.fill(text)
        bench.get_by_test_id("move-go").click()
        wait_for(lambda wanted=wanted: target(wide) == wanted, f"{text} is sent as {wanted}")  # type: ignore[misc]
    # another unit shows the same place, and sends it
    bench.get_by_role("combobox", name="Unit", exact=True).click()
    bench.get_by_role("option", name="rev").click()
    wide.call("move", target=0, unit="microsteps")
    bench.get_by_test_id("move-go").click()
    wait_for(lambda: target(wide) == 98765431, "the entry, not what the field rounds it to")
    bench.get_by_role("combobox", name="Unit", exact=True).click()
    bench.get_by_role("option", name="µsteps").click()


def test_enter_in_move_to_goes_there(bench: Page, wide: Chip) -> None:
    field = bench.get_by_test_id("move-target")
    field.fill("4321")
    field.press("Enter")
    wait_for(lambda: target(wide) == 4321, "Enter moves to what was just typed")
    wide.call("move", target=0, unit="microsteps")
    field.press("Enter")
    wait_for(lambda: target(wide) == 4321, "and again to what stands there")


def test_nothing_is_sent_beside_a_refused_entry(bench: Page, wide: Chip) -> None:
    field = bench.get_by_test_id("move-target")
    field.fill("12 monkeys")
    field.press("Enter")
    expect(bench.get_by_text("Not a number")).to_be_visible()
    expect(bench.get_by_test_id("move-go")).to_be_disabled()
    assert target(wide) == 0
    field.fill("77")
    field.press("Tab")
    expect(bench.get_by_test_id("move-go")).to_be_enabled()


def test_the_wanted_speed_is_remembered(bench: Page) -> None:
    field = bench.get_by_label("Speed pps", exact=True)
    field.fill("4321")
    field.press("Enter")
    bench.reload()
    expect(bench.get_by_test_id("link-readout").first).to_contain_text("live", timeout=20_000)
    expect(bench.get_by_label("Speed pps", exact=True)).to_have_value(re.compile(r"4.?321"))
