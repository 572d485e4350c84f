"""Profiles as scripts over REST: kept ones and documents, what the trial showed, and why there is none."""

from __future__ import annotations

import httpx
import pytest

from app.profiles.scripts.service import RENDER


async def test_a_kept_profile_as_a_script(client: httpx.AsyncClient) -> None:
    kept = (await client.post("profiles", json={"device": "bench", "name": "Quiet, and slow", "note": "*/ x"})).json()
    answer = await client.get(f"profiles/{kept['id']}/script", params={"language": "c"})
    assert answer.status_code == 200, answer.text
    script = answer.json()
    assert script["language"] == "c"
    assert script["file_name"] == "quiet-and-slow.h"
    assert "v_max" in script["text"]
    checked = script["checked"]
    assert (checked["model"], checked["differences"]) == ("tmc428", [])
    assert checked["how"] in ("compiled", "read")
    assert checked["registers"] > 80
    again = (await client.get(f"profiles/{kept['id']}/script", params={"language": "c"})).json()
    assert again == script  # not tried twice: it took the same time


async def test_a_document_that_is_not_kept_as_a_script(client: httpx.AsyncClient) -> None:
    device = await client.post("devices", json={"name": "drive", "model": "pd42-1241", "link": {"kind": "emulator"}})
    document = (await client.get(f"devices/{device.json()['id']}/profile")).json()
    answer = await client.post("profiles/script", json={"document": document, "language": "tmcl"})
    assert answer.status_code == 200, answer.text
    assert answer.json()["checked"]["how"] == "run"
    assert "\nSAP 6, 0, " in answer.json()["text"]
    assert (await client.get("profiles")).json()["profiles"] == []


async def test_why_there_is_none(client: httpx.AsyncClient, monkeypatch: pytest.MonkeyPatch) -> None:
    kept = (await client.post("profiles", json={"device": "slider"})).json()["id"]
    refused = await client.get(f"profiles/{kept}/script", params={"language": "tmcl"})
    assert refused.status_code == 409
    assert "speaks no TMCL" in refused.json()["detail"]
    assert (await client.get(f"profiles/{kept}/script", params={"language": "cobol"})).status_code == 422
    assert (await client.get("profiles/999/script", params={"language": "c"})).status_code == 404

    render = RENDER["c"]
    monkeypatch.setitem(
        RENDER, "c", lambda plan: "\n".join(line for line in render(plan).split("\n") if "V_MAX:" not in line)
    )
    failed = await client.get(f"profiles/{kept}/script", params={"language": "c"})
    assert (failed.status_code, failed.json()["type"]) == (409, "/problems/script-failed")
    assert failed.json()["facts"]["language"] == "c"
    assert "text" not in failed.json()
