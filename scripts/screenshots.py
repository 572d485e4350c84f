"""Takes pictures of every page at desktop and phone size, in light and dark: scripts/screenshots.py FOLDER [--url URL].

Without --url it starts a server of its own with the demo bench and a device of each other family, and sets their axes
moving: there is something to see. A server at --url shows the pages of these where it has devices of these names.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import sys
import tempfile
import urllib.request
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Literal

from chromium import chromium_flags, find_chromium
from playwright.sync_api import Browser, ViewportSize, sync_playwright
from server_process import ServerProcess

MODULE, SERVO, TWO_AXES, ONE_AXIS, DRIVER = "module", "servo", "pair", "single", "driver"
PAGES = {
    "bench": ("/", "bench"),
    "registers": ("/registers", "bench"),
    "ramps": ("/ramps", "bench"),
    "velocity": ("/velocity", "bench"),
    "microsteps": ("/microsteps", "bench"),
    "chain": ("/chain", "bench"),
    "module-bench": ("/", MODULE),
    "parameters": ("/parameters", MODULE),
    "encoder": ("/encoder", MODULE),
    "stallguard": ("/stallguard", MODULE),
    "program": ("/program", MODULE),
    "console": ("/console", MODULE),
    "servo-bench": ("/", SERVO),
    "servo-registers": ("/registers", SERVO),
    "sramp": ("/sramp", SERVO),
    "closed-loop": ("/closed-loop", SERVO),
    "filters": ("/filters", SERVO),
    "serial-encoder": ("/serial-encoder", SERVO),
    "driver-sync": ("/driver-sync", SERVO),
    "drive-currents": ("/drive-currents", SERVO),
    "start": ("/start", SERVO),
    "mslut": ("/microsteps", SERVO),
    "pair-bench": ("/", TWO_AXES),
    "pair-registers": ("/registers", TWO_AXES),
    "pair-mslut": ("/microsteps", TWO_AXES),
    "single-bench": ("/", ONE_AXIS),
    "single-registers": ("/registers", ONE_AXIS),
    "sixpoint": ("/sixpoint", ONE_AXIS),
    "currents": ("/currents", ONE_AXIS),
    "single-encoder": ("/encoder", ONE_AXIS),
    "single-stallguard": ("/stallguard", ONE_AXIS),
    "single-console": ("/console", ONE_AXIS),
    "driver-current": ("/driver-current", DRIVER),
    "rotary": ("/rotary", ONE_AXIS),
    "tune": ("/tune", ONE_AXIS),
    "first-run": ("/first-run", ONE_AXIS),
    "bench-rotary": ("/rotary", "bench"),
    "audit": ("/audit", "bench"),
    "health": ("/health", "bench"),
    "together": ("/together", "bench"),
    "recordings": ("/recordings", "bench"),
    "profiles": ("/profiles", "bench"),
    "connections": ("/connections", "bench"),
}
"""Page by name: its path, and the device that it shows."""
SERVO_RAMP = {
    "RAMPMODE": 6,
    "AMAX": 4 * 200_000,
    "DMAX": 4 * 300_000,
    "BOW1": 1_000_000,
    "BOW2": 1_000_000,
    "BOW3": 2_000_000,
    "BOW4": 2_000_000,
    "VMAX": 256 * 60_000,
}
SIXPOINT_RAMP = {
    "CHOPCONF": 0x0001_0153,
    "IHOLD_IRUN": 0x0007_1F0A,
    "A1": 1000,
    "V1": 50_000,
    "AMAX": 500,
    "VMAX": 200_000,
    "DMAX": 700,
    "D1": 1400,
    "VSTOP": 10,
}
SIXPOINT_ENCODER = {"ENCMODE": 1 << 10, "ENC_CONST": 1 << 16 | 2800}
"""Decimal, 1.28 microsteps a count: 40 000 counts of the emulated encoder are a turn of 51 200."""
SIZES: dict[str, ViewportSize] = {
    "desktop": {"width": 1440, "height": 900},
    "laptop": {"width": 1280, "height": 720},
    "phone": {"width": 390, "height": 844},
}
SCHEMES: tuple[Literal["light", "dark"], ...] = ("light", "dark")


@contextlib.contextmanager
def a_server(url: str | None) -> Iterator[str]:
    """Yield the URL of the given server or of one of our own."""
    if url:
        yield url
        return
    with tempfile.TemporaryDirectory() as folder, ServerProcess(Path(folder), "--demo") as server:
        yield server.url


def add_devices(url: str, count: int) -> None:
    """A device of each family that the demo bench lacks, ready to move, and more up to `count` in all."""
    ramps: tuple[tuple[str, str, int, dict[str, int]], ...] = (
        (MODULE, "pd42-1241", 1, {}),
        (SERVO, "tmc4361", 1, SERVO_RAMP),
        (TWO_AXES, "tmc5072", 2, SIXPOINT_RAMP),
        (ONE_AXIS, "tmc5160", 1, SIXPOINT_RAMP | SIXPOINT_ENCODER),
        (DRIVER, "tmc2660", 1, {"DRVCONF": 0x60, "SGCSCONF": 0x10014, "CHOPCONF": 0x101B5}),
    )
    gear = {"microsteps_per_motor_turn": 51_200, "motor_teeth": 3, "driven_teeth": 7}
    for name, model, axes, ramp in ramps:
        _call(f"{url}/api/v1/devices", {"name": name, "model": model, "link": {"kind": "emulator"}})
        for axis in range(axes):
            for register, value in ramp.items():
                _call(f"{url}/api/v1/devices/{name}/registers/{register}?axis={axis}", {"value": value}, "PUT")
    _call(f"{url}/api/v1/devices/{ONE_AXIS}/axes/0/extended-position", {"gear": gear}, "PUT")
    for number in range(len(_call(f"{url}/api/v1/devices")) + 1, count + 1):
        _call(f"{url}/api/v1/devices", {"name": f"axis {number}", "model": "tmc5160", "link": {"kind": "emulator"}})


def shuttle(url: str) -> None:
    """Send every axis of every device back and forth that can be sent somewhere."""
    for device in _call(f"{url}/api/v1/devices"):
        if device["id"] == DRIVER:
            continue
        for axis in device["axes"]:
            address = f"{url}/api/v1/devices/{device['id']}/axes/{axis['index']}"
            here = _call(address)["position"]
            _call(f"{address}/shuttle", {"first": here, "second": here + 20_000 * (1 + axis["index"])})


def _call(url: str, body: dict[str, object] | None = None, method: str | None = None) -> Any:
    data = None if body is None else json.dumps(body).encode()
    request = urllib.request.Request(url, data, {"content-type": "application/json"}, method=method)
    with urllib.request.urlopen(request, timeout=10) as answer:
        return json.load(answer)


def take(browser: Browser, url: str, folder: Path, pages: list[str], sizes: list[str], settle_s: float) -> list[str]:
    """Write FOLDER/page-size-scheme.png for each; return what the consoles said of errors."""
    said: list[str] = []
    for size in sizes:
        viewport = SIZES[size]
        for scheme in SCHEMES:
            context = browser.new_context(viewport=viewport, color_scheme=scheme, base_url=url)
            page = context.new_page()
            page.on("console", lambda message: said.append(message.text) if message.type == "error" else None)
            page.on("pageerror", lambda error: said.append(str(error)))
            for name in pages:
                path, device = PAGES[name]
                page.goto(path)
                page.evaluate(
                    "to => localStorage.setItem('stepscope.selection', JSON.stringify(to))", _selection(device)
                )
                page.goto(path)
                # Not for "networkidle": a page with a live socket and polling is never idle.
                page.wait_for_timeout(settle_s * 1000)
                page.screenshot(path=folder / f"{name}-{size}-{scheme}.png")
            context.close()
    return said


def _selection(device: str) -> dict[str, object]:
    return {"device": device, "axis": 0}


def main() -> int:
    """Take the pictures; 1 when a page complained on its console."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--url", help="a running server; by default one is started")
    parser.add_argument("--page", action="append", choices=PAGES, help="only this page; may be repeated")
    parser.add_argument("--devices", type=int, default=6, metavar="N", help="in all, at least")
    parser.add_argument("--size", action="append", choices=SIZES, help="only this size; may be repeated")
    parser.add_argument("--settle", type=float, default=2.0, metavar="S", help="how long a page may run before [s]")
    arguments = parser.parse_args()
    arguments.folder.mkdir(parents=True, exist_ok=True)
    with a_server(arguments.url) as url, sync_playwright() as playwright:
        if not arguments.url:
            add_devices(url, arguments.devices)
            shuttle(url)
        browser = playwright.chromium.launch(executable_path=find_chromium(), args=chromium_flags())
        said = take(
            browser,
            url,
            arguments.folder,
            arguments.page or list(PAGES),
            arguments.size or list(SIZES),
            arguments.settle,
        )
        browser.close()
    for line in dict.fromkeys(said):
        print(f"console: {line}", file=sys.stderr)
    return 1 if said else 0


if __name__ == "__main__":
    sys.exit(main())
