"""An emulated TMC4361 for the browser tests of its pages: made over REST, loaded and looked behind."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import httpx

from tests.e2e.motor import wait_for

COUNTS = 40_000
"""Counts a turn of the emulated encoder: 10 000 lines."""


class Loop:
    """One emulated chip, by REST: to arrange, and to look behind the page."""

    def __init__(self, api: httpx.Client, device: str) -> None:
        self.api = api
        self.device = device

    def call(self, method: str, path: str, body: dict[str, Any] | None = None) -> Any:
        answer = self.api.request(method, f"/devices/{self.device}/{path}", json=body)
        return answer.raise_for_status().json()

    def register(self, name: str) -> int:
        path = f"/devices/{self.device}/registers/{name}"
        return int(self.api.get(path, params={"axis": 0}).raise_for_status().json()["value"])

    def write(self, name: str, value: int) -> None:
        path = f"/devices/{self.device}/registers/{name}"
        self.api.put(path, params={"axis": 0}, json={"value": value}).raise_for_status()

    def axis(self) -> dict[str, Any]:
        state: dict[str, Any] = self.call("GET", "axes/0")
        return state

    def stop(self) -> None:
        self.call("POST", "axes/0/stop", {"mode": "ramp"})
        wait_for(lambda: not self.axis()["moving"], "the motor stands")

    def with_encoder(self) -> None:
        """Tell the chip of its encoder, and of ramps that a motor can follow."""
        self.write("ENC_IN_RES", COUNTS)
        for name, value in (("VMAX", 100_000 * 256), ("AMAX", 1_000_000 * 4), ("DMAX", 1_000_000 * 4), ("RAMPMODE", 4)):
            self.write(name, value)


@contextmanager
def a_loop(api: httpx.Client, name: str, **link: object) -> Iterator[Loop]:
    """Add a chip, and take it away again: the other tests count the devices."""
    body = {"name": name, "model": "tmc4361", "link": {"kind": "emulator", **link}}
    made = api.post("/devices", json=body).raise_for_status().json()
    try:
        wait_for(lambda: api.get(f"/devices/{made['id']}").json()["state"] == "connected", "it is connected")
        yield Loop(api, made["id"])
    finally:
        api.delete(f"/devices/{made['id']}")
