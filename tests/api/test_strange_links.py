"""Ten thousand requests with strange names of ports and channels: no file is opened, nothing but serial devices is."""

from __future__ import annotations

import asyncio
import random
import re
import sys
import sysconfig
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import httpx
import pytest
from fastapi import FastAPI

from app.links.can_bus import INTERFACES, SERIAL_INTERFACES
from app.main import bench_of
from app.settings import Settings
from tests.links.test_serial_address import strange_names

REQUESTS, PARTS = 10_000, 10
KEPT = "kept.txt"
OURS = tuple({*sysconfig.get_paths().values(), str(Path(__file__).parents[2] / "app")})
"""Where Python and we ourselves import from."""
USUAL = re.compile(r"/dev$|/dev/(tty[A-Za-z.]|pts/|rfcomm|cu\.)|/sys/(class|devices|bus)/|.*/python3\d+\.zip$")
"""Serial devices, and where the system lists them; and where Python looks for what it imports."""
WATCHED = frozenset({"open", "socket.connect", "os.listdir", "os.scandir", "os.remove", "os.rename", "os.mkdir"})

_heard: list[tuple[str, str]] | None = None


def _hear(event: str, arguments: tuple[Any, ...]) -> None:
    if _heard is not None and (event in WATCHED or event.startswith("subprocess")):
        what = arguments[1] if event == "socket.connect" else arguments[0]
        if not isinstance(what, int):  # a descriptor that is open already
            _heard.append((event, what.decode(errors="replace") if isinstance(what, bytes) else str(what)))
            if _heard[-1][1].endswith(KEPT):  # heard: it need not be done, and pyserial would never close it
                raise PermissionError("this file is watched")


sys.addaudithook(_hear)


@contextmanager
def touched(data_dir: Path) -> Iterator[list[str]]:
    """What this process opens, lists, removes or connects to meanwhile, without its own things; complete at the end."""
    global _heard
    _heard = []
    told: list[str] = []
    try:
        yield told
    finally:
        heard, _heard = _heard, None
        own = (*OURS, str(data_dir))
        looked = {("os.listdir", entry or str(Path.cwd())) for entry in sys.path}  # as something new was put there
        strange = ((event, what) for event, what in heard if not what.startswith(own) and (event, what) not in looked)
        told += sorted({f"{event} {what}" for event, what in strange if not USUAL.match(what)})


def requests(target: str, count: int, seed: int) -> Iterator[tuple[str, dict[str, Any]]]:
    """Address and body, `target` somewhere in the name of a port or channel."""
    chance = random.Random(seed)
    interfaces = sorted((SERIAL_INTERFACES | INTERFACES | {"socketcand", "../x", "os"}) - {"virtual"})
    for name in strange_names(target, count, seed):
        link: dict[str, Any]
        if chance.random() < 0.3:
            model, link = "pd42-1241", {"kind": "can", "interface": chance.choice(interfaces), "channel": name}
        else:
            kind = chance.choice(["serial", "uart", "landungsbruecke"])
            model = {"serial": "pd42-1241", "uart": "tmc5160", "landungsbruecke": "tmc4361"}[kind]
            link = {"kind": kind, "port": name}
        way = chance.random()
        if way < 0.1:
            yield "devices", {"name": "strange", "model": model, "link": link}
        elif way < 0.3:
            yield "ports/probe", {"port": name, "kind": chance.choice(["modules", "chips"])}
        else:
            yield "devices/test", {"model": model, "link": link}


async def send_all(app: FastAPI, client: httpx.AsyncClient, target: str, count: int, seed: int) -> dict[int, int]:
    """Each request, and what it began ended again; how many answers of which status."""
    answers: dict[int, int] = {}
    for path, body in requests(target, count, seed):
        answer = await client.post(path, json=body)
        answers[answer.status_code] = answers.get(answer.status_code, 0) + 1
        assert answer.status_code < 500 or answer.headers["content-type"] == "application/problem+json", answer.text
        if path == "ports/probe" and answer.status_code == 202:
            while bench_of(app).probing.running:  # noqa: ASYNC110
                await asyncio.sleep(0)
        elif path == "devices" and answer.status_code == 201:
            (await client.delete(f"devices/{answer.json()['id']}")).raise_for_status()
    return answers


@pytest.mark.parametrize("part", range(PARTS))
async def test_no_request_opens_anything_but_serial_devices(
    app: FastAPI, client: httpx.AsyncClient, settings: Settings, tmp_path: Path, part: int
) -> None:
    target = tmp_path / KEPT
    target.write_text("kept")
    await send_all(app, client, str(tmp_path / "other"), 50, 99)  # what is only imported is
    with touched(settings.data_dir) as told:
        answers = await send_all(app, client, str(target), REQUESTS // PARTS, part)
    assert told == []
    assert sum(answers.values()) == REQUESTS // PARTS
    assert not [status for status in answers if status >= 500], answers
    assert answers[200] > REQUESTS / PARTS / 10, answers  # tried, and told why not
    assert target.read_text() == "kept"


async def test_without_the_list_of_what_is_allowed_files_are_opened(
    app: FastAPI, client: httpx.AsyncClient, settings: Settings, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What the test above looks for is found where it is."""
    for module in ("api.links.probing", "links.can_bus", "links.discovery", "links.registry"):
        monkeypatch.setattr(f"app.{module}.port_url", lambda name: name)
    for module in ("links.can_bus", "links.streams"):
        monkeypatch.setattr(f"app.{module}.openable", lambda _, url: url)
    target = tmp_path / KEPT
    target.write_text("kept")
    with touched(settings.data_dir) as told:
        await send_all(app, client, str(target), 50, 0)
    assert f"open {target}" in told
