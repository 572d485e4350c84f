"""schemathesis over the whole schema, against a real server: no crash, nothing undocumented, nothing wrong accepted."""

from __future__ import annotations

import asyncio
import json
import os
import socket
import sys
from pathlib import Path
from typing import Any

import httpx
import pytest

from tests.api.live import live_server

SEED = 428
EXAMPLES = int(os.environ.get("STEPSCOPE_FUZZ_EXAMPLES", "4"))
"""Of each call. More than in CI is by hand: 100 are some 20,000 cases, calls one after another among them, and take an
hour; then each has to be answered within 2 s."""
BY_HAND = ("--phases", "examples,coverage,fuzzing,stateful", "--max-response-time", "2")
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
}
"""Calls that get a server of their own: they add devices of any name, take the bench, or leave the others nothing to
talk to."""
ALL_RUNS = tuple(name for names in RUNS.values() for name in names)

CONFIG = """
# Valid by its schema is not valid for the chip (v_max 5000, a chain of 65 bits): 422 is right there.
[checks]
positive_data_acceptance.expected-statuses = ["2xx", 404, 409, 422, 502, 504]
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
        "profile": {"type": "integer", "enum": [1, 2]},
        "model": {"type": "string", "enum": ["tmc428", "tmc4210", *ADDED.values(), "tmc5160"]},
    }
    for operations in schema["paths"].values():
        for operation in operations.values():
            for parameter in operation.get("parameters", ()):
                if parameter["in"] == "path":
                    parameter["schema"] = names[parameter["name"]]
    # The devices have to stay under the names that the paths use.
    del schema["components"]["schemas"]["DeviceChange"]["properties"]["name"]
    return schema


@pytest.fixture(autouse=True)
def _no_network(monkeypatch: pytest.MonkeyPatch) -> None:
    """Invented hosts end at this machine."""
    real = socket.getaddrinfo

    def here_only(host: Any, *rest: Any, **more: Any) -> Any:
        if host not in ("127.0.0.1", "localhost", "::1"):
            raise socket.gaierror(socket.EAI_NONAME, "the test has no network")
        return real(host, *rest, **more)

    monkeypatch.setattr(socket, "getaddrinfo", here_only)


async def _sweep(client: httpx.AsyncClient) -> None:
    """Remove what was added, while the run goes on: hundreds of devices would only make it slow."""
    while True:
        await asyncio.sleep(0.2)
        for device in (await client.get("/api/v1/devices")).json():
            if not device["demo"] and device["id"] not in ADDED:
                await client.delete(f"/api/v1/devices/{device['id']}")


@pytest.mark.slow
@pytest.mark.timeout(100 * EXAMPLES)  # a minute when nobody else is busy
@pytest.mark.parametrize("which", ["rest", *RUNS])
async def test_the_server_keeps_its_contract(tmp_path: Path, which: str) -> None:
    how, calls = ("--include-operation-id", RUNS[which]) if which in RUNS else ("--exclude-operation-id", ALL_RUNS)
    chosen = [flag for name in calls for flag in (how, name)]
    config = tmp_path / "schemathesis.toml"
    config.write_text(CONFIG)
    async with live_server(tmp_path / "data") as url, httpx.AsyncClient(base_url=url) as client:
        for name, model in ADDED.items():
            device = {"name": name, "model": model, "link": {"kind": "emulator"}}
            assert (await client.post("/api/v1/devices", json=device)).status_code == 201
        schema = tmp_path / "openapi.json"
        kept = {"device": CHIP40, "channels": ["position.0"]}
        recording = (await client.post("/api/v1/recordings", json=kept)).json()["id"]
        schema.write_text(json.dumps(with_real_names((await client.get("/openapi.json")).json(), recording)))
        command = [sys.executable, "-m", "schemathesis.cli", "--config-file", str(config), "run", str(schema)]
        command += ["--url", url, "--max-examples", str(EXAMPLES)]
        command += BY_HAND if "STEPSCOPE_FUZZ_EXAMPLES" in os.environ else ("--phases", "examples,coverage,fuzzing")
        command += ["--seed", str(SEED), "--generation-database", "none", "--checks", "all", "--continue-on-failure"]
        command += ["--request-timeout", "20", "--no-shrink", "--no-color", "--warnings", "off", *chosen]
        process = await asyncio.create_subprocess_exec(
            *command,
            cwd=tmp_path,
            env={**os.environ, "PYTHONWARNINGS": "default"},
            stdout=asyncio.subprocess.PIPE,
            stderr=asyncio.subprocess.STDOUT,
        )
        sweeping = asyncio.create_task(_sweep(client) if which == "new" else asyncio.sleep(0))
        report, _ = await process.communicate()
        sweeping.cancel()
        sys.stdout.write(report.decode()[-2000:])  # how many cases there were: -rP shows it
        assert process.returncode == 0, report.decode()[-8000:]
        assert (await client.get("/api/v1/health")).status_code == 200
        assert (await client.post("/api/v1/stop")).status_code == 200
