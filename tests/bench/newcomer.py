"""From the command of a server with an empty data directory to a motor that moves, by a newcomer's clicks."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path

from chromium import chromium_flags, find_chromium
from playwright.sync_api import sync_playwright

from tests.bench.table import Row
from tests.e2e.newcomer import CLICKS_AT_MOST, WITHIN_S, arrive


def measure(quick: bool) -> Sequence[Row]:
    """The slowest of three, each in a browser and a directory of its own; `quick` makes it one."""
    met = []
    with sync_playwright() as playwright:
        for _ in range(1 if quick else 3):
            browser = playwright.chromium.launch(executable_path=find_chromium(), args=chromium_flags())
            with tempfile.TemporaryDirectory() as folder:
                met.append(arrive(browser, Path(folder) / "data"))
            browser.close()
    slowest = max(met, key=lambda one: one.moved_s)
    return [
        Row(
            what="demo: empty data directory to a motor that moves, prediction on top",
            measured=f"{slowest.moved_s:.1f} s, {slowest.clicks} clicks",
            peer=f"limit {WITHIN_S:g} s, {CLICKS_AT_MOST} clicks",
            ratio=WITHIN_S / slowest.moved_s,
            required=">= 1",
            ok=slowest.moved_s <= WITHIN_S and slowest.clicks <= CLICKS_AT_MOST,
            notes=(
                f"slowest of {len(met)}, from the command; page live after {slowest.page_s:.1f} s",
                f"the prediction is off by {slowest.residual:g} microsteps",
            ),
        )
    ]
