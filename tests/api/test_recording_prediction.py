"""A recording beside what the calculators expect of its commands; and where nobody can tell, that it is said."""

from __future__ import annotations

from typing import Any

import httpx
import numpy as np
import pytest
from fastapi import FastAPI

from app.clock import VirtualClock
from app.main import bench_of
from app.procedures.replay import done_s
from app.store.recordings.file import Rows
from app.store.recordings.head import Column, Head
from app.store.recordings.library import Label
from app.store.recordings.marks import Mark
from tests.api.test_recordings import run, start

BOTH = ["position.0", "velocity.0"]


async def predicted(client: httpx.AsyncClient, recording: str, **query: str | float) -> dict[str, Any]:
    answer = await client.get(f"recordings/{recording}/prediction", params=query)
    assert answer.status_code == 200, answer.text
    found: dict[str, Any] = answer.json()
    return found


def residual(found: dict[str, Any], channel: str = "position.0") -> dict[str, Any]:
    """Figures of measured less predicted."""
    (of,) = [each for each in found["channels"] if each["channel"] == channel]
    figures: dict[str, Any] = of["differences"][0]["figures"]
    return figures


async def ready(client: httpx.AsyncClient, model: str) -> str:
    """A device of that model that can move: its id."""
    if model == "tmc428":
        return "bench"
    body = {"name": "Other", "model": model, "link": {"kind": "emulator", "motor": "rigid"}}
    if model in ("pd42-1241", "tmcm-1161", "tmc4361"):
        body["link"] = {"kind": "emulator"}
    assert (await client.post("devices", json=body)).status_code == 201
    if model in ("tmc5160", "tmc5240", "tmc5072", "tmcm-1161"):
        done = await client.post("devices/other/axes/0/start-up", json={})
        assert done.status_code == 200, done.text
    if model == "tmc4361":
        for register, value in {"RAMPMODE": 5, "AMAX": 800_000, "DMAX": 800_000, "VMAX": 256 * 5000}.items():
            await client.put(f"devices/other/registers/{register}", params={"axis": 0}, json={"value": value})
    return "other"


@pytest.mark.parametrize(
    ("model", "within"),
    # A module on a wire has no clock of its own: when it began is known to some 0.1 ms, here to a round trip.
    [("tmc428", 6), ("tmc5160", 3), ("tmc5240", 3), ("tmc5072", 3), ("tmc4361", 3), ("pd42-1241", 40)],
)
async def test_what_an_emulator_did_was_to_be_expected(
    client: httpx.AsyncClient, clock: VirtualClock, model: str, within: float
) -> None:
    device = await ready(client, model)
    await run(clock, 0.5)
    recording = await start(client, device=device, channels=BOTH, rate_hz=500.0 if model != "pd42-1241" else 100.0)
    await run(clock, 0.2)
    for target in (3000, 1000):
        moved = await client.post(f"devices/{device}/axes/0/move", json={"target": target})
        assert moved.status_code == 200, moved.text
        await run(clock, 2.0)
    turned = await client.post(f"devices/{device}/axes/0/rotate", json={"velocity": 1000})
    assert turned.status_code == 200, turned.text
    await run(clock, 0.6)
    await client.post(f"devices/{device}/axes/0/stop")
    await run(clock, 1.0)
    await client.post(f"recordings/{recording}/stop")

    found = await predicted(client, recording)
    assert found["notes"] == []
    assert (found["motions"], found["settings"]) == (4, "as the recording tells")
    assert [side["id"] for side in found["recordings"]] == [recording, "predicted"]
    assert abs(residual(found)["peak"]) <= within, residual(found)
    assert residual(found)["samples"] > 200
    assert residual(found, "velocity.0")["rms"] < 60, residual(found, "velocity.0")
    measured, expected = found["channels"][0]["curves"]
    assert expected["values"][0] is None, "nothing was commanded yet"
    assert max(value for value in expected["values"] if value is not None) == pytest.approx(
        max(measured["values"]), abs=within
    )


def test_a_start_is_its_command_s_though_it_was_told_after_it() -> None:
    command = Mark(10.0041, "command", "move to 2000", 0, {"do": "move", "target": 2000})
    assert done_s(command, {0: [9.0, 10.0, 10.2]}) == 10.0
    assert done_s(command, {0: [9.0, 10.05]}) == 10.05
    assert done_s(command, {0: [9.0], 1: [10.0]}) == 10.0041


async def test_a_write_meanwhile_is_part_of_it(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    await ready(client, "tmc5160")
    recording = await start(client, device="other", channels=BOTH, rate_hz=500.0)
    registers = (await client.get("devices/other/profile")).json()["registers"]
    (vmax,) = [entry["value"] for entry in registers if entry["name"] == "VMAX"]
    await client.post("devices/other/axes/0/move", json={"target": 60_000})
    await run(clock, 0.5)
    await client.put("devices/other/registers/VMAX", params={"axis": 0}, json={"value": vmax // 3})
    await run(clock, 4.0)
    await client.post(f"recordings/{recording}/stop")
    found = await predicted(client, recording)
    assert (found["motions"], found["notes"]) == (2, []), "the same target, by the ramp that is set now"
    figures = residual(found)
    assert abs(figures["peak"]) < 0.02 * 60_000, figures


async def test_other_settings_show_as_a_residual(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    await ready(client, "tmc5160")
    kept = (await client.get("devices/other/profile")).json()
    for entry in kept["registers"]:
        if entry["name"] == "AMAX":
            entry["value"] //= 2
    saved = await client.post("profiles", json={"name": "softer", "document": kept})
    assert saved.status_code == 201, saved.text
    recording = await start(client, device="other", channels=BOTH, rate_hz=500.0)
    await client.post("devices/other/axes/0/move", json={"target": 40_000})
    await run(clock, 3.0)
    await client.post(f"recordings/{recording}/stop")
    right = residual(await predicted(client, recording))
    found = await predicted(client, recording, profile=saved.json()["id"])
    assert found["settings"] == "softer"
    assert abs(right["peak"]) <= 3
    assert residual(found)["peak"] > 500, "the motor is ahead of what half the acceleration would make"
    assert residual(found)["rms"] > 30 * right["rms"]

    other = {"recording": recording, "device": "bench"}
    document = (await client.get(f"devices/{other['device']}/profile")).json()
    wrong = (await client.post("profiles", json={"name": "of a TMC428", "document": document})).json()["id"]
    assert (await client.get(f"recordings/{recording}/prediction", params={"profile": wrong})).status_code == 422
    assert (await client.get(f"recordings/{recording}/prediction", params={"profile": 999})).status_code == 404
    assert (await client.get(f"recordings/{recording}/prediction", params={"axis": 1})).status_code == 422


async def test_a_part_has_figures_of_its_own(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    recording = await start(client, rate_hz=200.0)
    await client.post("devices/bench/axes/0/move", json={"target": 2000})
    await run(clock, 2.0)
    await client.post(f"recordings/{recording}/stop")
    whole = await predicted(client, recording)
    part = await predicted(client, recording, from_s=0.3, to_s=0.6, points=20)
    assert (part["from_s"], part["to_s"]) == (pytest.approx(0.3, abs=0.01), pytest.approx(0.6, abs=0.01))
    assert 55 <= residual(part)["samples"] <= 62 < residual(whole)["samples"]
    assert len(part["channels"][0]["curves"][0]["time_s"]) <= 20


async def test_what_nobody_can_tell_is_said(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    await ready(client, "tmc5160")
    recording = await start(client, device="other", channels=BOTH, rate_hz=200.0)
    await client.put("devices/other/registers/XTARGET", params={"axis": 0}, json={"value": 5000})
    await run(clock, 2.0)
    await client.post("devices/other/axes/0/move", json={"target": 0})
    await run(clock, 0.2)
    await client.patch("devices/other/emulator", json={"axes": [{"axis": 0, "switches": {"left": True}}]})
    await run(clock, 1.0)
    await client.post(f"recordings/{recording}/stop")
    found = await predicted(client, recording)
    assert "XTARGET was written by hand" in found["notes"][0]
    assert found["motions"] == 1
    still = await start(client, channels=["position.1"])
    await run(clock, 0.3)
    await client.post(f"recordings/{still}/stop")
    found = await predicted(client, still, axis=1)
    assert found["notes"] == ["nothing told axis 1 to move while this was recorded"]
    assert residual(found, "position.1")["rms"] is None


async def test_settings_that_were_not_read_are_missing(app: FastAPI, client: httpx.AsyncClient) -> None:
    """A recording whose device did not answer when it began: nothing is claimed."""
    library = bench_of(app).recordings.library
    for model, words in (("tmc5160", "settings at the start were not read"), ("tmc2209", "how a tmc2209 moves")):
        of = library.new_id(1e9)
        head = Head(of, "gone", model, (Column("position.0", "microsteps"),), 100.0, 1e9, 1e9, True, 16e6)
        writer = library.begin(head, Label("old"))
        writer.append(Rows(np.arange(5) / 100, np.zeros((1, 5))))
        writer.close()
        library.ended(of)
        found = await predicted(client, of)
        assert found["motions"] == 0
        assert words in found["notes"][0]


async def test_the_report_has_it_where_it_is_asked_for(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    recording = await start(client, rate_hz=200.0)
    await client.post("devices/bench/axes/0/move", json={"target": 2000})
    await run(clock, 2.0)
    await client.post(f"recordings/{recording}/stop")
    assert "prediction" not in (await client.get(f"recordings/{recording}/report")).text
    report = (await client.get(f"recordings/{recording}/report", params={"predict": [0, 1]})).text
    assert "Beside the prediction of axis 0" in report
    assert "position.0 less its prediction" in report
    assert "nothing told axis 1 to move" in report
    assert (await client.get(f"recordings/{recording}/report", params={"predict": 30})).status_code == 422
