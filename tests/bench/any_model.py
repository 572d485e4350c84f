"""From "Add a device" to a parameter on the scope, for models drawn at random, in a browser: how long it took."""

from __future__ import annotations

import random
import time
from collections.abc import Sequence

from chromium import chromium_flags, find_chromium
from playwright.sync_api import sync_playwright

from app.registers import catalog
from tests.bench.serving import demo_server
from tests.bench.table import Row
from tests.e2e.session import a_client, begin_with_the_bench, take_the_bench
from tests.e2e.way_to_scope import way_to_the_scope

LONGEST_S = 60.0
OF_EACH = {"chip": 5, "module": 5}


def measure(quick: bool) -> Sequence[Row]:
    """Ten models, two where `quick`, of a seed that is told, so that the same can be drawn again."""
    seed = random.SystemRandom().randrange(1 << 32)
    draw = random.Random(seed)
    titles = [
        title
        for kind, count in OF_EACH.items()
        for title in draw.sample(
            [model.title for model in catalog.listings() if model.kind == kind], 1 if quick else count
        )
    ]
    took_s: dict[str, float] = {}
    said: list[str] = []
    with demo_server() as (server, _, _), a_client(server.url) as api, sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=find_chromium(), args=chromium_flags())
        context = browser.new_context(viewport={"width": 1440, "height": 900}, base_url=server.url)
        begin_with_the_bench(context)
        take_the_bench(api)
        for title in titles:
            page = context.new_page()
            page.goto("/")
            page.get_by_role("link", name="Connections").first.wait_for()
            began_s = time.monotonic()
            readout = way_to_the_scope(page, title, title.lower(), LONGEST_S)
            took_s[title] = time.monotonic() - began_s
            said.append(f"{title} {took_s[title]:.1f} s, {readout}")
            page.close()
        browser.close()
    longest_s = max(took_s.values())
    return [
        Row(
            what='from "Add" to a parameter on the scope',
            measured=f"{longest_s:.1f} s",
            peer=f"{LONGEST_S:g} s",
            ratio=longest_s / LONGEST_S,
            required="below 1",
            ok=longest_s < LONGEST_S,
            notes=(f"{len(titles)} models of seed {seed}, the longest counts: {'; '.join(said)}",),
        )
    ]
