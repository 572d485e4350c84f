"""What a browser that has never been here fetches before it shows the bench."""

from __future__ import annotations

from chromium import chromium_flags, find_chromium
from playwright.sync_api import Request, sync_playwright

from tests.bench.serving import demo_server
from tests.bench.table import Row

LIMIT_KB = 250.0
KINDS = ("script", "stylesheet")


def measure(*, quick: bool) -> Row:
    """Add up script and style of the first page as they come over the wire, until it is live. `quick` is no shorter."""
    del quick
    fetched: list[Request] = []
    with demo_server() as (server, _, _), sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=find_chromium(), args=chromium_flags())
        page = browser.new_page(viewport={"width": 1440, "height": 900}, base_url=server.url)
        page.on("requestfinished", lambda request: fetched.append(request))
        page.goto("/")
        page.get_by_test_id("link-readout").first.get_by_text("live").wait_for()
        page.wait_for_timeout(500)  # what is fetched last is on its way when the samples come
        files = {request.url: request for request in fetched if request.resource_type in KINDS}
        sizes = {url: request.sizes()["responseBodySize"] for url, request in files.items()}
        browser.close()
    total_kb = sum(sizes.values()) / 1000
    largest = sorted(sizes.items(), key=lambda item: -item[1])[:4]
    return Row(
        what="script and style that a cold browser fetches for the first page",
        measured=f"{total_kb:.0f} kB",
        peer=f"{len(sizes)} files",
        ratio=LIMIT_KB / total_kb,
        required=f"< {LIMIT_KB:g} kB gzip",
        ok=total_kb < LIMIT_KB,
        notes=(", ".join(f"{url.rpartition('/')[2]} {size / 1000:.0f} kB" for url, size in largest),),
    )
