"""A module beside the demo bench, for the pages of modules."""

from __future__ import annotations

import contextlib
import json
from collections.abc import Iterator

import httpx
from playwright.sync_api import BrowserContext, Page


@contextlib.contextmanager
def a_module(api: httpx.Client, name: str = "drive") -> Iterator[str]:
    """Yield the id of a new emulated PD42-1241; it is gone afterwards."""
    body = {"name": name, "model": "pd42-1241", "link": {"kind": "emulator"}}
    made = api.post("/devices", json=body).raise_for_status().json()
    try:
        yield made["id"]
    finally:
        api.delete(f"/devices/{made['id']}")


def select(target: Page | BrowserContext, device: str, axis: int = 0) -> None:
    """Make the page, or all pages of a context, show that device from their first moment on."""
    chosen = json.dumps({"device": device, "axis": axis})
    target.add_init_script(f"localStorage.setItem('stepscope.selection', {json.dumps(chosen)})")
