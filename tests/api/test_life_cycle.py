"""What becomes of a motor that moves when the server ends, dies, comes back, or loses it: docs/safety.md, held to it.

The chip is an emulator in a process of its own, which outlives each server as a real one would.
"""

from __future__ import annotations

import signal
import socket
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import httpx
import pytest
from fastapi import FastAPI

from app.clock import VirtualClock
from app.devices.core.found_moving import FoundMoving
from app.links import datagram32
from app.main import bench_of
from tests.api.processes import address, running

DEADLINE_S = 60.0
AXIS = 1
X_ACTUAL, V_ACTUAL = 0x11, 0x15
"""Of axis 1 (DS-TMC428 8.1)."""
X_ACTUAL_0 = 0x01


@dataclass
class FarChip:
    """The emulator behind its TCP port, asked past every server."""

    port: int

    def word(self, address: int) -> int:
        with socket.create_connection(("127.0.0.1", self.port), timeout=10) as line:
            line.sendall(datagram32.read(address))
            return int.from_bytes(line.recv(4)[1:], "big")

    @property
    def velocity(self) -> int:
        return self.word(V_ACTUAL)

    @property
    def position(self) -> int:
        return self.word(X_ACTUAL)


def until(met: Callable[[], bool], what: str) -> None:
    end_s = time.monotonic() + DEADLINE_S
    while not met():
        assert time.monotonic() < end_s, what
        time.sleep(0.02)


@pytest.fixture(scope="module")
def chip() -> Iterator[FarChip]:
    with running("emulate", "tmc428", "--tcp", "127.0.0.1:0") as (_, line):
        yield FarChip(int(line.rpartition(":")[2].split()[0]))


@contextmanager
def serving(data_dir: Path) -> Iterator[tuple[Any, httpx.Client]]:
    """The server's process, and its API."""
    with (
        running("serve", "--port", "0", "--no-demo", "--data-dir", str(data_dir)) as (server, line),
        httpx.Client(base_url=f"{address(line)}/api/v1/", timeout=20) as api,
    ):
        yield server, api


def set_up(api: httpx.Client, chip: FarChip) -> None:
    link = {"kind": "tcp", "host": "127.0.0.1", "port": chip.port}
    assert api.post("devices", json={"name": "far", "model": "tmc428", "link": link}).json()["state"] == "connected"
    wanted = {"chip": "tmc428", "a_max": 10, "ramp_div": 5, "pulse_div": 5}
    slope = api.post("calc/pmul-pdiv", json=wanted).json()
    writes: list[dict[str, Any]] = []
    for axis in (0, AXIS):
        writes += [
            {"name": "pulse_div_ramp_div_usrs", "axis": axis, "fields": {"pulse_div": 5, "ramp_div": 5}},
            {"name": "v_max", "axis": axis, "value": 100},
            {"name": "a_max", "axis": axis, "value": 10},
            {"name": "pmul_pdiv", "axis": axis, "fields": {"pmul": slope["pmul"], "pdiv": slope["pdiv"]}},
        ]
    assert api.post("devices/far/registers", json={"writes": writes}).json()["failed"] is None


def turn(api: httpx.Client, chip: FarChip, **headers: str) -> None:
    api.post(f"devices/far/axes/{AXIS}/rotate", json={"velocity": 50, "unit": "chip"}, headers=headers)
    until(lambda: chip.velocity == 50, "it turns")


def saved(data_dir: Path) -> bool:
    file = data_dir / "connections.json"
    return file.exists() and '"far"' in file.read_text()


@pytest.fixture
def _hangs_up() -> Iterator[None]:
    """A program under `nohup` hands on that nobody hears of the terminal's end; a server would rightly go on then."""
    before = signal.signal(signal.SIGHUP, signal.SIG_DFL)
    yield
    signal.signal(signal.SIGHUP, before)


@pytest.mark.timeout(300)
@pytest.mark.usefixtures("_hangs_up")
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_a_server_that_is_ended_ramps_its_motors_down(chip: FarChip, tmp_path: Path, number: signal.Signals) -> None:
    with serving(tmp_path) as (server, api):
        set_up(api, chip)
        # Of somebody who has the bench and keeps it: the end of the server is nobody's change.
        session = {"stepscope-session": "session-of-anna-0001"}
        api.post("lease", json={"name": "Anna"}, headers=session).raise_for_status()
        turn(api, chip, **session)
        server.send_signal(number)
        assert server.wait(DEADLINE_S) in (0, -number)
    until(lambda: chip.velocity == 0, "it was told to stop before the server went")


@pytest.mark.timeout(300)  # 10 s when nobody else is busy
def test_a_server_that_is_killed_stops_nothing_and_comes_back_knowing(chip: FarChip, tmp_path: Path) -> None:
    with serving(tmp_path) as (server, api):
        set_up(api, chip)
        turn(api, chip)
        target = api.post("devices/far/axes/0/move", json={"target": 3000, "relative": True}).json()["target_position"]
        until(lambda: saved(tmp_path), "the connection is on the disk")
        server.kill()
        server.wait(DEADLINE_S)
    before = chip.position
    until(lambda: chip.position != before, "a rotation goes on and on")
    assert chip.velocity == 50
    until(lambda: chip.word(X_ACTUAL_0) == target & 0xFFFFFF, "a move arrives")
    assert chip.velocity == 50

    with serving(tmp_path) as (_, api):

        def far() -> dict[str, Any]:
            device: dict[str, Any] = api.get("devices/far").json()
            return device

        until(lambda: bool(far()["notes"]), "it says so")
        (note,) = far()["notes"]
        assert note.startswith("axis 1 was already moving when stepscope connected")
        assert api.get(f"devices/far/axes/{AXIS}").json()["moving"]
        assert chip.velocity == 50  # knowing of it changes nothing
        assert all(result["ok"] for result in api.post("stop").json()["results"])
        until(lambda: chip.velocity == 0, "a stop works on it")
        assert far()["notes"] == []


async def test_what_moved_while_the_link_was_away_is_told(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    axis = "devices/bench/axes/1"

    async def notes() -> list[str]:
        found: list[str] = (await client.get("devices/bench")).json()["notes"]
        return found

    await client.post(f"{axis}/rotate", json={"velocity": 1000})
    await client.patch("devices/bench/emulator", json={"faults": {"unplugged": True}})
    for _ in range(10):
        await clock.advance(0.25)
    assert (await client.get("devices/bench")).json()["state"] == "failed"
    assert (await client.post(f"{axis}/stop")).status_code == 409
    await client.patch("devices/bench/emulator", json={"faults": {"unplugged": False}})
    for _ in range(10):
        await clock.advance(0.25)
    assert (await client.get(axis)).json()["moving"]  # nobody could tell it anything
    (note,) = await notes()
    assert note.startswith("axis 1 kept moving while the link was away")
    await client.post(f"{axis}/stop")
    assert await notes() == []


async def test_a_note_goes_when_the_motor_has_come_to_rest(
    app: FastAPI, client: httpx.AsyncClient, clock: VirtualClock
) -> None:
    started = (await client.post("devices/bench/axes/0/move", json={"target": 3000})).json()
    device = bench_of(app).manager.get("bench")
    device.session.motion_commands[0] = 0  # as for a server that has just come up
    device.session.set_state("connecting")
    device.session.set_state("connected")
    await clock.advance(0.01)
    assert list(device.notes) == ["axis 0 was already moving when stepscope connected; a stop ends it"]
    for _ in range(20):
        await clock.advance(0.25)
    assert (await client.get("devices/bench/axes/0")).json()["position"] == started["target_position"]
    assert not device.notes


async def test_a_device_that_is_removed_is_looked_at_no_more(app: FastAPI, clock: VirtualClock) -> None:
    bench = bench_of(app)
    found = FoundMoving(clock)
    device = bench.manager.get("bench")
    found.sync([device])
    await device.motion.rotate(0, 1000)
    device.session.set_state("connecting")
    device.session.set_state("connected")
    await clock.advance(0.01)
    assert device.notes
    found.sync([])
    assert not device.notes
    await found.close()
