"""The bench full: 12 panels, 24 channels of three devices at 1 kHz in 12 plots; its frames and its keys.

The peer of the frames, in the same run: canvases of the same sizes with nothing else on the page, as many lines of as
many points stroked on each in each frame, while the same telemetry comes in and is not even looked at.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
from chromium import chromium_flags, find_chromium
from playwright.sync_api import Page, sync_playwright
from server_process import ServerProcess

from tests.bench.browser import REQUIRED_FPS, idle_fps
from tests.bench.serving import demo_server, start_all
from tests.bench.table import Row

PANELS = 12
PLOTS = 12
IN_SCOPE = 4
CHANNELS = 24
RATE_HZ = 1000
PROTOCOL = "stepscope.telemetry.v1"
KEY_LIMIT_MS = 50.0
LOADED_S = 5.0
# The page asks for the frames and counts them itself, however late it is called.
FRAMES = """(seconds) => new Promise((resolve) => {
    const times = [];
    requestAnimationFrame(function next(nowMs) {
        times.push(nowMs);
        if (nowMs - times[0] < seconds * 1000) requestAnimationFrame(next);
        else resolve(times);
    });
})"""
# From a key on a plot to the end of the frame that shows its cursor elsewhere, painting included.
KEY = """async () => {
    const plot = document.activeElement;
    const beganMs = performance.now();
    plot.dispatchEvent(new KeyboardEvent('keydown', { key: 'ArrowRight', bubbles: true, cancelable: true }));
    await new Promise((done) => requestAnimationFrame(done));
    await new Promise((done) => {
        const { port1, port2 } = new MessageChannel();
        port1.onmessage = done;
        port2.postMessage(0);
    });
    return performance.now() - beganMs;
}"""

BOXES = """() => [...document.querySelectorAll('.uplot canvas')]
    .map((canvas) => canvas.getBoundingClientRect())
    .filter(({ width, height }) => width > 0 && height > 0)
    .map(({ left, top, width, height }) => ({ left, top, width, height }))"""
BARE = """({ boxes, urls, protocol, lines, pointsPerPixel }) => {
    document.body.replaceChildren();
    let frames = 0;
    for (const url of urls) {
        const socket = new WebSocket(url, protocol);
        socket.binaryType = 'arraybuffer';
        socket.onmessage = () => { frames += 1; };
    }
    const drawn = boxes.map(({ left, top, width, height }) => {
        const canvas = document.body.appendChild(document.createElement('canvas'));
        canvas.width = width;
        canvas.height = height;
        canvas.style.cssText = `position: fixed; left: ${left}px; top: ${top}px`;
        return canvas.getContext('2d');
    });
    requestAnimationFrame(function next(nowMs) {
        for (const ctx of drawn) {
            const { width, height } = ctx.canvas;
            ctx.clearRect(0, 0, width, height);
            for (let line = 0; line < lines; line++) {
                ctx.beginPath();
                for (let point = 0; point < width * pointsPerPixel; point++) {
                    const phase = (point / pointsPerPixel + nowMs / 20) / 60 + line;
                    ctx.lineTo(point / pointsPerPixel, height * (0.5 + 0.4 * Math.sin(phase)));
                }
                ctx.stroke();
            }
        }
        requestAnimationFrame(next);
    });
    window.framesCome = () => frames;
}"""
LINES, POINTS_PER_PIXEL = 2, 2
# Each drawing of a plot begins with an empty canvas.
COUNT = """() => {
    const { clearRect } = CanvasRenderingContext2D.prototype;
    window.plotsDrawn = 0;
    CanvasRenderingContext2D.prototype.clearRect = function (...box) {
        window.plotsDrawn += 1;
        return clearRect.apply(this, box);
    };
}"""


@dataclass(frozen=True)
class Bench:
    """A page with the bench full, and what it shows of what."""

    server: ServerProcess
    page: Page
    blank_fps: float
    about: str
    whole: bool
    telemetry: list[str]
    """Addresses of what the page is sent, one a device."""


@contextmanager
def full_bench() -> Iterator[Bench]:
    """12 panels in a browser, 24 channels of three devices at 1 kHz, every axis moving."""
    with demo_server() as (server, api, _), sync_playwright() as playwright:
        chip = {"name": "third", "model": "tmc5160", "link": {"kind": "emulator"}, "start_up": True}
        api.post("/devices", json=chip).raise_for_status()
        devices = api.get("/devices").raise_for_status().json()
        layout = api.post("/layouts", json={"document": _layout(_channels(devices))}).raise_for_status().json()["id"]
        start_all(api, devices)
        browser = playwright.chromium.launch(executable_path=find_chromium(), args=chromium_flags())
        page = browser.new_page(viewport={"width": 1440, "height": 900}, base_url=server.url)
        blank_fps = idle_fps(page)
        page.goto(f"/?layout={layout}&d=bench")
        page.get_by_test_id(f"free-plot-{IN_SCOPE}").wait_for()
        page.locator("[data-path]").nth(CHANNELS - 1).wait_for()
        time.sleep(LOADED_S)
        panels = page.locator("[data-panel]:visible").count()
        drawn = len(set(page.locator("[data-path]").evaluate_all("all => all.map((each) => each.dataset.path)")))
        about = f"{panels} panels, {drawn} channels of {len(devices)} devices at {RATE_HZ} Hz"
        telemetry = _telemetry(server.url, _channels(devices))
        yield Bench(server, page, blank_fps, about, panels == PANELS and drawn == CHANNELS, telemetry)
        browser.close()


def measure(*, quick: bool) -> list[Row]:
    seconds, keys = (5.0, 40) if quick else (20.0, 200)
    with full_bench() as bench:
        bench.page.evaluate(COUNT)
        times_ms = np.array(bench.page.evaluate(FRAMES, seconds))
        drawn = bench.page.evaluate("plotsDrawn")
        key_ms = _keys(bench.page, keys)
        bare_fps = _bare_fps(bench, seconds)
    about, blank_fps = bench.about, bench.blank_fps
    gaps_ms = np.diff(times_ms)
    fps = 1000.0 / float(gaps_ms.mean())
    drawn_hz = drawn / PLOTS * 1000.0 / (times_ms[-1] - times_ms[0])
    p95_ms = float(np.percentile(key_ms, 95))
    return [
        Row(
            what=f"{about}: frames",
            measured=f"{fps:.1f} frames/s",
            peer=f"bare canvases {bare_fps:.1f} frames/s, an empty page {blank_fps:.1f}",
            ratio=fps / REQUIRED_FPS,
            required=f">= {REQUIRED_FPS:g} frames/s",
            ok=fps >= REQUIRED_FPS and bench.whole,
            notes=(
                f"{len(gaps_ms)} frames, 99 % within {float(np.percentile(gaps_ms, 99)):.0f} ms",
                f"each plot is drawn {drawn_hz:.0f} times a second",
            ),
        ),
        Row(
            what=f"{about}: a key to its paint, p95",
            measured=f"{p95_ms:.1f} ms",
            peer=f"limit {KEY_LIMIT_MS:g} ms",
            ratio=KEY_LIMIT_MS / p95_ms,
            required=f"< {KEY_LIMIT_MS:g} ms",
            ok=p95_ms < KEY_LIMIT_MS and bench.whole,
            notes=(f"{len(key_ms)} keys, the slowest {max(key_ms):.1f} ms",),
        ),
    ]


def _telemetry(url: str, paths: list[str]) -> list[str]:
    by_device: dict[str, list[str]] = {}
    for path in paths:
        device, _, channel = path.partition(":")
        by_device.setdefault(device, []).append(channel)
    root = url.replace("http", "ws", 1)
    return [
        f"{root}/api/v1/devices/{device}/telemetry?channels={','.join(channels)}&rate_hz={RATE_HZ}"
        for device, channels in by_device.items()
    ]


def _bare_fps(bench: Bench, seconds: float) -> float:
    """Frames of canvases alone, as many and as large as those of the bench, while the same telemetry comes in."""
    boxes = bench.page.evaluate(BOXES)
    bench.page.goto("/api/v1/health")
    asked = {"boxes": boxes, "urls": bench.telemetry, "lines": LINES, "pointsPerPixel": POINTS_PER_PIXEL}
    bench.page.evaluate(BARE, {**asked, "protocol": PROTOCOL})
    bench.page.wait_for_function("framesCome() > 100")
    return 1000.0 / float(np.diff(bench.page.evaluate(FRAMES, seconds)).mean())


def _channels(devices: list[dict[str, Any]]) -> list[str]:
    """As many of each device, those that move first."""
    each = CHANNELS // len(devices)
    return [
        f"{device['id']}:{channel['name']}"
        for device in devices
        for channel in sorted(device["channels"], key=lambda channel: not _moves(channel["quantity"]))[:each]
    ]


def _layout(channels: list[str]) -> dict[str, Any]:
    """Motion, axes, stage, a scope with four plots; four plots over time and four XY plots in panels of their own."""
    plots = len(channels) // 2
    pairs = [channels[number::plots] for number in range(plots)]
    free = [{"id": str(number + 1), "kind": "time", "y": pair} for number, pair in enumerate(pairs[:IN_SCOPE])]
    configs: dict[str, dict[str, Any]] = {
        **{name: {} for name in ("motion", "axes", "stage")},
        "scope": {"scope": {"rateHz": RATE_HZ, "spanS": 10, "rows": [], "free": free}},
        **{f"residual{number}": {"y": pair} for number, pair in enumerate(pairs[IN_SCOPE : 2 * IN_SCOPE])},
        **{f"xy{number}": {"y": pair} for number, pair in enumerate(pairs[2 * IN_SCOPE :])},
    }
    columns = [
        [name for name in configs if name.startswith(start)] for start in (("motion", "axes"), ("residual",), ("xy",))
    ]
    side, timed, crossed = [[{"tabs": [name]} for name in column] for column in columns]
    middle = [{"tabs": ["stage"], "size": "content"}, {"tabs": ["scope"]}]
    row = [{"col": side, "size": "300px"}, {"col": middle, "size": 2}, {"col": timed, "size": 1}]
    row += [{"col": crossed, "size": 1}]
    return {
        "format": "stepscope.layout",
        "version": 1,
        "id": "full",
        "name": "Full",
        "revision": 0,
        "screens": {"desktop": {"row": row}, "phone": [*configs]},
        "panels": {
            name: {"type": name.rstrip("0123456789"), "v": 1, "at": "$", "config": config}
            for name, config in configs.items()
        },
    }


def _moves(quantity: str) -> bool:
    return quantity in (
        "position",
        "velocity",
        "target_position",
        "predicted_position",
        "predicted_velocity",
        "residual",
    )


def _keys(page: Page, count: int) -> list[float]:
    page.get_by_role("img", name="Plot 1: ").focus()
    return [page.evaluate(KEY) for _ in range(count)]
