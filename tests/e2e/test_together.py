"""Several devices as one machine in a browser: wired axes start together, and the page says how far apart."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from functools import partial

import httpx
import pytest
from playwright.sync_api import Page, expect

from tests.e2e.closed_loop import Loop, a_loop
from tests.e2e.conftest import DESKTOP, PHONE
from tests.e2e.motor import press, wait_for

PATIENCE_MS = 30_000
"""For whatever has to come from the server: the machine may be busy."""


@pytest.fixture(scope="module")
def pair(api: httpx.Client) -> Iterator[list[Loop]]:
    with ExitStack() as stack:
        chips = [stack.enter_context(a_loop(api, name)) for name in ("left", "right")]
        for chip in chips:
            for name, value in (("VMAX", 20_000 * 256), ("AMAX", 800_000), ("DMAX", 800_000), ("RAMPMODE", 5)):
                chip.write(name, value)
        yield chips


def is_at(chip: Loop, position: int) -> bool:
    return bool(chip.axis()["position"] == position)


def test_chosen_axes_start_by_their_wire(page: Page, pair: list[Loop], check_axe: Callable[[Page], None]) -> None:
    page.goto("/together")
    page.get_by_label("Net", exact=True).fill("go")
    choose = page.get_by_role("combobox", name="Pins to connect")
    for chip in pair:
        choose.fill(f"{chip.device} START")
        page.get_by_role("option", name=f"{chip.device} START").click()
    choose.press("Escape")
    press(page.get_by_role("button", name="Connect", exact=True))
    nets = page.get_by_test_id("nets")
    expect(nets).to_contain_text("an edge is seen at the same clock", timeout=PATIENCE_MS)
    button = page.get_by_role("button", name="Start together")
    expect(button).to_be_disabled()
    for chip, target in zip(pair, ("3000", "-2000"), strict=True):
        field = page.get_by_label(f"Target of {chip.device}", exact=False)
        field.fill(target)
        field.press("Enter")
        expect(page.get_by_role("checkbox", name=chip.device, exact=False)).to_be_checked()
    for size in (DESKTOP, PHONE):
        page.set_viewport_size(size)
        check_axe(page)
    button.press("Enter")
    started = page.get_by_test_id("started")
    expect(started.get_by_text("START wire")).to_have_count(2, timeout=PATIENCE_MS)
    expect(started).to_contain_text("0 s between the first and the last")
    for chip, position in zip(pair, (3000, -2000), strict=True):
        wait_for(partial(is_at, chip, position), "it is there")
    for chip in pair:
        field = page.get_by_label(f"Target of {chip.device}", exact=False)
        field.fill("0")
        field.press("Enter")
    press(page.get_by_role("button", name="Go by these positions"))
    expect(page.get_by_test_id("via").get_by_role("row")).to_have_count(2)
    for chip, target in zip(pair, ("500", "400"), strict=True):
        field = page.get_by_label(f"Target of {chip.device}", exact=False)
        field.fill(target)
        field.press("Enter")
    page.get_by_label("Each leg takes").fill("1.5")
    page.get_by_label("Each leg takes").press("Enter")
    press(page.get_by_role("button", name="Plan", exact=True))
    plan = page.get_by_test_id("line-plan")
    expect(plan).to_contain_text("Off the line", timeout=PATIENCE_MS)
    expect(plan.get_by_role("table").get_by_role("row")).to_have_count(1 + 2 * 2)
    expect(plan.get_by_role("img", name="All are there after 3.0")).to_be_visible()
    for size in (PHONE, DESKTOP):
        page.set_viewport_size(size)
        check_axe(page)
    press(page.get_by_role("button", name="Go there"))
    state = page.get_by_test_id("line-state")
    expect(state).to_contain_text("done: there after", timeout=PATIENCE_MS)
    expect(state).to_contain_text("µsteps at the most")
    expect(plan.get_by_text("left measured")).to_be_visible(timeout=PATIENCE_MS)
    expect(plan).to_contain_text("Seen off it")
    assert [chip.axis()["position"] for chip in pair] == [500, 400]
    press(nets.get_by_role("button", name="Take left START off go"))
    expect(nets).to_have_count(0, timeout=PATIENCE_MS)
