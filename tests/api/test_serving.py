"""`stepscope serve` and `stepscope emulate` as a user starts them: their own processes."""

from __future__ import annotations

import asyncio
import json
import signal
import socket
import time
from pathlib import Path

import httpx
import pytest

from app.clock import WallClock
from app.emulators.build import build_emulator
from app.emulators.server import serve_tcp
from app.emulators.tmc428.options import EmulatorPatch
from app.links import datagram32
from app.main import create_app
from app.settings import Settings
from tests.api.live import live_server
from tests.api.processes import address, running

SOON_S = 12.0
"""It takes 0.6 s alone on a machine; tests share theirs with others. What would hold it up here takes 30 s."""


def test_it_prints_the_url_when_it_is_ready_and_ends_soon_after_ctrl_c(tmp_path: Path) -> None:
    with (
        running("emulate", "tmc428", "--tcp", "127.0.0.1:0") as (_, listening),
        running("serve", "--port", "0", "--data-dir", str(tmp_path)) as (server, line),
        httpx.Client(base_url=f"{address(line)}/api/v1/") as api,
    ):
        # A chip that outlives the server: what it does after Ctrl-C is what a real one would do.
        port = int(listening.rpartition(":")[2].split()[0])
        link = {"kind": "tcp", "host": "127.0.0.1", "port": port}
        assert api.post("devices", json={"name": "far", "model": "tmc428", "link": link}).json()["state"] == "connected"
        for name, value in (("v_max", 100), ("a_max", 10)):
            api.put(f"devices/far/registers/{name}?axis=1", json={"value": value}).raise_for_status()
        fields = {"pulse_div": 5, "ramp_div": 5}
        api.put("devices/far/registers/pulse_div_ramp_div_usrs?axis=1", json={"fields": fields}).raise_for_status()
        api.post("devices/far/axes/1/rotate", json={"velocity": 50, "unit": "chip"}).raise_for_status()
        with socket.create_connection(("127.0.0.1", port), timeout=5) as chip:

            def v_actual() -> int:
                chip.sendall(datagram32.read(0x15))
                return int.from_bytes(chip.recv(4)[1:], "big")

            until_s = time.monotonic() + 20
            while v_actual() != 50 and time.monotonic() < until_s:
                time.sleep(0.01)
            assert v_actual() == 50
            asked_s = time.monotonic()
            server.send_signal(signal.SIGINT)
            assert server.wait(20) == 0
            assert time.monotonic() - asked_s < SOON_S
            until_s = time.monotonic() + 10
            while v_actual() and time.monotonic() < until_s:
                time.sleep(0.01)
            assert v_actual() == 0, "the motor was stopped before the server went"
        assert json.loads((tmp_path / "connections.json").read_text())["connections"][0]["name"] == "far"


def test_open_sockets_do_not_hold_up_the_end(tmp_path: Path) -> None:
    from websockets.sync.client import connect

    with running("serve", "--port", "0", "--data-dir", str(tmp_path)) as (server, line):
        url = address(line).replace("http", "ws", 1)
        with connect(f"{url}/api/v1/devices/bench/telemetry?channels=position.0&rate_hz=1000") as reader:
            assert json.loads(reader.recv())["type"] == "start"
            asked_s = time.monotonic()
            server.send_signal(signal.SIGTERM)
            assert server.wait(20) in (0, -signal.SIGTERM)
            assert time.monotonic() - asked_s < SOON_S


async def test_no_stop_waits_until_its_route_is_built(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    app = create_app(Settings(data_dir=tmp_path, demo=False))

    def late(*_: object, **__: object) -> None:
        raise AssertionError("a route is built while a request waits")

    monkeypatch.setattr("fastapi.routing.get_dependant", late)
    async with httpx.AsyncClient(transport=httpx.ASGITransport(app), base_url="http://127.0.0.1:8000/api/v1/") as api:
        assert (await api.post("stop")).status_code == 200
        assert (await api.post("devices/nobody/axes/0/stop")).status_code == 404


async def test_a_silent_device_does_not_hold_up_the_end(tmp_path: Path) -> None:
    chip = build_emulator("tmc428", WallClock())
    server = await serve_tcp(chip, "127.0.0.1", 0)
    port = server.sockets[0].getsockname()[1]
    async with live_server(tmp_path, demo=False) as url, httpx.AsyncClient(base_url=f"{url}/api/v1/") as api:
        link = {"kind": "tcp", "host": "127.0.0.1", "port": port, "timeout_s": 30.0}
        added = await api.post("devices", json={"name": "far", "model": "tmc428", "link": link})
        assert added.json()["state"] == "connected"
        chip.patch(EmulatorPatch.model_validate({"faults": {"silence": True}}))
        asked_s = time.monotonic()
    assert time.monotonic() - asked_s < SOON_S
    server.close()
    await server.wait_closed()


@pytest.mark.parametrize("options", [(), ("--v-actual-writable", "velocity-mode")])
async def test_an_emulated_chip_stops_dead_in_velocity_mode_where_that_was_asked_for(options: tuple[str, ...]) -> None:
    with running("emulate", "tmc428", "--tcp", "127.0.0.1:0", *options) as (process, line):
        reader, writer = await asyncio.open_connection("127.0.0.1", int(line.rpartition(":")[2].split()[0]))

        async def ask(frame: bytes) -> int:
            writer.write(frame)
            return int.from_bytes((await reader.readexactly(4))[1:], "big")

        # dividers, no stops and velocity mode, v_max, a_max, v_target: it turns at once
        for address, data in ((0xC, 5 << 12), (0xA, 0x302), (3, 1000), (6, 2047), (4, 1000)):
            await ask(datagram32.write(address, data))
        while await ask(datagram32.read(5)) != 1000:
            pass
        # from here on braking would take an hour
        for address, data in ((0xC, 5 << 12 | 13 << 8), (6, 1), (4, 0), (5, 0)):
            await ask(datagram32.write(address, data))
        velocity = await ask(datagram32.read(5))
        assert velocity == 0 if options else velocity > 900
        writer.close()
        await writer.wait_closed()
        process.send_signal(signal.SIGINT)
        assert process.wait(20) == 0


async def test_an_emulated_chip_answers_any_client() -> None:
    with running("emulate", "tmc4210", "--tcp", "127.0.0.1:0", "--seed", "7", "--clock-hz", "32e6") as (process, line):
        port = int(line.rpartition(":")[2].split()[0])
        reader, writer = await asyncio.open_connection("127.0.0.1", port)
        writer.write(datagram32.read(0x39))
        assert (await reader.readexactly(4))[1:] == bytes.fromhex("429101")
        writer.close()
        await writer.wait_closed()
        process.send_signal(signal.SIGINT)
        assert process.wait(20) == 0
