"""A start works out no route but the stops'; each is at its first call what it would have been at the start."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
SEEN = """
import asyncio, json, sys
import httpx
from app.api.app import ROUTES
from app.main import create_app
from app.settings import Settings

app = create_app(Settings(data_dir=sys.argv[1], demo=False))
named = {route.name: route for route in ROUTES}
worked_out = lambda: sorted(n for n, route in named.items() if hasattr(route, "_options") and "app" in vars(route))
print(json.dumps(worked_out()))

async def call():
    transport = httpx.ASGITransport(app)
    async with httpx.AsyncClient(transport=transport, base_url="http://127.0.0.1:8000/api/v1/") as api:
        wrong = await api.post("calc/units", json={"nonsense": 1})
        return [(await api.get("health")).status_code, (await api.delete("health")).status_code, wrong.status_code]

print(json.dumps(asyncio.run(call())))
print(json.dumps(worked_out()))
print(len(app.openapi()["paths"]) > 100 and "app" in vars(named["list_devices"]))
"""


def test_a_route_is_worked_out_at_its_first_call(tmp_path: Path) -> None:
    told = subprocess.run(
        [sys.executable, "-c", SEEN, str(tmp_path)], cwd=ROOT, check=True, capture_output=True, text=True
    ).stdout.splitlines()
    assert told[0] == '["stop_axis", "stop_everything"]'
    assert told[1] == "[200, 405, 422]"
    assert told[2] == '["convert_units", "get_health", "stop_axis", "stop_everything"]'
    assert told[3] == "True"
