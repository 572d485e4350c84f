"""Layouts over REST: kept, saved over the revision that they were made from and no other, forgotten."""

from __future__ import annotations

import asyncio
import json
from typing import Any

import httpx

from app.settings import Settings
from app.store.revisions import BYTES_MAX, KEPT_MAX, REVISIONS_MAX


def layout(name: str = "Tuning", **more: Any) -> dict[str, Any]:
    panels = {"motion": {"type": "motion", "v": 1, "at": "$", "config": {}}}
    screens = {"desktop": {"tabs": ["motion"]}, "phone": ["motion"]}
    return {"format": "stepscope.layout", "version": 1, "name": name, "screens": screens, "panels": panels, **more}


async def test_a_layout_is_kept_with_all_that_it_says(client: httpx.AsyncClient, settings: Settings) -> None:
    document = layout("My tuning!", derived={"slip": {"formula": "p - e"}})
    answer = await client.post("layouts", json={"document": document})
    assert answer.status_code == 201
    kept = answer.json()
    assert (kept["id"], kept["name"], kept["revision"]) == ("my-tuning", "My tuning!", 1)
    assert kept["document"] == {**document, "id": "my-tuning", "revision": 1}
    assert (await client.get("layouts/my-tuning")).json() == kept
    listed = (await client.get("layouts")).json()["layouts"]
    assert [(each["id"], each["name"]) for each in listed] == [("my-tuning", "My tuning!")]
    assert (settings.data_dir / "layouts" / "my-tuning.json").is_file()
    second = (await client.post("layouts", json={"document": layout("My  Tuning?")})).json()
    assert second["id"] == "my-tuning-2"


async def test_a_save_over_another_revision_is_refused_and_changes_nothing(client: httpx.AsyncClient) -> None:
    first = (await client.put("layouts/bench", json={"based_on": 0, "document": layout("Bench")})).json()
    assert first["revision"] == 1
    mine = {"based_on": 1, "document": layout("Mine")}
    assert (await client.put("layouts/bench", json=mine)).json()["revision"] == 2
    for based_on in (0, 1, 3):
        refused = await client.put("layouts/bench", json={"based_on": based_on, "document": layout("Theirs")})
        problem = refused.json()
        assert (refused.status_code, problem["type"]) == (409, "/problems/layout-changed")
        assert problem["facts"] == {"layout": "bench", "based_on": based_on, "revision": 2}
        assert "under another name" in problem["way_out"]
    assert (await client.get("layouts/bench")).json()["name"] == "Mine"


async def test_of_two_who_save_at_once_one_is_told(client: httpx.AsyncClient) -> None:
    await client.put("layouts/bench", json={"based_on": 0, "document": layout("Bench")})
    saves = [client.put("layouts/bench", json={"based_on": 1, "document": layout(f"of {who}")}) for who in range(8)]
    answers = await asyncio.gather(*saves)
    assert sorted(answer.status_code for answer in answers) == [200, *[409] * 7]
    assert (await client.get("layouts/bench")).json()["revision"] == 2


async def test_the_last_revisions_can_be_had_back(client: httpx.AsyncClient) -> None:
    for number in range(REVISIONS_MAX + 5):
        body = {"based_on": number, "document": layout(f"number {number + 1}")}
        (await client.put("layouts/bench", json=body)).raise_for_status()
    kept = (await client.get("layouts/bench")).json()
    numbers = [each["revision"] for each in kept["revisions"]]
    assert numbers == [*range(REVISIONS_MAX + 5, 5, -1)]
    earlier = (await client.get("layouts/bench", params={"revision": 7})).json()
    assert (earlier["name"], earlier["revision"]) == ("number 7", 7)
    gone = await client.get("layouts/bench", params={"revision": 3})
    assert (gone.status_code, "25" in gone.json()["detail"]) == (404, True)


async def test_a_layout_is_forgotten(client: httpx.AsyncClient) -> None:
    await client.put("layouts/mine", json={"based_on": 0, "document": layout()})
    assert (await client.delete("layouts/mine")).status_code == 204
    for answer in (await client.delete("layouts/mine"), await client.get("layouts/mine")):
        assert answer.status_code == 404
    again = await client.put("layouts/mine", json={"based_on": 1, "document": layout()})
    assert "not there any more" in again.json()["detail"]


async def test_what_is_no_layout_is_refused(client: httpx.AsyncClient) -> None:
    bad: list[Any] = [
        {},
        {**layout(), "format": "other"},
        {**layout(), "version": 0},
        {**layout(), "version": True},
        {**layout(), "name": ""},
        {**layout(), "screens": []},
        layout(note="x" * BYTES_MAX),
        layout(note="\ud800"),
    ]
    for document in bad:
        said = json.dumps({"based_on": 0, "document": document})  # half of a surrogate pair is written as an escape
        answer = await client.put("layouts/mine", content=said, headers={"content-type": "application/json"})
        assert answer.status_code in (400, 422), document
    assert (await client.put("layouts/Mine", json={"based_on": 0, "document": layout()})).status_code == 422
    assert (await client.get("layouts")).json() == {"layouts": []}


async def test_one_that_is_damaged_is_said_and_the_others_are_there(
    client: httpx.AsyncClient, settings: Settings
) -> None:
    for name in ("one", "two"):
        await client.put(f"layouts/{name}", json={"based_on": 0, "document": layout(name)})
    damaged = settings.data_dir / "layouts" / "one.json"
    for content in ("half a docu", "[]", '{"format": "other"}', '{"format": "stepscope-layout-revisions"}'):
        damaged.write_text(content)
        assert [each["id"] for each in (await client.get("layouts")).json()["layouts"]] == ["two"]
        answer = await client.get("layouts/one")
        assert (answer.status_code, "mend or delete" in answer.json()["way_out"]) == (409, True)
        over = await client.put("layouts/one", json={"based_on": 1, "document": layout("one")})
        assert over.status_code == 409
        assert damaged.read_text() == content, "it is not written over"


async def test_there_is_an_end_to_how_many_are_kept(client: httpx.AsyncClient, settings: Settings) -> None:
    await client.put("layouts/bench", json={"based_on": 0, "document": layout("Bench")})
    for number in range(KEPT_MAX - 1):
        (settings.data_dir / "layouts" / f"x{number}.json").write_text("{}")
    answer = await client.post("layouts", json={"document": layout("One more")})
    assert (answer.status_code, "delete one" in answer.json()["detail"]) == (422, True)
    saved = await client.put("layouts/bench", json={"based_on": 1, "document": layout("Bench")})
    assert saved.status_code == 200, "what is there can be saved all the same"


async def test_no_layout_comes_to_be_under_what_a_program_writes_for_no_id(client: httpx.AsyncClient) -> None:
    for nothing in ("null", "undefined", "true", "0", "42"):
        refused = await client.put(f"layouts/{nothing}", json={"based_on": 0, "document": layout("Bench")})
        assert refused.status_code == 404, nothing
        assert (await client.get("layouts")).json()["layouts"] == []
    named = (await client.post("layouts", json={"document": layout("Null")})).json()
    assert named["id"] == "layout-null"
    again = await client.put("layouts/layout-null", json={"based_on": 1, "document": layout("42")})
    assert again.json()["revision"] == 2
