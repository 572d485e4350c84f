"""Ten thousand requests of people who should not get in: how many do, and does the server stand?"""

from __future__ import annotations

import os
import tempfile
import time
from collections import Counter
from collections.abc import Sequence
from contextlib import closing
from pathlib import Path
from urllib.parse import urlsplit

import httpx
from server_process import ServerProcess

from tests.bench.table import Row
from tests.hostile import CANARY, Attack, Finding, attacks, send

ATTACKS = 10_000
TOKEN = "not-to-be-guessed-in-a-lifetime"
SPARE_DESCRIPTORS = 8
"""Open files may differ by so many: connections that are just being closed, a log."""


def measure(quick: bool) -> Sequence[Row]:
    count = 800 if quick else ATTACKS
    with tempfile.TemporaryDirectory(prefix="stepscope-") as folder:
        outside = Path(folder)
        (outside / "canary.txt").write_text(CANARY)
        started_s = time.perf_counter()
        findings, troubles = attacked(outside, count)
        took_s = time.perf_counter() - started_s
    wrong = [finding for finding in findings if finding.wrong]
    kinds = Counter(finding.attack.kind for finding in findings)
    return [
        Row(
            what=f"{len(findings):,} hostile requests",
            measured=f"{len(wrong)} got in, {len(troubles)} troubles",
            peer="none",
            ratio=float(len(wrong) + len(troubles)),
            required="0",
            ok=not wrong and not troubles,
            notes=(
                ", ".join(f"{number:,} {kind}" for kind, number in sorted(kinds.items())),
                f"{took_s:.0f} s, each over a connection of its own",
                *(f"{finding.attack.kind} {finding.attack.request[:120]!r}: {finding.wrong}" for finding in wrong[:10]),
                *troubles[:10],
            ),
        )
    ]


def attacked(outside: Path, count: int) -> tuple[list[Finding], list[str]]:
    """What came of `count` attacks on two servers with a demo bench, and what was wrong with the servers after them."""
    with (
        ServerProcess(outside / "open", "--demo") as free,
        ServerProcess(outside / "token", "--demo", "--token", TOKEN) as closed,
        closing(_visitor(free)) as of_free,
        closing(_visitor(closed)) as of_closed,
    ):
        doors = {"open": free, "token": closed}
        visitors = {"open": of_free, "token": of_closed}
        before = {name: _state(visitor) for name, visitor in visitors.items()}
        descriptors = {name: _descriptors(server) for name, server in doors.items()}
        findings = [
            send(_for(attack, free, closed), _address(doors[attack.door]))
            for attack in attacks(count, urlsplit(free.url).netloc)
        ]
        troubles = []
        for name, server in doors.items():
            if (now := _state(visitors[name])) != before[name]:
                troubles.append(f"the bench of the {name} server is another one: {before[name]} -> {now}")
            if _settled(server) > descriptors[name] + SPARE_DESCRIPTORS:
                troubles.append(f"the {name} server has {_descriptors(server) - descriptors[name]} more open files")
            troubles += [f"{name} server: {line}" for line in server.log().splitlines() if "Traceback" in line]
        strangers = {path.name for path in outside.iterdir()} - {"canary.txt", *doors}
        if strangers or (outside / "canary.txt").read_text() != CANARY:
            troubles.append(f"something was written beside the data directory: {sorted(strangers)}")
    return findings, troubles


def _for(attack: Attack, free: ServerProcess, closed: ServerProcess) -> Attack:
    """The same attack, with the port of the server that it is for."""
    if attack.door == "open":
        return attack
    there, here = (urlsplit(server.url).netloc.encode() for server in (free, closed))
    return Attack(attack.kind, attack.door, attack.request.replace(there, here), attack.well, attack.may_serve)


def _address(server: ServerProcess) -> tuple[str, int]:
    parts = urlsplit(server.url)
    assert parts.hostname is not None
    assert parts.port is not None
    return parts.hostname, parts.port


def _visitor(server: ServerProcess) -> httpx.Client:
    """Somebody who may come in, as a browser does: its session is never shut out by the guesses of others."""
    client = httpx.Client(base_url=server.url, timeout=30)
    if client.get("/api/v1/devices").status_code == 401:
        client.post("/login", data={"token": TOKEN})
    return client


def _state(client: httpx.Client) -> object:
    """What the bench is: devices, where the motor stands, recordings."""
    devices = client.get("/api/v1/devices").raise_for_status().json()
    axis = client.get("/api/v1/devices/bench/axes/0").raise_for_status().json()
    v_max = client.get("/api/v1/devices/bench/registers/v_max", params={"axis": 0}).raise_for_status().json()
    recordings = client.get("/api/v1/recordings").raise_for_status().json()
    names = [(device["id"], device["state"], device["link"]) for device in devices]
    kept = [recording["id"] for recording in recordings["recordings"]]
    return names, axis["position"], axis["moving"], v_max["value"], kept


def _descriptors(server: ServerProcess) -> int:
    return len(os.listdir(f"/proc/{server.pid}/fd"))


def _settled(server: ServerProcess, within_s: float = 10.0) -> int:
    """Open files as soon as they are no longer getting fewer."""
    until_s = time.monotonic() + within_s
    last, now = _descriptors(server) + 1, _descriptors(server)
    while now < last and time.monotonic() < until_s:
        time.sleep(0.5)
        last, now = now, _descriptors(server)
    return now
