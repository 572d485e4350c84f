"""A server that is killed in the middle of a study: what the next one tells, and how the axis gets back."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import httpx
import pytest

from tests.api.processes import address, running

MOVE = {"kind": "fastest_move", "distance": 12_800, "repeats": 1}
OWN = {
    "kind": "custom_search",
    "space": [{"name": "ramp.acceleration", "low": 100_000, "high": 400_000}],
    "distances": [12_800],
    "objectives": ["peak_fullsteps"],
}
START = {"velocity_pps": 50_000, "acceleration_pps2": 200_000, "counts_per_rev": 40_000, "stops": False}
WITHIN_S = 60.0


def until(said: str, asked: Any) -> Any:
    """What `asked` answers, as soon as that is something."""
    end_s = time.monotonic() + WITHIN_S
    while time.monotonic() < end_s:
        found = asked()
        if found:
            return found
        time.sleep(0.05)
    raise AssertionError(f"not within {WITHIN_S:g} s: {said}")


def set_to(api: httpx.Client) -> dict[str, int]:
    found = api.get("/devices/slide/profile").json()["registers"]
    return {one["name"]: one["value"] for one in found if one["name"] in ("VMAX", "AMAX", "DMAX")}


def connected(api: httpx.Client) -> bool:
    answer = api.get("/devices/slide")
    return answer.status_code == 200 and answer.json()["state"] == "connected"


@pytest.mark.parametrize("wanted", [MOVE, OWN], ids=lambda wanted: wanted["kind"])
def test_a_killed_study_is_told_put_back_and_gone_on_with(tmp_path: Path, wanted: dict[str, Any]) -> None:
    serve = ("serve", "--port", "0", "--data-dir", str(tmp_path), "--no-demo")
    with running("emulate", "tmc5160", "--tcp", "127.0.0.1:0", "--time-scale", "4") as (_, line):
        link = {"kind": "tcp", "host": "127.0.0.1", "port": int(line.rpartition(":")[2].split()[0])}
        with (
            running(*serve) as (server, said),
            httpx.Client(base_url=f"{address(said)}/api/v1", timeout=30) as api,
        ):
            api.post("/devices", json={"name": "Slide", "model": "tmc5160", "link": link}).raise_for_status()
            until("connected", lambda: connected(api))
            api.post("/devices/slide/start-up", json=START).raise_for_status()
            before = set_to(api)
            begun = api.post("/studies", json={"device": "slide", "study": wanted, "budget": {"trials": 3}})
            study = begun.raise_for_status().json()["id"]
            until("a trial is set", lambda: set_to(api) != before)
            server.kill()
            server.wait()
        with (
            running(*serve) as (_, said),
            httpx.Client(base_url=f"{address(said)}/api/v1", timeout=30) as api,
        ):
            until("connected again", lambda: connected(api))
            found = api.get(f"/studies/{study}").json()
            assert (found["state"], bool(found["left"])) == ("interrupted", True)
            assert {one["name"]: one["value"] for one in found["baseline"] if one["name"] in before} == before
            left = api.get(f"/studies/{study}/left").json()["left"]
            assert any(one.startswith("VMAX is not known") for one in left), "it can only be written"
            until("at rest", lambda: not api.get("/devices/slide/axes/0").json()["moving"])
            refused = api.post("/studies", json={"device": "slide", "study": wanted})
            assert "put that back first" in refused.json()["detail"]
            back = api.post(f"/studies/{study}/take", json={"which": "baseline"})
            assert back.raise_for_status().json()["left"] == []
            assert set_to(api) == before
            assert api.get(f"/studies/{study}/left").json()["left"] == []
            gone_on = api.post(f"/studies/{study}/resume")
            assert gone_on.status_code == 201 or gone_on.is_success, gone_on.text
            assert api.post(f"/studies/{study}/stop").json()["state"] == "aborted"
            assert set_to(api) == before
