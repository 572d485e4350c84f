"""Whether a view comes again by Reload, by Back, by its copied link in another browser, and in a second tab."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import httpx
from chromium import chromium_flags, find_chromium
from playwright.sync_api import BrowserContext, Page, sync_playwright

from tests.bench.serving import demo_server
from tests.bench.table import Row
from tests.e2e.views import shown

VIEWS = 40
SIZE: Any = {"width": 1440, "height": 900}


def measure(*, quick: bool) -> Row:
    """Look at 40 views of the demo in four ways each; every fifth of them where it is `quick`."""
    missed: list[str] = []
    with demo_server() as (server, api, _), sync_playwright() as playwright:
        views = addresses(api)[:: 5 if quick else 1]
        browser = playwright.chromium.launch(executable_path=find_chromium(), args=chromium_flags())

        def fresh() -> BrowserContext:
            return browser.new_context(viewport=SIZE, base_url=server.url, reduced_motion="reduce")

        first = fresh()
        page, second = first.new_page(), first.new_page()
        for address in views:
            page.goto(address)
            view = shown(page)
            other = fresh()
            stranger = other.new_page()
            ways: dict[str, tuple[Page, Callable[[], object]]] = {
                "Reload": (page, page.reload),
                "Back": (page, lambda: away_and_back(page)),
                "a link": (stranger, lambda: stranger.goto(page.url)),  # noqa: B023 - called in this turn
                "a second tab": (second, lambda: second.goto(page.url)),
            }
            for way, (where, go) in ways.items():
                go()
                if shown(where) != view:
                    missed.append(f"{address} by {way}")
            other.close()
        browser.close()
    tried, again = 4 * len(views), 4 * len(views) - len(missed)
    return Row(
        what=f"{len(views)} views again by Reload, Back, a link in another browser, a second tab",
        measured=f"{again} of {tried}",
        peer="all",
        ratio=again / tried,
        required="the same view, each time",
        ok=not missed,
        notes=tuple(missed[:5]),
    )


def away_and_back(page: Page) -> None:
    page.get_by_role("navigation", name="Pages").get_by_role("link", name="Health").click()
    page.get_by_role("heading", level=1, name="Health").wait_for(state="attached")
    page.go_back()


def addresses(api: httpx.Client) -> list[str]:
    """Address 40 views of the demo: its pages, axes, searches, tabs, and stretches of a recording."""
    recording = recorded(api)
    pages = ("registers", "console", "rotary", "microsteps", "ramps", "chain", "velocity")
    views = [f"/{page}?d=bench&a={axis}" for page in pages for axis in (1, 2)]
    views += [f"/?d=bench&a={axis}&tab={tab}" for axis in (1, 2) for tab in ("together", "reference")]
    views += [f"/?d=slider&t=-{span}s&rows={rows}" for span in (0.5, 2, 20) for rows in ("position", "velocity,load")]
    views += [f"/registers?d=bench&find={find}&axes=all" for find in ("max", "v%20m", "a_max", "nothing", "0x")]
    views += [f"/registers?d=bench&reg=0/{name}&tab=changes" for name in ("a_max", "v_max", "x_target")]
    views += [f"/recordings/{recording}?d=bench&t={stretch}" for stretch in ("0.1~0.4", "0.2~0.25", "-0.1~0.9")]
    views += [f"/recordings/{recording}?d=bench&hide=position", "/audit?d=bench&find=x_target&outcome=done"]
    views += ["/audit?d=bench&span=hour&device=bench", "/profiles?d=slider", "/together?d=bench&a=1"]
    assert len(views) == VIEWS, len(views)
    return views


def recorded(api: httpx.Client) -> str:
    """Record a move of the demo's first axis. Returns its id."""
    body = {"device": "bench", "channels": ["position.0", "velocity.0"], "rate_hz": 200.0, "duration_s": 1.0}
    recording: str = api.post("/recordings", json=body).raise_for_status().json()["id"]
    target = {"target": 4000, "relative": True, "unit": "microsteps"}
    api.post("/devices/bench/axes/0/move", json=target).raise_for_status()
    deadline_s = time.monotonic() + 20
    while api.get(f"/recordings/{recording}/info").raise_for_status().json()["state"] != "done":
        if time.monotonic() > deadline_s:
            raise TimeoutError(f"the recording {recording} does not end")
        time.sleep(0.05)
    return recording
