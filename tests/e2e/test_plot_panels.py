"""Plots in panels of their own: an XY plot and the residual, several beside each other, found, kept and in step."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from typing import Any

import httpx
import pytest
from playwright.sync_api import BrowserContext, Locator, Page, expect

from tests.e2e.conftest import PHONE, Errors
from tests.e2e.test_palette import find, first


def panel(kind: str, **config: object) -> dict[str, Any]:
    return {"type": kind, "v": 1, "at": "$", "config": config}


XY, RESIDUAL = "XY plot", "Residual"
LAYOUT: dict[str, Any] = {
    "format": "stepscope.layout",
    "version": 1,
    "id": "plots",
    "name": "Plots",
    "revision": 0,
    "screens": {
        "desktop": {
            "row": [
                {"tabs": ["motion"], "size": "300px"},
                {"col": [{"tabs": ["xy"]}, {"tabs": ["xy2"]}]},
                {"tabs": ["residual"]},
            ]
        },
        "phone": ["motion", "xy", "xy2", "residual"],
    },
    "panels": {
        "motion": panel("motion"),
        "xy": panel("xy"),
        "xy2": panel("xy", y=["$:position", "$:acceleration"], spanS=5),
        "residual": panel("residual"),
    },
}


@pytest.fixture(autouse=True)
def plots(api: httpx.Client) -> Iterator[None]:
    # before its first move nothing is predicted
    for axis in (0, 1):
        api.post(f"/devices/bench/axes/{axis}/move", json={"target": 0}).raise_for_status()
    api.post("/layouts", json={"document": LAYOUT}).raise_for_status()
    yield
    api.post("/stop").raise_for_status()
    for layout in api.get("/layouts").raise_for_status().json()["layouts"]:
        api.delete(f"/layouts/{layout['id']}").raise_for_status()


def shown(page: Page, kind: str) -> Locator:
    return page.get_by_role("region", name=kind, exact=True)


def value(card: Locator, path: str) -> Locator:
    return card.locator(f"[data-path='{path}']")


def test_several_plots_stand_beside_each_other_and_are_set_by_themselves(page: Page, api: httpx.Client) -> None:
    page.goto("/?layout=plots&d=bench&a=0")
    first_xy, second_xy = shown(page, XY).first, shown(page, XY).last
    expect(shown(page, XY)).to_have_count(2)
    residual = shown(page, RESIDUAL)
    api.post("/devices/bench/axes/0/rotate", json={"velocity": 500}).raise_for_status()
    for card, path in ((first_xy, "velocity.0"), (second_xy, "acceleration.0"), (residual, "residual.0")):
        expect(value(card, f"bench:{path}")).to_have_text(re.compile(r"\d"))
        expect(card.locator("canvas")).to_be_visible()
    expect(first_xy.get_by_role("img", name=re.compile("velocity"))).to_be_visible()
    expect(residual.locator("[data-figures]")).to_have_text(re.compile(r"\d to .*RMS \d"))
    first_xy.get_by_role("combobox", name="Add a channel").click()
    page.keyboard.type("slider velocity")
    page.get_by_role("option", name="slider velocity.0").click()
    expect(value(first_xy, "slider:velocity.0")).to_have_text(re.compile(r"\d"))
    first_xy.get_by_role("button", name=re.compile("^Take .* velocity.0 out of")).first.click()
    second_xy.get_by_label("Time").select_option("20")
    page.reload()
    expect(value(first_xy, "slider:velocity.0")).to_be_visible()
    expect(value(first_xy, "bench:velocity.0")).to_have_count(0)
    expect(value(second_xy, "bench:acceleration.0")).to_be_visible()
    expect(second_xy.get_by_label("Time")).to_have_value("20")
    expect(first_xy.get_by_label("Time")).to_have_value("0")
    # what was said of the axis follows the choice of another one
    page.goto("/?layout=plots&d=bench&a=1")
    expect(value(second_xy, "bench:acceleration.1")).to_be_visible()
    expect(value(residual, "bench:residual.1")).to_be_visible()
    expect(value(first_xy, "bench:position.1")).to_be_visible()


def test_the_palette_adds_a_panel_that_is_in_step_with_the_scope(page: Page, api: httpx.Client) -> None:
    page.goto("/health")
    find(page, "residual")
    first(page, RESIDUAL)
    page.keyboard.press("Enter")
    residual = shown(page, RESIDUAL)
    expect(value(residual, "bench:residual.0")).to_have_text(re.compile(r"\d"))
    expect(residual.get_by_role("button", name="Hold the picture")).to_have_count(0)
    page.keyboard.press("p")
    expect(page.get_by_test_id("scope")).to_have_attribute("data-paused", "true")
    figures = residual.locator("[data-figures='bench:residual.0']")
    api.post("/devices/bench/axes/0/rotate", json={"velocity": 500}).raise_for_status()
    expect(page.get_by_test_id("position")).to_have_text(re.compile("[1-9]"))
    here = page.get_by_test_id("position").inner_text()
    held = (value(residual, "bench:residual.0").inner_text(), figures.inner_text())
    expect(page.get_by_test_id("position")).not_to_have_text(here)
    assert (value(residual, "bench:residual.0").inner_text(), figures.inner_text()) == held
    # in step with the scope, it is measured by the scope's cursors
    page.get_by_role("button", name="Measuring cursors").click()
    page.get_by_role("button", name="Figures", exact=True).click()
    residual.get_by_role("combobox", name="Add a channel").click()
    page.get_by_role("option", name="bench residual.1").click()
    measured = page.get_by_test_id("cursor-table").locator("[data-channel='bench:residual.1'] [data-figure='RMS']")
    expect(measured).to_have_text(re.compile(r"\d"))
    residual.get_by_label("Time").select_option("5")
    expect(residual.get_by_role("button", name="Hold the picture")).to_be_visible()
    expect(measured).to_have_count(0)
    expect(figures).not_to_have_text(held[1])


def test_a_channel_of_a_device_that_began_later_is_in_the_same_time(page: Page, api: httpx.Client) -> None:
    body = {"name": "late", "model": "tmc5160", "link": {"kind": "emulator"}, "start_up": True}
    api.post("/devices", json=body).raise_for_status()
    try:
        api.post("/devices/late/axes/0/move", json={"target": 0}).raise_for_status()
        page.goto("/?layout=plots&d=bench&a=0")
        residual = shown(page, RESIDUAL)
        expect(value(residual, "bench:residual.0")).to_have_text(re.compile(r"\d"))
        residual.get_by_role("combobox", name="Add a channel").click()
        page.get_by_role("option", name="late residual.0").click()
        expect(residual.locator("[data-figures='late:residual.0']")).to_have_text(re.compile(r"\d.* to .*\d"))
        page.goto("/?layout=plots&d=late&a=0")
        expect(value(residual, "late:residual.0")).to_have_text(re.compile(r"\d"))
        expect(residual.locator("[data-figures='late:residual.0']")).to_have_text(re.compile(r"\d.* to .*\d"))
    finally:
        api.delete("/devices/late").raise_for_status()


def test_a_panel_tells_what_it_lacks(page: Page, api: httpx.Client, errors: Errors) -> None:
    errors.expect("409")  # of an axis whose device is just being disconnected
    page.goto("/?layout=plots&d=bench&a=0")
    expect(value(shown(page, RESIDUAL), "bench:residual.0")).to_have_text(re.compile(r"\d"))
    api.post("/devices/bench/disconnect").raise_for_status()
    try:
        expect(shown(page, RESIDUAL)).to_contain_text("is not connected")
    finally:
        api.post("/devices/bench/connect").raise_for_status()
    body = {"name": "driver", "model": "tmc2208", "link": {"kind": "emulator"}, "start_up": True}
    made = api.post("/devices", json=body)
    made.raise_for_status()
    try:
        page.goto("/?layout=plots&d=driver")
        expect(page.get_by_text(re.compile("nothing is predicted for it|has no axis")).first).to_be_visible()
    finally:
        api.delete("/devices/driver").raise_for_status()


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_plots_of_panels_fit_and_are_accessible(
    new_context: Callable[..., BrowserContext], check_axe: Callable[[Page], None], scheme: str
) -> None:
    for size in ({"width": 1280, "height": 720}, PHONE):
        page = new_context(color_scheme=scheme, viewport=size).new_page()
        page.goto("/?layout=plots&d=bench&a=0")
        expect(value(shown(page, RESIDUAL), "bench:residual.0")).to_have_text(re.compile(r"\d"))
        assert page.evaluate("document.documentElement.scrollWidth") <= size["width"]
        check_axe(page)
        page.close()
