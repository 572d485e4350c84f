"""Recordings over REST: started, triggered, listed, plotted, handed on; real chip, the test's time."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path

import httpx
import numpy as np
import pyarrow as pa
import pyarrow.parquet
import pytest
from fastapi import FastAPI

from app.clock import VirtualClock
from app.main import bench_of
from app.settings import Settings
from app.store.recordings.file import Rows
from app.store.recordings.head import Column, Head
from app.store.recordings.library import Label
from app.store.recordings.opened import PIECE_ROWS

CHANNELS = ["position.0", "velocity.0"]
MISSING = "20200101-000000-0000"


async def start(client: httpx.AsyncClient, **more: object) -> str:
    body = {"device": "bench", "channels": CHANNELS, "rate_hz": 100.0, **more}
    answer = await client.post("recordings", json=body)
    assert answer.status_code == 201, answer.text
    recording: str = answer.json()["id"]
    return recording


async def run(clock: VirtualClock, seconds: float) -> None:
    """Time goes on in beats, as the pump's does."""
    for _ in range(round(seconds / 0.05)):
        await clock.advance(0.05)


async def with_gap(client: httpx.AsyncClient, clock: VirtualClock) -> str:
    """A recording of 2 s, in whose middle half the device does not answer."""
    recording = await start(client)
    await run(clock, 0.5)
    await client.patch("devices/bench/emulator", json={"faults": {"unplugged": True}})
    await run(clock, 1.0)
    await client.patch("devices/bench/emulator", json={"faults": {"unplugged": False}})
    await client.post("devices/bench/connect")
    await run(clock, 0.5)
    await client.post(f"recordings/{recording}/stop")
    return recording


async def detail(client: httpx.AsyncClient, recording: str) -> dict[str, object]:
    answer = await client.get(f"recordings/{recording}")
    assert answer.status_code == 200, answer.text
    found: dict[str, object] = answer.json()
    return found


async def test_a_move_is_recorded_with_everything_around_it(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    recording = await start(client, name="first run", note="warm motor")
    await client.post("devices/bench/axes/0/move", json={"target": 2000})
    await run(clock, 2.0)
    await client.post(f"recordings/{recording}/marks", json={"text": "here it sang"})
    stopped = (await client.post(f"recordings/{recording}/stop")).json()
    assert (stopped["state"], stopped["message"]) == ("done", "")

    found = await detail(client, recording)
    assert (found["name"], found["note"], found["device"], found["model"]) == (
        "first run",
        "warm motor",
        "bench",
        "tmc428",
    )
    assert found["rows"] == pytest.approx(200, abs=15)
    assert found["duration_s"] == pytest.approx(2.0, abs=0.15)
    kinds = [mark["kind"] for mark in found["marks"]]  # type: ignore[attr-defined]
    assert "move" in kinds
    assert "note" in kinds
    assert [mark["text"] for mark in found["marks"] if mark["kind"] == "note"] == ["here it sang"]  # type: ignore[attr-defined]
    position = found["figures"]["position.0"]  # type: ignore[index]
    assert (position["first"], position["last"], position["overshoot"]) == (0, 2000, 0)
    assert 0 < position["settling_s"] < 2
    registers = {(entry["name"], entry["axis"]): entry["value"] for entry in found["configuration"]["registers"]}  # type: ignore[index]
    assert registers["v_max", 0] > 0


async def test_a_stop_keeps_what_was_sampled_until_then(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    recording = await start(client)
    await run(clock, 1.0)
    clock.set(clock.now() + 0.09)  # between two beats of the recorder, and of the pump
    await client.post(f"recordings/{recording}/stop")
    found = await detail(client, recording)
    assert found["duration_s"] == pytest.approx(1.09, abs=0.015)


@pytest.mark.parametrize(("level", "rising"), [(500.0, True), (1500.0, False)])
async def test_a_level_triggers_and_what_was_before_is_kept(
    client: httpx.AsyncClient, clock: VirtualClock, level: float, rising: bool
) -> None:
    if not rising:
        await client.post("devices/bench/axes/0/move", json={"target": 2000})
        await run(clock, 2.0)
    trigger = {"kind": "level", "channel": "position.0", "level": level, "rising": rising, "pre_s": 0.2}
    recording = await start(client, trigger=trigger, duration_s=0.5)
    await run(clock, 1.0)
    assert (await client.get("recordings")).json()["recordings"][0]["state"] == "waiting"
    await client.post("devices/bench/axes/0/move", json={"target": 2000 if rising else 0})
    await run(clock, 2.0)
    found = await detail(client, recording)
    assert found["state"] == "done"
    assert found["duration_s"] == pytest.approx(0.7, abs=0.03)

    plot = (await client.get(f"recordings/{recording}/plot")).json()
    assert plot["from_s"] == pytest.approx(-0.2, abs=0.011)
    assert plot["to_s"] == pytest.approx(0.5, abs=0.011)
    curve = plot["curves"][0]
    at_zero = curve["time_s"].index(min(curve["time_s"], key=abs))
    before, at = curve["values"][at_zero - 1], curve["values"][at_zero]
    assert (before < level <= at) if rising else (before > level >= at)


async def test_a_move_triggers(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    recording = await start(client, trigger={"kind": "move", "axis": 1, "pre_s": 0.1}, duration_s=0.3)
    await client.post("devices/bench/axes/0/move", json={"target": 2000})
    await run(clock, 0.5)
    assert (await detail(client, recording))["rows"] == 0
    await client.post("devices/bench/axes/1/move", json={"target": 2000})
    await run(clock, 1.0)
    found = await detail(client, recording)
    assert (found["state"], found["duration_s"]) == ("done", pytest.approx(0.4, abs=0.03))


async def test_files_for_other_programs(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    recording = await start(client)
    await client.post("devices/bench/axes/0/move", json={"target": 1000})
    await run(clock, 1.0)
    await client.post(f"recordings/{recording}/stop")

    answer = await client.get(f"recordings/{recording}?format=csv")
    assert answer.headers["content-type"].startswith("text/csv")
    assert f'filename="{recording}.csv"' in answer.headers["content-disposition"]
    lines = list(csv.reader(io.StringIO(answer.text)))
    assert lines[0] == ["time_s", *CHANNELS]
    assert float(lines[-1][1]) == 1000

    parquet = (await client.get(f"recordings/{recording}?format=parquet")).content
    table = pyarrow.parquet.ParquetFile(io.BytesIO(parquet)).read(use_threads=False)
    assert table.column_names == ["time_s", *CHANNELS]
    assert table.field("velocity.0").metadata == {b"unit": b"pps"}
    assert table["position.0"].to_pylist() == [float(line[1]) for line in lines[1:]]
    assert json.loads(table.schema.metadata[b"stepscope"])["device"] == "bench"


async def test_a_long_recording_goes_out_piece_by_piece(client: httpx.AsyncClient, app: FastAPI) -> None:
    library = bench_of(app).recordings.library
    head = Head("20261123-200000-0a0a", "bench", "tmc428", (Column("a.0", "pps"),), 1000.0, 0.0, 0.0, True, 16e6)
    writer = library.begin(head, Label("long"))
    values = np.arange(3 * PIECE_ROWS, dtype=float)
    for part in np.array_split(values, 30):
        writer.append(Rows(part / 1000, part[None]))
    writer.close()
    library.ended(head.id)
    async with client.stream("GET", f"recordings/{head.id}?format=csv") as answer:
        assert "content-length" not in answer.headers
        lines = (await answer.aread()).decode().splitlines()
    assert lines[0] == '"time_s","a.0"'
    assert [float(line.split(",")[1]) for line in lines[1:]] == values.tolist()
    parquet = (await client.get(f"recordings/{head.id}?format=parquet")).content
    assert (
        pyarrow.parquet.ParquetFile(io.BytesIO(parquet)).read(use_threads=False)["a.0"].to_pylist() == values.tolist()
    )
    assert pyarrow.parquet.ParquetFile(io.BytesIO(parquet)).num_row_groups >= 3
    found = (await client.get(f"recordings/{head.id}/figures")).json()
    assert (found["from_s"], found["to_s"]) == (0.0, values[-1] / 1000)
    assert found["figures"]["a.0"]["mean"] == pytest.approx(values.mean())


async def test_the_list_is_searched_renamed_and_cleared(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    ids = []
    for name in ("Slow run", "fast run", "third"):
        ids.append(await start(client, name=name))
        await run(clock, 0.2)
        await client.post(f"recordings/{ids[-1]}/stop")

    async def names(**query: str) -> set[str]:
        listed: set[str] = set()
        before: str | None = ""
        while before is not None:  # a page ends early where this machine is too slow to read all at once
            found = (await client.get("recordings", params={**query, "before": before})).json()
            size_bytes = sum(each["size_bytes"] for each in found["recordings"])
            assert found["size_bytes"] >= size_bytes > 0 or not found["recordings"]
            listed |= {each["name"] for each in found["recordings"]}
            before = found["next"]
        assert (found["total"], found["unread"]) == (len(listed), 0)
        return listed

    assert await names() == {"Slow run", "fast run", "third"}
    assert await names(search="RUN slow") == {"Slow run"}
    assert await names(search="tmc428 bench") == {"Slow run", "fast run", "third"}
    assert await names(device="slider") == set()
    await client.patch(f"recordings/{ids[2]}", json={"note": "the slow one"})
    assert await names(search="slow") == {"Slow run", "third"}
    assert (await client.delete(f"recordings/{ids[0]}")).status_code == 204
    assert await names() == {"fast run", "third"}
    assert (await client.get(f"recordings/{ids[0]}")).status_code == 404


async def test_a_long_one_is_thinned_and_no_peak_hidden(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    recording = await start(client, rate_hz=1000.0)
    await client.post("devices/bench/axes/0/move", json={"target": 3000})
    await run(clock, 3.0)
    await client.post(f"recordings/{recording}/stop")
    whole = (await client.get(f"recordings/{recording}/plot", params={"points": 100_000})).json()
    thin = (await client.get(f"recordings/{recording}/plot", params={"points": 60})).json()
    assert (whole["thinned"], thin["thinned"]) == (False, True)
    for full, few in zip(whole["curves"], thin["curves"], strict=True):
        assert len(few["values"]) <= 60 < len(full["values"])
        assert (max(few["values"]), min(few["values"])) == (max(full["values"]), min(full["values"]))
    part: dict[str, str | float] = {"from_s": 0.5, "to_s": 0.6, "channel": "position.0"}
    zoomed = (await client.get(f"recordings/{recording}/plot", params=part)).json()
    assert [curve["channel"] for curve in zoomed["curves"]] == ["position.0"]
    assert zoomed["rows"] == pytest.approx(100, abs=2)
    assert 0.5 <= zoomed["from_s"] <= zoomed["to_s"] <= 0.6


async def test_a_device_that_fails_leaves_a_gap(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    recording = await with_gap(client, clock)
    found = await detail(client, recording)
    assert "gap" in [mark["kind"] for mark in found["marks"]]  # type: ignore[attr-defined]
    assert found["figures"]["position.0"]["missing"] >= 1  # type: ignore[index]
    values = (await client.get(f"recordings/{recording}/plot")).json()["curves"][0]["values"]
    assert None in values


async def test_a_removed_device_ends_it(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    recording = await start(client)
    await run(clock, 0.5)
    await client.delete("devices/bench")
    await run(clock, 0.2)
    found = await detail(client, recording)
    assert found["state"] == "done"
    assert "removed" in str(found["message"])
    assert found["rows"] == pytest.approx(50, abs=10)


async def test_the_end_of_the_server_ends_it_properly(
    app: FastAPI, client: httpx.AsyncClient, clock: VirtualClock, settings: Settings
) -> None:
    recording = await start(client)
    await run(clock, 0.5)
    await app.state.bench.recordings.close()
    path = settings.data_dir / "recordings" / f"{recording}.arrows"
    table = pa.ipc.open_stream(path.read_bytes()).read_all()
    assert table.num_rows == pytest.approx(50, abs=10)


@pytest.mark.parametrize(
    ("body", "status", "words"),
    [
        ({"device": "nobody", "channels": CHANNELS}, 404, "known: bench"),
        ({"device": "bench", "channels": ["colour.0"]}, 404, "colour.0"),
        ({"device": "bench", "channels": []}, 422, "channels"),
        ({"device": "bench", "channels": CHANNELS, "rate_hz": 5000.0}, 422, "1000"),
        (
            {
                "device": "bench",
                "channels": CHANNELS,
                "trigger": {"kind": "level", "channel": "deviation.0", "level": 1.0},
            },
            404,
            "deviation.0",
        ),
        ({"device": "bench", "channels": CHANNELS, "trigger": {"kind": "move", "axis": 9}}, 404, "axis"),
        ({"device": "bench", "channels": CHANNELS, "duration_s": -1.0}, 422, "duration_s"),
    ],
)
async def test_what_cannot_be_recorded_leaves_nothing(
    client: httpx.AsyncClient, body: dict[str, object], status: int, words: str
) -> None:
    answer = await client.post("recordings", json=body)
    assert answer.status_code == status, answer.text
    assert words in answer.text
    listed = (await client.get("recordings")).json()
    assert (listed["recordings"], listed["size_bytes"]) == ([], 0)


async def test_one_that_runs_is_not_deleted_and_one_that_is_over_not_marked(
    client: httpx.AsyncClient, clock: VirtualClock
) -> None:
    recording = await start(client)
    await run(clock, 0.2)
    assert (await client.delete(f"recordings/{recording}")).status_code == 409
    await client.post(f"recordings/{recording}/stop")
    assert (await client.post(f"recordings/{recording}/marks", json={"text": "late"})).status_code == 409
    assert (await client.post(f"recordings/{recording}/stop")).status_code == 200
    assert (await client.delete(f"recordings/{recording}")).status_code == 204


@pytest.mark.parametrize("name", [MISSING, "..", "x", "%2e%2e%2fconnections", "20200101-000000-0000.json"])
@pytest.mark.parametrize("method", ["GET", "DELETE", "PATCH"])
async def test_an_id_never_leads_elsewhere(client: httpx.AsyncClient, name: str, method: str) -> None:
    answer = await client.request(method, f"recordings/{name}", json={} if method == "PATCH" else None)
    assert answer.status_code in (404, 405)


async def test_a_file_that_is_none_is_told(client: httpx.AsyncClient, settings: Settings) -> None:
    folder = Path(settings.data_dir) / "recordings"
    folder.mkdir(parents=True)
    (folder / f"{MISSING}.arrows").write_bytes(b"nonsense")
    listed = (await client.get("recordings")).json()["recordings"][0]
    assert (listed["state"], listed["device"]) == ("failed", None)
    assert "Arrow" in listed["message"]
    answer = await client.get(f"recordings/{MISSING}")
    assert answer.status_code == 409
    assert (await client.delete(f"recordings/{MISSING}")).status_code == 204


async def test_rows_are_in_the_order_of_time(
    client: httpx.AsyncClient, clock: VirtualClock, settings: Settings
) -> None:
    recording = await start(client)
    await run(clock, 1.0)
    path = settings.data_dir / "recordings" / f"{recording}.arrows"
    while_it_runs = pa.ipc.open_stream(path.read_bytes())
    rows = [batch for batch in while_it_runs if batch.num_rows]
    time_s = np.concatenate([batch.column("time_s").to_numpy() for batch in rows])
    assert len(time_s) >= 80, "what was sampled is in the file, but for the last beat"
    assert np.all(np.diff(time_s) > 0)


async def test_a_recording_has_tags_a_colour_and_a_notebook(client: httpx.AsyncClient) -> None:
    recording = await start(client, name="first run")
    path = f"recordings/{recording}"
    cells = [
        {"kind": "text", "text": "It rings at **80 Hz**.", "from_s": None, "to_s": None, "channels": []},
        {"kind": "figure", "text": "", "from_s": 0.1, "to_s": 0.5, "channels": ["position.0"]},
    ]
    told = (
        await client.patch(path, json={"tags": ["warm", "warm", " x "], "colour": "green", "notebook": cells})
    ).json()
    assert (told["tags"], told["colour"], told["name"]) == (["warm", "x"], "green", "first run")
    assert (await client.get(path)).json()["notebook"] == cells
    assert (await client.patch(path, json={"name": "again"})).json()["tags"] == ["warm", "x"]
    assert (await client.get(path)).json()["notebook"] == cells
    for wrong in ({"tags": [""]}, {"colour": "red"}, {"notebook": [{"kind": "code"}]}, {"tags": ["x"] * 13}):
        assert (await client.patch(path, json=wrong)).status_code == 422
    backwards = {"notebook": [{"kind": "figure", "from_s": 2, "to_s": 1}]}
    assert (await client.patch(path, json=backwards)).status_code in (400, 422)
    stale = await client.patch(path, json={"notebook": cells, "notebook_revision": 0})
    assert stale.status_code == 409
    assert "has revision 1 by now" in stale.json()["detail"]


async def test_the_report_shows_the_notebook(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    recording = await start(client)
    path = f"recordings/{recording}"
    await run(clock, 1.0)
    await client.post(f"{path}/stop")
    plain = (await client.get(f"{path}/report")).text
    assert "Notebook" not in plain
    cells = [
        {"kind": "text", "text": "It <b>rings</b> at 80 Hz."},
        {"kind": "figure", "from_s": 0.1, "to_s": 0.5, "channels": ["position.0", "gone.0"]},
        {"kind": "table", "from_s": 0.2, "to_s": 0.4, "channels": ["velocity.0"]},
    ]
    await client.patch(path, json={"notebook": cells})
    told = (await client.get(f"{path}/report")).text
    assert "It &lt;b&gt;rings&lt;/b&gt; at 80 Hz." in told
    assert told.count("<svg") == plain.count("<svg") + 1
    assert told.count("<table") == plain.count("<table") + 1
    assert "0.2 to 0.4 s" in told


async def test_a_file_of_an_instrument_lies_beside_a_recording(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    recording = await start(client)
    path = f"recordings/{recording}"
    await run(clock, 0.3)
    await client.post("devices/bench/axes/0/move", json={"target": 1000})
    await run(clock, 1.0)
    await client.post(f"{path}/stop")
    told = (await client.get(f"{path}/plot")).json()
    position = next(curve for curve in told["curves"] if curve["channel"] == "position.0")
    # a scope's record of the same move, upside down, which began its own time 5 s late
    rows = [
        f"{at_s - 5},{2 - 0.001 * value}," for at_s, value in zip(position["time_s"], position["values"], strict=True)
    ]
    text = "\n".join(["time (s),CH1 (V),position.0 (A)", *rows])

    async def add(name: str, content: str) -> httpx.Response:
        return await client.post(
            f"{path}/added", params={"name": name}, content=content.encode(), headers={"content-type": "text/csv"}
        )

    added = (await add("scope.csv", text)).json()
    assert (added["number"], added["offset_s"], added["rows"]) == (0, 0.0, len(rows))
    assert [(each["name"], each["unit"]) for each in added["channels"]] == [("CH1", "V"), ("position.0 (2)", "A")]
    like = await client.patch(f"{path}/added/0", json={"like": "position.0"})
    assert like.json()["offset_s"] == pytest.approx(5, abs=0.002)
    assert "correlation -" in like.json()["aligned"]
    shown = (await client.get(f"{path}/plot", params={"channel": ["CH1", "position.0 (2)"]})).json()["curves"]
    assert [curve["channel"] for curve in shown] == ["CH1", "position.0 (2)"]
    assert shown[0]["time_s"][0] == pytest.approx(position["time_s"][0], abs=0.002)
    assert set(shown[1]["values"]) == {None}, "what is missing is no 0"
    figures = (await client.get(f"{path}/figures", params={"from_s": 0.9})).json()["figures"]
    assert figures["CH1"]["mean"] == pytest.approx(1.0, abs=1e-6)
    assert figures["position.0 (2)"]["samples"] == 0
    assert "CH1" in (await client.get(f"{path}/report")).text
    assert (await client.patch(f"{path}/added/0", json={"offset_s": -1.5})).json()["from_s"] == pytest.approx(-6.5)
    marks = (await client.get(path)).json()["marks"]
    zero_s = (await client.get(path)).json()["zero_s"]
    on_mark = (await client.patch(f"{path}/added/0", json={"mark": len(marks) - 1})).json()
    assert on_mark["offset_s"] == pytest.approx(marks[-1]["time_s"] - zero_s)
    for wrong, status in (
        ({"mark": 999}, 422),
        ({"like": "no.0"}, 404),
        ({"like": "position.0", "channel": "position.0 (2)"}, 409),
        ({"offset_s": 1, "mark": 0}, 422),
    ):
        answer = await client.patch(f"{path}/added/0", json=wrong)
        assert answer.status_code == status, answer.text
    assert (await client.get(path)).json()["added"] == [on_mark], "what was refused changed nothing"

    broken = await add("broken.csv", "time (s),U (V)\n0,1\n1,x\n")
    assert (broken.status_code, "line 3, column 2" in broken.json()["detail"]) == (422, True)
    long = "\n".join(["time (s),U (V)", *(f"{each},1" for each in range(150_000))])
    assert len(long) > 1 << 20, "more than other bodies may be"
    assert (await add("long.csv", long)).status_code == 201
    for _ in range(6):
        assert (await add("more.csv", text)).status_code == 201
    assert (await add("ninth.csv", text)).status_code == 409
    assert (await client.delete(f"{path}/added/0")).status_code == 204
    assert (await client.delete(f"{path}/added/0")).status_code == 404
    assert len((await client.get(path)).json()["added"]) == 7


async def test_channels_of_a_file_are_compared_analysed_and_exported(
    client: httpx.AsyncClient, clock: VirtualClock
) -> None:
    recordings = []
    for late in (0.0, 0.1):
        recording = await start(client)
        await run(clock, 1.0)
        await client.post(f"recordings/{recording}/stop")
        # 10 Hz of 2 V, at 1 kHz, `late` behind the recording's zero.
        text = "time [s],probe [V]\n" + "".join(
            f"{n / 1000:.3f},{2 * np.sin(2 * np.pi * 10 * n / 1000):.6f}\n" for n in range(900)
        )
        path = f"recordings/{recording}/added"
        answer = await client.post(path, params={"name": "a.csv"}, content=text, headers={"content-type": "text/csv"})
        assert answer.status_code == 201, answer.text
        moved = await client.patch(f"{path}/0", json={"offset_s": late})
        assert moved.status_code == 200, moved.text
        recordings.append(recording)
    first, second = recordings

    found = (await client.get(f"recordings/{first}/spectrum", params={"channel": "probe"})).json()
    assert found["peak_hz"] == pytest.approx(10, abs=0.6)
    assert found["peak"] == pytest.approx(2, rel=0.1)
    assert (found["unit"], found["samples"]) == ("V", 900)
    part = await client.get(f"recordings/{first}/spectrum", params={"channel": "probe", "from_s": 0.2, "to_s": 0.6})
    assert part.json()["samples"] == pytest.approx(400, abs=2)
    assert (await client.get(f"recordings/{first}/spectrum", params={"channel": "prob"})).status_code == 404

    both = (await client.post("recordings/compare", json={"recordings": recordings})).json()
    (probe,) = [each for each in both["channels"] if each["channel"] == "probe"]
    assert probe["unit"] == "V"
    assert [curve["time_s"][0] for curve in probe["curves"]] == [pytest.approx(0.0), pytest.approx(0.1)]
    assert probe["differences"][0]["figures"]["samples"] == pytest.approx(800, abs=2), "from 0.1 to 0.9 s"
    assert abs(probe["differences"][0]["figures"]["peak"]) < 0.01, "a whole period later it is the same"
    assert both["recordings"][0]["figures"]["probe"]["samples"] == 900

    lines = list(csv.reader(io.StringIO((await client.get(f"recordings/{second}", params={"format": "csv"})).text)))
    assert lines[0] == ["time_s", *CHANNELS, "probe"]
    zero_s = float(lines[1][0])
    read = {round(float(line[0]) - zero_s, 3): line[3] for line in lines[1:]}
    assert read[0.05] == "", "the file begins later"
    quarter = min(read, key=lambda at_s: abs(at_s - 0.125))
    assert float(read[quarter]) == pytest.approx(2 * np.sin(2 * np.pi * 10 * (quarter - 0.1)), abs=0.05)
    table = pa.parquet.read_table(
        io.BytesIO((await client.get(f"recordings/{second}", params={"format": "parquet"})).content)
    )
    assert table.schema.field("probe").metadata == {b"unit": b"V"}
    assert table.num_rows == len(lines) - 1
