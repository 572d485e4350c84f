"""The page of serial encoders in a browser: an SSI encoder chosen and read, the output clocked out."""

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
    with a_loop(api, "serial") as running:
        yield running


@pytest.mark.sheet("DS-TMC4361", "14.3")
@pytest.mark.sheet("DS-TMC4361", "15.1")
def test_an_ssi_encoder_is_set_read_and_given_on(page: Page, chip: Loop, check_axe: Callable[[Page], None]) -> None:
    chip.write("ENC_IN_DATA", 12 | 11 << 5)
    chip.write("ENC_OUT_DATA", 11)
    chip.write("ENC_OUT_RES", 4096)
    select(page, chip.device)
    page.goto("/serial-encoder")
    expect(page.get_by_text("An incremental encoder is set on the page Closed loop")).to_be_visible(timeout=PATIENCE_MS)
    page.get_by_test_id("field-serial_enc_in_mode").click()
    page.get_by_role("option", name="SSI", exact=True).click()
    page.get_by_test_id("field-multi_turn_in_en").check()
    page.get_by_role("button", name="8192 counts a turn").click()
    expect(page.get_by_test_id("serial-facts")).to_contain_text("25 clocks", timeout=PATIENCE_MS)
    page.get_by_role("button", name="Apply", exact=True).click()
    expect(page.get_by_text("staged")).to_have_count(0, timeout=PATIENCE_MS)
    page.get_by_test_id("put-on-shaft").click()
    expect(page.get_by_test_id("on-shaft")).to_contain_text("SSI, 13 bits of angle, 12 of turns")
    page.get_by_test_id("listen").click()
    expect(page.get_by_test_id("heard")).to_contain_text("the output is off")
    page.get_by_test_id("field-serial_enc_out_enable").check()
    page.get_by_role("button", name="Apply", exact=True).click()
    expect(page.get_by_text("staged")).to_have_count(0, timeout=PATIENCE_MS)
    page.get_by_test_id("listen").click()
    expect(page.get_by_test_id("heard")).to_contain_text("count")
    check_axe(page)
