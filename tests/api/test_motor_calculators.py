"""Coil currents, choppers, units and SixPoint registers of the TMC5xxx over REST: as calculated, or refused."""

from __future__ import annotations

import math
from typing import Any

import httpx
import pytest

from app.calc.tmc5xxx.chopper import Winding
from app.calc.tmc5xxx.chopper_hints import hints
from app.calc.tmc5xxx.coil import CurrentStage
from app.registers.tmc5xxx.table import TABLES

MOTOR = {"resistance_ohm": 2.3, "inductance_h": 4.4e-3, "current_a": 1.06, "supply_v": 24}
MODELS = list(TABLES)


ONE_AXIS = ("tmc5130", "tmc5160", "tmc5240")


def sense(model: str) -> dict[str, object]:
    if model == "tmc5240":
        return {"model": model, "reference_resistor_ohm": 12_000}
    return {"model": model, "sense_resistor_ohm": 0.1 if model == "tmc5160" else 0.15}


@pytest.mark.parametrize("model", MODELS)
async def test_a_wanted_current_comes_back_from_its_settings(client: httpx.AsyncClient, model: str) -> None:
    wanted = {**sense(model), "run_a": 0.9, "hold_a": 0.3}
    there = (await client.post("calc/coil-current", json=wanted)).json()
    assert abs(there["run"]["error"]) < 0.03
    assert there["nearest"][0] == there["run"]
    assert there["run"]["rms_a"] * math.sqrt(2) == pytest.approx(there["run"]["peak_a"])
    selected = {name: there["run"][name] for name in ("vsense", "global_scaler") if there["run"][name] is not None}
    if there["current_range"] is not None:
        selected["current_range"] = there["current_range"]
    settings = {**sense(model), **selected, "irun": there["run"]["scale"], "ihold": there["hold"]["scale"]}
    back = (await client.post("calc/coil-current", json=settings)).json()
    assert back["run"]["peak_a"] == there["run"]["peak_a"]
    assert back["hold"]["peak_a"] == there["hold"]["peak_a"]
    assert back["nearest"] == []
    assert back["full_scale_peak_a"] == pytest.approx(there["full_scale_peak_a"])


@pytest.mark.parametrize("model", MODELS)
async def test_what_is_to_be_written_has_a_place_in_the_chip(client: httpx.AsyncClient, model: str) -> None:
    waiting = {"waiting_s": 0.2} if model in ONE_AXIS else {}
    body = {**sense(model), "run_a": 0.8, "hold_a": 0.3, "lowering_s": 0.3, **waiting}
    answer = (await client.post("calc/coil-current", json=body)).json()
    written = {(s["name"], s["field"]) for s in answer["settings"]}
    for setting in answer["settings"]:
        word = TABLES[model].get(setting["name"], 0)
        part = word if setting["field"] is None else word.field_named(setting["field"])
        assert part is not None
        assert part.minimum <= setting["value"] <= part.maximum
    assert ("IHOLD_IRUN", "IHOLDDELAY") in written
    assert (("TPOWERDOWN", None) in written) == bool(waiting)
    assert (("GLOBAL_SCALER", None) in written) == (model in ("tmc5160", "tmc5240"))
    assert (("DRV_CONF", "CURRENT_RANGE") in written) == (model == "tmc5240")
    assert answer["delay"]["lowering_s"] == pytest.approx(0.3, abs=0.3)


async def test_peaks_and_rms_are_told_apart(client: httpx.AsyncClient) -> None:
    rms = (await client.post("calc/coil-current", json={**sense("tmc5072"), "run_a": 0.5})).json()
    body = {**sense("tmc5072"), "run_a": 0.5 * math.sqrt(2), "measure": "peak"}
    peak = (await client.post("calc/coil-current", json=body)).json()
    assert peak["run"]["scale"] == rms["run"]["scale"]
    assert peak["least_a"] == pytest.approx(rms["least_a"] * math.sqrt(2))
    assert rms["sense_power_w"] == pytest.approx(rms["run"]["peak_a"] ** 2 * 0.15)
    assert rms["sense_voltage_v"] == pytest.approx(rms["run"]["peak_a"] * 0.15)


async def test_a_tmc5130_measures_inside(client: httpx.AsyncClient) -> None:
    body = {"model": "tmc5130", "reference_resistor_ohm": 10_000, "irun": 31}
    answer = (await client.post("calc/coil-current", json=body)).json()
    assert answer["run"]["peak_a"] == CurrentStage("tmc5130", None, 10_000).full_scale_a(0)
    assert answer["sense_power_w"] is None
    assert {"name": "GCONF", "field": "internal_Rsense", "value": 1} in answer["settings"]
    assert "3000" in answer["formula"]
    assert answer["source"].startswith("DS-TMC5130 11")


async def test_delays_of_the_current(client: httpx.AsyncClient) -> None:
    """The sheets' example: IRUN 31, IHOLD 16, IHOLDDELAY 4."""
    body = {**sense("tmc5160"), "irun": 31, "ihold": 16, "ihold_delay": 4, "tpowerdown": 10}
    delay = (await client.post("calc/coil-current", json=body)).json()["delay"]
    assert (delay["steps"], delay["tpowerdown"]) == (15, 10)
    assert delay["lowering_s"] == pytest.approx(0.983, abs=1e-3)
    assert delay["waiting_s"] == pytest.approx(0.164, abs=1e-3)
    assert delay["standstill_s"] == pytest.approx(0.0655, abs=1e-4)
    two_axes = {**sense("tmc5072"), "irun": 31, "ihold": 16, "ihold_delay": 4}
    dual = (await client.post("calc/coil-current", json=two_axes)).json()["delay"]
    assert (dual["tpowerdown"], dual["waiting_s"], dual["standstill_s"]) == (None, None, 0), "after TZEROWAIT at once"
    short = (await client.post("calc/coil-current", json={**body, "tpowerdown": 1})).json()
    assert any("TPOWERDOWN" in said for said in short["warnings"])


@pytest.mark.parametrize(
    ("model", "change", "words"),
    [
        ("tmc5160", {}, "either a wanted run_a"),
        ("tmc5160", {"run_a": 1, "irun": 3}, "either a wanted run_a"),
        ("tmc5160", {"run_a": 1, "hold_a": 1, "ihold": 3}, "hold_a or an ihold"),
        ("tmc5160", {"run_a": 1, "vsense": 0}, "no vsense"),
        ("tmc5130", {"run_a": 1, "global_scaler": 0}, "no global_scaler"),
        ("tmc5160", {"run_a": 1, "global_scaler": 31}, "32 to 255"),
        ("tmc5160", {"run_a": 1, "sense_resistor_ohm": None}, "is missing"),
        ("tmc5072", {"run_a": 1, "tpowerdown": 3}, "no TPOWERDOWN"),
        ("tmc5072", {"run_a": 1, "ain_v": 2}, "no AIN_IREF"),
        ("tmc5160", {"run_a": 1, "tpowerdown": 3, "waiting_s": 1}, "not both"),
        ("tmc5160", {"run_a": 1, "ihold_delay": 3, "lowering_s": 1}, "not both"),
        ("tmc5160", {"run_a": 1, "waiting_s": 100}, "TPOWERDOWN is 0 to"),
    ],
)
async def test_a_current_that_cannot_be_is_422(
    client: httpx.AsyncClient, model: str, change: dict[str, object], words: str
) -> None:
    answer = await client.post("calc/coil-current", json={**sense(model), **change})
    assert answer.status_code == 422
    assert words in answer.json()["detail"]


@pytest.mark.parametrize("model", MODELS)
async def test_chopper_hints_are_the_calculators(client: httpx.AsyncClient, model: str) -> None:
    body = {"model": model, **MOTOR, "holding_torque_nm": 0.45, "rated_current_a": 1.5}
    answer = (await client.post("calc/chopper", json=body)).json()
    wanted = hints(model, Winding(2.3, 4.4e-3, 1.06, 24, 16e6, holding_torque_nm=0.45, rated_current_a=1.5))
    assert [s["value"] for s in answer["settings"]] == [s.value for s in wanted.settings]
    assert {f["name"]: f["value"] for f in answer["figures"]} == {f.name: f.value for f in wanted.figures}
    for setting in answer["settings"]:
        part = TABLES[model].get(setting["name"], 0).field_named(setting["field"])
        assert part is not None, "the chip has what is hinted at"
        assert part.minimum <= setting["value"] <= part.maximum


async def test_a_chopper_that_cannot_be_is_422(client: httpx.AsyncClient) -> None:
    answer = await client.post("calc/chopper", json={"model": "tmc5160", **MOTOR, "tbl": 0, "toff": 1})
    assert answer.status_code == 422
    assert "24 clocks" in answer.json()["detail"]


def units_body(model: str, **changes: Any) -> dict[str, Any]:
    return {"model": model, "mechanics": {"microsteps_per_full_step": 256}, **changes}


@pytest.mark.parametrize("model", MODELS)
async def test_a_velocity_in_every_register(client: httpx.AsyncClient, model: str) -> None:
    body = units_body(
        model,
        velocity={"value": 1, "unit": "rps"},
        acceleration={"value": 1000, "unit": "chip"},
        delay_s=0.1,
    )
    answer = (await client.post("calc/units", json=body)).json()
    rows = {row["name"]: row for row in answer["sixpoint"]["registers"]}
    assert answer["velocity"]["chip"] == pytest.approx(53_687.09)
    assert answer["acceleration"]["pps2"] == pytest.approx(116_415.32)
    assert answer["sixpoint"]["tstep"] == 312
    assert rows["VMAX"]["raw"] == rows["VSTART"]["raw"] == 53_687
    assert abs(rows["VMAX"]["error"]) < 1e-5
    assert [rows[name]["raw"] for name in ("A1", "AMAX", "DMAX", "D1")] == [1000] * 4
    assert rows["TZEROWAIT"]["raw"] == 3125
    assert {"TPWMTHRS", "TCOOLTHRS", "THIGH", "TPOWERDOWN"} & set(rows) == (
        {"TPWMTHRS", "TCOOLTHRS", "THIGH", "TPOWERDOWN"} if model in ONE_AXIS else set()
    )
    if model in ONE_AXIS:
        assert rows["TPWMTHRS"]["raw"] == 313
        assert rows["TPWMTHRS"]["rising"] > rows["TPWMTHRS"]["value"]
    else:
        assert rows["VHIGH"]["raw"] == 53_760
    assert ("VDCMIN" in rows) == (model != "tmc5031")


async def test_registers_the_other_way(client: httpx.AsyncClient) -> None:
    numbers = {"VMAX": 200_000, "TPWMTHRS": 0, "TCOOLTHRS": 1000, "TZEROWAIT": 65_535, "IHOLDDELAY": 15}
    body = units_body("tmc5160", registers=numbers, small_hysteresis=True)
    answer = (await client.post("calc/units", json=body)).json()
    rows = {row["name"]: row for row in answer["sixpoint"]["given"]}
    assert list(rows) == list(numbers)
    assert rows["VMAX"]["value"] == pytest.approx(190_734.86)
    assert (rows["TPWMTHRS"]["value"], rows["TPWMTHRS"]["note"]) == (None, "never reached")
    assert rows["TCOOLTHRS"]["value"] == pytest.approx(16e3)
    assert rows["TCOOLTHRS"]["rising"] == pytest.approx(16e6 / (1000 * 31 / 32 - 1))
    assert rows["TZEROWAIT"]["value"] == pytest.approx(2.097, abs=1e-3)
    assert answer["sixpoint"]["tstep"] is None
    assert answer["sixpoint"]["registers"] == []


async def test_what_a_register_cannot_hold_says_why(client: httpx.AsyncClient) -> None:
    body = units_body("tmc5072", velocity={"value": 600_000, "unit": "pps"})
    rows = {row["name"]: row for row in (await client.post("calc/units", json=body)).json()["sixpoint"]["registers"]}
    assert rows["VSTART"]["raw"] is None
    assert "18 bits" in rows["VSTART"]["note"]
    assert rows["V1"]["raw"] == 629_146


@pytest.mark.parametrize(
    ("model", "change", "words"),
    [
        ("tmc5072", {"registers": {"TPWMTHRS": 3}}, "no such register"),
        ("tmc5072", {"registers": {"VMAX": 1 << 23}}, "VMAX is 0 to"),
        ("tmc4361", {"registers": {"VMAX": 3}}, "are for tmc5031"),
        ("pd42-1241", {"delay_s": 3}, "are for tmc5031"),
        ("tmc5160", {"bow": {"value": 1, "unit": "pps3"}}, "no bows"),
        ("tmc5160", {"velocity": {"value": 9e6, "unit": "chip"}}, "velocity"),
    ],
)
async def test_units_that_cannot_be_are_422(
    client: httpx.AsyncClient, model: str, change: dict[str, object], words: str
) -> None:
    answer = await client.post("calc/units", json=units_body(model, **change))
    assert answer.status_code == 422
    assert words in answer.json()["detail"]


SIXPOINT = {"amax": 116_415.3, "vmax": 190_735, "a1": 232_830.6, "v1": 95_367, "d1": 232_830.6, "vstop": 10}


async def test_a_ramp_in_registers(client: httpx.AsyncClient) -> None:
    body = {"model": "sixpoint", "parameters": {**SIXPOINT, "clock_hz": 16e6}, "distance": 500_000}
    answer = (await client.post("calc/ramp", json=body)).json()
    raw = {row["name"]: row["raw"] for row in answer["registers"]}
    assert raw == {
        "VSTART": 0,
        "A1": 2000,
        "V1": 100_000,
        "AMAX": 1000,
        "VMAX": 200_000,
        "DMAX": 1000,
        "D1": 2000,
        "VSTOP": 10,
        "TZEROWAIT": 0,
    }
    assert {row["parameter"] for row in answer["registers"]} >= set(SIXPOINT)
    assert answer["findings"] == []
    assert answer["warnings"] == []


async def test_what_is_wrong_with_a_ramp_is_said_of_a_chip(client: httpx.AsyncClient) -> None:
    body = {"model": "sixpoint", "parameters": {"amax": 1e5, "vmax": 1e5, "vstart": 100}, "distance": 1e5}
    plain = (await client.post("calc/ramp", json=body)).json()
    assert (plain["registers"], plain["warnings"]) == ([], []), "nobody asked for a chip"
    body["parameters"] = {"amax": 1e5, "vmax": 1e5, "vstart": 100, "clock_hz": 12e6}
    answer = (await client.post("calc/ramp", json=body)).json()
    assert {finding["code"] for finding in answer["findings"]} == {"vstop_zero", "vstart_above_vstop"}
    assert [finding["text"] for finding in answer["findings"]] == answer["warnings"]
    raw = {row["name"]: row["raw"] for row in answer["registers"]}
    assert raw["D1"] == raw["DMAX"] == 1527, "D1 is never left at 0"


async def test_a_ramp_of_what_the_registers_hold(client: httpx.AsyncClient) -> None:
    parameters = {"amax": 300, "vmax": 2000.4, "clock_hz": 16e6}
    body = {"model": "sixpoint", "parameters": {**parameters, "rounding": "registers"}, "distance": 10_000}
    rounded = (await client.post("calc/ramp", json=body)).json()
    exact = (await client.post("calc/ramp", json={**body, "parameters": parameters})).json()
    assert max(rounded["acceleration_pps2"]) == pytest.approx(3 * 116.415, abs=0.01)
    assert max(exact["acceleration_pps2"]) == 300
    body["parameters"] = {**parameters, "rounding": "wild"}
    assert (await client.post("calc/ramp", json=body)).status_code == 422
    body["parameters"] = {**parameters, "vmax": 9e6, "v1": 2e6}
    assert (await client.post("calc/ramp", json=body)).status_code == 422
