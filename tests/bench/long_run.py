"""A day of operation in fast-forward, with telemetry and a recording on: is memory flat, does every file close?

Two emulated devices run `TIME_SCALE` times as fast as they would: a TMC428 that shuttles, and a TMC4210 that turns all
day under the service of extended positions. (Chips whose motors are physics may run at most 20 times as fast.) A
reader follows the telemetry of both as a browser does, one recording of each runs from beginning to end, and now and
then somebody lists registers, reads the audit log and makes a short recording. Memory is the server's resident set;
what it is after its start-up hours and at the end is compared.
"""

from __future__ import annotations

import json
import os
import statistics
import tempfile
import threading
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import httpx
from server_process import ServerProcess
from websockets.sync.client import connect
from websockets.typing import Subprotocol

from app.client.stream import SUBPROTOCOL
from app.telemetry.frames import decode
from tests.bench.table import Row

TIME_SCALE = 250.0
DAY_S = 86_400.0
QUICK_S = 3_600.0
SETTLED = 0.25
"""The share of the day after which what is kept for a while (the history of ten minutes) has its size."""
GROWTH_MAX = 0.03
DESCRIPTORS_MAX = 4
RATE_HZ = 500.0
"""On the wall clock: two samples a second of the devices, which live so much faster [Hz]."""
POLL_PERIOD_S = 1.0
CHANNELS = ("position.0", "velocity.0", "target_position.0", "residual.0")
DEVICES = {"shuttle": "tmc428", "turning": "tmc4210"}


@dataclass
class Reader:
    """Somebody who watches a device: how far its time has come [s], and what was lost on the way."""

    url: str
    first_s: float = float("nan")
    now_s: float = float("nan")
    rows: int = 0
    dropped: int = 0
    ended: str = ""
    stopping: threading.Event = field(default_factory=threading.Event)

    @property
    def seconds(self) -> float:
        """Device time that has gone by [s]; 0 before the first sample."""
        return self.now_s - self.first_s if self.rows else 0.0

    def run(self) -> None:
        try:
            with connect(self.url, subprotocols=[Subprotocol(SUBPROTOCOL)], max_size=None) as socket:
                while not self.stopping.is_set():
                    message = socket.recv()
                    if isinstance(message, str):
                        if json.loads(message)["type"] == "problem":
                            self.ended = message
                            return
                        continue
                    frame = decode(message)
                    if len(frame.time_s):
                        self.first_s = float(frame.time_s[0]) if not self.rows else self.first_s
                        self.now_s = float(frame.time_s[-1])
                        self.rows += len(frame.time_s)
                        self.dropped = frame.dropped
        except Exception as error:  # whatever it is, the reader sees no more
            self.ended = repr(error)


def measure(quick: bool) -> Sequence[Row]:
    wanted_s = QUICK_S if quick else DAY_S
    looks: list[tuple[float, int, int]] = []
    with (
        tempfile.TemporaryDirectory(prefix="stepscope-") as folder,
        ServerProcess(Path(folder), "--no-demo") as server,
        httpx.Client(base_url=f"{server.url}/api/v1", timeout=60) as api,
    ):
        for name, model in DEVICES.items():
            link = {"kind": "emulator", "time_scale": TIME_SCALE}
            _send(api, "POST", "/devices", {"name": name, "model": model, "link": link})
            body = {"device": name, "channels": CHANNELS, "rate_hz": RATE_HZ, "name": "the whole day"}
            _send(api, "POST", "/recordings", body)
        _set_in_motion(api)
        readers = [
            Reader(
                f"{server.url.replace('http', 'ws')}/api/v1/devices/{name}/telemetry"
                f"?channels={','.join(CHANNELS)}&rate_hz={RATE_HZ:g}"
            )
            for name in DEVICES
        ]
        threads = [threading.Thread(target=reader.run, daemon=True) for reader in readers]
        for thread in threads:
            thread.start()
        began_s = time.monotonic()
        while (done_s := min(reader.seconds for reader in readers)) < wanted_s:
            if any(reader.ended for reader in readers) or time.monotonic() - began_s > 10 * wanted_s / TIME_SCALE + 120:
                break
            _as_a_user(api, turn=len(looks))
            looks.append((done_s, _resident_bytes(server.pid), len(os.listdir(f"/proc/{server.pid}/fd"))))
            time.sleep(POLL_PERIOD_S)
        took_s = time.monotonic() - began_s
        moving = [api.get(f"/devices/{name}/axes/0").raise_for_status().json() for name in DEVICES]
        for reader in readers:
            reader.stopping.set()
        for thread in threads:
            thread.join(10)
        api.post("/stop")
        kept_bytes = sum(path.stat().st_size for path in Path(folder).rglob("*") if path.is_file())
        log = server.log()
    return [_row(wanted_s, done_s, took_s, looks, readers, moving, kept_bytes, log)]


def _set_in_motion(api: httpx.Client) -> None:
    for name, chip in DEVICES.items():
        ramp = {"a_max": 100, "ramp_div": 6, "pulse_div": 6}
        found = api.post("/calc/pmul-pdiv", json={"chip": chip, **ramp}).raise_for_status().json()
        pmul = found["pmul" if chip == "tmc428" else "p_mul"]  # the sheets count it from 0 and from 128
        wanted = {**ramp, "pmul": pmul, "pdiv": found["pdiv"], "v_min": 1, "v_max": 1000}
        writes = [{"name": register, "axis": 0, "value": value} for register, value in wanted.items()]
        done = _send(api, "POST", f"/devices/{name}/registers", {"writes": writes})
        if done["failed"] is not None:
            raise RuntimeError(f"{name} does not take its ramp: {done}")
    shuttle = {"first": 0, "second": 2_000_000, "dwell_s": 0.0}
    _send(api, "POST", "/devices/shuttle/axes/0/shuttle", shuttle)
    _send(api, "PUT", "/devices/turning/axes/0/extended-position", {"actual": 0})
    _send(api, "POST", "/devices/turning/axes/0/rotate", {"velocity": 3_500})


def _send(api: httpx.Client, method: str, path: str, body: object) -> Any:
    answer = api.request(method, path, json=body)
    if answer.is_error:
        raise RuntimeError(f"{method} {path}: {answer.text}")
    return answer.json()


def _as_a_user(api: httpx.Client, turn: int) -> None:
    """What somebody does who has the page open all day."""
    for name in DEVICES:
        api.get(f"/devices/{name}/axes/0").raise_for_status()
        api.get(f"/devices/{name}/registers", params={"axis": 0}).raise_for_status()
    api.get("/audit", params={"limit": 50})
    if turn % 20 == 10:
        body = {"device": "shuttle", "channels": ["position.0"], "rate_hz": RATE_HZ, "duration_s": 60.0}
        recording = api.post("/recordings", json=body).raise_for_status().json()["id"]
        api.get(f"/recordings/{recording}").raise_for_status()


def _resident_bytes(pid: int) -> int:
    return int(Path(f"/proc/{pid}/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def _row(
    wanted_s: float,
    done_s: float,
    took_s: float,
    looks: Sequence[tuple[float, int, int]],
    readers: Sequence[Reader],
    moving: Sequence[dict[str, object]],
    kept_bytes: int,
    log: str,
) -> Row:
    settled = [look for look in looks if look[0] >= SETTLED * wanted_s]
    half = len(settled) // 2
    early, late = (
        [statistics.median(look[what] for look in part) for what in (1, 2)] for part in (settled[:half], settled[half:])
    )
    growth = late[0] / early[0] - 1
    more_files = late[1] - early[1]
    troubles = [reader.ended for reader in readers if reader.ended]
    troubles += [line for line in log.splitlines() if "Traceback" in line]
    troubles += [f"axis {index} stands" for index, axis in enumerate(moving) if not axis["moving"]]
    return Row(
        what=f"{done_s / 3600:.1f} h of operation in fast-forward, telemetry and recordings on",
        measured=f"{growth:+.1%} memory, {more_files:+.0f} files",
        peer=f"{early[0] / 1e6:.0f} MB after {SETTLED:.0%} of it",
        ratio=late[0] / early[0],
        required=f"<= {1 + GROWTH_MAX:g}",
        ok=growth <= GROWTH_MAX and more_files <= DESCRIPTORS_MAX and done_s >= wanted_s and not troubles,
        notes=(
            f"{took_s:.0f} s on the wall clock, {kept_bytes / 1e6:.0f} MB kept on disk",
            f"{sum(one.rows for one in readers):,} rows seen, {sum(one.dropped for one in readers):,} dropped",
            *troubles,
        ),
    )
