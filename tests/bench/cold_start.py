"""From `pip install` of the wheel in an empty environment to a page that lives and a motor that moves, cold and later.

Cold is without anything that a start leaves for the next: no data directory, no machine code. The same with an
installation that nobody may write to, whose machine code goes to the user's cache, and with one without byte code.

What a later start takes is told beside what our libraries and our page take alone on this machine, in the same minutes:
after each one, a server of nothing else is started by the same means (bare_server.py).
"""

from __future__ import annotations

import os
import shutil
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from statistics import median

import httpx
from chromium import chromium_flags, find_chromium
from playwright.sync_api import Error as PageError
from playwright.sync_api import Page, sync_playwright
from server_process import free_port

from tests.bench.table import Row
from tests.installation import answers, install, move, running, server, until, wheel

PAGE_WITHIN_S, MOVING_WITHIN_S, LATER_WITHIN_S = 5.0, 10.0, 3.0
BARE_STARTS = 2.0
"""A later start may take 3 s, or as long as so many of what our libraries and our page take alone: on a machine of two
cores that is half as fast at times, 3 s say more about its neighbours than about us."""
WITHOUT_BYTE_CODE_WITHIN_S = 10.0
"""Python itself compiles 1,900 modules then, 2 s more of a core."""
LATER_STARTS = 3
BARE = Path(__file__).parent / "bare_server.py"
COMPILED_WITHIN_S = 600.0
MOVED: dict[str, tuple[str, dict[str, int]]] = {
    "tmc428": ("move", {"target": 500}),
    "tmc4361": ("move", {"target": 500}),
    "tmc5160": ("move", {"target": 5000}),
    "tmc2209": ("rotate", {"velocity": 2000}),
    "pd42-1241": ("move", {"target": 5000}),
}
"""A model of each family, and what moves it: its device is added to a server that has just started."""


@dataclass(frozen=True)
class Start:
    """How long after its command a server's page was live, and its first motor had moved [s]."""

    page_s: float
    moving_s: float
    bare_s: float = 0.0
    """The same of a bare start right after it, until the page showed something [s]; 0 where none was made."""


def measure(quick: bool) -> Sequence[Row]:
    """`quick` leaves out the starts from machine code on disk, which is a minute or two in the making."""
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        place = Path(folder)
        built = wheel(place / "wheels")
        began_s = time.perf_counter()
        install(built, place / "venv")
        installed_s = time.perf_counter() - began_s
        page = playwright.chromium.launch(executable_path=find_chromium(), args=chromium_flags()).new_page()
        rows = []
        for what, read_only, byte_code, page_within_s in (
            ("pip install", False, True, PAGE_WITHIN_S),
            ("read-only installation", True, True, PAGE_WITHIN_S),
            ("without byte code, as uv installs", False, False, WITHOUT_BYTE_CODE_WITHIN_S),
        ):
            forget_caches(place / "venv", byte_code)
            first, *later = starts(place, page, read_only, 1 + LATER_STARTS if byte_code and not quick else 1)
            rows.append(row(f"{what}, first start: page live", first.page_s, page_within_s))
            rows.append(row(f"{what}, first start: a motor moves", first.moving_s, MOVING_WITHIN_S))
            if later:
                rows.append(later_row(f"{what}, later start: page live", later))
        for model, command in MOVED.items():
            forget_caches(place / "venv", byte_code=True)
            rows.append(
                row(f"first start: an emulated {model} moves", first_motion_s(place, model, *command), MOVING_WITHIN_S)
            )
    beside = os.getloadavg()[1] - 1.0
    told = f"pip took {installed_s:.0f} s before; some {max(beside, 0.0):.1f} other processes wanted the cores"
    return [*rows[:-1], replace(rows[-1], notes=(told,))]


def row(what: str, seconds: float, limit_s: float) -> Row:
    """One figure against its limit."""
    return Row(what, f"{seconds:.2f} s", f"limit {limit_s:.3g} s", limit_s / seconds, ">= 1", seconds < limit_s)


def later_row(what: str, later: Sequence[Start]) -> Row:
    """The median of them against the limit: 3 s, or twice that of the bare starts where the machine is so slow."""
    page_s, bare_s = median(one.page_s for one in later), median(one.bare_s for one in later)
    limit_s = max(LATER_WITHIN_S, BARE_STARTS * bare_s)
    told = f"median of {len(later)}; bare libraries with the page: {bare_s:.2f} s, of which {BARE_STARTS:g} are allowed"
    return replace(row(what, page_s, limit_s), notes=(told,))


def forget_caches(venv: Path, byte_code: bool) -> None:
    """As pip left it, or without the byte code that it makes."""
    for folder in list(venv.rglob("__pycache__")):
        if byte_code:
            for kept in (*folder.glob("*.nb?"), *folder.glob("*.compiled")):
                kept.unlink()
        else:
            shutil.rmtree(folder)


def starts(place: Path, page: Page, read_only: bool, count: int) -> Iterator[Start]:
    """A user's first start, and further ones once all is compiled."""
    home = Path(tempfile.mkdtemp(dir=place))
    for number in range(count):
        with server(place / "venv", home, read_only) as (url, began_s):
            until(lambda: live(page, url))
            page_s = time.perf_counter() - began_s
            page.goto("about:blank")
            with httpx.Client(base_url=f"{url}/api/v1/", timeout=30) as api:
                move(api)
                moving_s = time.perf_counter() - began_s
                if count > 1 and number == 0:  # it looks what is there once the page has had its time
                    until(lambda: api.get("health/details").json()["compiling"] is not None)
                    until(lambda: api.get("health/details").json()["compiling"] is None, COMPILED_WITHIN_S)
        yield Start(page_s, moving_s, bare_start_s(place, page, home) if number else 0.0)


def bare_start_s(place: Path, page: Page, home: Path) -> float:
    """From the command of a server of nothing but our libraries and our page until a browser shows the page [s]."""
    port = free_port()
    with running([str(place / "venv/bin/python"), str(BARE), str(port)], home) as began_s:
        until(lambda: shown(page, f"http://127.0.0.1:{port}"))
        page_s = time.perf_counter() - began_s
        page.goto("about:blank")
    return page_s


def first_motion_s(place: Path, model: str, how: str, body: dict[str, int]) -> float:
    """From the server's command to the first step of a device of that model, which is added by hand [s]."""
    home = Path(tempfile.mkdtemp(dir=place))
    with server(place / "venv", home) as (url, began_s), httpx.Client(base_url=f"{url}/api/v1/", timeout=60) as api:
        until(lambda: answers(url))
        api.post("devices", json={"name": "mine", "model": model, "link": {"kind": "emulator"}}).raise_for_status()
        api.post("devices/mine/start-up", json={"axes": [0]}).raise_for_status()
        api.post(f"devices/mine/axes/0/{how}", json=body).raise_for_status()
        until(lambda: api.get("devices/mine/axes/0").raise_for_status().json()["position"])
        return time.perf_counter() - began_s


def shown(page: Page, url: str) -> bool:
    """Whether the browser shows anything of the page."""
    try:
        page.goto(url, timeout=20_000)
        page.locator("#root > *").first.wait_for(state="attached", timeout=20_000)  # styles come first
    except PageError:
        return False
    return True


def live(page: Page, url: str) -> bool:
    """Whether the browser shows samples of the demo bench."""
    try:
        page.goto(url, timeout=20_000)
        page.get_by_test_id("link-readout").first.get_by_text("live").wait_for(timeout=20_000)
    except PageError:
        return False
    return True
