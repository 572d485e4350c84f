"""The bench in a browser: the demo motors move as the page says, and stop however one asks for it."""

from __future__ import annotations

import json
import re
import struct
import time
from collections.abc import Callable, Iterator
from typing import Any

import httpx
import numpy as np
import pytest
from playwright.sync_api import BrowserContext, Page, WebSocket, expect

from tests.e2e.chips import a_chip, select
from tests.e2e.conftest import DESKTOP, PHONE, Errors

AXES = ("bench/0", "bench/1", "bench/2", "slider/0")


def axis(api: httpx.Client, which: str = "bench/0") -> dict[str, Any]:
    device, index = which.split("/")
    state: dict[str, Any] = api.get(f"/devices/{device}/axes/{index}").raise_for_status().json()
    return state


def wait_for(condition: Any, what: str, seconds: float = 10.0) -> None:
    """The server lives in real time, and so do its motors: look again until it is so."""
    until_s = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < until_s, f"not within {seconds:g} s: {what}"
        time.sleep(0.02)


def shown_position(page: Page) -> int:
    """The big number, without the spaces that group its digits; a dash for an unknown one is no number."""
    text = page.get_by_test_id("position").inner_text().replace("\N{MINUS SIGN}", "-")
    digits = re.sub(r"[^\d-]", "", text)
    return int(digits) if digits.lstrip("-") else -(1 << 30)


@pytest.fixture(autouse=True)
def at_rest_in_the_middle(api: httpx.Client) -> Iterator[None]:
    """Each test finds the axes at rest, and position 0 on the bench's first one."""

    def settle() -> None:
        for which in AXES:
            device, index = which.split("/")
            api.request("DELETE", f"/devices/{device}/axes/{index}/shuttle")
        api.post("/stop").raise_for_status()
        wait_for(lambda: not any(axis(api, which)["moving"] for which in AXES), "all axes at rest")

    settle()
    api.post("/devices/bench/axes/0/move", json={"target": 0}).raise_for_status()
    wait_for(lambda: axis(api)["position_reached"], "bench X at 0")
    yield
    settle()


@pytest.fixture
def bench(page: Page) -> Page:
    """The bench page, live."""
    page.goto("/")
    expect(page.get_by_test_id("server-status")).to_have_text("2 of 2 connected")
    expect(page.get_by_test_id("link-readout").first).to_contain_text("live")
    return page


def test_the_demo_bench_is_there(bench: Page) -> None:
    for which in AXES:
        expect(bench.get_by_test_id(f"axis-{which.replace('/', '-')}")).to_be_visible()
    expect(bench.get_by_test_id("scope").locator("canvas").first).to_be_visible()
    expect(bench.get_by_test_id("mode")).to_have_text(re.compile("ramp", re.IGNORECASE))


def test_what_the_figures_of_a_link_are_is_told_without_a_mouse(bench: Page, check_axe: Callable[[Page], None]) -> None:
    readout = bench.get_by_test_id("link-readout").first
    readout.get_by_role("button", name="What these figures are").press("Enter")
    for size in (DESKTOP, PHONE):
        bench.set_viewport_size(size)
        expect(readout).to_contain_text("latency: From the sample to its way out to this page")
        check_axe(bench)
        assert bench.evaluate("document.scrollingElement.scrollWidth - document.documentElement.clientWidth") <= 0


def test_another_family_is_one_click_away(bench: Page, api: httpx.Client, errors: Errors) -> None:
    errors.expect("status of 40[49]")  # a look that is under way when the device goes
    modules = bench.get_by_role("button", name="Add one of the emulated modules")
    modules.click()
    bench.get_by_role("button", name="Add an emulated PD42-1241").click()
    try:
        expect(bench.get_by_test_id("server-status")).to_have_text("3 of 3 connected")
        expect(bench.get_by_role("link", name="Encoder")).to_be_visible()
        expect(bench.get_by_test_id("link-readout").first).to_contain_text("live")
        expect(modules).to_have_count(0)  # one is left of them
        expect(bench.get_by_role("button", name="Add an emulated TMCM-1161")).to_be_visible()
    finally:
        for device in api.get("/devices").raise_for_status().json():
            if not device["demo"]:
                api.delete(f"/devices/{device['id']}").raise_for_status()


def test_a_move_moves_the_motor_and_the_page_follows(bench: Page, api: httpx.Client) -> None:
    bench.get_by_test_id("move-target").fill("4000")
    bench.get_by_test_id("move-go").click()
    expect(bench.get_by_test_id("motion-card")).to_contain_text("On target")
    wait_for(lambda: shown_position(bench) == 4000, "the page shows 4000")
    state = axis(api)
    assert (state["position"], state["target_position"], state["moving"]) == (4000, 4000, False)


def test_moving_back_and_forth_by_a_distance(bench: Page, api: httpx.Client) -> None:
    bench.get_by_role("textbox", name=re.compile("^Move by")).fill("1000")
    bench.get_by_role("button", name="Move forward by this distance").click()
    wait_for(lambda: axis(api)["position"] == 1000, "1000 to the right")
    bench.get_by_role("button", name="Move back by this distance").click()
    wait_for(lambda: axis(api)["position"] == 0, "and back")


def test_the_demo_shows_what_it_moves(
    new_context: Callable[..., BrowserContext], api: httpx.Client, errors: Errors
) -> None:
    errors.expect("status of 40[49]")  # a look that is under way when the device goes
    with a_chip(api, "other") as chip:
        context = new_context(viewport=PHONE)
        select(context, chip)
        page = context.new_page()
        page.goto("/")
        expect(page.get_by_test_id("motion-card")).to_contain_text("other")
        page.get_by_test_id("demo-motion").click()
        expect(page.get_by_test_id("motion-card")).to_contain_text("bench")
        expect(page.get_by_test_id("position")).to_be_in_viewport(ratio=1)
        before = shown_position(page)
        wait_for(lambda: shown_position(page) not in (before, -(1 << 30)), "what is shown moves")
        page.close()
    assert not errors.unexpected()


def test_escape_stops_every_axis_of_every_device(bench: Page, api: httpx.Client) -> None:
    for which in AXES:
        device, index = which.split("/")
        api.post(f"/devices/{device}/axes/{index}/rotate", json={"velocity": 3000}).raise_for_status()
    wait_for(lambda: all(axis(api, which)["velocity_pps"] > 2000 for which in AXES), "all axes turn")
    bench.get_by_test_id("move-target").focus()  # the key works from within a field, too
    bench.keyboard.press("Escape")
    wait_for(lambda: not any(axis(api, which)["moving"] for which in AXES), "all axes at rest", 5.0)
    assert [axis(api, which)["velocity_pps"] for which in AXES] == [0, 0, 0, 0]


def test_the_red_button_stops_too(bench: Page, api: httpx.Client) -> None:
    api.post("/devices/slider/axes/0/rotate", json={"velocity": -3000}).raise_for_status()
    wait_for(lambda: axis(api, "slider/0")["moving"], "the slider turns")
    bench.get_by_test_id("stop-all").click()
    wait_for(lambda: not axis(api, "slider/0")["moving"], "the slider at rest", 5.0)


def test_a_jog_lasts_as_long_as_the_button_is_held(bench: Page, api: httpx.Client) -> None:
    bench.get_by_test_id("jog-left").hover()
    bench.mouse.down()
    wait_for(lambda: axis(api)["velocity_pps"] < 0, "jogging left")
    bench.mouse.up()
    wait_for(lambda: not axis(api)["moving"], "released, at rest", 5.0)
    assert axis(api)["position"] < 0


def test_a_page_that_is_left_while_jogging_stops_the_motor(bench: Page, api: httpx.Client) -> None:
    bench.get_by_test_id("jog-right").hover()
    bench.mouse.down()
    wait_for(lambda: axis(api)["velocity_pps"] > 0, "jogging right")
    bench.goto("about:blank")
    wait_for(lambda: not axis(api)["moving"], "the page is gone, the motor at rest", 5.0)


def test_a_shuttle_runs_until_it_is_ended(bench: Page, api: httpx.Client) -> None:
    bench.get_by_test_id("shuttle-toggle").click()
    wait_for(lambda: axis(api)["moving"], "the shuttle moves")
    expect(bench.get_by_test_id("shuttle-toggle")).to_have_text("End")
    bench.get_by_test_id("shuttle-toggle").click()
    expect(bench.get_by_test_id("shuttle-toggle")).to_have_text("Start")
    wait_for(lambda: not axis(api)["moving"], "the shuttle has ended", 10.0)


def test_a_reloaded_page_has_the_past(bench: Page, api: httpx.Client) -> None:
    api.post("/devices/bench/axes/0/move", json={"target": 3000}).raise_for_status()
    wait_for(lambda: axis(api)["position_reached"], "moved before the reload")
    reloaded_at_s = axis(api)["time_s"]
    received: list[tuple[dict[str, Any], list[bytes]]] = []

    def on_socket(socket: WebSocket) -> None:
        if "/bench/telemetry" in socket.url:
            frames: list[bytes] = []
            hello: dict[str, Any] = {}

            def on_frame(payload: str | bytes) -> None:
                if isinstance(payload, bytes):
                    frames.append(payload)
                elif not hello:
                    hello.update(json.loads(payload))

            socket.on("framereceived", on_frame)
            received.append((hello, frames))

    bench.on("websocket", on_socket)
    bench.reload()
    expect(bench.get_by_test_id("link-readout").first).to_contain_text("live")
    positions: list[float] = []
    for _ in range(200):
        positions = list(positions_before(reloaded_at_s, received))
        if max(positions, default=0.0) > 2900:
            break
        bench.wait_for_timeout(50)  # not `wait_for`: Playwright tells of frames only while it is being asked something
    assert positions, "nothing from before the reload was sent"
    assert (min(positions) < 100, max(positions) > 2900) == (True, True)


def positions_before(time_s: float, received: list[tuple[dict[str, Any], list[bytes]]]) -> Iterator[float]:
    """Positions of the bench's first axis, from telemetry frames, sampled before `time_s`."""
    for hello, frames in received:
        names = [channel["name"] for channel in hello.get("channels", [])]
        if "position.0" not in names:
            continue
        for frame in frames:
            rows, columns = struct.unpack_from("<8xII", frame)
            samples = np.frombuffer(frame, "<f8", offset=24).reshape(columns + 1, rows)
            yield from samples[1 + names.index("position.0")][samples[0] < time_s].tolist()


def test_a_chip_that_vanishes_is_said_and_found_again(bench: Page, api: httpx.Client, errors: Errors) -> None:
    errors.expect("status of (409|502|504)")
    api.patch("/devices/slider/emulator", json={"faults": {"unplugged": True}}).raise_for_status()
    try:
        expect(bench.get_by_test_id("server-status")).to_have_text("1 of 2 connected", timeout=15_000)
    finally:
        api.patch("/devices/slider/emulator", json={"faults": {"unplugged": False}}).raise_for_status()
    expect(bench.get_by_test_id("server-status")).to_have_text("2 of 2 connected", timeout=15_000)
