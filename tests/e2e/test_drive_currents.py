"""Drive currents and Start and steps in a browser: planned, staged, applied; pulses in and starts counted."""

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
    with a_loop(api, "currents") as running:
        running.with_encoder()
        yield running


def test_current_is_planned_over_a_move_and_steps_from_outside_are_counted(
    page: Page, chip: Loop, check_axe: Callable[[Page], None]
) -> None:
    select(page, chip.device)
    page.goto("/drive-currents")
    expect(page.get_by_test_id("drive-current")).to_be_visible(timeout=PATIENCE_MS)
    expect(page.get_by_test_id("pwm-duty")).to_be_visible(timeout=PATIENCE_MS)
    page.get_by_label("hold_current_scale_en").check()
    page.get_by_label("hold_scale_val").fill("63")
    page.get_by_label("hold_scale_val").press("Enter")
    expect(page.get_by_test_id("drive-current").get_by_role("row", name="hold")).to_contain_text(
        "63", timeout=PATIENCE_MS
    )
    assert chip.register("CURRENT_CONF") & 1 == 0, "nothing is written before Apply"
    check_axe(page)
    page.get_by_role("button", name="Apply", exact=True).click()
    expect(page.get_by_text("last apply: 2 read back")).to_be_visible(timeout=PATIENCE_MS)
    assert chip.register("SCALE_VALUES") >> 24 == 63

    chip.write("START_CONF", 1 | 1 << 5)
    chip.write("GEAR_RATIO", 1 << 23)
    chip.write("GENERAL_CONF", chip.register("GENERAL_CONF") | 1 << 6)
    page.goto("/start")
    expect(page.get_by_test_id("start-picture")).to_have_attribute(
        "aria-label", "A start comes from START pin, and does new XTARGET", timeout=PATIENCE_MS
    )
    before = int(page.get_by_test_id("starts").locator(".num").inner_text())
    page.get_by_test_id("pulse-start").click()
    expect(page.get_by_test_id("starts").locator(".num")).to_have_text(str(before + 1), timeout=PATIENCE_MS)
    expect(page.get_by_test_id("steps-out")).to_contain_text("500", timeout=PATIENCE_MS)
    page.get_by_test_id("feed").click()
    expect(page.get_by_test_id("came-out")).to_contain_text("came out: 500 of 500", timeout=PATIENCE_MS)
    check_axe(page)
