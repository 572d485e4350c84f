"""What the 3D twin costs: the server and the process that draws, at full rate, and nothing when it is off."""

from __future__ import annotations

import tempfile
import threading
import time
from collections.abc import Callable, Sequence
from pathlib import Path

import httpx
import viser
from server_process import ServerProcess
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect
from websockets.sync.connection import Connection
from websockets.typing import Subprotocol

from tests.bench.serving import cpu_seconds
from tests.bench.table import Row

UPDATES_MAX = 30.0
UPDATES_LEAST = 25.0
SERVER_LIMIT, CHILD_LIMIT, OFF_LIMIT = 0.10, 0.30, 0.01
CHIP = {"CHOPCONF": 0x0001_0153, "IHOLD_IRUN": 0x0007_1F0A, "AMAX": 500, "VMAX": 200_000, "ENCMODE": 1 << 10}


def measure(quick: bool) -> Sequence[Row]:
    """One TMC5160 with an encoder turns; one browser's worth of socket looks."""
    seconds = 3.0 if quick else 8.0
    with (
        tempfile.TemporaryDirectory(prefix="stepscope-") as folder,
        ServerProcess(Path(folder), "--no-demo") as server,
        httpx.Client(base_url=f"{server.url}/api/v1", timeout=60) as api,
    ):
        api.post("/devices", json={"name": "chip", "model": "tmc5160", "link": {"kind": "emulator"}}).raise_for_status()
        for register, value in (CHIP | {"ENC_CONST": 1 << 16 | 2800}).items():
            path = f"/devices/chip/registers/{register}"
            api.put(path, params={"axis": 0}, json={"value": value}).raise_for_status()
        api.post("/devices/chip/axes/0/rotate", json={"velocity": 50_000}).raise_for_status()
        off = _share(server.pid, seconds)
        began_s = time.perf_counter()
        api.post("/twin", json={"device": "chip"}).raise_for_status()
        started_s = time.perf_counter() - began_s
        with connect(
            f"{server.url.replace('http', 'ws')}/twin/view",
            subprotocols=[Subprotocol(f"viser-v{viser.__version__}")],
            max_size=None,
        ) as socket:
            received = _Received(socket)
            time.sleep(1.5)
            child = _child_of(server.pid)
            child_s, bytes_before = cpu_seconds(child), received.count
            rates: list[float] = []
            on = _share(server.pid, seconds, lambda: rates.append(api.get("/twin").json()["updates_per_s"]))
            drawing = (cpu_seconds(child) - child_s) / seconds
            per_s = (received.count - bytes_before) / seconds
        api.delete("/twin").raise_for_status()
        alive = Path(f"/proc/{child}").exists()
        again = _share(server.pid, seconds)
    updates = sum(rates) / len(rates)
    return [
        Row(
            what="3D twin: updates of the picture",
            measured=f"{updates:.1f}/s, at most {max(rates):.0f}",
            peer=f"{UPDATES_MAX:g}/s",
            ratio=max(rates) / UPDATES_MAX,
            required=f"<= 30/s, and {UPDATES_LEAST:g}",
            ok=max(rates) <= UPDATES_MAX and updates >= UPDATES_LEAST,
            notes=(f"started in {started_s:.1f} s; {per_s / 1e3:.0f} kB/s to a browser",),
        ),
        Row(
            what="3D twin: server, more than without",
            measured=f"{100 * (on - off):.1f} % of a core",
            peer=f"{100 * SERVER_LIMIT:g} %",
            ratio=(on - off) / SERVER_LIMIT,
            required="<= 1",
            ok=on - off <= SERVER_LIMIT,
            notes=(f"{100 * off:.1f} % without, {100 * on:.1f} % with",),
        ),
        Row(
            what="3D twin: the process that draws",
            measured=f"{100 * drawing:.1f} % of a core",
            peer=f"{100 * CHILD_LIMIT:g} %",
            ratio=drawing / CHILD_LIMIT,
            required="<= 1",
            ok=drawing <= CHILD_LIMIT,
        ),
        Row(
            what="3D twin: off again",
            measured=f"{100 * (again - off):+.1f} % of a core",
            peer=f"{100 * OFF_LIMIT:g} %",
            ratio=abs(again - off) / OFF_LIMIT,
            required="<= 1, no process",
            ok=again - off <= OFF_LIMIT and not alive,
        ),
    ]


class _Received:
    """Reads a socket as fast as it comes, and counts its bytes."""

    def __init__(self, socket: Connection) -> None:
        self.count = 0
        self._socket = socket
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self) -> None:
        try:
            for message in self._socket:
                self.count += len(message)
        except ConnectionClosed:
            pass


def _share(pid: int, seconds: float, look: Callable[[], object] | None = None) -> float:
    """Share of a core that a process takes, asked to `look` once a second meanwhile."""
    began_s, before_s = time.perf_counter(), cpu_seconds(pid)
    while (left_s := began_s + seconds - time.perf_counter()) > 0:
        time.sleep(min(1.0, left_s))
        if look is not None:
            look()
    return (cpu_seconds(pid) - before_s) / (time.perf_counter() - began_s)


def _child_of(pid: int) -> int:
    """The process that draws."""
    children = Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
    return next(int(child) for child in children if b"twin" in Path(f"/proc/{child}/cmdline").read_bytes())
