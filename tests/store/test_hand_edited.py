"""What somebody wrote into `connections.json` by hand: the server starts, keeps what is well, and says what is not."""

from __future__ import annotations

import json
from pathlib import Path

import httpx
import pytest

from app.clock import VirtualClock
from app.devices.core.config import DeviceConfig
from app.main import create_app
from app.settings import Settings
from app.store.connections import FILE_NAME, ConnectionStore

WHOLE: dict[str, object] = {
    "name": "Bad",
    "model": "tmc428",
    "link": {"kind": "emulator", "seed": 1},
    "clock_hz": 16e6,
    "axes": [{"name": "X", "gear_ratio": 2.5, "limits": {"position_min": -5, "velocity_max_pps": 1000.0}}],
}
VALUES: list[object] = [None, True, 5, -1, 10**400, 1.5, "", "\ud800", "x" * 5000, [], [5], {}, {"kind": ["a"]}, [[[]]]]
PATHS: list[list[str | int]] = [
    [],
    ["name"],
    ["model"],
    ["link"],
    ["link", "kind"],
    ["link", "seed"],
    ["clock_hz"],
    ["axes"],
    ["axes", 0],
    ["axes", 0, "name"],
    ["axes", 0, "gear_ratio"],
    ["axes", 0, "full_steps_per_rev"],
    ["axes", 0, "limits"],
    ["axes", 0, "limits", "position_min"],
    ["axes", 0, "limits", "velocity_max_pps"],
]


def spoilt(path: list[str | int], value: object) -> object:
    whole = json.loads(json.dumps(WHOLE))
    if not path:
        return value
    place = whole
    for step in path[:-1]:
        place = place[step]
    place[path[-1]] = value
    return whole


@pytest.mark.parametrize("path", PATHS, ids=str)
async def test_what_somebody_spoilt_is_set_aside_and_the_rest_is_kept(path: list[str | int], tmp_path: Path) -> None:
    for number, value in enumerate(VALUES):
        directory = tmp_path / str(number)
        ConnectionStore(directory).save(
            [DeviceConfig(name, "tmc428", {"kind": "emulator"}) for name in ("first", "last")]
        )
        file = directory / FILE_NAME
        document = json.loads(file.read_text())
        document["connections"].insert(1, spoilt(path, value))
        file.write_text(json.dumps(document))
        store = ConnectionStore(directory)
        loaded = store.load()
        kept = [one.name for one in loaded.configs]
        assert kept[0] == "first"
        assert kept[-1] == "last"
        if len(kept) == 2:
            assert "left out" in loaded.warnings[0]
            assert "is kept as" in loaded.warnings[1]
            assert list(directory.glob("connections.broken-*.json"))
            if number:
                continue  # what was left out does the server no harm: one such start a place is enough
        app = create_app(Settings(data_dir=directory, demo=False), VirtualClock())
        async with app.router.lifespan_context(app):
            transport = httpx.ASGITransport(app)
            async with httpx.AsyncClient(transport=transport, base_url="http://127.0.0.1:8000") as client:
                told = await client.get("/api/v1/devices")
                assert told.status_code == 200
                assert {"first", "last"} <= {device["name"] for device in told.json()}
                added = await client.post(
                    "/api/v1/devices", json={"name": "new", "model": "tmc428", "link": {"kind": "emulator"}}
                )
                assert added.status_code == 201
                assert added.json()["notes"] == []
        assert {"first", "last", "new"} <= {one.name for one in ConnectionStore(directory).load().configs}
