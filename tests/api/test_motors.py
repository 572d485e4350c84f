"""The motor data base over REST: the list, and motors of one's own beside it."""

from __future__ import annotations

from pathlib import Path

import httpx

from app.settings import Settings

LIST = "ldo-42sth48-2504ac"


def the_file(settings: Settings) -> Path:
    return settings.data_dir / "motors.json"


def damage(file: Path) -> None:
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text("half a docu")


def broken(settings: Settings) -> list[str]:
    return [path.read_text() for path in settings.data_dir.glob("motors.broken-*.json")]


async def names(client: httpx.AsyncClient, search: str, **more: int) -> list[str]:
    answer = await client.get("motors", params={"search": search, **more})
    return [motor["name"] for motor in answer.raise_for_status().json()["motors"]]


async def test_the_list_is_searched_and_says_where_it_is_from(client: httpx.AsyncClient) -> None:
    answer = (await client.get("motors", params={"search": "42sth48 2504ac"})).raise_for_status().json()
    motor = answer["motors"][0]
    assert (motor["name"], motor["own"], motor["rated_current_a"], motor["full_steps_per_rev"]) == (
        LIST,
        False,
        2.5,
        200,
    )
    assert "not checked" in motor["source"]
    everything = (await client.get("motors", params={"limit": 3})).json()
    assert len(everything["motors"]) == 3
    assert everything["found"] > 200


async def test_an_own_motor_is_kept_found_first_and_forgotten(client: httpx.AsyncClient, settings: Settings) -> None:
    figures = {"rated_current_a": 1.2, "full_steps_per_rev": 400, "resistance_ohm": 2.2, "rotor_inertia_kgm2": 6.8e-6}
    kept = (await client.put("motors/Spindle 42sth48", json=figures)).raise_for_status().json()
    assert (kept["own"], kept["inductance_h"], kept["holding_torque_nm"]) == (True, None, None)
    first, second = (await client.get("motors", params={"search": "42sth48", "limit": 2})).json()["motors"]
    assert (first["name"], first["rotor_inertia_kgm2"]) == ("Spindle 42sth48", 6.8e-6)
    assert second["rotor_inertia_kgm2"] is None  # the public list has none
    assert "Spindle 42sth48" in the_file(settings).read_text()
    only = (await client.get("motors", params={"own": True, "limit": 1000})).raise_for_status().json()
    assert (only["found"], [motor["name"] for motor in only["motors"]]) == (1, ["Spindle 42sth48"])
    (await client.delete("motors/Spindle 42sth48")).raise_for_status()
    assert "Spindle 42sth48" not in await names(client, "42sth48")
    gone = await client.delete("motors/Spindle 42sth48")
    assert (gone.status_code, "of your own" in gone.json()["detail"]) == (404, True)


async def test_an_own_motor_stands_before_the_one_of_the_list_of_its_name(client: httpx.AsyncClient) -> None:
    (await client.put(f"motors/{LIST}", json={"rated_current_a": 2.0})).raise_for_status()
    answer = (await client.get("motors", params={"search": LIST})).json()
    assert [(motor["own"], motor["rated_current_a"]) for motor in answer["motors"]] == [(True, 2.0)]
    (await client.delete(f"motors/{LIST}")).raise_for_status()
    answer = (await client.get("motors", params={"search": LIST})).json()
    assert [(motor["own"], motor["rated_current_a"]) for motor in answer["motors"]] == [(False, 2.5)]


async def test_a_motor_that_cannot_be_is_refused(client: httpx.AsyncClient) -> None:
    for figures in (
        {},
        {"rated_current_a": 0},
        {"rated_current_a": 1, "full_steps_per_rev": 0},
        {"rated_current_a": "1"},
    ):
        assert (await client.put("motors/none", json=figures)).status_code == 422
    assert "none" not in await names(client, "none")


async def test_a_damaged_file_is_kept_aside_and_the_list_is_there(
    client: httpx.AsyncClient, settings: Settings
) -> None:
    damage(the_file(settings))
    assert LIST in await names(client, "42sth48")
    (await client.put("motors/mine", json={"rated_current_a": 1.0})).raise_for_status()
    assert "half a docu" in broken(settings)
    assert (await names(client, "mine"))[0] == "mine"
