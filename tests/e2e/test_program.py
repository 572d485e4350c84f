"""A program in a browser: written, its mistakes shown, downloaded, run to a breakpoint, stepped, watched."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator

import httpx
import pytest
from playwright.sync_api import Page, expect

from tests.e2e.conftest import PHONE
from tests.e2e.modules import a_module, select

TEXT = """\
Count = 7
    CALC LOAD, 40
    CSUB Add
    AGP Count, 2
    STOP
Add:
    CALC ADD, 2
    RSUB
"""


@pytest.fixture(autouse=True)
def module(api: httpx.Client) -> Iterator[str]:
    with a_module(api) as device:
        yield device


@pytest.fixture
def drive(module: str, page: Page) -> str:
    select(page, module)
    return module


def test_a_program_from_its_first_letter_to_its_end(page: Page, api: httpx.Client, drive: str) -> None:
    page.goto("/program")
    text = page.get_by_test_id("program-text")
    verdict = page.get_by_test_id("verdict")
    text.click()
    # what could stand here, and what is wrong with what stands here
    page.keyboard.type("cal")
    page.get_by_role("listbox", name="Completions").get_by_role("option", name="CALCcalculate").click()
    page.keyboard.type("LOAD, 40\nJA Nowhere")
    expect(verdict).to_have_text("1 problem")
    expect(page.get_by_role("list", name="Problems")).to_contain_text("2:4 nothing is called Nowhere")
    expect(page.get_by_role("button", name="Download")).to_be_disabled()
    page.get_by_role("list", name="Problems").get_by_role("button").click()
    expect(page.get_by_test_id("program-help")).to_contain_text("address")
    text.fill(TEXT)
    expect(verdict).to_have_text("6 of 2048 commands")

    page.keyboard.press("Control+s")
    expect(page.get_by_text("6 commands stored and read back")).to_be_visible()
    assert "CALC ADD, 2" in api.get(f"/devices/{drive}/program", params={"count": 6}).json()["text"]

    # to a breakpoint in the subroutine, out of it, over the next command
    page.get_by_label("Number of a user variable").fill("7")
    page.keyboard.press("Enter")
    text.click()
    page.keyboard.press("Control+Home")
    for _ in range(6):
        page.keyboard.press("ArrowDown")
    page.keyboard.press("F9")
    page.keyboard.press("F5")
    counter = page.get_by_test_id("program-counter")
    expect(counter).to_have_text("4 Add")
    expect(page.locator("[data-current=true]")).to_have_text("    CALC ADD, 2")
    expect(page.get_by_test_id("program-state")).to_contain_text("2")
    page.keyboard.press("Shift+F11")
    expect(counter).to_have_text("2")
    expect(page.get_by_test_id("variable-7")).to_have_text("0")
    page.keyboard.press("F11")
    expect(counter).to_have_text("3")
    expect(page.get_by_test_id("variable-7")).to_have_text("42")
    expect(page.get_by_test_id("program-trace")).to_contain_text("every command")

    # the scope, opened afterwards, has the latest step at its device time
    page.get_by_role("link", name="scope", exact=True).click()
    expect(page.get_by_test_id("program-mark")).to_have_text(re.compile(r"program: one command \(\d+\.\d{3}\ss\)"))
    page.go_back()

    # what was written is there after a reload
    page.reload()
    expect(text).to_contain_text("CALC ADD, 2")
    expect(verdict).to_have_text("6 of 2048 commands")


def test_it_is_read_on_a_phone_and_with_a_keyboard_alone(
    page: Page, drive: str, check_axe: Callable[[Page], None]
) -> None:
    page.goto("/program")
    page.get_by_role("button", name="File").click()
    page.get_by_role("menuitem", name="Ten strokes, counted in a variable").click()
    expect(page.get_by_test_id("verdict")).to_have_text("15 of 2048 commands")
    page.get_by_test_id("program-text").focus()
    page.keyboard.press("F9")
    page.keyboard.press("Tab")  # leaves the text
    expect(page.get_by_test_id("program-text")).not_to_be_focused()
    page.get_by_role("tab", name="Listing").click()
    expect(page.get_by_text("CSUB There").last).to_be_visible()
    page.get_by_role("tab", name="Trial").click()
    page.get_by_role("button", name="Try on the emulator").click()
    expect(page.get_by_test_id("trial")).to_contain_text(
        re.compile(r"variables .*\b7: 7\.")
    )  # beside what others have left in the module
    check_axe(page)
    page.set_viewport_size(PHONE)
    expect(page.get_by_role("button", name="Download")).to_have_count(0)
    expect(page.get_by_test_id("program-text")).to_contain_text("Stroke:")
    check_axe(page)
