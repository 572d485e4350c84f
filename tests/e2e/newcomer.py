"""Somebody who has never been here: an empty data directory, a fresh browser, the demo, and a motor that moves."""

from __future__ import annotations

import re
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from playwright.sync_api import Browser, Page, expect
from server_process import ServerProcess

CLICKS_AT_MOST = 3
WITHIN_S = 10.0
FAR = 1000
"""What nobody takes for a twitch [microsteps]."""
PATIENCE_S = 60.0
COUNT = "window.clicks = 0; addEventListener('click', (event) => { clicks += event.isTrusted ? 1 : 0 }, true)"
MOVED = f"""() => {{
    const number = (channel) => {{
        const text = document.querySelector(`[data-channel="${{channel}}"]`)?.innerText ?? '';
        return /\\d/.test(text) ? Number(text.replace('\\u2212', '-').replace(/[^\\d.-]/g, '')) : NaN;
    }};
    const moved = Math.abs(number('position.0')) > {FAR} && !isNaN(number('predicted_position.0'));
    return moved ? number('residual.0') : null;
}}"""
"""The residual that the scope shows of the first axis, once that is far from where it began and has a prediction."""
GOES_BACK = MOVED.replace(f"> {FAR}", f"> {FAR} && number('velocity.0') > 0")
"""The same on the way from the lower end, to which it goes first."""


@dataclass(frozen=True)
class Newcomer:
    """What it took from the command that starts the server, and what the scope showed then."""

    clicks: int
    page_s: float
    """Until the page was live [s]."""
    moved_s: float
    """Until the motor was `FAR` away, with its prediction on top [s]."""
    residual: float
    """Between measured and predicted position [microsteps]."""


def arrive(browser: Browser, folder: Path, look: Callable[[Page], object] | None = None) -> Newcomer:
    """Start a server on the empty `folder`, open its page, and do what that says; `look` at it on the way back."""
    began_s = time.perf_counter()
    with ServerProcess(folder) as server:
        context = browser.new_context(base_url=server.url, viewport={"width": 1440, "height": 900})
        try:
            context.add_init_script(COUNT)
            page = context.new_page()
            page.goto("/")
            expect(page.get_by_test_id("link-readout").first).to_contain_text("live", timeout=PATIENCE_S * 1000)
            page_s = time.perf_counter() - began_s
            page.get_by_role("button", name="Start demo motion").click()
            residual = until(page, MOVED)
            moved_s = time.perf_counter() - began_s
            _both_are_drawn(page)
            if look is not None:
                until(page, GOES_BACK)
                look(page)
            return Newcomer(page.evaluate("clicks"), page_s, moved_s, abs(residual))
        finally:
            context.close()


def until(page: Page, look: str) -> float:
    """What `look` finds as soon as that is something. The page's own policy has no room for Playwright's wait."""
    end_s = time.monotonic() + PATIENCE_S
    while (found := page.evaluate(look)) is None:
        assert time.monotonic() < end_s, look
        page.wait_for_timeout(20)
    return float(found)


def _both_are_drawn(page: Page) -> None:
    plot = page.locator('[data-row="position"]')
    for name in ("position", "predicted"):
        expect(plot.get_by_role("button", name=re.compile(f"^{name}"))).to_have_attribute("aria-pressed", "true")
