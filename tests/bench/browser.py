"""Four live plots in headless Chromium: the UI's own page for it, /bench/plots, counts its frames."""

from __future__ import annotations

import json
import time
from typing import Any

from chromium import chromium_flags, find_chromium
from playwright.sync_api import Page, sync_playwright

from tests.bench.serving import demo_server
from tests.bench.table import Row

REQUIRED_FPS = 55.0


def measure(*, quick: bool) -> Row:
    seconds = 5.0 if quick else 20.0
    with demo_server() as (server, _, _), sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=find_chromium(), args=chromium_flags())
        page = browser.new_page(viewport={"width": 1440, "height": 900}, base_url=server.url)
        blank_fps = idle_fps(page)
        page.goto("/bench/plots")
        page.get_by_test_id("plot-speed").wait_for()
        time.sleep(3.0)  # loading and compiling are over
        before = _figures(page)
        time.sleep(seconds)
        figures = _figures(page)
        browser.close()
    fps = (figures["frames"] - before["frames"]) * 1000.0 / (figures["atMs"] - before["atMs"])
    return Row(
        what="4 plots x 3 series x 20,000 points in headless Chromium",
        measured=f"{fps:.1f} frames/s",
        peer=f"empty page {blank_fps:.1f} frames/s",
        ratio=fps / REQUIRED_FPS,
        required=f">= {REQUIRED_FPS:g} frames/s",
        ok=fps >= REQUIRED_FPS,
        notes=(f"script {figures['scriptMs']:.1f} ms a frame, {figures['frames'] - before['frames']} frames",),
    )


def _figures(page: Page) -> dict[str, Any]:
    said = page.get_by_test_id("plot-speed").get_attribute("data-figures")
    figures: dict[str, Any] | None = json.loads(said or "null")
    if figures is None:
        raise RuntimeError("the page has drawn too few frames to tell a rate")
    return figures


def idle_fps(page: Page) -> float:
    page.goto("about:blank")
    rate: float = page.evaluate(
        """() => new Promise((resolve) => {
            let frames = 0, startMs;
            requestAnimationFrame(function next(nowMs) {
                startMs ??= nowMs;
                frames += 1;
                if (nowMs - startMs < 1000) requestAnimationFrame(next);
                else resolve((frames - 1) * 1000 / (nowMs - startMs));
            });
        })"""
    )
    return rate
