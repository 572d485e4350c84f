"""Channels of the scope: one socket a device, any channel in any plot, formulas, figures of a stretch, its address."""

from __future__ import annotations

import re
import struct
from collections.abc import Callable, Iterator
from urllib.parse import parse_qs, urlparse

import httpx
import numpy as np
import pytest
from playwright.sync_api import Locator, Page, WebSocket, expect


class Sockets:
    """The telemetry sockets of a page, and the times of the samples that came over each."""

    def __init__(self, page: Page) -> None:
        self.open: list[WebSocket] = []
        self.most_at_once: dict[str, int] = {}
        page.on("websocket", self._opened)

    def _opened(self, socket: WebSocket) -> None:
        if "/telemetry" not in socket.url:
            return
        self.open.append(socket)
        device = self.device(socket)
        self.most_at_once[device] = max(self.most_at_once.get(device, 0), len(self.of(device)))
        socket.on("close", lambda _: self.open.remove(socket))

    @staticmethod
    def device(socket: WebSocket) -> str:
        return urlparse(socket.url).path.split("/")[-2]

    @staticmethod
    def channels(socket: WebSocket) -> set[str]:
        return set(parse_qs(urlparse(socket.url).query)["channels"][0].split(","))

    def of(self, device: str) -> list[WebSocket]:
        return [socket for socket in self.open if self.device(socket) == device]


@pytest.fixture
def sockets(page: Page) -> Sockets:
    return Sockets(page)


@pytest.fixture(autouse=True)
def stopped_after(api: httpx.Client) -> Iterator[None]:
    yield
    api.post("/stop").raise_for_status()


@pytest.fixture
def bench(page: Page, sockets: Sockets) -> Page:
    """The bench page, live."""
    page.goto("/?d=bench")
    expect(page.get_by_test_id("server-status")).to_have_text("2 of 2 connected")
    expect(page.get_by_test_id("link-readout").first).to_contain_text("live")
    return page


def test_everything_of_a_device_comes_over_one_socket(bench: Page, sockets: Sockets) -> None:
    """Cards, drawing, scope and events of the bench read the same samples."""
    expect(bench.get_by_test_id("position")).to_have_text(re.compile(r"\d"))
    expect(bench.get_by_test_id("scope").locator("canvas").first).to_be_visible()
    for device in ("bench", "slider"):
        (socket,) = sockets.of(device)
        assert "position.0" in sockets.channels(socket)
    (scope,) = sockets.of("bench")
    assert {"residual.0", "predicted_velocity.0", "position.2"} <= sockets.channels(scope)


def test_another_channel_takes_over_from_a_socket_that_goes_on_until_then(bench: Page, sockets: Sockets) -> None:
    """For a moment there are two, then one; of the old one no sample is missing before the first of the new one."""
    (old,) = sockets.of("bench")
    times: list[float] = []
    old.on("framereceived", lambda data: times.extend(times_of(data)))
    readout = bench.get_by_test_id("link-readout").first
    bench.get_by_test_id("axis-bench-2").click()
    wait(bench, lambda: sockets.of("bench") != [old] and len(sockets.of("bench")) == 1)
    (new,) = sockets.of("bench")
    assert {"residual.2", "position.0"} <= sockets.channels(new)
    assert sockets.most_at_once["bench"] == 2
    assert len(times) > 0
    assert (np.diff(times) > 0).all()
    expect(readout).to_contain_text("live")


def test_any_channel_goes_into_any_plot(bench: Page, check_axe: Callable[[Page], None]) -> None:
    """Ticked or dragged; a second unit has the other axis, and a third is refused with the reason."""
    bench.get_by_role("button", name="Channels and plots of your own").click()
    tree = bench.get_by_test_id("channel-tree")
    tree.get_by_label("Find a channel").fill("position")
    line(tree, "bench:position.0").get_by_role("checkbox").check()
    plot = bench.get_by_test_id("free-plot-1")
    expect(plot.locator("canvas")).to_be_visible()
    expect(plot.locator("[data-path='bench:position.0']")).to_have_text(re.compile(r"\d"))
    tree.get_by_label("Find a channel").fill("slider velocity")
    line(tree, "slider:velocity.0").drag_to(plot)
    expect(plot.locator("[data-path='slider:velocity.0']")).to_have_text(re.compile(r"\d"))
    tree.get_by_label("Find a channel").fill("bench acceleration")
    line(tree, "bench:acceleration.0").drag_to(plot)
    expect(plot.get_by_role("status")).to_have_text(
        "pps² has no axis here: its two y axes are µsteps and pps. Put it into another plot"
    )
    line(tree, "bench:acceleration.0").get_by_role("checkbox").click()
    expect(tree.get_by_role("status")).to_contain_text("pps² has no axis here")
    plot.get_by_role("combobox", name="Kind of plot 1").click()
    bench.get_by_role("option", name="XY").click()
    expect(plot).to_contain_text("x: ")
    check_axe(bench)
    bench.reload()
    expect(bench.get_by_test_id("free-plot-1").locator("[data-path='slider:velocity.0']")).to_be_visible()
    bench.get_by_role("button", name="Close plot 1").click()
    expect(bench.get_by_test_id("free-plot-1")).to_have_count(0)


def test_a_formula_is_a_channel_with_a_unit(bench: Page) -> None:
    bench.get_by_role("button", name="Channels and plots of your own").click()
    tree = bench.get_by_test_id("channel-tree")
    tree.get_by_role("button", name="Derive by a formula").click()
    form = tree.get_by_role("form", name="Derive by a formula")
    for letter, channel in (("a", "bench velocity.0"), ("b", "bench position.0")):
        form.get_by_label(letter, exact=True).fill(channel)
        bench.get_by_role("option", name=re.compile(re.escape(channel) + "$")).first.click()
    verdict = form.get_by_test_id("formula-verdict")
    formula = form.get_by_label("Formula", exact=True)
    expect(verdict).to_have_text("what is subtracted has two units: pps and µsteps")
    for hostile in ("a.constructor", "(()=>a)()", "a = 1", "mean(" * 30, "a" * 400, "__proto__"):
        formula.fill(hostile)
        expect(form.get_by_role("button", name="Add")).to_be_disabled()
        expect(verdict).not_to_have_text(re.compile("^In "))
    formula.fill("a - d(b) + 1000")
    expect(verdict).to_have_text("In pps")
    form.get_by_label("Name").fill("slip")
    form.get_by_role("button", name="Add").click()
    line(tree, "=:slip").get_by_role("checkbox").check()
    value = bench.get_by_test_id("free-plot-1").locator("[data-path='=:slip']")
    expect(value).to_have_text(re.compile("^1000$"))  # at rest there is no difference
    bench.get_by_role("button", name="Close plot 1").click()


def test_figures_between_cursors_are_those_of_a_recording(bench: Page, api: httpx.Client) -> None:
    """The same samples, on the scope and recorded: the page and the server work the same figures out."""
    bench.goto("/?d=bench&t=-2s")
    expect(bench.get_by_test_id("link-readout").first).to_contain_text("live")
    asked = {"device": "bench", "channels": ["position.0", "velocity.0"], "rate_hz": 100}
    recording = api.post("/recordings", json=asked).raise_for_status().json()["id"]
    api.post("/devices/bench/axes/0/move", json={"target": 3000, "relative": True}).raise_for_status()
    wait(bench, lambda: not api.get("/devices/bench/axes/0").json()["moving"])
    wait(bench, lambda: api.get(f"/recordings/{recording}").json()["duration_s"] > 3)
    bench.get_by_role("button", name="Pause").click()
    api.post(f"/recordings/{recording}/stop").raise_for_status()
    try:
        bench.get_by_role("button", name="Measuring cursors").click()
        bench.get_by_role("button", name="Figures", exact=True).click()
        detail = api.get(f"/recordings/{recording}").raise_for_status().json()
        begin_s = detail["zero_s"]
        wait(bench, lambda: "c=" in bench.url)
        cursors_from, cursors_to = map(float, parse_qs(urlparse(bench.url).query)["c"][0].split("~"))
        table = bench.get_by_test_id("cursor-table")
        stretch = {"from_s": cursors_from - begin_s, "to_s": cursors_to - begin_s}
        server = api.get(f"/recordings/{recording}/figures", params=stretch).raise_for_status().json()["figures"]
        for channel in ("position.0", "velocity.0"):
            row = table.locator(f"[data-channel='bench:{channel}']")
            expect(row.locator("[data-figure]")).to_have_count(12)
            figures = server[channel]
            assert figures["samples"] > 50
            shown = {
                cell.get_attribute("data-figure"): float(cell.get_attribute("data-value") or "nan")
                for cell in row.locator("[data-figure]").all()
            }
            assert shown["samples"] == figures["samples"]
            assert shown["missing"] == figures["missing"]
            for name, of in (("min", "minimum"), ("max", "maximum"), ("mean", "mean"), ("RMS", "rms")):
                assert shown[name] == pytest.approx(figures[of], rel=1e-9, abs=1e-9), (channel, name)
            assert shown["peak to peak"] == pytest.approx(figures["maximum"] - figures["minimum"])
            assert shown["SD"] == pytest.approx((figures["rms"] ** 2 - figures["mean"] ** 2) ** 0.5, rel=1e-6, abs=1e-3)
    finally:
        api.delete(f"/recordings/{recording}").raise_for_status()


CURSOR_A = """(plot) => [...plot.querySelectorAll('canvas')].some((canvas) => {
    const pixels = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
    const near = (at) => [181, 23, 158].reduce((off, value, of) => off + Math.abs(pixels[at + of] - value), 0) < 60;
    for (let at = 0; at < pixels.length; at += 4) if (near(at)) return true;
    return false;
})"""
"""Whether something of the colour of cursor A is drawn, on light ground."""


def test_cursors_stand_in_plots_of_ones_own_at_once_also_in_a_held_picture(bench: Page) -> None:
    bench.get_by_role("button", name="Channels and plots of your own").click()
    tree = bench.get_by_test_id("channel-tree")
    tree.get_by_label("Find a channel").fill("position")
    line(tree, "bench:position.0").get_by_role("checkbox").check()
    plot = bench.get_by_test_id("free-plot-1")
    expect(plot.locator("[data-path='bench:position.0']")).to_have_text(re.compile(r"\d"))
    bench.get_by_role("button", name="Pause").click()
    cursors = bench.get_by_role("button", name="Measuring cursors")
    for shown in (True, False):
        cursors.click()
        wait(bench, lambda shown=shown: plot.evaluate(CURSOR_A) is shown)


def test_a_stretch_and_its_cursors_are_in_the_address(bench: Page) -> None:
    bench.get_by_role("button", name="Pause").click()
    bench.get_by_role("button", name="Measuring cursors").click()
    wait(bench, lambda: "t=" in bench.url and "c=" in bench.url)
    bench.wait_for_timeout(400)
    said = parse_qs(urlparse(bench.url).query)
    other = bench.context.new_page()
    other.goto(bench.url)
    expect(other.get_by_test_id("scope")).to_have_attribute("data-paused", "true")
    for part in "ct":
        wait(other, lambda part=part: parse_qs(urlparse(other.url).query).get(part) == said[part])
    readout = bench.get_by_test_id("cursor-readout").inner_text()
    wait(other, lambda: other.get_by_test_id("cursor-readout").inner_text() == readout)
    other.get_by_role("button", name="Run").click()
    wait(other, lambda: "~" not in other.url)
    other.close()


def test_what_was_written_is_marked(bench: Page, api: httpx.Client) -> None:
    bench.get_by_role("button", name="Plots and further axes").click()
    bench.get_by_role("checkbox", name="Writes, stops and events as marks").check()
    api.put("/devices/bench/registers/V_MAX", params={"axis": 0}, json={"value": 1234}).raise_for_status()
    expect(bench.get_by_test_id("program-mark")).to_have_text(re.compile(r"v_max 1234 \(", re.IGNORECASE))


def line(tree: Locator, path: str) -> Locator:
    """The line of a channel in the tree."""
    return tree.locator(f"li[data-path='{path}']")


def times_of(data: str | bytes) -> list[float]:
    """The device times of a binary frame [s]; none of a text."""
    if isinstance(data, str):
        return []
    rows = struct.unpack_from("<I", data, 8)[0]
    return list(np.frombuffer(data, "<f8", rows, 24))


def wait(page: Page, condition: object, seconds: float = 30.0) -> None:
    """Until it is so; the page's own events are heard meanwhile."""
    for _ in range(int(seconds / 0.05)):
        if condition():  # type: ignore[operator]
            return
        page.wait_for_timeout(50)
    raise AssertionError(f"not within {seconds:g} s")
