"""Sequences of targets in a browser: entered, foreseen, applied, and made by the emulated chip alone."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import httpx
import pytest
from playwright.sync_api import Page, expect

from tests.e2e.closed_loop import Loop, a_loop
from tests.e2e.modules import select
from tests.e2e.motor import wait_for

PATIENCE_MS = 30_000
"""For whatever has to come from the server: the machine may be busy."""


@pytest.fixture(scope="module")
def chip(api: httpx.Client) -> Iterator[Loop]:
    with a_loop(api, "sequence") as running:
        yield running


@pytest.mark.sheet("DS-TMC4361", "10.2")
@pytest.mark.sheet("DS-TMC4361", "17.21")
def test_a_sequence_is_entered_foreseen_and_made_by_the_chip(
    page: Page, chip: Loop, check_axe: Callable[[Page], None]
) -> None:
    for name, value in (
        *(("RAMPMODE", 6), ("AMAX", 4 * 100_000), ("DMAX", 4 * 100_000), ("VMAX", 256 * 20_000)),
        *((f"BOW{n}", 1_000_000) for n in (1, 2, 3, 4)),
    ):
        chip.write(name, value)
    select(page, chip.device)
    page.goto("/start")
    for n, target in ((1, 4000), (2, -3000), (3, 1234)):
        field = page.get_by_test_id(f"target-{n}")
        expect(field).to_be_visible(timeout=PATIENCE_MS)
        field.fill(str(target))
        field.press("Enter")
    page.get_by_test_id("sequence-shadow").click()
    page.get_by_role("option", name="0: one set, all registers").click()
    moves = page.get_by_test_id("sequence-moves")
    expect(moves).to_contain_text("1234", timeout=PATIENCE_MS)
    expect(moves.get_by_role("row")).to_have_count(4)
    check_axe(page)
    expect(page.get_by_test_id("stage-sequence")).to_be_enabled(timeout=PATIENCE_MS)
    page.get_by_test_id("stage-sequence").click()
    page.get_by_role("button", name="Apply", exact=True).click()
    expect(page.get_by_text("24 read back")).to_be_visible(timeout=PATIENCE_MS)
    wait_for(lambda: chip.register("XACTUAL") == 1234, "the last target is reached")
    assert chip.register("START_CONF") == 1 << 4 | 1 << 6 | 1 << 12 | 1 << 18
    # three takeovers, a cyclic set: the speeds have changed places an odd number of times
    wait_for(lambda: chip.register("VMAX") == 256 * 10_000, "the start after the last move")
