"""The calculators over REST give what app/calc gives, and refuse aloud."""

from __future__ import annotations

from typing import Any

import httpx
import pytest

from app.calc.ramps.pmul_pdiv import design
from app.calc.ramps.sixpoint import SixPoint, position_plan
from app.calc.ramps.ticked import RampParameters, exact_ramp

RAMP: dict[str, Any] = {"v_min": 1, "v_max": 1000, "a_max": 172, "ramp_div": 7, "pulse_div": 2, "pmul": 35, "pdiv": 9}


@pytest.mark.parametrize("chip", ["tmc428", "tmc4210"])
async def test_a_pair_is_the_calculators_own(client: httpx.AsyncClient, chip: str) -> None:
    body = {"chip": chip, "a_max": 172, "ramp_div": 7, "pulse_div": 2}
    answer = (await client.post("calc/pmul-pdiv", json=body)).json()
    wanted = design(chip, 172, 7, 2)
    assert (answer["pmul"], answer["p_mul"], answer["pdiv"]) == (wanted.pmul, wanted.p_mul, wanted.pdiv)
    assert len(answer["candidates"]) == len(wanted.candidates)
    assert answer["candidates"][0]["overshoot_steps"] == wanted.candidates[0].overshoot_steps


async def test_where_no_pair_fits_none_is_invented(client: httpx.AsyncClient) -> None:
    answer = (await client.post("calc/pmul-pdiv", json={"a_max": 2047, "ramp_div": 0, "pulse_div": 13})).json()
    assert answer["pmul"] is None
    assert answer["warnings"]


async def test_a_ramp_is_the_exact_one(client: httpx.AsyncClient) -> None:
    body = {"model": "tmc428", "parameters": RAMP, "distance": 10_000, "samples": 100}
    answer = (await client.post("calc/ramp", json=body)).json()
    curve = exact_ramp(RampParameters(**RAMP, ramp_mode="ramp", clock_hz=16e6), 10_000, 100)
    assert answer["duration_s"] == curve.duration_s
    assert answer["position"] == curve.position.tolist()
    assert answer["time_s"][-1] == answer["duration_s"]
    assert answer["position"][-1] == 10_000
    assert answer["overshoot_steps"] == 0


async def test_a_trapezoid_takes_its_time(client: httpx.AsyncClient) -> None:
    body = {"model": "trapezoid", "parameters": {"vmax": 1000, "amax": 1000, "dmax": 500}, "distance": 5000}
    answer = (await client.post("calc/ramp", json=body)).json()
    assert answer["duration_s"] == pytest.approx(1 + 2 + (5000 - 500 - 1000) / 1000)
    assert [phase["name"] for phase in answer["phases"]] == ["acceleration", "constant velocity", "deceleration"]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"parameters": {**RAMP, "v_max": 0}}, "v_max"),
        ({"parameters": {**RAMP, "speed": 1}}, "speed"),
        ({"parameters": {k: v for k, v in RAMP.items() if k != "pdiv"}}, "pdiv"),
        ({"parameters": {**RAMP, "v_max": 1.5}}, "whole number"),
        ({"parameters": {**RAMP, "v_max": "fast"}}, "v_max"),
        ({"parameters": {**RAMP, "ramp_mode": "warp"}}, "ramp_mode"),
        ({"parameters": {**RAMP, "ramp_mode": "velocity", "v_target": 3000}}, "v_target"),
        ({"parameters": {**RAMP, "clock_hz": 0}}, "clock_hz"),
        ({"distance": 0.5}, "distance"),
        ({"distance": 2**23}, "distance"),
        ({"samples": 1}, "samples"),
        ({"model": "trapezoid"}, "parameter"),
        ({"model": "trapezoid", "parameters": {"vmax": 1e-300, "amax": 1e-300}, "distance": 1e300}, "longer"),
    ],
)
async def test_a_ramp_that_cannot_be_is_422(client: httpx.AsyncClient, change: dict[str, object], words: str) -> None:
    body = {"model": "tmc428", "parameters": RAMP, "distance": 10_000, "samples": 100, **change}
    answer = await client.post("calc/ramp", json=body)
    assert answer.status_code == 422, answer.text
    assert words in answer.json()["detail"]


async def test_every_unit_of_a_velocity(client: httpx.AsyncClient) -> None:
    body = {
        "pulse_div": 2,
        "ramp_div": 7,
        "mechanics": {"microsteps_per_full_step": 16, "travel_mm_per_rev": 8},
        "velocity": {"value": 600, "unit": "rpm"},
        "acceleration": {"value": 100, "unit": "mm_per_s2"},
        "position": {"value": 1, "unit": "rev"},
    }
    answer = (await client.post("calc/units", json=body)).json()
    assert answer["velocity"]["pps"] == pytest.approx(32_000)
    assert answer["velocity"]["mm_per_s"] == pytest.approx(80)
    assert answer["velocity"]["chip"] == pytest.approx(32_000 * 4 * 65536 / 16e6)
    assert answer["position"] == {
        "microsteps": 3200,
        "fullsteps": 200,
        "rev": 1,
        "deg": pytest.approx(360),
        "rad": pytest.approx(6.283185307),
        "mm": 8,
    }
    assert answer["acceleration_time_s"] == pytest.approx(0.8)
    assert answer["acceleration_steps"] == pytest.approx(0.5 * 80 * 0.8 / 8 * 3200)


async def test_what_no_register_holds_is_null_and_a_rotary_axis_has_no_mm(client: httpx.AsyncClient) -> None:
    body = {"pulse_div": 13, "ramp_div": 0, "velocity": {"value": 1e6, "unit": "pps"}}
    velocity = (await client.post("calc/units", json=body)).json()["velocity"]
    assert velocity["chip"] is None
    assert velocity["mm_per_s"] is None


@pytest.mark.parametrize(
    ("path", "body", "words"),
    [
        ("units", {"pulse_div": 2, "ramp_div": 7, "velocity": {"value": 1, "unit": "mph"}}, "mph"),
        ("units", {"pulse_div": 2, "ramp_div": 7, "velocity": {"value": 1, "unit": "mm_per_s"}}, "travel_mm_per_rev"),
        ("units", {"pulse_div": 14, "ramp_div": 7}, "pulse_div"),
        ("driver-chain", {"drivers": ["tmc5160"]}, "tmc5160"),
        ("driver-chain", {"drivers": ["tmc236"], "clk2_div": 256}, "clk2_div"),
        ("microstep-table", {"values": [1] * 63}, "64"),
        ("microstep-table", {"offset": 50, "amplitude": 40}, "offset"),
        ("microstep-table", {"sigma": 1.1}, "sigma"),
        (
            "ramp-inverse",
            {"velocity": {"value": 1e12, "unit": "pps"}, "acceleration": {"value": 1, "unit": "pps2"}},
            "",
        ),
    ],
)
async def test_what_cannot_be_calculated_is_422(
    client: httpx.AsyncClient, path: str, body: dict[str, object], words: str
) -> None:
    answer = await client.post(f"calc/{path}", json=body)
    assert answer.status_code == 422, answer.text
    assert words in answer.json()["detail"]


async def test_an_inverse_reaches_what_was_wanted(client: httpx.AsyncClient) -> None:
    body = {
        "velocity": {"value": 300, "unit": "rpm"},
        "acceleration": {"value": 600, "unit": "rpm_per_s"},
        "mechanics": {"full_steps_per_rev": 200},
    }
    found = (await client.post("calc/ramp-inverse", json=body)).json()
    assert abs(found["velocity_error"]) < 0.01
    assert abs(found["acceleration_error"]) < 0.03
    assert found["mechanics"]["microsteps_per_full_step"] == 2 ** found["usrs"]
    per_rev = 200 * 2 ** found["usrs"]
    assert found["achieved_velocity_pps"] == pytest.approx(300 / 60 * per_rev, rel=0.01)


async def test_a_microstep_table_with_its_figures(client: httpx.AsyncClient) -> None:
    answer = (await client.post("calc/microstep-table", json={"usrs": 4})).json()
    assert len(answer["values"]) == 64
    assert len(answer["datagrams"]) == 32
    assert len(answer["sequence"]) == 64
    assert answer["metrics"]["angle_error_max_deg"] < 2
    drawn = (await client.post("calc/microstep-table", json={"values": [0] * 64})).json()
    assert drawn["metrics"]["thd"] is None
    assert drawn["values"] == [0] * 64


async def test_a_driver_chain_with_its_frequencies(client: httpx.AsyncClient) -> None:
    answer = (await client.post("calc/driver-chain", json={"drivers": ["tmc236"] * 3, "ramp_divs": [7, 7, 7]})).json()
    assert answer["spi_clock_hz"] == 1e6
    assert answer["length_bits"] == 36
    assert answer["full_step_hz_max"] == pytest.approx(1e6 / 36)
    assert answer["continuous_update_hz"] == pytest.approx(16e6 * 3 / 128 / 32768)
    assert len(answer["ram_words"]) == 64


@pytest.mark.parametrize("mode", ["velocity", "hold"])
@pytest.mark.parametrize("distance", [20_000, -20_000])
async def test_without_a_wanted_velocity_it_turns_at_v_max_that_way(
    client: httpx.AsyncClient, mode: str, distance: int
) -> None:
    body = {"model": "tmc428", "parameters": {**RAMP, "ramp_mode": mode}, "distance": distance, "samples": 50}
    answer = (await client.post("calc/ramp", json=body)).json()
    full_speed = 16e6 * RAMP["v_max"] / (2 ** RAMP["pulse_div"] * 65536) * (1 if distance > 0 else -1)
    assert answer["velocity_pps"][-1] == pytest.approx(full_speed)
    assert answer["position"][-1] == distance
    assert answer["velocity_pps"][1] == pytest.approx(full_speed) or mode == "velocity"


async def test_names_of_a_custom_drivers_bits_come_back(client: httpx.AsyncClient) -> None:
    custom = {"driver": "custom", "signals": ["Step", "Direction"], "bit_names": ["STP", "DIR"]}
    answer = (await client.post("calc/driver-chain", json={"drivers": ["tmc236", custom]})).json()
    assert [bit["bit_name"] for bit in answer["bits"]][-3:] == ["PHB", "STP", "DIR"]


# --- a module's ramps and units -----------------------------------------------------------------

SIXPOINT = {
    "vstart": 100,
    "a1": 50_000,
    "v1": 20_000,
    "amax": 20_000,
    "vmax": 50_000,
    "dmax": 30_000,
    "d1": 60_000,
    "vstop": 200,
}


async def test_a_sixpoint_ramp_is_the_planners(client: httpx.AsyncClient) -> None:
    body = {"model": "sixpoint", "parameters": SIXPOINT, "distance": -100_000, "samples": 64}
    answer = (await client.post("calc/ramp", json=body)).json()
    ramp = SixPoint(v_max=50_000, a_max=20_000, d_max=30_000, v_start=100, a1=50_000, v1=20_000, d1=60_000, v_stop=200)
    curve = position_plan(ramp, -100_000).curve(64)
    assert answer["duration_s"] == curve.duration_s
    assert answer["position"] == curve.position.tolist()
    assert answer["velocity_pps"] == curve.velocity_pps.tolist()
    assert [phase["name"] for phase in answer["phases"]] == [phase.name for phase in curve.phases]
    assert len(answer["phases"]) == 5
    assert answer["warnings"] == []


async def test_a_sixpoint_ramp_from_any_velocity_waits_where_it_turns(client: httpx.AsyncClient) -> None:
    parameters = {**SIXPOINT, "v_actual": 50_000, "t_zero_wait_s": 0.25}
    body = {"model": "sixpoint", "parameters": parameters, "distance": 1000}
    answer = (await client.post("calc/ramp", json=body)).json()
    assert answer["overshoot_steps"] > 30_000
    wait = next(phase for phase in answer["phases"] if phase["name"] == "wait")
    assert wait["end_s"] - wait["start_s"] == pytest.approx(0.25)
    assert answer["position"][-1] == 1000


async def test_a_sixpoint_rotation_goes_on_until_the_distance_is_behind(client: httpx.AsyncClient) -> None:
    parameters = {"amax": 20_000, "vmax": 50_000, "ramp_mode": "velocity"}
    body = {"model": "sixpoint", "parameters": parameters, "distance": -100_000}
    answer = (await client.post("calc/ramp", json=body)).json()
    assert answer["position"][-1] == pytest.approx(-100_000)
    assert answer["velocity_pps"][-1] == -50_000
    assert [phase["name"] for phase in answer["phases"]] == ["acceleration AMAX", "constant velocity"]
    stop = {**body, "parameters": {**parameters, "v_target": 0, "v_actual": 50_000}}
    assert (await client.post("calc/ramp", json=stop)).json()["duration_s"] == pytest.approx(2.5)


async def test_left_out_decelerations_are_the_accelerations(client: httpx.AsyncClient) -> None:
    parameters = {"amax": 20_000, "vmax": 50_000, "v1": 10_000}
    body = {"model": "sixpoint", "parameters": parameters, "distance": 50_000, "samples": 3}
    spelled_out = {**body, "parameters": {**parameters, "a1": 20_000, "dmax": 20_000, "d1": 20_000}}
    assert (await client.post("calc/ramp", json=body)).json() == (
        await client.post("calc/ramp", json=spelled_out)
    ).json()


@pytest.mark.parametrize(
    ("parameters", "words"),
    [
        ({"amax": 1000}, "vmax"),
        ({"amax": 1000, "vmax": 0}, "v_max"),
        ({"amax": 1000, "vmax": 1000, "pmul": 3}, "'pmul'"),
        ({"amax": 1000, "vmax": 1000, "ramp_mode": "soft"}, "soft"),
        ({"amax": 1000, "vmax": 1000, "vstart": 500}, "v_start"),
        ({"amax": "fast", "vmax": 1000}, "'fast'"),
    ],
)
async def test_a_sixpoint_ramp_that_cannot_be_is_422(
    client: httpx.AsyncClient, parameters: dict[str, object], words: str
) -> None:
    answer = await client.post("calc/ramp", json={"model": "sixpoint", "parameters": parameters, "distance": 10})
    assert answer.status_code == 422
    assert words in answer.json()["detail"]


@pytest.mark.sheet("FM-PD42-1241", "7.4")
async def test_units_of_a_module(client: httpx.AsyncClient) -> None:
    body = {
        "model": "pd42-1241",
        "velocity": {"value": 60, "unit": "rpm"},
        "acceleration": {"value": 1, "unit": "rps2"},
        "mechanics": {"microsteps_per_full_step": 256},
    }
    answer = (await client.post("calc/units", json=body)).json()
    assert answer["velocity"]["pps"] == pytest.approx(51_200)
    assert answer["velocity"]["rps"] == pytest.approx(1)
    assert answer["velocity"]["chip"] == pytest.approx(53_687.0912)
    assert answer["module"] == {
        "velocity": 53_687,
        "velocity_pps": pytest.approx(51_200, abs=0.5),
        "acceleration": 440,
        "acceleration_pps2": pytest.approx(51_200, abs=60),
        "tstep": 312,
    }
    back = {"model": "pd42-1241", "velocity": {"value": 53_687, "unit": "chip"}}
    assert (await client.post("calc/units", json=back)).json()["velocity"]["pps"] == answer["module"]["velocity_pps"]
    beyond = {"model": "pd42-1241", "velocity": {"value": 9e6, "unit": "pps"}}
    assert (await client.post("calc/units", json=beyond)).json()["module"]["velocity"] is None


async def test_a_chip_needs_its_dividers_and_a_module_has_none(client: httpx.AsyncClient) -> None:
    answer = await client.post("calc/units", json={"model": "tmc428", "velocity": {"value": 1, "unit": "pps"}})
    assert answer.status_code == 422
    assert "pulse_div" in answer.json()["detail"]
    chip = {"model": "tmc428", "pulse_div": 2, "ramp_div": 7, "velocity": {"value": 1, "unit": "rps"}}
    assert (await client.post("calc/units", json=chip)).json()["module"] is None


async def test_current_scales_over_a_move(client: httpx.AsyncClient) -> None:
    body = {
        "parameters": {**RAMP, "clock_hz": 16e6},
        "distance": 5_000,
        "is_v0": 2,
        "is_aleat": 4,
        "is_agtat": 7,
        "a_threshold": 100,
        "continuous_update": False,
    }
    answer = (await client.post("calc/current-scales", json=body)).json()
    assert answer["spans"][0]["scale"] == "is_v0"
    assert answer["spans"][0]["eighths"] == 2
    assert answer["rest_delay_s"] == 255 * 32 * 2**7 / 16e6
    assert any("continuous_update" in said for said in answer["warnings"])
    refused = await client.post("calc/current-scales", json={**body, "is_v0": 8})
    assert refused.status_code == 422
    refused = await client.post("calc/current-scales", json={**body, "parameters": {**RAMP, "v_max": 0}})
    assert refused.status_code == 422
    assert "v_max is 0" in refused.json()["detail"]


async def test_v_min_as_a_start_stop_speed(client: httpx.AsyncClient) -> None:
    body = {"parameters": {**RAMP, "clock_hz": 16e6}, "distance": 5_000, "motor": {"microsteps_per_full_step": 64}}
    answer = (await client.post("calc/start-stop", json=body)).json()
    assert answer["keeps_steps"]
    assert 1 <= answer["suggested_chip"] <= answer["limit_chip"]
    assert answer["duration_s"] == answer["duration_least_s"]
    refused = await client.post("calc/start-stop", json={**body, "motor": {"inertia_kgm2": 0}})
    assert refused.status_code == 422


async def test_current_of_a_driver_with_one_scale(client: httpx.AsyncClient) -> None:
    body = {"model": "tmc2660", "sense_resistor_ohm": 0.1, "scale": 31, "vsense": 0, "toff": 5, "tbl": 2}
    answer = (await client.post("calc/scale-current", json=body)).json()
    assert answer["rms_a"] == pytest.approx(2.192, abs=1e-3)
    assert answer["full_scale_rms_a"] == answer["rms_a"]
    assert answer["nearest"] == []
    assert answer["warnings"] == []
    wanted = {**body, "sense_resistor_ohm": 0.05, "toff": 0, "wanted_rms_a": 1.0}
    answer = (await client.post("calc/scale-current", json=wanted)).json()
    assert (answer["nearest"][0]["vsense"], answer["off_s"]) == (1, None)
    assert len(answer["warnings"]) == 2
    assert (await client.post("calc/scale-current", json={**body, "model": "tmc5160"})).status_code == 422
