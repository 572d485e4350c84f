"""The console in a browser: commands with their bytes, and everything that goes over the wire."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator

import httpx
import pytest
from playwright.sync_api import Page, expect

from tests.e2e.conftest import DESKTOP, PHONE, Errors
from tests.e2e.held import Held
from tests.e2e.modules import a_module, select


@pytest.fixture(autouse=True)
def module(api: httpx.Client) -> Iterator[str]:
    """Made before the page, so that it goes after the page: nobody asks for a device that is gone."""
    with a_module(api) as device:
        yield device


@pytest.fixture
def drive(module: str, page: Page) -> str:
    select(page, module)
    return module


def send(page: Page, line: str) -> None:
    page.get_by_label("TMCL command").fill(line)
    page.get_by_label("TMCL command").press("Enter")


def test_a_command_is_completed_sent_and_taken_apart(page: Page, drive: str) -> None:
    page.goto("/console")
    line = page.get_by_label("TMCL command")
    line.press_sequentially("gap actual p")
    page.keyboard.press("Tab")
    expect(line).to_have_value("gap 1, ")
    page.keyboard.press("Tab")
    expect(line).to_have_value("gap 1, 0")
    page.keyboard.press("Enter")
    entry = page.get_by_label("Commands sent, newest first").get_by_role("listitem").first
    expect(entry).to_contain_text("gap 1, 0")
    expect(entry).to_contain_text("100 done")
    for field in ("module", "command", "type", "motor", "value", "sum", "host", "status"):
        expect(entry.get_by_text(field, exact=True).first).to_be_visible()
    expect(line).to_have_value("")
    send(page, "136 STRING")
    expect(entry).to_contain_text("1241V144")


def test_a_completion_asked_before_the_commands_are_there_is_made_when_they_come(page: Page, drive: str) -> None:
    held = Held(page, "**/api/v1/catalog/*")
    page.goto("/console")
    line = page.get_by_label("TMCL command")
    line.press_sequentially("gap actual p")
    page.keyboard.press("Tab")
    expect(line).to_be_focused()
    expect(line).to_have_value("gap actual p")
    held.let_go()
    expect(line).to_have_value("gap 1, ")


def test_what_was_sent_comes_back_with_the_arrow_key_even_after_a_reload(page: Page, drive: str) -> None:
    page.goto("/console")
    send(page, "GAP 4, 0")
    sent = page.get_by_label("Commands sent, newest first").get_by_role("listitem")
    expect(sent).to_have_count(1)
    send(page, "GAP 5, 0")
    expect(sent).to_have_count(2)
    page.reload()
    expect(sent).to_have_count(2)
    line = page.get_by_label("TMCL command")
    line.press("ArrowUp")
    expect(line).to_have_value("GAP 5, 0")
    line.press("ArrowUp")
    expect(line).to_have_value("GAP 4, 0")
    line.press("ArrowDown")
    line.press("ArrowDown")
    expect(line).to_have_value("")


def test_what_is_entered_while_a_command_is_under_way_is_not_lost(page: Page, drive: str) -> None:
    page.goto("/console")
    held = Held(page, "**/tmcl")
    send(page, "GAP 4, 0")
    send(page, "GAP 5, 0")
    line = page.get_by_label("TMCL command")
    line.fill("GAP 6")
    held.let_one_go()
    held.let_one_go()
    sent = page.get_by_label("Commands sent, newest first").get_by_role("listitem")
    expect(sent).to_have_count(2)
    expect(sent.first).to_contain_text("GAP 5, 0")
    expect(line).to_have_value("GAP 6")


def test_commands_that_move_are_marked_before_they_are_sent(page: Page, api: httpx.Client, drive: str) -> None:
    page.goto("/console")
    expect(page.get_by_text("keep STOP in reach")).to_be_visible()
    page.get_by_role("button", name="Understood").click()
    page.reload()
    expect(page.get_by_label("TMCL command")).to_be_visible()
    expect(page.get_by_text("keep STOP in reach")).to_have_count(0)
    line = page.get_by_label("TMCL command")
    line.fill("MVP ABS, 0, 2000")
    expect(page.locator("form").get_by_text("moves the motor")).to_be_visible()
    line.press("Enter")
    expect(page.get_by_label("Commands sent, newest first")).to_contain_text("100 done")
    page.get_by_label("Filter frames").fill("MVP")  # while it moves, looks push it out of sight
    expect(page.get_by_label("Frames, newest last")).to_contain_text("MVP ABS, 0, 2000")
    assert api.get(f"/devices/{drive}/registers/ap0").json()["value"] == 2000
    api.post(f"/devices/{drive}/axes/0/stop", json={}).raise_for_status()


def test_refusals_of_module_and_server_are_told(page: Page, drive: str, errors: Errors) -> None:
    errors.expect("40[04]|422")
    page.goto("/console")
    send(page, "GAP 250, 0")
    entry = page.get_by_label("Commands sent, newest first").get_by_role("listitem").first
    expect(entry).to_contain_text("3 wrong type")
    send(page, "FLY 1")
    expect(entry.get_by_role("alert")).to_contain_text("FLY")
    page.get_by_role("button", name="Last error").click()
    expect(page.get_by_label("The chosen frame")).to_contain_text("GAP 250")
    page.get_by_label("Errors only").click(force=True)
    expect(page.get_by_role("option")).to_have_count(1)


def test_the_frame_log_is_filtered_paused_and_copied(page: Page, api: httpx.Client, drive: str) -> None:
    page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    page.goto("/console")
    send(page, "GGP 66, 0")
    # With the comma: telemetry asks for the module's time (GGP 132), whose digits may be any.
    page.get_by_label("Filter frames").fill("ggp 66,")
    frame = page.get_by_role("option").last
    expect(frame).to_contain_text("GGP 66, 0 -> 1")
    frame.click()
    expect(page.get_by_label("The chosen frame")).to_contain_text("status")
    page.get_by_role("button", name="Pause").click()
    expect(page.get_by_role("button", name="Resume")).to_be_visible()
    count = page.get_by_role("option").count()
    api.post(f"/devices/{drive}/tmcl", json={"line": "GGP 66, 0"}).raise_for_status()
    page.get_by_role("button", name="Copy CSV").click()
    expect(page.get_by_text("copied as CSV")).to_be_visible()
    lines = page.evaluate("navigator.clipboard.readText()").splitlines()
    assert lines[0] == "seq,time_unix_s,priority,tx,rx,took_ms,text,error"
    assert len(lines) == count + 1
    page.get_by_role("button", name="Resume").click()
    expect(page.get_by_role("option")).to_have_count(count + 1)


def test_a_chip_has_its_datagrams_and_its_frames_here(page: Page) -> None:
    select(page, "bench")
    page.goto("/console")
    page.get_by_label("Datagram in hex, 4 bytes").fill("03 00 00 00")
    page.get_by_role("button", name="Send").click()
    expect(page.get_by_label("Datagrams sent, newest first")).to_contain_text("read x_actual")
    expect(page.get_by_label("Frames, newest last")).to_contain_text("read x_actual")


def test_a_datagram_entered_while_another_is_under_way_is_not_lost(page: Page) -> None:
    select(page, "bench")
    page.goto("/console")
    held = Held(page, "**/exchange")
    line = page.get_by_label("Datagram in hex, 4 bytes")
    for frame in ("03 00 00 00", "05 00 00 00"):
        line.fill(frame)
        line.press("Enter")
    held.let_one_go()
    held.let_one_go()
    sent = page.get_by_label("Datagrams sent, newest first").get_by_role("listitem")
    expect(sent).to_have_count(2)
    expect(sent.first).to_contain_text("05 00 00 00")


def test_a_disconnected_module_says_so(page: Page, api: httpx.Client, drive: str) -> None:
    api.post(f"/devices/{drive}/disconnect").raise_for_status()
    page.goto("/console")
    expect(page.get_by_text("commands can be written, not sent")).to_be_visible()
    page.get_by_label("TMCL command").fill("GAP 1, 0")
    expect(page.get_by_role("button", name="Send")).to_be_disabled()


def test_the_page_is_open_to_everybody(page: Page, drive: str, check_axe: Callable[[Page], None]) -> None:
    page.goto("/console")
    send(page, "GAP 1, 0")
    expect(page.get_by_label("Commands sent, newest first")).to_contain_text("100 done")
    page.get_by_role("button", name="commands").first.click()
    page.get_by_label("TMCL command").fill("M")
    for size in (DESKTOP, PHONE):
        page.set_viewport_size(size)
        for scheme in ("light", "dark"):
            page.emulate_media(color_scheme=scheme)
            check_axe(page)
        sideways = page.evaluate("document.scrollingElement.scrollWidth - document.documentElement.clientWidth")
        assert sideways <= 0


def test_a_module_in_download_mode_is_left_alone_and_every_page_offers_the_way_out(
    page: Page, drive: str, api: httpx.Client, check_axe: Callable[[Page], None]
) -> None:
    page.goto("/console")
    held = page.get_by_test_id("held-back")
    expect(page.get_by_label("TMCL command")).to_be_visible()
    expect(held).to_have_count(0)
    send(page, "132 0, 0, 0")
    expect(held).to_contain_text("download mode")
    expect(page.get_by_role("main").get_by_text("because the module stores commands")).to_have_count(1)
    check_axe(page)
    page.goto("/")
    leave = held.get_by_role("button", name="Leave download mode")
    leave.click()
    expect(held).to_have_count(0)
    until = time.monotonic() + 10
    while (device := api.get(f"/devices/{drive}").raise_for_status().json())["state"] == "connecting":
        assert time.monotonic() < until
    assert (device["state"], device["problem"]) == ("connected", None)
