"""Programs of a module over REST: assembled, stored, run, looked at, and what is told of mistakes."""

from __future__ import annotations

import httpx
import pytest
from fastapi import FastAPI

from app.clock import VirtualClock
from tests.calc.tmcl_programs import ROUTINES


async def test_a_program_from_its_text_to_its_end(client: httpx.AsyncClient, motor: str, clock: VirtualClock) -> None:
    stored = await client.put(f"{motor}/program", json={"text": ROUTINES})
    assert stored.status_code == 200, stored.text
    assert (stored.json()["commands"], stored.json()["labels"]["Func2"]) == (16, 1)
    held = (await client.get(f"{motor}/program", params={"count": 16})).json()
    assembled = (await client.post(f"{motor}/program/assemble", json={"text": held["text"]})).json()
    original = (await client.post(f"{motor}/program/assemble", json={"text": ROUTINES})).json()
    bytes_of = [
        [line.split("  ")[1] for line in made["listing"].split("\n\n")[0].splitlines()]
        for made in (assembled, original)
    ]
    assert bytes_of[0] == bytes_of[1]
    assert (await client.post(f"{motor}/program/run", json={"address": 1})).status_code == 204
    await clock.advance(0.1)
    state = (await client.get(f"{motor}/program/state", params={"variable": [0, 7]})).json()
    assert (state["status"], state["counter"], state["variables"]) == ("running", 9, {"0": 0, "7": 0})
    assert (await client.post(f"{motor}/program/stop")).status_code == 204
    assert (await client.post(f"{motor}/program/step")).status_code == 204
    assert (await client.get(f"{motor}/program/state")).json()["status"] == "stepping"
    assert (await client.post(f"{motor}/program/reset")).status_code == 204
    state = (await client.get(f"{motor}/program/state")).json()
    assert (state["status"], state["counter"], state["accumulator"], state["x"]) == ("stopped", 0, 0, 0)


async def test_mistakes_are_told_all_at_once(client: httpx.AsyncClient, motor: str) -> None:
    body = {"text": "#include a.tmc\nROX 0\nJA Nowhere", "name": "my.tmc", "files": {"a.tmc": "STOP 1"}}
    told = (await client.post(f"{motor}/program/assemble", json=body)).json()
    assert [(each["file"], each["line"], each["column"]) for each in told["problems"]] == [
        ("my.tmc", 2, 1),
        ("my.tmc", 3, 4),
        ("a.tmc", 1, 1),
    ]
    refused = await client.put(f"{motor}/program", json=body)
    assert refused.status_code == 422
    assert "my.tmc:2:1" in refused.json()["detail"]
    assert "a.tmc:1:1" in refused.json()["detail"]


@pytest.mark.parametrize(
    ("method", "path", "body", "status"),
    [
        ("POST", "run", {"address": 2048}, 422),
        ("POST", "run", {"address": -1}, 422),
        ("GET", "?address=2047&count=2", None, 422),
        ("GET", "state?variable=256", None, 422),
    ],
)
async def test_what_is_beyond_the_memory(
    client: httpx.AsyncClient, motor: str, method: str, path: str, body: object, status: int
) -> None:
    address = f"{motor}/program{path}" if path.startswith("?") else f"{motor}/program/{path}"
    assert (await client.request(method, address, json=body)).status_code == status


async def test_soft_limits_hold_for_programs(client: httpx.AsyncClient, motor: str) -> None:
    limits = {"axes": [{"limits": {"position_min": -1000, "position_max": 1000}}]}
    changed = await client.patch(motor, json=limits)
    assert changed.status_code == 200, changed.text
    refused = await client.put(f"{motor}/program", json={"text": "MVP ABS, 0, 5000\nSTOP"})
    assert (refused.status_code, refused.json()["type"]) == (422, "/problems/soft-limit")
    assert (await client.get(motor)).json()["state"] == "connected"


async def test_a_chip_has_no_program(client: httpx.AsyncClient) -> None:
    answer = await client.get("devices/bench/program/state")
    assert answer.status_code == 409
    assert "no memory for programs" in answer.json()["detail"]


async def test_the_wire_is_left_alone_while_nobody_listens(
    app: FastAPI, client: httpx.AsyncClient, motor: str, clock: VirtualClock
) -> None:
    device = app.state.bench.manager.get("motor")

    async def looks() -> int:
        """How often accumulator and X are asked for in a second."""
        asked = [0]
        exchange = device.session.port.exchange

        async def counted(frame: bytes, timeout_s: float | None = None) -> bytes:
            asked[0] += frame[1] == 135
            return bytes(await exchange(frame, timeout_s))

        device.session.port.exchange = counted
        await clock.advance(1.0)
        device.session.port.exchange = exchange
        return asked[0] // 2

    assert await looks() == 0
    leave = [app.state.bench.programs.join(device, [number])[1] for number in (1, 2)]
    assert 19 <= await looks() <= 21  # for both together
    leave[0]()
    assert 19 <= await looks() <= 21
    leave[1]()
    assert await looks() == 0


# --- by single steps --------------------------------------------------------------------------------

CALLS = """\
    CALC LOAD, 1
    CSUB Add
    CSUB Add
    AGP 7, 2
    STOP
Add:
    CALC ADD, 10
    WAIT TICKS, 0, 5
    RSUB
"""


async def _debugged(client: httpx.AsyncClient, motor: str, clock: VirtualClock, **body: object) -> dict[str, object]:
    begun = await client.post(f"{motor}/program/debug", json=body)
    assert (begun.status_code, begun.json()["state"]) == (200, "running"), begun.text
    for _ in range(100):
        state: dict[str, object] = (await client.get(f"{motor}/program/debug")).json()
        if state["state"] != "running":
            return state
        await clock.advance(0.01)
    raise AssertionError(f"it does not end: {state}")


async def test_breakpoints_over_and_out(client: httpx.AsyncClient, motor: str, clock: VirtualClock) -> None:
    stored = await client.put(f"{motor}/program", json={"text": CALLS})
    assert stored.status_code == 200, stored.text

    async def counter() -> int:
        return int((await client.get(f"{motor}/program/state")).json()["counter"])

    state = await _debugged(client, motor, clock, from_start=True, breakpoints=[6, 3])
    assert (state["state"], state["halted_at"], state["steps"], await counter()) == ("done", 6, 3, 6)
    assert await counter() == 6
    await _debugged(client, motor, clock, mode="out")
    assert await counter() == 2
    state = await _debugged(client, motor, clock, mode="over")
    assert (await counter(), state["steps"]) == (3, 4)
    state = await _debugged(client, motor, clock, breakpoints=[0])
    assert (state["halted_at"], state["message"]) == (None, "the program ended at 4")
    run = (await client.get(f"{motor}/program/state", params={"variable": 7})).json()
    assert (run["status"], run["accumulator"], run["variables"]) == ("stopped", 21, {"7": 21})


async def test_a_debugged_program_is_paused_and_taken_over(
    client: httpx.AsyncClient, motor: str, clock: VirtualClock
) -> None:
    await client.put(f"{motor}/program", json={"text": "Loop:\nROR 0, 2000\nJA Loop"})
    begun = await client.post(f"{motor}/program/debug", json={"from_start": True})
    assert begun.status_code == 200, begun.text
    again = await client.post(f"{motor}/program/debug", json={})
    assert (again.status_code, "a debugged program runs" in again.json()["detail"]) == (409, True)
    await clock.advance(0.5)
    changed = await client.put(f"{motor}/program/debug/breakpoints", json={"breakpoints": [1]})
    assert changed.json()["breakpoints"] == [1]
    await clock.advance(0.1)
    state = (await client.get(f"{motor}/program/debug")).json()
    assert (state["state"], state["halted_at"]) == ("done", 1)
    assert (await client.get(f"{motor}/axes/0")).json()["moving"]  # halting leaves the motor alone
    await client.post(f"{motor}/program/debug", json={})
    stopped = await client.post(f"{motor}/axes/0/stop", json={"mode": "ramp"})
    assert stopped.status_code == 200, stopped.text
    state = (await client.get(f"{motor}/program/debug")).json()
    assert (state["state"], "another command" in state["message"]) == ("aborted", True)
    await clock.advance(2.0)
    assert not (await client.get(f"{motor}/axes/0")).json()["moving"]
    assert (await client.get(f"{motor}/program/state")).json()["status"] == "stopped"


async def test_runs_by_single_steps_are_in_the_audit_log_once(
    client: httpx.AsyncClient, motor: str, clock: VirtualClock
) -> None:
    await client.put(f"{motor}/program", json={"text": CALLS})
    await _debugged(client, motor, clock, from_start=True)
    entries = (await client.get("audit", params={"device": "motor"})).json()["entries"]
    assert [each["action"] for each in entries].count("debug program") == 1
    assert [each["action"] for each in entries].count("download program") == 1


async def test_runs_are_marked_in_recordings(client: httpx.AsyncClient, motor: str, clock: VirtualClock) -> None:
    await client.put(f"{motor}/program", json={"text": CALLS})
    body = {"device": "motor", "channels": ["position.0"], "rate_hz": 100}
    recording = (await client.post("recordings", json=body)).json()["id"]
    await clock.advance(0.2)
    await client.post(f"{motor}/program/run", json={"address": 0})
    await clock.advance(0.2)
    await client.post(f"{motor}/program/reset")
    await _debugged(client, motor, clock, breakpoints=[3])
    await client.post(f"recordings/{recording}/stop")
    found = (await client.get(f"recordings/{recording}")).json()
    told = [mark["text"] for mark in found["marks"] if mark["kind"] == "command"]
    assert told == ["run application ADDRESS, 0, 0", "reset application 0", "debug program: by single steps until 3"]


@pytest.mark.parametrize(
    ("body", "told"),
    [
        ({"breakpoints": [2048]}, "address of a breakpoint"),
        ({"breakpoints": list(range(65))}, "64"),
        ({"mode": "back"}, "over"),
    ],
)
async def test_debug_runs_that_cannot_be(
    client: httpx.AsyncClient, motor: str, body: dict[str, object], told: str
) -> None:
    refused = await client.post(f"{motor}/program/debug", json=body)
    assert (refused.status_code, told in refused.json()["detail"]) == (422, True), refused.text


async def test_a_binary_file_becomes_text_and_back(client: httpx.AsyncClient, motor: str) -> None:
    made = (
        await client.post(f"{motor}/program/assemble", json={"text": CALLS, "binary": True, "listing": False})
    ).json()
    assert (made["listing"], made["lines"]) == ("", [1, 2, 3, 4, 5, 7, 8, 9])
    text = (await client.post(f"{motor}/program/disassemble", json={"binary": made["binary"]})).json()["text"]
    again = (await client.post(f"{motor}/program/assemble", json={"text": text, "binary": True})).json()
    assert again["binary"] == made["binary"]
    for binary, told in (("!", "base64"), ("\U00021cc50é", "base64"), ("AAAA", "no multiple")):
        refused = await client.post(f"{motor}/program/disassemble", json={"binary": binary})
        assert (refused.status_code, told in refused.json()["detail"]) == (422, True), refused.text


@pytest.mark.parametrize(
    ("call", "body", "named"),
    [
        ("debug", {"from_start": 0}, "from_start"),
        ("assemble", {"text": "STOP", "listing": 1}, "listing"),
        ("assemble", {"text": "STOP", "binary": "yes"}, "binary"),
        ("try", {"text": "STOP", "duration_s": "5"}, "duration_s"),
    ],
)
async def test_a_value_of_another_kind_is_not_taken_for_one(
    client: httpx.AsyncClient, motor: str, call: str, body: dict[str, object], named: str
) -> None:
    refused = await client.post(f"{motor}/program/{call}", json=body)
    assert (refused.status_code, named in refused.json()["detail"]) == (422, True), refused.text


async def test_what_programs_may_include(client: httpx.AsyncClient, motor: str) -> None:
    files = (await client.get(f"{motor}/program/includes")).json()["files"]
    assert "APMaxPositioningSpeed = 4\n" in files["TMCLParam.tmc"]
    assert "TI_GLOBAL = 255\n" in files["Interrupts.inc"]


async def test_a_program_is_tried_on_an_emulator_of_its_own(client: httpx.AsyncClient, motor: str) -> None:
    set_up = await client.put(f"{motor}/registers/ap4", json={"value": 20_000})
    assert set_up.status_code == 200, set_up.text
    body = {"text": "GAP 4, 0\nAGP 7, 2\nMVP ABS, 0, 20000\nWAIT POS, 0, 0\nSTOP", "duration_s": 20}
    tried = await client.post(f"{motor}/program/try", json=body)
    assert tried.status_code == 200, tried.text
    made = tried.json()
    assert (made["ended"], made["status"], made["counter"]) == ("stopped", "stopped", 4)
    assert made["variables"] == {"7": 20_000}  # it was set as the module is
    assert (made["position"][0], made["position"][-1]) == (0, 20_000)
    assert max(made["velocity_pps"]) == pytest.approx(20_000, rel=0.01)
    assert set(made["counters"]) >= {3, 4}
    # the module itself has neither moved nor got the program
    assert (await client.get(f"{motor}/axes/0")).json()["position"] == 0
    assert (await client.get(f"{motor}/emulator")).json()["application"]["commands"] == 0
    endless = (await client.post(f"{motor}/program/try", json={"text": "L:\nJA L", "duration_s": 0.5})).json()
    assert (endless["ended"], endless["status"], endless["time_s"][-1]) == ("time", "running", pytest.approx(0.5))
    refused = await client.post(f"{motor}/program/try", json={"text": "STOP", "address": 1})
    assert (refused.status_code, "0..0" in refused.json()["detail"]) == (422, True)


async def test_what_soft_limits_forbid_is_not_even_tried(client: httpx.AsyncClient, motor: str) -> None:
    await client.patch(motor, json={"axes": [{"limits": {"position_min": -1000, "position_max": 1000}}]})
    refused = await client.post(f"{motor}/program/try", json={"text": "MVP ABS, 0, 5000\nSTOP"})
    assert (refused.status_code, refused.json()["type"]) == (422, "/problems/soft-limit")
