"""The way from "Add a device" to a register or parameter on the scope, by what the page says: roles and labels."""

from __future__ import annotations

import re

from playwright.sync_api import Page, expect


def way_to_the_scope(page: Page, title: str, name: str, within_s: float = 10.0) -> str:
    """Add an emulated `title` under `name`, and show its first register or parameter without a plot of its own.

    Each step may take `within_s`. What the readout says, e.g. "MaxCurrent 0".
    """
    within_ms = within_s * 1e3
    page.set_default_timeout(within_ms)
    page.get_by_role("link", name="Connections").first.click()
    page.get_by_role("button", name="Add a device").click()
    page.get_by_label("Name", exact=True).fill(name)
    model = page.get_by_role("combobox", name="Model")
    model.click()
    model.fill(title)
    page.get_by_role("option", name=re.compile(rf"^{re.escape(title)} · ")).click()
    page.get_by_role("button", name="Add and connect").click()
    entry = page.get_by_role("region", name=name)
    expect(entry).to_contain_text("connected", timeout=within_ms)
    entry.get_by_text("Show it on every page").click()
    entry.get_by_role("link", name="Bench").click()
    page.get_by_role("button", name="Plots and further axes").click()
    choice = page.get_by_role("combobox", name="Registers and parameters")
    choice.click()
    option = page.get_by_role("listbox", name="Registers and parameters").get_by_role("option").first
    channel = option.inner_text()
    option.click()
    page.keyboard.press("Escape")
    expect(choice).to_be_hidden(timeout=within_ms)
    readout = page.get_by_role("button", name=re.compile(rf"^{re.escape(channel)}\s+-?\d"))
    expect(readout).to_be_visible(timeout=within_ms)
    return " ".join(readout.inner_text().split())
