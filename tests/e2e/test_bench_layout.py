"""The bench with few and with many devices: nothing jumps while it loads, what moves and stops is always in sight."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import cycle, islice

import httpx
import pytest
from playwright.sync_api import BrowserContext, Page, ViewportSize, expect
from server_process import ServerProcess

from tests.e2e.conftest import DESKTOP, PHONE
from tests.e2e.motor import wait_for
from tests.e2e.session import a_client, take_the_bench

LAPTOP: ViewportSize = {"width": 1280, "height": 720}
SIZES = {"desktop": DESKTOP, "laptop": LAPTOP, "phone": PHONE}
MODELS = ("tmc5160", "tmc4361", "pd42-1241", "tmc5072", "tmc5031", "tmc5130", "tmc428", "tmc5062", "tmc4210")
CLS_MAX = 0.05
WATCH_SHIFTS = """
window.shifts = [];
new PerformanceObserver((list) => {
  for (const entry of list.getEntries()) {
    if (entry.hadRecentInput) continue;
    const moved = entry.sources.map(({ node, previousRect: from, currentRect: to }) =>
      `${node?.className || node?.nodeName} from ${JSON.stringify(from)} to ${JSON.stringify(to)}`);
    window.shifts.push({ value: entry.value, at_ms: Math.round(entry.startTime), moved });
  }
}).observe({ type: "layout-shift", buffered: true });
"""


@pytest.fixture(scope="module")
def crowd(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ServerProcess]:
    """A server of its own: its devices grow in number. It begins with the demo's bench alone."""
    with ServerProcess(tmp_path_factory.mktemp("crowd"), "--demo") as running:
        with a_client(running.url) as api:
            take_the_bench(api)
            api.delete("/devices/slider").raise_for_status()
        yield running


@pytest.fixture(scope="module", params=[1, 5, 12])
def several(request: pytest.FixtureRequest, crowd: ServerProcess) -> int:
    """So many devices behind that server, all connected."""
    count: int = request.param
    with a_client(crowd.url) as api:
        take_the_bench(api)
        there = api.get("/devices").raise_for_status().json()
        for number, model in enumerate(islice(cycle(MODELS), count - 1), 1):
            if number >= len(there):
                body = {"name": f"device {number}", "model": model, "link": {"kind": "emulator"}}
                api.post("/devices", json=body).raise_for_status()
        wait_for(lambda: connected(api) == count, f"{count} devices are connected")
    return count


def connected(api: httpx.Client) -> int:
    states = [device["state"] for device in api.get("/devices").raise_for_status().json()]
    return states.count("connected")


@pytest.fixture(params=SIZES)
def bench(
    request: pytest.FixtureRequest,
    several: int,
    crowd: ServerProcess,
    new_context: Callable[..., BrowserContext],
) -> Page:
    """The bench page with that many devices, loaded anew at a size, watched from its first moment, and at rest."""
    page = new_context(base_url=crowd.url, viewport=SIZES[request.param]).new_page()
    page.set_default_timeout(
        30_000
    )  # a dozen emulators compute beside the browser: how long it takes is not the question
    page.add_init_script(WATCH_SHIFTS)
    page.goto("/")
    expect(page.locator("[data-testid^=axis-bench-]")).to_have_count(3)
    expect(page.get_by_test_id("link-readout").first).to_contain_text("live")
    page.wait_for_load_state("load")
    # What comes later comes with these: the emulator's stage and the catalog's other models.
    expect(page.get_by_test_id("stage")).to_be_visible()
    page.evaluate("() => new Promise((done) => requestIdleCallback(done, { timeout: 3000 }))")
    return page


def test_nothing_jumps_and_what_moves_and_stops_is_in_sight(bench: Page, several: int) -> None:
    for part in ("stop-all", "motion-card", "position", "move-target", "move-go", "stop-axis"):
        expect(bench.get_by_test_id(part)).to_be_in_viewport(ratio=1)
    covered = bench.evaluate(
        """() => ['move-go', 'stop-axis', 'stop-all'].filter((name) => {
          const part = document.querySelector(`[data-testid="${name}"]`);
          const box = part.getBoundingClientRect();
          return !part.contains(document.elementFromPoint(box.x + box.width / 2, box.y + box.height / 2));
        })"""
    )
    assert covered == [], "nothing lies over them"
    assert bench.evaluate("scrollY") == 0
    shifts = bench.evaluate("window.shifts")
    total = sum(shift["value"] for shift in shifts)
    assert total < CLS_MAX, "\n".join([f"with {several} devices at {bench.viewport_size}", *map(str, shifts)])
