"""The scope full: 12 plots of the user's own with 24 channels of three devices at 1 kHz, its frames and its keys."""

from __future__ import annotations

import json
import time
from typing import Any

import numpy as np
from chromium import chromium_flags, find_chromium
from playwright.sync_api import Page, sync_playwright

from tests.bench.browser import REQUIRED_FPS, idle_fps
from tests.bench.serving import demo_server, start_all
from tests.bench.table import Row

PLOTS = 12
CHANNELS = 24
RATE_HZ = 1000
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


def measure(*, quick: bool) -> list[Row]:
    seconds, keys = (5.0, 40) if quick else (20.0, 200)
    with demo_server() as (server, api, _), sync_playwright() as playwright:
        chip = {"name": "third", "model": "tmc5160", "link": {"kind": "emulator"}}
        api.post("/devices", json=chip).raise_for_status()
        devices = api.get("/devices").raise_for_status().json()
        settings = _settings(devices)
        start_all(api, [device for device in devices if device["demo"]])
        browser = playwright.chromium.launch(executable_path=find_chromium(), args=chromium_flags())
        page = browser.new_page(viewport={"width": 1440, "height": 900}, base_url=server.url)
        blank_fps = idle_fps(page)
        page.add_init_script(
            f"if (location.protocol !== 'about:') localStorage['stepscope.scope'] = {json.dumps(settings)}"
        )
        page.goto("/?d=bench")
        page.get_by_test_id(f"free-plot-{PLOTS}").wait_for()
        time.sleep(LOADED_S)
        times_ms = np.array(page.evaluate(FRAMES, seconds))
        key_ms = _keys(page, keys)
        drawn = page.locator("[data-path]").count()
        browser.close()
    gaps_ms = np.diff(times_ms)
    fps = 1000.0 / float(gaps_ms.mean())
    p95_ms = float(np.percentile(key_ms, 95))
    about = f"{PLOTS} plots, {drawn} channels of {len(devices)} devices at {RATE_HZ} Hz"
    return [
        Row(
            what=f"{about}: frames",
            measured=f"{fps:.1f} frames/s",
            peer=f"empty page {blank_fps:.1f} frames/s",
            ratio=fps / REQUIRED_FPS,
            required=f">= {REQUIRED_FPS:g} frames/s",
            ok=fps >= REQUIRED_FPS and drawn == CHANNELS,
            notes=(f"{len(gaps_ms)} frames, 99 % within {float(np.percentile(gaps_ms, 99)):.0f} ms",),
        ),
        Row(
            what=f"{about}: a key to its paint, p95",
            measured=f"{p95_ms:.1f} ms",
            peer=f"limit {KEY_LIMIT_MS:g} ms",
            ratio=KEY_LIMIT_MS / p95_ms,
            required=f"< {KEY_LIMIT_MS:g} ms",
            ok=p95_ms < KEY_LIMIT_MS and drawn == CHANNELS,
            notes=(f"{len(key_ms)} keys, the slowest {max(key_ms):.1f} ms",),
        ),
    ]


def _settings(devices: list[dict[str, Any]]) -> str:
    """Two channels a plot, those that move first, from each device in turn."""
    offered = [
        [f"{device['id']}:{channel['name']}" for channel in device["channels"] if _moves(channel["quantity"])]
        for device in devices
    ]
    each = CHANNELS // len(devices)
    chosen = [path for paths in offered for path in (paths * each)[:each]]
    free = [{"id": str(number + 1), "kind": "time", "y": chosen[number::PLOTS]} for number in range(PLOTS)]
    return json.dumps({"rateHz": RATE_HZ, "spanS": 10, "rows": [], "free": free})


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
