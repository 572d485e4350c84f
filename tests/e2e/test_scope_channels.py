"""Samples on their way to the scope: one socket a device, whatever the page shows of it."""

from __future__ import annotations

import re
import struct
from collections.abc import Iterator
from urllib.parse import parse_qs, urlparse

import httpx
import numpy as np
import pytest
from playwright.sync_api import Page, WebSocket, expect


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


def times_of(data: str | bytes) -> list[float]:
    """The device times of a binary frame [s]; none of a text."""
    if isinstance(data, str):
        return []
    rows = struct.unpack_from("<I", data, 8)[0]
    return list(np.frombuffer(data, "<f8", rows, 24))


def wait(page: Page, condition: object, seconds: float = 10.0) -> None:
    """Until it is so; the page's own events are heard meanwhile."""
    for _ in range(int(seconds / 0.05)):
        if condition():  # type: ignore[operator]
            return
        page.wait_for_timeout(50)
    raise AssertionError(f"not within {seconds:g} s")
