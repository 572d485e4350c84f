"""The page of chopSync and dcStep in a browser: figures for registers, and registers for figures."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import httpx
import pytest
from playwright.sync_api import Page, expect

from tests.e2e.closed_loop import Loop, a_loop
from tests.e2e.modules import select

PATIENCE_MS = 30_000
"""For whatever has to come from the server: the machine may be busy."""


@pytest.fixture(scope="module")
def chip(api: httpx.Client) -> Iterator[Loop]:
    with a_loop(api, "synced") as running:
        yield running


@pytest.mark.sheet("DS-TMC4361", "11.4")
def test_speeds_become_registers_and_a_clock_a_divider(
    page: Page, chip: Loop, check_axe: Callable[[Page], None]
) -> None:
    select(page, chip.device)
    page.goto("/driver-sync")
    facts = page.get_by_test_id("dcstep-facts")
    expect(facts).to_contain_text("never", timeout=PATIENCE_MS)
    speed = page.get_by_test_id("dc-vel-rpm")
    speed.fill("120")
    speed.press("Enter")
    expect(facts).to_contain_text("400 full steps/s, 120 rpm", timeout=PATIENCE_MS)
    expect(page.get_by_test_id("chopsync-facts")).to_contain_text("25")
    page.get_by_test_id("use-divider").click()
    expect(page.get_by_test_id("field-CHOPSYNC_DIV")).to_have_value("444")
    page.get_by_role("button", name="Apply", exact=True).click()
    expect(page.get_by_text("staged")).to_have_count(0, timeout=PATIENCE_MS)
    assert chip.register("CHOPSYNC_DIV") == 444
    expect(page.get_by_test_id("dcstep-now")).to_contain_text("not enabled")
    check_axe(page)
