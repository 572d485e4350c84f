"""schemathesis over the whole schema, against a real server: no crash, nothing undocumented, nothing wrong accepted.

For `tests/api/test_fuzz.py`, a few cases of each call, and for `make bench`: tens of thousands, calls one after another
among them, each answered in time.
"""

from __future__ import annotations

import asyncio
import json
import os
import re
import socket
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import httpx

from app.profiles.scripts.process import guest_server
from tests.api.live import live_server

SEED = 428
WITHIN_S = 2.0
GUESTS = ("make_script", "make_script_of_document", "try_macro")
"""Calls that try something in a process which is started for it: they have that long beyond such a start."""
STARTS = 3
UNTIMED_S = 150.0
"""Where nobody measures: longer than such a call ever waits, so that a busy machine fails no case."""
MODULE = "module"
CHIP40 = "chip40"
SIXPOINT = "sixpoint"
"""An emulated PD42-1241, TMC4361 and TMC5072 beside the demo's chips."""
ADDED = {MODULE: "pd42-1241", CHIP40: "tmc4361", SIXPOINT: "tmc5072"}
RUNS = {
    "new": ("add_device", "test_link"),
    "lease": ("take_lease", "keep_lease", "give_lease_back", "ask_for_lease", "hand_lease_over"),
    "destructive": (
        "edit_device",
        "remove_device",
        "disconnect_device",
        "change_emulator",
        "start_recording",
        "delete_recording",
    ),
    "guests": GUESTS,
}
"""Calls that get a server of their own: they add devices of any name, take the bench, leave the others nothing to talk
to, or start a process each."""
ALL_RUNS = tuple(name for names in RUNS.values() for name in names)

PARTS = ("rest", *RUNS)
CASES = re.compile(r"^ *(\d[\d,]*) generated", re.MULTILINE)


@dataclass(frozen=True)
class Outcome:
    """What came of a run: `failed` is what schemathesis ended with, 0 where all was well; `report` its last words."""

    cases: int
    failed: int
    report: str


CONFIG = """
# Valid by its schema is not valid for the chip (v_max 5000, a chain of 65 bits): 422 is right there.
[checks]
positive_data_acceptance.expected-statuses = ["2xx", 404, 409, 422, 502, 504]
# What has too many items may be too long to be read at all.
negative_data_rejection.expected-statuses = [400, 403, 404, 405, 409, 413, 415, 422, 502, 504]
"""


async def timed_config(folder: Path) -> str:
    """`CONFIG`, and how long answers may take: `WITHIN_S`, those of `GUESTS` beyond the slowest start of a guest."""
    start_s = 0.0
    for number in range(1 + STARTS):
        own = folder / f"guest{number}"
        own.mkdir()
        began_s = time.perf_counter()
        async with guest_server(own):
            if number:  # the first may have compiled the emulators
                start_s = max(start_s, time.perf_counter() - began_s)
    sys.stdout.write(f"answers within {WITHIN_S} s; {', '.join(GUESTS)} within {WITHIN_S} s beyond {start_s:.2f} s\n")
    return f"""{CONFIG}
max_response_time = {WITHIN_S}

[[operations]]
include-operation-id = {json.dumps(GUESTS)}
checks.max_response_time = {start_s + WITHIN_S:.3f}
"""


def with_real_names(schema: dict[str, Any], recording: str) -> dict[str, Any]:
    """The schema with what there is on the bench: random names would be 404 before anything is reached."""
    names = {
        "device": {"type": "string", "enum": ["bench", "slider", *ADDED]},
        "axis": {"type": "integer", "enum": [0, 1, 2]},
        "name": {
            "type": "string",
            "enum": [
                "v_max",
                "pmul_pdiv",
                "rm",
                "LSMD",
                "ap4",
                "gp2_5",
                "coord3",
                "out0",
                "RAMPMODE",
                "EVENTS",
                "SW_MODE",
                "GSTAT",
                "PID_P",
            ],
        },
        "recording": {"type": "string", "enum": [recording]},
        "study": {"type": "string", "enum": ["20260101-120000"]},
        "layout": {"type": "string", "enum": ["bench", "mine"]},
        "macro": {"type": "string", "enum": ["there", "mine"]},
        "net": {"type": "string", "enum": ["start", "none"]},
        "profile": {"type": "integer", "enum": [1, 2]},
        "model": {"type": "string", "enum": ["tmc428", "tmc4210", *ADDED.values(), "tmc5160"]},
    }
    for operations in schema["paths"].values():
        for operation in operations.values():
            for parameter in operation.get("parameters", ()):
                if parameter["in"] == "path":
                    parameter["schema"] = names.get(parameter["name"], parameter["schema"])
    # The devices have to stay under the names that the paths use.
    del schema["components"]["schemas"]["DeviceChange"]["properties"]["name"]
    return schema


@contextmanager
def only_this_machine() -> Iterator[None]:
    """Invented hosts end at this machine."""
    real = socket.getaddrinfo

    def here_only(host: Any, *rest: Any, **more: Any) -> Any:
        if host not in ("127.0.0.1", "localhost", "::1"):
            raise socket.gaierror(socket.EAI_NONAME, "the test has no network")
        return real(host, *rest, **more)

    socket.getaddrinfo = here_only
    try:
        yield
    finally:
        socket.getaddrinfo = real


async def _sweep(client: httpx.AsyncClient) -> None:
    """Remove what was added, while the run goes on: hundreds of devices would only make it slow."""
    while True:
        await asyncio.sleep(0.2)
        for device in (await client.get("/api/v1/devices")).json():
            if not device["demo"] and device["id"] not in ADDED:
                await client.delete(f"/api/v1/devices/{device['id']}")


async def fuzzed(which: str, folder: Path, examples: int, *, timed: bool, every_bound: bool = True) -> Outcome:
    """What comes of `examples` of each call of that part; `timed`: sequences of calls too, and answers in time.

    `every_bound`: also a value within and one outside each bound of each field, which is thousands of cases where a
    field has one of many forms.

    Raises AssertionError where the server is not well afterwards.
    """
    how, calls = ("--include-operation-id", RUNS[which]) if which in RUNS else ("--exclude-operation-id", ALL_RUNS)
    chosen = [flag for name in calls for flag in (how, name)]
    config = folder / "schemathesis.toml"
    config.write_text(await timed_config(folder) if timed else f"{CONFIG}max_response_time = {UNTIMED_S}\n")
    with only_this_machine():
        async with live_server(folder / "data") as url, httpx.AsyncClient(base_url=url, timeout=60) as client:
            for name, model in ADDED.items():
                device = {"name": name, "model": model, "link": {"kind": "emulator"}}
                assert (await client.post("/api/v1/devices", json=device)).status_code == 201
            schema = folder / "openapi.json"
            kept = {"device": CHIP40, "channels": ["position.0"]}
            recording = (await client.post("/api/v1/recordings", json=kept)).json()["id"]
            schema.write_text(json.dumps(with_real_names((await client.get("/openapi.json")).json(), recording)))
            command = [sys.executable, "-m", "schemathesis.cli", "--config-file", str(config), "run", str(schema)]
            command += ["--url", url, "--max-examples", str(examples)]
            phases = ["examples", *["coverage"] * every_bound, "fuzzing", *["stateful"] * timed]
            command += ["--phases", ",".join(phases)]
            command += ["--seed", str(SEED), "--generation-database", "none", "--checks", "all"]
            command += ["--continue-on-failure", "--no-shrink", "--no-color"]
            command += ["--request-timeout", "20" if timed else str(UNTIMED_S)]
            command += ["--warnings", "off", *chosen]
            process = await asyncio.create_subprocess_exec(
                *command,
                cwd=folder,
                env={**os.environ, "PYTHONWARNINGS": "default"},
                stdout=asyncio.subprocess.PIPE,
                stderr=asyncio.subprocess.STDOUT,
            )
            sweeping = asyncio.create_task(_sweep(client) if which == "new" else asyncio.sleep(0))
            report = (await process.communicate())[0].decode()
            sweeping.cancel()
            assert (await client.get("/api/v1/health")).status_code == 200
            assert (await client.post("/api/v1/stop")).status_code == 200
    told = CASES.findall(report)
    cases = int(told[-1].replace(",", "")) if told else 0
    return Outcome(cases, process.returncode or 0, report[-8000:])
