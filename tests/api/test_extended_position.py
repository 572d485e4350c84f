"""Extended positions over REST: what is told, what is refused, what outlives the server."""

from __future__ import annotations

from typing import Any

import httpx
import pytest

from app.clock import VirtualClock
from app.main import create_app
from app.settings import Settings

AXIS = "devices/bench/axes/0"
WHERE = f"{AXIS}/extended-position"


async def put(client: httpx.AsyncClient, where: str = WHERE, **change: object) -> dict[str, Any]:
    answer = await client.put(where, json=change)
    assert answer.status_code == 200, answer.text
    found: dict[str, Any] = answer.json()
    return found


async def get(client: httpx.AsyncClient, where: str = WHERE) -> dict[str, Any]:
    answer = await client.get(where)
    assert answer.status_code == 200, answer.text
    found: dict[str, Any] = answer.json()
    return found


async def test_an_axis_that_nobody_watches(client: httpx.AsyncClient) -> None:
    found = await get(client)
    assert (found["watching"], found["state"], found["actual"], found["counter_bits"]) == (False, "off", None, 24)
    assert (await client.get(f"{WHERE}/history")).status_code == 409
    assert (await client.get(f"{WHERE}/latched")).status_code == 409
    assert (await client.put(WHERE, json={"confirm": True})).status_code == 409
    assert (await client.delete(WHERE)).status_code == 200


async def test_a_target_begins_to_watch_and_is_reached(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    found = await put(client, target=20_000)
    assert (found["state"], found["target"], found["pieces"]["total"]) == ("moving", 20_000, 1)
    await clock.advance(5)
    found = await get(client)
    assert (found["state"], found["actual"], found["actual_text"]) == ("idle", 20_000, "20000")
    assert (found["progress"], found["message"], found["trusted"]) == (1.0, "at its target", True)
    assert found["service_period_s"] < found["allowed_s"] / 3


async def test_positions_of_64_bits_come_in_and_out_as_text(client: httpx.AsyncClient) -> None:
    found = await put(client, actual="9007199254740993")
    assert found["actual_text"] == "9007199254740993"
    await put(client, microsteps_per_turn=200)
    assert (await put(client, zero="9007199254740992"))["position_in_turn_text"] == "1"
    assert (await client.put(WHERE, json={"actual": "9223372036854775808"})).status_code == 422
    assert (await client.put(WHERE, json={"actual": 1 << 63})).status_code == 422


async def test_a_rotary_axis(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    found = await put(client, gear={"microsteps_per_motor_turn": 12_800, "motor_teeth": 3, "driven_teeth": 7})
    assert found["rotary"]["microsteps_per_turn"] == "89600/3"
    assert found["rotary"]["gear"] == {"microsteps_per_motor_turn": 12_800, "motor_teeth": 3, "driven_teeth": 7}
    await put(client, angle_deg=-90, way="positive")
    await clock.advance(5)
    found = await get(client)
    assert found["actual"] == 22_400
    assert (found["turns"], found["position_in_turn_text"], found["angle_deg"]) == (0, "22400", 270)
    await put(client, turns=-3)  # as far as the demo's stage goes
    await clock.advance(20)
    found = await get(client)
    assert (found["state"], found["target"]) == ("idle", 22_400 - 89_600)
    assert "the left switch is active; nothing is sent again" in found["message"]
    await put(client, turns=1)
    await clock.advance(20)
    assert (await get(client))["actual"] == found["actual"] + 29_867
    await put(client, place="29866/3", way="shortest")
    await clock.advance(8)
    assert (await get(client))["actual"] == -49_778
    assert (await put(client, zero=-49_778))["angle_deg"] == 0
    assert (await put(client, microsteps_per_turn=None))["rotary"] is None
    assert (await put(client, microsteps_per_turn="200/7"))["rotary"]["microsteps_per_turn_value"] == pytest.approx(
        200 / 7
    )
    history = (await client.get(f"{WHERE}/history", params={"seconds": 100})).json()
    assert len({len(column) for column in history.values()}) == 1
    assert history["position_text"] == [str(position) for position in history["position"]]


async def test_a_compare_register_and_a_snapshot(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    where = "devices/slider/axes/0/extended-position"
    found = await put(client, where, compare=str(1 << 40))
    await clock.advance(1)
    found = await get(client, where)
    assert found["compare"]["register_name"] == "POS_COMP_4210"
    assert (found["compare"]["position"], found["compare"]["armed"]) == (1 << 40, False)
    assert (await put(client, where, compare=None))["compare"] is None
    latched = (await client.get(f"{where}/latched")).json()
    assert latched["register_name"] == found["latch_register"] == "X_LATCHED"
    assert latched["position_text"] == str(latched["position"])


@pytest.mark.parametrize(
    "body",
    [
        {},
        {"target": 1, "actual": 1},
        {"target": None},
        {"target": 1.5},
        {"target": "1e3"},
        {"target": True},
        {"zero": 5, "way": "positive"},
        {"angle_deg": 5, "way": "sideways"},
        {"microsteps_per_turn": "1/0"},
        {"microsteps_per_turn": 0},
        {"gear": {"microsteps_per_motor_turn": 1, "motor_teeth": 0, "driven_teeth": 1}},
        {"nonsense": 1},
        {"watch": False},
        {"place": "-1"},
    ],
)
async def test_what_cannot_be_is_refused_and_begins_nothing(client: httpx.AsyncClient, body: dict[str, object]) -> None:
    answer = await client.put(WHERE, json=body)
    assert answer.status_code == 422, answer.text
    assert answer.headers["content-type"] == "application/problem+json"
    if "microsteps_per_turn" not in body:
        assert (await get(client))["watching"] is False


async def test_an_unknown_axis_is_404(client: httpx.AsyncClient) -> None:
    assert (await client.get("devices/bench/axes/3/extended-position")).status_code == 404


async def test_a_stop_ends_the_move(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    await put(client, target=1 << 40)
    await clock.advance(1)
    await client.post("stop")
    found = await get(client)
    assert found["state"] == "idle"
    assert found["message"].endswith("another command to this axis: stop")
    await put(client, target=1 << 40)
    found = (await client.delete(WHERE)).json()
    assert found["watching"] is False
    await clock.advance(5)
    assert not (await client.get(AXIS)).json()["moving"]


async def test_a_reset_of_an_emulator_is_told_at_once(client: httpx.AsyncClient, clock: VirtualClock) -> None:
    await put(client, target=500)
    await clock.advance(3)
    await client.patch("devices/bench/emulator", json={"power_cycle": True})
    found = await get(client)
    assert (found["state"], found["trusted"], found["actual"]) == ("lost", False, 500)
    assert "the chip was reset" in found["reason"]
    answer = await client.put(WHERE, json={"target": 5})
    assert answer.status_code == 409
    assert "confirm" in answer.json()["way_out"]
    assert (await put(client, confirm=True))["trusted"] is True


async def test_a_restart_of_the_server_is_told_of_for_what_ran_in_it(settings: Settings, clock: VirtualClock) -> None:
    for run in range(2):
        app = create_app(settings, clock, list)
        async with app.router.lifespan_context(app):
            transport = httpx.ASGITransport(app)
            async with httpx.AsyncClient(transport=transport, base_url="http://127.0.0.1:8000/api/v1/") as client:
                if run == 0:
                    await put(client, target=600)
                    await clock.advance(3)
                    await put(client, actual="1000000000600")
                    await put(client, gear={"microsteps_per_motor_turn": 200, "motor_teeth": 3, "driven_teeth": 7})
                else:
                    await clock.advance(1)
                    found = await get(client)
                    assert (found["watching"], found["trusted"], found["actual_text"]) == (True, False, "1000000000600")
                    assert "the chip was reset" in found["reason"]
                    assert found["rotary"]["microsteps_per_turn"] == "1400/3"
