"""An emulated TMC5xxx for the browser tests of its pages: made over REST, set up, turned and loaded by a test."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import httpx
from playwright.sync_api import BrowserContext, Page

from tests.e2e.motor import wait_for


class Chip:
    """One axis of an emulated chip, by REST: to arrange, and to look behind the page."""

    def __init__(self, api: httpx.Client, device: str, axis: int = 0) -> None:
        self.api = api
        self.device = device
        self.number = axis

    def axis(self) -> dict[str, Any]:
        state: dict[str, Any] = self.api.get(f"/devices/{self.device}/axes/{self.number}").raise_for_status().json()
        return state

    def register(self, name: str) -> dict[str, Any]:
        """A register as it is read; one that cannot be read as the driver knows it."""
        known = self.api.get(f"/devices/{self.device}/registers", params={"axis": self.number, "kept": True})
        found: dict[str, Any] = next(each for each in known.raise_for_status().json() if each["name"] == name)
        return found

    def write(self, name: str, value: int | None = None, **fields: int) -> None:
        body = {"value": value} if value is not None else {"fields": fields}
        path = f"/devices/{self.device}/registers/{name}"
        self.api.put(path, params={"axis": self.number}, json=body).raise_for_status()

    def emulator(self, **change: Any) -> dict[str, Any]:
        """Change what is around the chip: `axes` for the motor's load, or faults."""
        answer = self.api.patch(f"/devices/{self.device}/emulator", json=change).raise_for_status()
        state: dict[str, Any] = answer.json()
        return state

    def call(self, what: str, **body: Any) -> None:
        self.api.post(f"/devices/{self.device}/axes/{self.number}/{what}", json=body).raise_for_status()

    def stop(self) -> None:
        self.call("stop", mode="ramp")
        wait_for(lambda: not self.axis()["moving"], "the motor stands")


RAMP = {"A1": 20_000, "V1": 50_000, "AMAX": 10_000, "DMAX": 10_000, "D1": 20_000, "VSTOP": 10, "VMAX": 100_000}
"""A second to 95 000 pps and less."""


def set_up(chip: Chip) -> None:
    """Current, chopper and a ramp: the motor can turn."""
    chip.write("CHOPCONF", toff=3, hstrt=4, hend=1, tbl=2)
    chip.write("IHOLD_IRUN", IHOLD=8, IRUN=31, IHOLDDELAY=4)
    for name, value in RAMP.items():
        chip.write(name, value)


@contextmanager
def a_chip(api: httpx.Client, name: str, model: str = "tmc5160", axis: int = 0, **options: Any) -> Iterator[Chip]:
    """Add an emulated chip as it comes out of a reset, and take it away again: the other tests count the devices.

    options : of its emulator
    """
    body = {"name": name, "model": model, "link": {"kind": "emulator", **options}}
    device = api.post("/devices", json=body).raise_for_status().json()["id"]
    try:
        wait_for(
            lambda: api.get(f"/devices/{device}").raise_for_status().json()["state"] == "connected", "it is connected"
        )
        yield Chip(api, device, axis)
    finally:
        api.post("/stop")
        api.delete(f"/devices/{device}").raise_for_status()


def select(target: Page | BrowserContext, chip: Chip) -> None:
    """Let the pages show this axis, as if it had been picked."""
    stored = json.dumps({"device": chip.device, "axis": chip.number})
    target.add_init_script(
        f"if (location.protocol !== 'about:') localStorage.setItem('stepscope.selection', {json.dumps(stored)})"
    )
