"""From "Add a device" to a parameter on the scope, for models drawn at random, by what the page says alone."""

from __future__ import annotations

import random
import re
from collections.abc import Iterator

import httpx
import pytest
from playwright.sync_api import Page, expect

from app.registers import catalog

NAME = "drawn"
A_NUMBER = re.compile(r"^-?\d")
DRAWN = random.Random(15).sample([model.title for model in catalog.listings()], 2)


@pytest.fixture(autouse=True)
def without_it(api: httpx.Client) -> Iterator[None]:
    yield
    api.delete(f"/devices/{NAME}")


def way_to_the_scope(page: Page, title: str) -> None:
    """Add an emulated `title`, and show its first register or parameter without a plot of its own."""
    page.goto("/connections")
    page.get_by_role("button", name="Add a device").click()
    page.get_by_label("Name", exact=True).fill(NAME)
    model = page.get_by_role("combobox", name="Model")
    model.click()
    model.fill(title)
    page.get_by_role("option", name=title).first.click()
    page.get_by_role("button", name="Add and connect").click()
    entry = page.get_by_role("region", name=NAME)
    expect(entry).to_contain_text("connected")
    entry.get_by_text("Show it on every page").click()
    entry.get_by_role("link", name="Bench").click()
    page.get_by_role("button", name="Plots and further axes").click()
    choice = page.get_by_role("combobox", name="Registers and parameters")
    choice.click()
    page.get_by_role("listbox", name="Registers and parameters").get_by_role("option").first.click()
    page.keyboard.press("Escape")
    page.keyboard.press("Escape")
    expect(page.locator("[data-row=more] [data-channel]").first).to_have_text(A_NUMBER)


@pytest.mark.parametrize("title", DRAWN)
def test_a_parameter_comes_onto_the_scope(page: Page, title: str) -> None:
    way_to_the_scope(page, title)
