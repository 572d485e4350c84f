"""Escape: while anything moves, or nobody knows, it stops first and closes; while all stand, it only closes."""

from __future__ import annotations

from collections.abc import Iterator

import httpx
import pytest
from playwright.sync_api import Page, WebSocketRoute, expect

from tests.e2e.motor import wait_for

AXES = [("bench", 0), ("bench", 1), ("bench", 2), ("slider", 0)]
STANDS = "body[data-may-move=false]"
MAY_MOVE = "body[data-may-move=true]"


def moves(api: httpx.Client) -> bool:
    states = [api.get(f"/devices/{device}/axes/{axis}").raise_for_status().json() for device, axis in AXES]
    return any(state["moving"] for state in states)


@pytest.fixture(autouse=True)
def at_rest(api: httpx.Client) -> Iterator[None]:
    api.post("/stop").raise_for_status()
    wait_for(lambda: not moves(api), "all axes at rest")
    yield
    api.post("/stop").raise_for_status()


@pytest.fixture
def stops(page: Page) -> list[str]:
    """Every stop of everything that the page sends."""
    sent: list[str] = []
    page.on("request", lambda request: sent.append(request.url) if request.url.endswith("/api/v1/stop") else None)
    return sent


def open_units(page: Page) -> None:
    page.get_by_test_id("motion-card").get_by_role("combobox", name="Unit").click()
    expect(page.get_by_role("option").first).to_be_visible()


def test_it_only_closes_while_everything_stands(page: Page, stops: list[str]) -> None:
    page.goto("/")
    expect(page.locator(STANDS)).to_be_attached()
    open_units(page)
    page.keyboard.press("Escape")
    expect(page.get_by_role("option")).to_have_count(0)
    page.get_by_role("button", name="Why").click()
    detail = page.get_by_test_id("condition-detail")
    expect(detail).to_be_visible()
    page.keyboard.press("Escape")
    expect(detail).to_be_hidden()
    page.get_by_test_id("move-target").focus()
    page.keyboard.press("Escape")
    page.keyboard.press("?")
    expect(page.get_by_role("dialog", name="Keyboard")).to_be_hidden()  # that key was the entry's
    assert stops == []


def test_it_stops_first_and_closes_while_anything_moves(page: Page, stops: list[str], api: httpx.Client) -> None:
    page.goto("/")
    expect(page.locator(STANDS)).to_be_attached()
    open_units(page)
    api.post("/devices/slider/axes/0/rotate", json={"velocity": 3000}).raise_for_status()
    expect(page.locator(MAY_MOVE)).to_be_attached()
    said = "getComputedStyle(document.querySelector('.mantine-Select-dropdown'), '::after').content"
    assert page.evaluate(said) == '"Esc stops every axis, then closes this"'
    page.keyboard.press("Escape")
    wait_for(lambda: not moves(api), "the slider at rest", 5.0)
    expect(page.get_by_role("option")).to_have_count(0)
    assert len(stops) == 1


def test_it_stops_while_nobody_knows_whether_anything_moves(page: Page, stops: list[str]) -> None:
    sockets: list[WebSocketRoute] = []

    def keep_silent(socket: WebSocketRoute) -> None:
        sockets.append(socket)

    page.route_web_socket("**/api/v1/conditions", keep_silent)  # it is open, and says nothing
    page.goto("/")
    expect(page.get_by_test_id("condition-bar")).to_contain_text("Unknown")
    open_units(page)
    with page.expect_request("**/api/v1/stop"):
        page.keyboard.press("Escape")
    expect(page.get_by_role("option")).to_have_count(0)
    assert sockets, "it was asked; one that is silent for long is asked for anew"
    assert len(stops) == 1


def test_an_edit_of_a_register_is_closed_by_it(page: Page, stops: list[str]) -> None:
    page.goto("/registers")
    page.get_by_label("Search registers").fill("v_max")
    page.get_by_role("button", name="Edit v_max").first.click()
    entry = page.get_by_label("New value of v_max").first
    entry.fill("700")
    expect(page.locator(STANDS)).to_be_attached()
    page.keyboard.press("Escape")
    expect(entry).to_have_count(0)
    expect(page.get_by_text("edit staged")).to_have_count(0)
    assert stops == []
