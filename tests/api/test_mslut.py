"""Microstep tables of 256 differences over REST: designed, refused with place and nearest wave, and in a chip."""

from __future__ import annotations

from typing import Any

import httpx
import pytest

from app.calc.microsteps.mslut import POWER_ON, Wave, decode
from app.clock import VirtualClock

POWER_1100_LUT = ["A492487E", "294A52A4", "492494A5", "82110912", "00000080", "DB777DF8", "252AAAD6", "00808449"]
POWER_1100 = [*POWER_1100_LUT, "FFA20659", "00F70000"]


async def designed(client: httpx.AsyncClient, **body: object) -> dict[str, Any]:
    answer = await client.post("calc/microstep-table", json={"chip": "tmc4361", **body})
    assert answer.status_code == 200, answer.text
    result: dict[str, Any] = answer.json()
    return result


async def test_without_a_formula_it_is_the_power_on_wave(client: httpx.AsyncClient) -> None:
    answer = await designed(client)
    assert answer["encodable"] is True
    assert answer["refusals"] == []
    assert answer["nearest"] is None
    assert answer["table"]["values"] == answer["values"] == list(decode(POWER_ON).values)
    assert answer["metrics"]["angle_error_max_deg"] == pytest.approx(0.218, abs=1e-3)
    assert answer["metrics"]["quantisation_max"] <= 0.5
    assert [segment["width"] for segment in answer["table"]["segments"]] == [2, 1]


async def test_a_linearity_correction_has_the_firmwares_registers(client: httpx.AsyncClient) -> None:
    answer = await designed(client, thousandths=100)
    assert [register["hex"] for register in answer["table"]["registers"]] == POWER_1100
    assert [register["address"] for register in answer["table"]["registers"]] == [*range(0x70, 0x79), 0x7E]
    assert answer["table"] == (await designed(client, exponent=1.1))["table"]


async def test_registers_of_a_chip_are_told_as_they_are(client: httpx.AsyncClient) -> None:
    words = {"mslut": list(POWER_ON.words), "mslutsel": POWER_ON.select, "mslutstart": POWER_ON.start}
    answer = await designed(client, registers=words)
    assert [register["value"] for register in answer["table"]["registers"]] == [
        *POWER_ON.words,
        POWER_ON.select,
        POWER_ON.start,
    ]
    assert answer["ideal"] is None
    assert answer["metrics"]["quantisation_max"] is None


async def test_what_cannot_be_encoded_names_place_and_reason_and_the_nearest_wave(client: httpx.AsyncClient) -> None:
    values = list(decode(POWER_ON).values)
    values[100] += 40
    answer = await designed(client, values=values)
    assert answer["encodable"] is False
    assert answer["table"] is None
    assert answer["values"] == values
    first = answer["refusals"][0]
    assert (first["index"], first["reason"]) == (100, "difference")
    assert "-1..+3" in first["detail"]
    nearest = answer["nearest"]
    again = await designed(client, values=nearest["table"]["values"], mirror=nearest["table"]["mirror"])
    assert again["encodable"] is True
    assert again["table"] == nearest["table"]


async def test_the_norm_decides_what_is_nearest(client: httpx.AsyncClient) -> None:
    values = list(decode(POWER_ON).values)
    values[100] += 40
    squares = (await designed(client, values=values))["nearest"]
    largest = (await designed(client, values=values, norm="minimax"))["nearest"]
    assert largest["distance_max"] < squares["distance_max"]
    assert squares["distance_rms"] < largest["distance_rms"]


async def test_an_asymmetric_harmonic_is_refused_with_its_symmetric_part(client: httpx.AsyncClient) -> None:
    answer = await designed(client, harmonics=[{"order": 3, "amplitude": 0.05, "phase_deg": 90}])
    assert answer["refusals"][0]["reason"] == "asymmetric"
    assert answer["nearest"]["table"]["values"]


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ({"sigma": 1.5}, "sigma"),
        ({"exponent": 9}, "0.2..5"),
        ({"thousandths": 100, "exponent": 1.2}, "not both"),
        ({"values": [0] * 256, "registers": {"mslut": [0] * 8, "mslutsel": 0, "mslutstart": 0}}, "not both"),
        ({"values": [0] * 255}, "256"),
        ({"values": [0.5] * 256}, "values"),
        ({"harmonics": [{"order": 4, "amplitude": 0.1}]}, "3, 5, 7"),
        ({"corrections": [{"order": 3, "degrees": 1}]}, "4, 8, 12"),
        ({"amplitude": 1000}, "amplitude"),
        ({"offset": 3}, "offset"),
        ({"registers": {"mslut": [0] * 7, "mslutsel": 0, "mslutstart": 0}}, "8"),
        ({"chip": "tmc9999"}, "chip"),
    ],
)
async def test_what_is_no_wave_is_422(client: httpx.AsyncClient, body: dict[str, object], words: str) -> None:
    answer = await client.post("calc/microstep-table", json={"chip": "tmc4361", **body})
    assert answer.status_code == 422, answer.text
    assert words in answer.json()["detail"]


async def test_a_chip_of_64_values_takes_no_wave_of_256(client: httpx.AsyncClient) -> None:
    answer = await client.put("devices/bench/microstep-table", json={"values": [0] * 256})
    assert answer.status_code == 422
    assert "64 values" in answer.json()["detail"]


@pytest.fixture
async def chip(client: httpx.AsyncClient) -> str:
    """An emulated TMC4361 that can move: the address of its table."""
    body = {"name": "wave", "model": "tmc4361", "link": {"kind": "emulator"}}
    answer = await client.post("devices", json=body)
    assert answer.status_code == 201, answer.text
    # positioning first: in velocity mode a VMAX turns the motor at once
    ramp = {"RAMPMODE": 0b101, "VMAX": 20_000 * 256, "AMAX": 200_000 * 4, "DMAX": 200_000 * 4}
    for register, value in ramp.items():
        answer = await client.put(f"devices/wave/registers/{register}", json={"value": value})
        assert answer.status_code == 200, answer.text
    return "devices/wave/microstep-table"


async def test_a_chip_begins_with_the_power_on_wave(client: httpx.AsyncClient, chip: str, clock: VirtualClock) -> None:
    await clock.advance(0.001)
    held = (await client.get(chip)).json()
    assert held["written"] is False
    assert held["values"] == list(decode(POWER_ON).values)
    assert (held["position"], held["current_a"], held["current_b"]) == (0, 0, 247)
    assert held["agrees"] is True


async def test_a_wave_is_in_the_chip_and_its_currents_show_it_all_around(
    client: httpx.AsyncClient, chip: str, clock: VirtualClock
) -> None:
    wanted = await designed(client, sigma=0.4, grid="opposite")
    answer = await client.put(chip, json={"values": wanted["values"], "mirror": wanted["mirror"]})
    assert answer.status_code == 200, answer.text
    held = answer.json()
    assert held["written"] is True
    assert held["registers"] == wanted["table"]["registers"]
    period = Wave(tuple(wanted["values"]), wanted["mirror"])
    places = set()
    for _ in range(28):
        move = {"target": 37, "relative": True, "unit": "microsteps"}
        assert (await client.post("devices/wave/axes/0/move", json=move)).status_code == 200
        await clock.advance(0.2)
        shown = (await client.get(chip)).json()
        assert (shown["current_a"], shown["current_b"]) == period.currents(shown["position"])
        assert shown["agrees"] is True
        places.add(shown["position"])
    assert len(places) == 28
    assert min(places) < 256
    assert max(places) >= 768


async def test_registers_go_in_as_they_are_and_the_dac_offset_stays(client: httpx.AsyncClient, chip: str) -> None:
    name = "START_SIN___START_SIN90_120___DAC_OFFSET"
    offset = await client.put(f"devices/wave/registers/{name}", json={"value": 0x5AF7_0000})
    assert offset.status_code == 200, offset.text
    words = {"mslut": list(POWER_ON.words), "mslutsel": POWER_ON.select, "mslutstart": POWER_ON.start}
    held = (await client.put(chip, json={"registers": words})).json()
    assert [register["value"] for register in held["registers"]] == [*POWER_ON.words, POWER_ON.select, 0x5AF7_0000]


async def test_a_chip_takes_no_wave_that_cannot_be_encoded(client: httpx.AsyncClient, chip: str) -> None:
    values = list(decode(POWER_ON).values)
    values[10] += 20
    answer = await client.put(chip, json={"values": values})
    assert answer.status_code == 422
    problem = answer.json()
    assert (problem["facts"]["index"], problem["facts"]["reason"]) == (10, "difference")
    assert "nearest" in problem["way_out"]
    assert (await client.get(chip)).json()["written"] is False


@pytest.mark.parametrize(
    "body", [{}, {"values": [0] * 64}, {"values": [0] * 256, "registers": {"mslut": [0] * 8}}, {"mirror": 0}]
)
async def test_half_a_table_is_refused(client: httpx.AsyncClient, chip: str, body: dict[str, object]) -> None:
    assert (await client.put(chip, json=body)).status_code == 422
