"""Looking at recordings: zoomed frames, figures of a part, spectra, comparisons, and a disk that fills up."""

from __future__ import annotations

import httpx
import numpy as np
import pytest
from fastapi import FastAPI

from app.clock import VirtualClock
from app.main import bench_of
from app.recording.service import RecordingService
from app.telemetry.frames import decode
from tests.api.test_recordings import CHANNELS, detail, run, start


async def move_recorded(client: httpx.AsyncClient, clock: VirtualClock, target: int, **more: object) -> str:
    """A recording of a move from 0 to `target`, triggered by it."""
    recording = await start(client, trigger={"kind": "move", "axis": 0, "pre_s": 0.2}, **more)
    await run(clock, 0.5)
    await client.post("devices/bench/axes/0/move", json={"target": target})
    await run(clock, 2.0)
    await client.post(f"recordings/{recording}/stop")
    await client.post("devices/bench/axes/0/move", json={"target": 0})
    await run(clock, 3.0)
    return recording


async def test_a_frame_shows_what_the_plot_shows(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    recording = await move_recorded(client, clock, 2000, rate_hz=1000.0)
    for query in ({"points": 60}, {"points": 60, "from_s": 0.25, "to_s": 0.75}, {"points": 9000}):
        answer = await client.get(f"recordings/{recording}/plot", params={"format": "frame", **query})
        assert answer.headers["content-type"] == "application/vnd.stepscope.frame"
        frame = decode(answer.content)
        plot = (await client.get(f"recordings/{recording}/plot", params=query)).json()
        assert int(answer.headers["stepscope-rows"]) == plot["rows"]
        assert frame.time_s[0] == pytest.approx(plot["from_s"])
        assert frame.time_s[-1] <= plot["to_s"] + 1e-9
        for values, curve in zip(frame.columns, plot["curves"], strict=True):
            assert (values.min(), values.max()) == (min(curve["values"]), max(curve["values"]))
    one = {"format": "frame", "channel": "position.0"}
    assert (await client.get(f"recordings/{recording}/plot", params=one)).status_code == 422


async def test_figures_of_a_part(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    recording = await move_recorded(client, clock, 2000)
    before = (await client.get(f"recordings/{recording}/figures", params={"to_s": -0.05})).json()
    assert before["figures"]["position.0"]["maximum"] == 0
    assert before["to_s"] <= -0.05
    whole = (await client.get(f"recordings/{recording}/figures")).json()
    assert whole["figures"]["position.0"]["peak"] == 2000
    assert whole["figures"] == (await detail(client, recording))["figures"]
    assert (await client.get(f"recordings/{recording}", params={"figures": "false"})).json()["figures"] == {}


async def test_the_following_error_is_counted_where_the_plan_is_recorded(
    client: httpx.AsyncClient, clock: VirtualClock
) -> None:
    recording = await move_recorded(client, clock, 2000, channels=["position.0", "predicted_position.0"])
    figures = (await detail(client, recording))["figures"]
    assert abs(figures["following_error.0"]["peak"]) <= 2, "the TMC428's ramp is known tick by tick"  # type: ignore[index]


async def test_two_moves_lie_on_each_other(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    first = await move_recorded(client, clock, 2000, name="far")
    second = await move_recorded(client, clock, 1500, name="near")
    body = {"recordings": [first, second], "channels": ["position.0"]}
    found = (await client.post("recordings/compare", json=body)).json()
    assert found["notes"] == []
    assert [side["name"] for side in found["recordings"]] == ["far", "near"]
    assert [side["figures"]["position.0"]["last"] for side in found["recordings"]] == [2000, 1500]
    channel = found["channels"][0]
    assert [curve["recording"] for curve in channel["curves"]] == [first, second]
    starts = [curve["time_s"][int(np.argmax(np.array(curve["values"]) > 0))] for curve in channel["curves"]]
    assert starts[0] == pytest.approx(starts[1], abs=0.011)
    difference = channel["differences"][0]
    assert (difference["recording"], difference["figures"]["peak"]) == (second, -500)
    assert difference["values"][0] == 0

    with_itself = {"recordings": [first, first]}
    assert (await client.post("recordings/compare", json=with_itself)).status_code == 422
    for method in ("GET", "PUT", "PATCH", "DELETE"):
        assert (await client.request(method, "recordings/compare", json={})).status_code == 405
    unknown = {"recordings": [first, second], "channels": ["colour.0"]}
    assert (await client.post("recordings/compare", json=unknown)).status_code == 404


async def test_what_has_no_trigger_or_move_is_told(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    ids = [await move_recorded(client, clock, 1000)]
    for channels in (CHANNELS, ["velocity.1"]):
        ids.append(await start(client, channels=channels, name="still"))
        await run(clock, 0.3)
        await client.post(f"recordings/{ids[-1]}/stop")
    for align, words in (("trigger", "no trigger"), ("move", "no move")):
        found = (await client.post("recordings/compare", json={"recordings": ids[:2], "align": align})).json()
        assert words in found["notes"][0]
    found = (await client.post("recordings/compare", json={"recordings": [ids[0], ids[2]], "align": "start"})).json()
    assert found["channels"] == []
    assert "no channel" in found["notes"][0]


async def test_a_spectrum(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    recording = await move_recorded(client, clock, 2000)
    query: dict[str, str | float] = {"channel": "velocity.0", "points": 50}
    found = (await client.get(f"recordings/{recording}/spectrum", params=query)).json()
    assert found["rate_hz"] == pytest.approx(100, rel=0.01)
    assert len(found["frequency_hz"]) == len(found["amplitude"]) <= 50
    assert max(found["amplitude"]) == pytest.approx(found["peak"])
    assert found["peak_hz"] < 5, "a move of two seconds has its swing far below"
    short = {**query, "from_s": 0.0, "to_s": 0.02}
    assert (await client.get(f"recordings/{recording}/spectrum", params=short)).status_code == 409
    unknown = {"channel": "colour.0"}
    assert (await client.get(f"recordings/{recording}/spectrum", params=unknown)).status_code == 404


async def test_one_that_runs_is_shown_as_far_as_it_is(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    recording = await start(client)
    rows = []
    for _ in range(3):
        await run(clock, 0.5)
        plot = await client.get(f"recordings/{recording}/plot", params={"format": "frame"})
        rows.append(len(decode(plot.content).time_s))
        line = (await client.get(f"recordings/{recording}/info")).json()
        assert (line["state"], line["rows"]) == ("recording", rows[-1])
    assert rows[0] < rows[1] < rows[2]


async def test_a_full_disk_ends_a_recording_and_says_so(
    app: FastAPI, client: httpx.AsyncClient, clock: VirtualClock, monkeypatch: pytest.MonkeyPatch
) -> None:
    recording = await start(client)
    await run(clock, 1.0)
    monkeypatch.setattr(RecordingService, "room_bytes", 0)
    await run(clock, 2.0)
    found = await detail(client, recording)
    assert (found["state"], found["rows"]) == ("done", pytest.approx(100, abs=110))
    assert "disk is full" in str(found["message"])
    assert recording not in bench_of(app).recordings.library.running
    answer = await client.post("recordings", json={"device": "bench", "channels": CHANNELS})
    assert answer.status_code == 409
    assert "delete recordings" in answer.text


async def test_marks_say_what_was_done(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    recording = await start(client)
    await client.post("devices/bench/axes/0/move", json={"target": 1000})
    await run(clock, 0.5)
    await client.post("devices/bench/axes/1/rotate", json={"velocity": 500})
    await run(clock, 0.5)
    await client.post("devices/bench/axes/1/stop")
    await run(clock, 0.5)
    await client.post(f"recordings/{recording}/stop")
    marks = (await detail(client, recording))["marks"]
    done = [(mark["axis"], mark["detail"]) for mark in marks if mark["kind"] == "command"]  # type: ignore[attr-defined]
    assert done[0] == (0, {"do": "move", "target": 1000})
    assert (1, {"do": "stop", "mode": "ramp"}) in done
    turning = next(detail for _, detail in done if detail and detail["do"] == "rotate")
    assert turning["velocity"] > 0
