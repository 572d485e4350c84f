"""Tables and profiles over REST: into the chip and out of it."""

from __future__ import annotations

import httpx
import pytest

from app.calc.driver_chain.chain import build_chain
from app.calc.microsteps.table import design_table


async def test_a_table_is_in_the_chip_when_the_answer_comes(client: httpx.AsyncClient) -> None:
    values = list(design_table(sigma=-0.5).values)
    answer = await client.put("devices/bench/microstep-table", json={"values": values})
    assert answer.json() == {"values": values}
    assert (await client.get("devices/bench/microstep-table")).json() == {"values": values}


@pytest.mark.parametrize("values", [[], [1] * 63, [1] * 65, [64] * 64, [-1] * 64, [1.5] * 64, [None] * 64, ["1"] * 64])
async def test_no_table_is_refused_and_the_old_one_stays(client: httpx.AsyncClient, values: list[object]) -> None:
    before = (await client.get("devices/bench/microstep-table")).json()
    assert (await client.put("devices/bench/microstep-table", json={"values": values})).status_code == 422
    assert (await client.get("devices/bench/microstep-table")).json() == before


async def test_a_chain_goes_in_and_comes_back_readable(client: httpx.AsyncClient) -> None:
    body = {"drivers": ["tmc236", {"driver": "tmc236", "fast_decay": True}]}
    table = (await client.put("devices/bench/driver-chain", json=body)).json()
    chain = build_chain(body["drivers"])  # type: ignore[arg-type]
    assert table["lsmd"] == 1
    assert table["length_bits"] == chain.length_bits
    assert [bit["signal"] for bit in table["bits"]] == [bit.signal for bit in chain.bits]
    assert len(table["ram_words"]) == 64
    assert (await client.get("devices/bench/driver-chain")).json() == table


@pytest.mark.parametrize("drivers", [[], ["tmc5160"], ["tmc236"] * 4, [{"driver": "custom"}], [5]])
async def test_no_chain_is_refused(client: httpx.AsyncClient, drivers: list[object]) -> None:
    assert (await client.put("devices/bench/driver-chain", json={"drivers": drivers})).status_code == 422


async def test_a_chip_without_tables_says_so(client: httpx.AsyncClient) -> None:
    for path in ("microstep-table", "driver-chain"):
        answer = await client.get(f"devices/slider/{path}")
        assert answer.status_code == 409
        assert answer.json()["way_out"]
