"""The list of a choice in a browser: wide enough for its field and its options, on a desk and on a phone."""

from __future__ import annotations

from typing import Literal

import pytest
from playwright.sync_api import Page, ViewportSize, expect

from tests.e2e.conftest import DESKTOP, PHONE


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("size", [DESKTOP, PHONE], ids=["desktop", "phone"])
def test_a_list_is_as_wide_as_its_field_and_inside_the_page(
    page: Page, size: ViewportSize, scheme: Literal["light", "dark"]
) -> None:
    page.set_viewport_size(size)
    page.emulate_media(color_scheme=scheme)
    page.goto("/")
    expect(page.get_by_label("Loading the page")).to_have_count(0)
    for name in ("Device and axis", "Time span", "Unit"):
        field = page.get_by_role("combobox", name=name, exact=True)
        expect(field).not_to_have_value("")
        field.click()
        options = page.get_by_role("listbox", name=name, exact=True)
        expect(options).to_be_visible()
        above, below = field.locator("..").bounding_box(), options.locator("..").bounding_box()
        assert above is not None
        assert below is not None
        assert below["width"] >= above["width"] - 0.5, name
        assert below["x"] >= 0, name
        assert below["x"] + below["width"] <= size["width"], name
        page.keyboard.press("Escape")
        expect(options).to_have_count(0)
