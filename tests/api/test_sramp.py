"""The S-ramp calculator over REST: the planner's own motion, what registers make of it, and refusals by name."""

from __future__ import annotations

from typing import Any

import httpx
import numpy as np
import pytest

from app.calc.motor_torque import StepperMotor
from app.calc.ramps.sramp import SRamp, position_plan, velocity_plan
from app.calc.ramps.trapezoid import trapezoid_ramp
from app.calc.units.tmc4361 import Units

RAMP: dict[str, Any] = {
    "vmax": 50_000,
    "amax": 200_000,
    "dmax": 250_000,
    "bow1": 2e6,
    "bow2": 1e6,
    "bow3": 3e6,
    "bow4": 1.5e6,
    "vstart": 100,
    "vstop": 0,
    "astart": 0,
    "dfinal": 0,
}


async def answer(client: httpx.AsyncClient, distance: float = 40_000, samples: int = 50, **change: Any) -> Any:
    body = {"model": "s_ramp", "parameters": {**RAMP, **change}, "distance": distance, "samples": samples}
    reply = await client.post("calc/ramp", json=body)
    assert reply.status_code == 200, reply.text
    return reply.json()


async def refusal(client: httpx.AsyncClient, drop: str = "", **change: Any) -> str:
    parameters = {name: value for name, value in {**RAMP, **change}.items() if name != drop}
    reply = await client.post("calc/ramp", json={"model": "s_ramp", "parameters": parameters, "distance": 1000})
    assert reply.status_code == 422, reply.text
    return str(reply.json()["detail"])


async def test_the_answer_is_the_planners_motion(client: httpx.AsyncClient) -> None:
    given = await answer(client)
    plan = position_plan(SRamp(**RAMP), 40_000)
    motion = plan.at(np.linspace(0, plan.duration_s, 50))
    assert given["duration_s"] == plan.duration_s == given["time_s"][-1]
    assert given["position"] == motion.position.tolist()
    assert given["jerk_pps3"] == motion.jerk_pps3.tolist()
    assert given["position"][-1] == 40_000
    assert [phase["name"] for phase in given["phases"]] == [piece.name for piece in plan.pieces]
    assert {limit["name"]: limit["peak"] for limit in given["limits"]} == {use.name: use.peak for use in plan.limits}


async def test_a_move_under_way_begins_with_its_state(client: httpx.AsyncClient) -> None:
    given = await answer(client, -3000, v_actual=20_000, a_actual=1000)
    plan = position_plan(SRamp(**RAMP), -3000, 20_000, 1000)
    assert given["duration_s"] == plan.duration_s
    assert given["overshoot_steps"] == 0
    assert given["velocity_pps"][0] == 20_000
    assert given["rivals"] == [], "what comes before decides how long others take"


async def test_velocity_mode_goes_to_its_target_and_on(client: httpx.AsyncClient) -> None:
    given = await answer(client, -50_000, ramp_mode="velocity")
    plan = velocity_plan(SRamp(**RAMP), -50_000)
    assert given["velocity_pps"][-1] == -50_000
    assert given["position"][-1] == pytest.approx(-50_000)
    assert given["duration_s"] > plan.duration_s
    slower = await answer(client, 0, ramp_mode="velocity", v_target=1000)
    assert slower["velocity_pps"][-1] == pytest.approx(1000)


async def test_bows_and_dmax_follow_the_first_where_they_are_left_out(client: httpx.AsyncClient) -> None:
    body = {"model": "s_ramp", "parameters": {"vmax": 5e4, "amax": 2e5, "bow1": 2e6}, "distance": 4e4}
    given = (await client.post("calc/ramp", json=body)).json()
    plan = position_plan(SRamp(5e4, 2e5, 2e5, 2e6, 2e6, 2e6, 2e6), 4e4)
    assert given["duration_s"] == plan.duration_s


@pytest.mark.sheet("DS-TMC4361", "8.2.3")
async def test_registers_say_what_the_chip_will_hold(client: httpx.AsyncClient) -> None:
    given = await answer(client, vmax=1000.001, amax=1234.6, rounding="registers", direct_bow_val_en=1)
    registers = {register["parameter"]: register for register in given["registers"]}
    assert set(registers) == set(RAMP)
    units = Units(16e6, direct_bow=True)
    assert registers["vmax"]["raw"] == 256_000
    assert registers["vmax"]["value"] == 1000.0
    assert registers["amax"]["value"] == 1234.5
    assert registers["bow1"]["raw"] == units.to_raw("BOW1", 2e6)
    assert registers["bow1"]["least"] == units.least("BOW1")
    held: dict[str, Any] = {
        name: units.held(name.upper(), value) for name, value in {**RAMP, "vmax": 1000.001, "amax": 1234.6}.items()
    }
    assert given["duration_s"] == position_plan(SRamp(**held), 40_000).duration_s
    wished = await answer(client, vmax=1000.001, amax=1234.6, direct_bow_val_en=1)
    assert wished["duration_s"] != given["duration_s"], "without rounding the wishes are taken at their word"


async def test_findings_name_their_parameter(client: httpx.AsyncClient) -> None:
    given = await answer(client, 500, bow2=1e3)
    by_code = {finding["code"]: finding["parameter"] for finding in given["findings"]}
    assert by_code["amax_out_of_reach"] == "amax"
    assert by_code["vmax_not_reached"] == "vmax"
    assert given["warnings"] == [finding["text"] for finding in given["findings"]]
    fast = await answer(client, vmax=5e6, amax=4e6, bow1=1e7, bow2=1e7)
    assert ("vmax", "limit") in {(finding["parameter"], finding["code"]) for finding in fast["findings"]}, "fCLK/4"


async def test_the_trapezoid_of_the_same_limits_is_what_the_bows_cost(client: httpx.AsyncClient) -> None:
    given = await answer(client, vstart=0)
    rival = next(rival for rival in given["rivals"] if rival["name"] == "trapezoid")
    assert rival["duration_s"] == trapezoid_ramp(5e4, 2e5, 2.5e5, 40_000, 2).duration_s
    assert rival["saved_s"] == rival["duration_s"] - given["duration_s"] < 0


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"speed": 1}, "'speed'"),
        ({"drop": "vmax"}, "vmax"),
        ({"drop": "bow1"}, "bow1"),
        ({"vmax": 9e6}, "fCLK/2"),
        ({"amax": 5e6}, "AMAX"),
        ({"bow3": 2e7}, "BOW3"),
        ({"bow3": 0.1}, "least step"),
        ({"bow2": 0}, "bow2"),
        ({"vmax": 0}, "VMAX"),
        ({"vstart": -1}, "VSTART"),
        ({"clock_hz": 40e6}, "CLK_FREQ"),
        ({"ramp_mode": "warp"}, "ramp_mode"),
        ({"shape": "round"}, "shape"),
        ({"rounding": "up"}, "rounding"),
        ({"direct_acc_val_en": 2}, "direct_acc_val_en"),
        ({"vmax": "fast"}, "vmax"),
        ({"ramp_mode": "velocity", "v_target": 9e6}, "fCLK/2"),
    ],
)
async def test_what_cannot_be_is_refused_by_name(client: httpx.AsyncClient, change: dict[str, Any], words: str) -> None:
    assert words in await refusal(client, **change)


async def test_a_trapezoid_and_a_rectangle_are_ramps_of_the_chip_too(client: httpx.AsyncClient) -> None:
    given = await answer(client, shape="trapezoid", vbreak=1e4, astart=5e4, dfinal=6e4, vstop=2000)
    assert [phase["name"] for phase in given["phases"]] == ["A1L", "A1", "A2", "A3", "A3L"]
    assert given["position"][-1] == 40_000
    assert {register["name"] for register in given["registers"]} >= {"VBREAK", "DFINAL"}
    turning = await answer(client, shape="trapezoid", ramp_mode="velocity", vbreak=0)
    assert turning["velocity_pps"][-1] == 50_000
    held = await answer(client, ramp_mode="hold")
    assert held["duration_s"] == 40_000 / 50_000
    assert set(held["velocity_pps"][:-1]) == {50_000}
    at_once = await answer(client, 1000, ramp_mode="hold", v_target=-1000)
    assert at_once["velocity_pps"][0] == -1000
    assert "VBREAK" in await refusal(client, shape="trapezoid", vbreak=1e4, astart=0)


async def test_the_torque_left_is_shown_against_the_motor(client: httpx.AsyncClient) -> None:
    body = {"model": "s_ramp", "parameters": RAMP, "distance": 4e4, "samples": 200, "motor": {}}
    given = (await client.post("calc/ramp", json=body)).json()
    motor = StepperMotor()
    asked = motor.required_nm(given["velocity_pps"], given["acceleration_pps2"])
    assert given["torque"]["required_nm"] == asked.tolist()
    least = int(np.argmin(motor.margin(given["velocity_pps"], given["acceleration_pps2"])[:-1]))
    assert given["torque"]["margin_at_s"] == given["time_s"][least]
    times = {rival["name"]: rival["duration_s"] for rival in given["rivals"]}
    assert times["motor_limit"] <= min(times["motor_trapezoid"], given["duration_s"])
    overload = {**body, "motor": {"supply_v": 0.5, "inertia_kgm2": 1.0}}
    worse = (await client.post("calc/ramp", json=overload)).json()
    assert worse["torque"]["margin"] < 0
    assert (await client.post("calc/ramp", json={**body, "motor": {"supply_v": 0}})).status_code == 422


@pytest.mark.parametrize("model", ["sixpoint", "trapezoid"])
async def test_other_smooth_ramps_are_compared_with_a_motor_too(client: httpx.AsyncClient, model: str) -> None:
    """The torque is of the curve that is answered, and there is none without a motor, or of steps bit for bit."""
    parameters = {"vmax": 50_000, "amax": 400_000, "dmax": 500_000}
    body = {"model": model, "parameters": parameters, "distance": 4e4, "samples": 200}
    assert (await client.post("calc/ramp", json=body)).json()["torque"] is None
    given = (await client.post("calc/ramp", json={**body, "motor": {}})).json()
    motor = StepperMotor()
    asked = motor.required_nm(given["velocity_pps"], given["acceleration_pps2"])
    assert given["torque"]["required_nm"] == asked.tolist()
    assert given["torque"]["speed_pps"][-1] == 75_000
    exact = {"v_max": 1000, "a_max": 200, "ramp_div": 6, "pulse_div": 4, "pmul": 60, "pdiv": 5}
    steps = {"model": "tmc428", "parameters": exact, "distance": 1000, "samples": 20, "motor": {}}
    assert (await client.post("calc/ramp", json=steps)).json()["torque"] is None
