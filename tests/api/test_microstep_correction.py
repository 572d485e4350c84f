"""The calculator that corrects a motor's angle error."""

from __future__ import annotations

import httpx
import pytest

ERROR = {"harmonics": [{"order": 4, "sine_deg": 3.0}, {"order": 2, "cosine_deg": 1.0}]}


@pytest.mark.parametrize(("chip", "length"), [("tmc428", 64), ("tmc4361", 256)])
async def test_a_table_comes_back_that_the_chip_takes(client: httpx.AsyncClient, chip: str, length: int) -> None:
    found = (
        await client.post("calc/microstep-correction", json={**ERROR, "table": "ram64" if length == 64 else "mslut"})
    ).json()
    assert len(found["values"]) == length
    assert found["left_deg"] < found["sine_deg"] / 2
    assert found["beyond_deg"] == pytest.approx(0.707, abs=0.05)
    assert (found["shaped"] is None) == (length == 256)
    again = await client.post("calc/microstep-table", json={"chip": chip, "values": found["values"]})
    assert again.status_code == 200
    if length == 64:
        assert (await client.put("devices/bench/microstep-table", json={"values": found["values"]})).status_code == 200


async def test_more_than_any_table_makes_up_for_is_refused(client: httpx.AsyncClient) -> None:
    body = {"harmonics": [{"order": 16, "sine_deg": 20.0}]}
    answer = await client.post("calc/microstep-correction", json=body)
    assert answer.status_code == 422
    assert "turn back" in answer.json()["detail"]
