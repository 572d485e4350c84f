"""The 3D twin in a real browser, drawn in software."""

from __future__ import annotations

import io
import os
import signal
from collections.abc import Callable, Iterator
from pathlib import Path
from urllib.parse import urlsplit

import httpx
import numpy as np
import pytest
from chromium import chromium_flags, find_chromium
from PIL import Image
from playwright.sync_api import Browser, BrowserContext, Page, ViewportSize, expect, sync_playwright
from server_process import ServerProcess

from tests.e2e.conftest import PHONE, Errors

STARTS_MS = 60_000
"""Software rendering on a busy machine: the first picture takes its time."""
SMALL: ViewportSize = {"width": 800, "height": 600}
"""Each pixel is work for the processor: a picture of this size is a third of a desktop's."""
NO_WEBGL = "HTMLCanvasElement.prototype.getContext = () => null"


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    """One that draws 3D without a graphics card."""
    flags = [*chromium_flags(), "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"]
    with sync_playwright() as playwright:
        running = playwright.chromium.launch(executable_path=find_chromium(), args=flags)
        yield running
        running.close()


@pytest.fixture
def page(page: Page) -> Page:
    """Of a size that is drawn quickly."""
    page.set_viewport_size(SMALL)
    return page


@pytest.fixture(autouse=True)
def _off_again(api: httpx.Client) -> Iterator[None]:
    yield
    api.delete("/twin")


def twin(api: httpx.Client) -> dict[str, object]:
    state: dict[str, object] = api.get("/twin").json()
    return state


def picture(page: Page) -> np.ndarray:
    """The frame's pixels [rows, columns, rgb]."""
    image = Image.open(io.BytesIO(page.locator("iframe").screenshot())).convert("RGB")
    return np.asarray(image, dtype=np.int16)


def drawn(page: Page) -> np.ndarray:
    """The picture once there is one."""
    expect(page.locator("iframe")).to_be_visible(timeout=STARTS_MS)
    for _ in range(120):
        pixels = picture(page)
        if len(np.unique(pixels.reshape(-1, 3), axis=0)) > 200:
            return pixels
        page.wait_for_timeout(250)
    raise AssertionError("nothing was drawn")


def drawing_process(server: ServerProcess) -> int:
    """Its process id: a child of the server."""
    for entry in Path("/proc").iterdir():
        if entry.name.isdecimal():
            try:
                stat = (entry / "stat").read_text().rpartition(")")[2].split()
                command = (entry / "cmdline").read_bytes()
            except (FileNotFoundError, ProcessLookupError):
                continue
            if int(stat[1]) == server.pid and b"app.twin.child" in command:
                return int(entry.name)
    raise AssertionError("no drawing process")


def test_an_axis_is_drawn_follows_and_nothing_leaves_our_origin(
    page: Page, api: httpx.Client, server: ServerProcess
) -> None:
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    page.on("websocket", lambda socket: asked.append(socket.url))
    page.goto("/twin")
    before = drawn(page)
    ours = urlsplit(server.url).netloc
    foreign = [url for url in asked if not url.startswith(("data:", "blob:")) and urlsplit(url).netloc != ours]
    assert not foreign
    assert any(url.endswith("/twin/view") for url in asked if url.startswith("ws:"))
    here = api.get("/devices/bench/axes/0").json()["position"]
    api.post("/devices/bench/axes/0/move", json={"target": 3200 * 3 + 1100, "relative": True}).raise_for_status()
    expect(page.get_by_text("updates/s")).to_be_visible(timeout=STARTS_MS)
    expect(page.get_by_text("no updates", exact=True)).to_be_visible(timeout=STARTS_MS)
    assert np.abs(picture(page) - before).max() > 60  # hand, carriage and field stand elsewhere
    api.post("/devices/bench/axes/0/move", json={"target": here})
    page.get_by_role("button", name="End the view").click()
    expect(page.get_by_text("The 3D view is off")).to_be_visible()
    assert twin(api)["state"] == "off"
    page.reload()
    expect(page.get_by_text("The 3D view is off")).to_be_visible()  # what was ended stays so
    page.get_by_role("button", name="Show X in 3D").click()
    expect(page.locator("iframe")).to_be_visible(timeout=STARTS_MS)


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_the_page_is_accessible_and_fits_a_phone(
    new_context: Callable[..., BrowserContext], check_axe: Callable[[Page], None], scheme: str, api: httpx.Client
) -> None:
    page = new_context(viewport=PHONE, color_scheme=scheme).new_page()
    page.goto("/twin")
    pixels = drawn(page)
    assert (pixels[5, 5].mean() < 128) == (scheme == "dark")  # the picture's ground is the page's
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    assert twin(api)["scheme"] == scheme
    # what is in the frame is viser's; what it tells stands beside it in words
    page.evaluate("document.querySelector('iframe').remove()")
    check_axe(page)


def test_without_webgl_there_are_the_numbers(new_context: Callable[..., BrowserContext]) -> None:
    context = new_context()
    context.add_init_script(NO_WEBGL)
    page = context.new_page()
    page.goto("/twin")
    expect(page.get_by_text("This browser cannot draw 3D")).to_be_visible(timeout=STARTS_MS)
    expect(page.get_by_text("carriage, by the counter")).to_be_visible(timeout=STARTS_MS)
    expect(page.locator("iframe")).to_have_count(0)


def test_a_process_that_is_killed_is_told_and_started_again(page: Page, server: ServerProcess, errors: Errors) -> None:
    errors.expect("WebSocket|socket|twin/view|409")
    page.goto("/twin")
    expect(page.locator("iframe")).to_be_visible(timeout=STARTS_MS)
    os.kill(drawing_process(server), signal.SIGKILL)
    expect(page.get_by_text("was ended by signal 9")).to_be_visible(timeout=STARTS_MS)
    page.get_by_role("button", name="Try again").click()
    expect(page.locator("iframe")).to_be_visible(timeout=STARTS_MS)


def test_what_somebody_else_looks_at_is_not_taken_away(
    page: Page, new_context: Callable[..., BrowserContext], api: httpx.Client
) -> None:
    page.goto("/twin")
    drawn(page)
    other = new_context(viewport=SMALL).new_page()
    other.goto("/connections")
    other.evaluate("localStorage.setItem('stepscope.selection', JSON.stringify({device: 'slider', axis: 0}))")
    other.goto("/twin")
    expect(other.get_by_text("Another session looks at bench, X")).to_be_visible(timeout=STARTS_MS)
    assert twin(api)["device"] == "bench"
    other.get_by_role("button", name="Show slider, slider").click()
    expect(other.locator("iframe")).to_be_visible(timeout=STARTS_MS)
    assert twin(api)["device"] == "slider"


def test_the_cursor_of_a_plot_scrubs_its_recording(page: Page, api: httpx.Client) -> None:
    body = {"device": "bench", "channels": ["position.0", "velocity.0"], "rate_hz": 200, "duration_s": 1.0}
    recording = api.post("/recordings", json=body).json()["id"]
    page.goto(f"/recordings/{recording}")
    page.get_by_role("button", name="Show in 3D").click()
    drawn(page)
    assert twin(api)["following"] == "recording"
    plot = page.get_by_test_id("recording-plots").locator(".u-over").last  # the first one is the overview
    plot.scroll_into_view_if_needed()
    plot.hover(position={"x": 200, "y": 20})
    expect(page.get_by_text("at 0.000 s")).to_have_count(0)
    assert twin(api)["recording"] == recording
    assert twin(api)["recording_time_s"] != 0.0
    page.goto("/connections")
