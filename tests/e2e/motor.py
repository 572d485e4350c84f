"""An emulated PD42-1241 for the browser tests of its pages: made over REST, turned and loaded as a test wants it."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import httpx
from playwright.sync_api import BrowserContext, Locator, Page, expect

TURN = 200 * 256
"""Microsteps of a turn, as the module is delivered."""


class Motor:
    """One emulated module, by REST: to arrange, and to look behind the page."""

    def __init__(self, api: httpx.Client, device: str) -> None:
        self.api = api
        self.device = device

    def axis(self) -> dict[str, Any]:
        state: dict[str, Any] = self.api.get(f"/devices/{self.device}/axes/0").raise_for_status().json()
        return state

    def call(self, method: str, path: str, body: dict[str, Any]) -> Any:
        return self.api.request(method, f"/devices/{self.device}/{path}", json=body).raise_for_status().json()

    def parameter(self, name: str) -> int:
        reading = self.api.get(f"/devices/{self.device}/registers/{name}", params={"axis": 0}).raise_for_status().json()
        return int(reading["value"])

    def write(self, name: str, value: int) -> None:
        path = f"/devices/{self.device}/registers/{name}"
        self.api.put(path, params={"axis": 0}, json={"value": value}).raise_for_status()

    def emulator(self, **change: Any) -> dict[str, Any]:
        state: dict[str, Any] = self.call("PATCH", "emulator", change)
        return state

    def rotate(self, turns_per_s: float) -> None:
        self.call("POST", "axes/0/rotate", {"velocity": turns_per_s * TURN, "unit": "pps"})

    def stop(self) -> None:
        self.call("POST", "axes/0/stop", {"mode": "ramp"})
        wait_for(lambda: not self.axis()["moving"], "the motor stands")

    def reasons(self) -> list[str]:
        """Why its last motions ended, newest first."""
        stops = self.api.get(f"/devices/{self.device}/axes/0/stops").raise_for_status().json()
        return [stop["reason"] for stop in stops]


@contextmanager
def a_motor(api: httpx.Client, name: str, **options: object) -> Iterator[Motor]:
    """Add a module with these options of its emulator, and take it away again: the other tests count the devices."""
    body = {"name": name, "model": "pd42-1241", "link": {"kind": "emulator", **options}}
    device = api.post("/devices", json=body).raise_for_status().json()["id"]
    motor = Motor(api, device)
    try:
        wait_for(
            lambda: api.get(f"/devices/{device}").raise_for_status().json()["state"] == "connected", "it is connected"
        )
        motor.write("maximum_acceleration", 10 * TURN)  # as delivered it takes seconds to any speed
        yield motor
    finally:
        api.post("/stop")
        api.delete(f"/devices/{device}").raise_for_status()


def wait_for(condition: Callable[[], bool], what: str, seconds: float = 30.0) -> None:
    """The server lives in real time, and so does its motor: look again until it is so."""
    until_s = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < until_s, f"not within {seconds:g} s: {what}"
        time.sleep(0.02)


def press(button: Locator) -> None:
    """Press it with the keyboard, as soon as it can be: Playwright waits for that only with a click."""
    expect(button).to_be_enabled()
    button.press("Enter")


def whole_run(page: Page, motor: Motor, button: str) -> list[float]:
    """Press `button` and wait until the run that it begins is done; velocities that were seen meanwhile [pps].

    A page that a busy machine keeps from its beat for 1.5 s loses the motor, as it should: then the server answers 409,
    and the run is begun anew, twice at most.
    """
    note = page.get_by_test_id("run-note")
    speeds: list[float] = []

    def over() -> bool:
        speeds.append(motor.axis()["velocity_pps"])
        return note.get_attribute("data-phase") != "running"

    for last in (False, False, True):
        speeds.clear()
        page.get_by_test_id(button).click()
        expect(note).to_have_attribute("data-phase", "running")
        wait_for(over, "it ends by itself", 30.0)
        wait_for(lambda: not motor.axis()["moving"], "at rest")
        if note.get_attribute("data-phase") == "done" or last:
            break
    expect(note).to_have_attribute("data-phase", "done")
    return speeds


def select(target: Page | BrowserContext, motor: Motor) -> None:
    """Let the pages show this motor, as if it had been picked."""
    stored = json.dumps({"device": motor.device, "axis": 0})
    script = f"localStorage.setItem('stepscope.selection', {json.dumps(stored)})"
    target.add_init_script(f"if (location.protocol !== 'about:') {script}")
