"""Current and chopper in a browser: a TMC2660's scale in amperes, a wanted current staged and applied."""

from __future__ import annotations

from collections.abc import Callable

import httpx
from playwright.sync_api import Page, expect

from tests.e2e.modules import select

PATIENCE_MS = 30_000
"""For whatever has to come from the server: the machine may be busy."""


def test_a_wanted_current_becomes_a_scale(page: Page, api: httpx.Client, check_axe: Callable[[Page], None]) -> None:
    made = api.post("devices", json={"name": "lone driver", "model": "tmc2660", "link": {"kind": "emulator"}})
    device = made.raise_for_status().json()["id"]
    try:
        for name, value in (("DRVCONF", 0x20), ("SGCSCONF", 0x1001F), ("CHOPCONF", 0x101B5)):
            api.put(f"devices/{device}/registers/{name}", json={"value": value}).raise_for_status()
        select(page, device)
        page.goto("/driver-current")
        expect(page.get_by_test_id("rms")).to_contain_text("2.192", timeout=PATIENCE_MS)
        page.get_by_role("button", name="Use", exact=True).click()
        expect(page.get_by_test_id("rms")).to_contain_text("0.984", timeout=PATIENCE_MS)
        check_axe(page)
        page.get_by_role("button", name="Apply", exact=True).click()
        expect(page.get_by_text("last apply: 2")).to_be_visible(timeout=PATIENCE_MS)
        kept = api.get(f"devices/{device}/registers", params={"kept": True}).json()
        words = {one["name"]: one["fields"] for one in kept}
        assert (words["SGCSCONF"]["CS"], words["DRVCONF"]["vsense"]) == (26, 1)
    finally:
        api.delete(f"devices/{device}").raise_for_status()
