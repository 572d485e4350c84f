"""What a page shows, as far as its address holds it: to compare a view with the same one come by another way."""

from __future__ import annotations

from typing import Any

from playwright.sync_api import Page

SHOWN = """() => {
    const main = document.querySelector("#main");
    const texts = (selector, read) => [...main.querySelectorAll(selector)].map(read);
    const words = (each) => each.textContent.trim();
    if (document.querySelector("[aria-label='Loading the page'], [aria-busy=true]")) return null;
    const picker = document.querySelector("input[aria-label='Device and axis']");
    if (!picker?.value || !document.querySelector("#main h1")) return null;
    return {
        title: document.title,
        axis: picker.value,
        searched: texts("search input", (each) => each.value),
        lists: texts("search select", (each) => each.value),
        tabs: texts("[role=tab][aria-selected=true]", words),
        choices: texts(".mantine-SegmentedControl-root input:checked", (each) => each.value),
        headings: texts("h1", words),
        current: texts("[aria-current=true], tr[aria-selected=true], [data-row][data-selected=true]", words).length,
        switches: texts("input[role=switch]", (each) => each.checked),
        pressed: texts("fieldset[aria-label='Channels shown'] [aria-pressed=false]", words),
        range: texts("[data-testid=range]", words),
        plots: texts("[data-testid^=scope] canvas", () => 1).length,
    };
}"""


def shown(page: Page, patience_ms: float = 15_000) -> dict[str, Any]:
    """What `page` shows when that has stood still for a third of a second: longer than a typed text takes to settle."""
    before, since_ms, waited_ms, step_ms = None, 0.0, 0.0, 70.0
    while waited_ms < patience_ms:
        now: dict[str, Any] | None = page.evaluate(SHOWN)
        since_ms = since_ms + step_ms if now is not None and now == before else 0.0
        if now is not None and since_ms >= 350.0:
            return now
        before = now
        page.wait_for_timeout(step_ms)
        waited_ms += step_ms
    raise AssertionError(f"{page.url} does not come to rest: {before}")
