"""Macros over REST: kept, made of the log, tried on a twin, run, and stopped in each kind of step."""

from __future__ import annotations

import asyncio
from typing import Any

import httpx
import pytest
from fastapi import FastAPI
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import TypeAdapter

from app.clock import VirtualClock
from app.macros.document import MacroDocument, Step
from app.macros.python import render

MODELS = ("tmc428", "tmc5160", "tmc4361", "pd42-1241")
START = {"velocity_pps": 20_000, "acceleration_pps2": 100_000}
"""What an axis is set up with before its macro."""


def document(*steps: dict[str, Any], name: str = "There and back", **more: Any) -> dict[str, Any]:
    return {"format": "stepscope.macro", "version": 1, "name": name, "steps": list(steps), **more}


def move(target: float, **more: Any) -> dict[str, Any]:
    return {"do": "move", "target": target, **more}


THERE = {"do": "wait position", "at_most_s": 20}


async def added(client: httpx.AsyncClient, model: str) -> str:
    """An emulated device of that model, ready to move: its address."""
    if model == "tmc428":
        return "devices/bench"
    body = {"name": "Mine", "model": model, "link": {"kind": "emulator"}, "start_up": model != "pd42-1241"}
    answer = await client.post("devices", json=body)
    assert answer.status_code == 201, answer.text
    return "devices/mine"


async def over(client: httpx.AsyncClient, clock: VirtualClock, device: str) -> dict[str, Any]:
    """Let time go on until the run is over."""
    for _ in range(3000):
        state: dict[str, Any] = (await client.get(f"{device}/macro-run")).json()["run"]
        if state["state"] != "running":
            return state
        await clock.advance(0.05)
    raise AssertionError(state)


async def begun(client: httpx.AsyncClient, clock: VirtualClock, device: str, *steps: dict[str, Any]) -> dict[str, Any]:
    answer = await client.post(f"{device}/macro-run", json={"document": document(*steps)})
    assert answer.status_code == 200, answer.text
    await clock.advance(0.05)
    started: dict[str, Any] = answer.json()
    return started


async def keep(client: httpx.AsyncClient, *steps: dict[str, Any], **more: Any) -> dict[str, Any]:
    answer = await client.post("macros", json={"document": document(*steps, **more)})
    assert answer.status_code == 201, answer.text
    kept: dict[str, Any] = answer.json()
    return kept


# --- kept -----------------------------------------------------------------------------------------


async def test_a_macro_is_kept_with_its_revisions(client: httpx.AsyncClient) -> None:
    first = await keep(client, move(1, relative=True, unit="rev"), THERE)
    assert (first["id"], first["revision"], first["steps"]) == ("there-and-back", 1, 2)
    assert first["texts"] == ["move axis 0 by 1 rev", "wait until axis 0 is there, at most 20 s"]
    changed = {"based_on": 1, "document": document(move(2, unit="rev"))}
    assert (await client.put("macros/there-and-back", json=changed)).json()["revision"] == 2
    refused = await client.put("macros/there-and-back", json=changed)
    assert (refused.status_code, refused.json()["type"]) == (409, "/problems/macro-changed")
    assert refused.json()["facts"]["macro"] == "there-and-back"
    earlier = (await client.get("macros/there-and-back", params={"revision": 1})).json()
    assert earlier["document"] == first["document"]
    assert [each["steps"] for each in (await client.get("macros")).json()["macros"]] == [1]
    assert (await client.delete("macros/there-and-back")).status_code == 204
    assert (await client.get("macros/there-and-back")).status_code == 404


@pytest.mark.parametrize(
    "step",
    [
        {"do": "jump"},
        {"do": "write", "name": "v_max", "axis": 0},
        {"do": "write", "name": "v_max", "value": 1, "fields": {"a": 1}},
        {"do": "move"},
        {"do": "move", "target": "1"},
        {"do": "move", "target": 1, "unit": "miles"},
        {"do": "wait", "seconds": -1},
        {"do": "wait", "seconds": 1e9},
        {"do": "wait position", "at_most_s": 0},
        {"do": "record stop"},
        {"do": "wait", "seconds": 1, "more": 1},
    ],
)
async def test_what_is_no_step_is_refused(client: httpx.AsyncClient, step: dict[str, Any]) -> None:
    assert (await client.post("macros", json={"document": document(step)})).status_code == 422


@settings(max_examples=60)
@given(st.lists(st.from_type(object), max_size=3), st.data())
def test_any_document_reads_back_as_it_was_written(rubbish: list[object], data: st.DataObject) -> None:
    del rubbish
    numbers = st.floats(-1e9, 1e9, allow_nan=False)
    axes = st.integers(0, 31)
    seconds = st.floats(0.001, 3600)
    names = st.text(st.characters(min_codepoint=32, exclude_categories=("Cc", "Cs")), min_size=1, max_size=60)
    steps = st.one_of(
        st.fixed_dictionaries({"do": st.just("write"), "name": names, "axis": axes, "value": st.integers(0, 1 << 32)}),
        st.fixed_dictionaries({"do": st.just("move"), "axis": axes, "target": numbers, "relative": st.booleans()}),
        st.fixed_dictionaries({"do": st.just("rotate"), "axis": axes, "velocity": numbers}),
        st.fixed_dictionaries({"do": st.just("wait"), "seconds": seconds}),
        st.fixed_dictionaries({"do": st.just("wait position"), "axis": axes, "at_most_s": seconds}),
        st.fixed_dictionaries(
            {
                "do": st.just("wait channel"),
                "channel": st.just("position.0"),
                "when": st.sampled_from(["above", "below"]),
                "value": numbers,
            }
        ),
        st.fixed_dictionaries({"do": st.just("profile"), "profile": st.integers(1, 1 << 50), "name": names}),
    )
    wanted = document(*data.draw(st.lists(steps, max_size=20)), name=data.draw(names))
    read = MacroDocument.model_validate(wanted)
    written = read.model_dump(mode="json")
    assert MacroDocument.model_validate(written) == read
    for step in read.steps:
        assert step.text
        assert TypeAdapter(Step).validate_python(step.model_dump(mode="json")) == step
    compile(render(read, "bench"), "macro.py", "exec")


# --- run ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("model", MODELS)
async def test_a_macro_does_its_steps_once_each_and_tells_of_them(
    client: httpx.AsyncClient, clock: VirtualClock, model: str
) -> None:
    device = await added(client, model)
    register = {
        "tmc428": ("v_max", 0, 1000),
        "tmc5160": ("VMAX", 0, 100_000),
        "tmc4361": ("VMAX", 0, 10_000 << 8),
        "pd42-1241": ("maximum_positioning_speed", 0, 20_000),
    }[model]
    before = (await client.get(f"{device}/axes/0")).json()["position"]
    steps = [
        {"do": "write", "name": register[0], "axis": register[1], "value": register[2]},
        {"do": "record start", "name": "mine", "channels": ["position.0"], "rate_hz": 100},
        move(3000, relative=True),
        THERE,
        {"do": "record stop"},
        {"do": "wait", "seconds": 0.3},
        move(-3000, relative=True),
        {"do": "wait channel", "channel": "position.0", "when": "below", "value": before + 1500, "at_most_s": 10},
        THERE,
    ]
    kept = await keep(client, *steps)
    answer = await client.post(f"{device}/macro-run", json={"macro": kept["id"]})
    assert answer.status_code == 200, answer.text
    state = await over(client, clock, device)
    assert state["state"] == "done", state["message"]
    assert [done["number"] for done in state["done"]] == [*range(1, 10)]
    came = state["done"][0]["came"]  # VMAX of a TMC5160 can be written only
    assert "read" in came if model == "tmc5160" else came == f"reads back {register[2]}"
    assert (await client.get(f"{device}/axes/0")).json()["position"] == before
    (recording,) = state["recordings"]
    assert (await client.get(f"recordings/{recording}/info")).json()["name"] == "mine"
    entries = (await client.get("audit", params={"device": device.split("/")[1]})).json()["entries"]
    (run,) = [entry for entry in entries if entry["action"] == "run macro"]
    (end,) = [entry for entry in entries if entry["action"] == "macro over"]
    (write,) = [entry for entry in entries if entry["action"] == "write" and entry["call"] == run["call"]]
    assert (run["subject"], end["new"], end["outcome"]) == ("There and back", "9 of 9 steps", "done")
    assert (write["subject"], end["call"]) == (register[0], run["call"])


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("kind", ["move", "rotate", "wait", "wait channel"])
@pytest.mark.parametrize("how", ["macro", "axis", "all"])
async def test_a_stop_ends_it_at_once_in_each_kind_of_step(
    client: httpx.AsyncClient, clock: VirtualClock, model: str, kind: str, how: str
) -> None:
    device = await added(client, model)
    waits: dict[str, list[dict[str, Any]]] = {
        "move": [move(10_000_000, relative=True), {**THERE, "at_most_s": 3600}],
        "rotate": [{"do": "rotate", "velocity": 3000}, {"do": "wait", "seconds": 3600}],
        "wait": [{"do": "wait", "seconds": 3600}],
        "wait channel": [
            {"do": "rotate", "velocity": 3000},
            {"do": "wait channel", "channel": "velocity.0", "when": "above", "value": 1e9, "at_most_s": 3600},
        ],
    }
    if model == "tmc428":
        waits["move"][0]["target"] = 3_000_000
    last = {"do": "write", "name": "v_max", "axis": 0, "value": 1}
    await begun(client, clock, device, *waits[kind], last)
    await clock.advance(0.5)
    stop = {
        "macro": client.delete(f"{device}/macro-run"),
        "axis": client.post(f"{device}/axes/0/stop", json={"mode": "immediate"}),
        "all": client.post("stop", json={"mode": "immediate"}),
    }
    for name, call in stop.items():
        if name != how:
            call.close()
    stopping = asyncio.create_task(stop[how])
    while not stopping.done():
        await clock.advance(0.01)
    assert stopping.result().status_code == 200
    state = (await client.get(f"{device}/macro-run")).json()["run"]
    assert state["state"] == "aborted"
    assert f"step {len(waits[kind])} of" in state["message"]
    assert len(state["done"]) == len(waits[kind]) - 1
    await clock.advance(2.0)
    assert not (await client.get(f"{device}/axes/0")).json()["moving"]


async def test_a_stop_of_one_axis_stops_all_that_it_moves(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    steps = [{"do": "rotate", "axis": axis, "velocity": 2000} for axis in (0, 1, 2)]
    await begun(client, clock, "devices/bench", *steps, {"do": "wait", "seconds": 100})
    await clock.advance(0.5)
    assert all([(await client.get(f"devices/bench/axes/{axis}")).json()["moving"] for axis in (0, 1, 2)])
    await client.post("devices/bench/axes/1/stop")
    await clock.advance(3.0)
    for axis in (0, 1, 2):
        assert not (await client.get(f"devices/bench/axes/{axis}")).json()["moving"]
    assert (await client.get("devices/bench/macro-run")).json()["run"]["state"] == "aborted"


@pytest.mark.parametrize("kind", ["move", "wait", "wait channel"])
async def test_a_dead_link_ends_it_with_its_step(
    client: httpx.AsyncClient, clock: VirtualClock, app: FastAPI, kind: str
) -> None:
    device = await added(client, "tmc5160")
    steps: dict[str, list[dict[str, Any]]] = {
        "move": [move(10_000_000, relative=True), {**THERE, "at_most_s": 3600}],
        "wait": [{"do": "wait", "seconds": 3600}],
        "wait channel": [
            {"do": "wait channel", "channel": "velocity.0", "when": "above", "value": 1e9, "at_most_s": 3600}
        ],
    }
    await begun(client, clock, device, *steps[kind])
    answer = await client.patch(f"{device}/emulator", json={"link": {"silent": True}})
    if answer.status_code != 200:
        await client.post(f"{device}/disconnect")
    state = await over(client, clock, device)
    assert state["state"] in ("failed", "aborted")
    assert f"step {len(steps[kind])} of" in state["message"]


async def test_what_is_refused_names_the_step_and_what_is_done(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    limits = {"position_min": -5000, "position_max": 5000}
    device = await added(client, "tmc5160")
    answer = await client.patch(device, json={"axes": [{"name": "x", "limits": limits}]})
    assert answer.status_code == 200, answer.text
    kept = await keep(client, move(1000), THERE, move(9000), THERE)
    await client.post(f"{device}/macro-run", json={"macro": kept["id"]})
    state = await over(client, clock, device)
    assert state["state"] == "failed"
    assert state["message"].startswith("step 3 of 4, move axis 0 to 9000 microsteps: ")
    assert "5000" in state["message"]
    assert [done["came"] for done in state["done"]][1] == "at 1000"
    tried = (await client.post(f"{device}/macro-trial", json={"macro": kept["id"]})).json()
    assert (tried["passed"], tried["why_not"]) == (False, "")
    assert "5000" in tried["run"]["message"], "the twin has the soft limits too"


async def test_one_run_a_device_at_a_time(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    await begun(client, clock, "devices/bench", {"do": "wait", "seconds": 100})
    again = await client.post("devices/bench/macro-run", json={"document": document(move(1))})
    assert (again.status_code, "a macro runs" in again.json()["detail"]) == (409, True)
    other = await client.post("devices/slider/macro-run", json={"document": document({"do": "wait", "seconds": 0.1})})
    assert other.status_code == 200
    await client.delete("devices/bench/macro-run")
    assert (await over(client, clock, "devices/slider"))["state"] == "done"


async def test_it_runs_on_the_model_that_it_was_made_for(client: httpx.AsyncClient) -> None:
    wrong = {"document": document(move(1), model="tmc5160")}
    answer = await client.post("devices/bench/macro-run", json=wrong)
    assert (answer.status_code, "for a tmc5160" in answer.json()["detail"]) == (409, True)
    assert "for a tmc5160" in (await client.post("devices/bench/macro-trial", json=wrong)).json()["why_not"]
    far = {"document": document(move(1, axis=7))}
    assert (await client.post("devices/bench/macro-run", json=far)).status_code == 422


async def test_a_profile_is_a_step(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    made = (await client.get("devices/bench/profile")).json()
    saved = (await client.post("profiles", json={"document": made, "name": "As it was"})).json()
    was = (await client.get("devices/bench/registers/v_max", params={"axis": 0})).json()["value"]
    steps = [
        {"do": "write", "name": "v_max", "axis": 0, "value": was - 1},
        {"do": "profile", "profile": saved["id"]},
    ]
    await begun(client, clock, "devices/bench", *steps)
    state = await over(client, clock, "devices/bench")
    assert state["state"] == "done", state["message"]
    assert "1 registers" in state["done"][1]["came"]
    assert (await client.get("devices/bench/registers/v_max", params={"axis": 0})).json()["value"] == was


# --- tried ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("model", MODELS)
async def test_a_trial_shows_what_it_would_do_and_moves_nothing(
    client: httpx.AsyncClient, clock: VirtualClock, model: str
) -> None:
    device = await added(client, model)
    await begun(client, clock, device, move(700), THERE)
    assert (await over(client, clock, device))["state"] == "done"
    kept = await keep(client, move(4000, relative=True), THERE, {"do": "rotate", "velocity": -2000})
    answer = await client.post(f"{device}/macro-trial", json={"macro": kept["id"]})
    assert answer.status_code == 200, answer.text
    tried = answer.json()
    assert (tried["passed"], tried["why_not"]) == (True, ""), tried
    seen = tried["axes"][0]
    start = 700 if model != "pd42-1241" else seen["start"]
    assert (seen["start"], seen["greatest"]) == (start, start + 4000)
    assert any("still turns at the end" in warning for warning in tried["warnings"])
    assert (await client.get(f"{device}/axes/0")).json()["position"] == 700, "nothing moved here"
    standing = (await client.get(f"{device}/macro-run")).json()
    assert standing["tried"] == [{"macro": kept["id"], "revision": 1, "passed": True}]
    await client.put(f"macros/{kept['id']}", json={"based_on": 1, "document": document(move(1))})
    again = (await client.get(f"{device}/macro-run")).json()["tried"]
    assert again == [{"macro": kept["id"], "revision": 2, "passed": None}], "another revision was not tried"


# --- made of the log ------------------------------------------------------------------------------


async def test_what_one_does_becomes_steps(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    newest = (await client.get("audit", params={"limit": 1})).json()["entries"][0]["id"]
    await client.put("devices/bench/registers/v_max", params={"axis": 0}, json={"value": 900})
    recording = {"device": "bench", "channels": ["position.0", "velocity.0"], "rate_hz": 100, "name": "run"}
    made = (await client.post("recordings", json=recording)).json()
    body = {"target": 0.5, "relative": True, "unit": "rev"}
    await client.post("devices/bench/axes/0/move", json=body)
    await client.post("devices/bench/axes/1/move", json={"target": 1234})
    await client.post("devices/bench/axes/1/move", json={"target": 1e12})  # refused
    await client.post("devices/bench/axes/2/rotate", json={"velocity": 2, "unit": "rps"})
    await client.post("devices/bench/axes/2/stop", json={"mode": "ramp"})
    await client.post(f"recordings/{made['id']}/stop")
    await client.post("devices/bench/axes/0/shuttle", json={"first": 0, "second": 100})
    draft = (await client.get("devices/bench/macro-draft", params={"after": newest})).json()
    steps = [step for step in draft["document"]["steps"] if step["do"] not in ("wait", "wait position")]
    assert steps == [
        {"do": "write", "name": "v_max", "axis": 0, "value": 900, "fields": None},
        {"do": "record start", "name": "run", "channels": ["position.0", "velocity.0"], "rate_hz": 100},
        {"do": "move", "axis": 0, "target": 0.5, "relative": True, "unit": "rev"},
        {"do": "move", "axis": 1, "target": 1234, "relative": False, "unit": "microsteps"},
        {"do": "rotate", "axis": 2, "velocity": 2, "unit": "rps"},
        {"do": "stop", "axis": 2, "mode": "ramp"},
        {"do": "record stop"},
    ]
    assert any("refused" in line for line in draft["left_out"])
    assert any("shuttle" in line and "no step" in line for line in draft["left_out"])
    await client.delete("devices/bench/axes/0/shuttle")
    kept = await client.post("macros", json={"document": draft["document"]})
    assert kept.status_code == 201, kept.text
