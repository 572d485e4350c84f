"""What happens to a motor is told within 0.5 s of its time; nobody asks for the axis, and `GET /devices` reads none."""

from __future__ import annotations

from typing import Any

import httpx
import pytest
from fastapi import FastAPI

from app.clock import VirtualClock
from app.devices.core.device import Device
from app.devices.tmc5xxx import start_up as six_point_start
from app.devices.tmc428 import start_up as ramp_start
from app.devices.tmc4361 import start_up as s_ramp_start
from app.main import bench_of

TOLD_S = 0.5
SIX_POINT = ("tmc5031", "tmc5062", "tmc5072", "tmc5130", "tmc5160")
WITH_ENCODER = ("tmc4361", "tmc5062", "tmc5072", "tmc5130", "tmc5160", "pd42-1241")
ALL = ("tmc428", "tmc4210", "tmc4361", *SIX_POINT, "pd42-1241")


class Rig:
    """One emulated device that can move, and the API around it."""

    def __init__(self, client: httpx.AsyncClient, clock: VirtualClock, device: Device) -> None:
        self.client, self.clock, self.device = client, clock, device
        self.url = f"devices/{device.id}"

    async def told(self) -> dict[str, Any]:
        """The axis as last judged."""
        axis: dict[str, Any] = (await self.client.get(self.url)).json()["axes"][0]
        return axis

    async def kind(self) -> str:
        return str((await self.told())["condition"]["kind"])

    async def post(self, path: str, body: object = None) -> dict[str, Any]:
        answer = await self.client.post(f"{self.url}/{path}", json=body)
        assert answer.status_code == 200, answer.text
        found: dict[str, Any] = answer.json()
        return found

    async def change_emulator(self, **change: Any) -> None:
        """Change the emulated plant; of a chip that counts its axes, that of the first."""
        answer = await self.client.patch(f"{self.url}/emulator", json=self.emulator_patch(change))
        assert answer.status_code == 200, answer.text

    def emulator_patch(self, change: dict[str, Any]) -> dict[str, Any]:
        """A change as this model's emulator takes it."""
        several = self.device.model in SIX_POINT and not change.keys() & {"faults", "power_cycle"}
        body = {"axes": [{"axis": 0, **change}]} if several else change
        if self.device.model in ("tmc428", "tmc4210") and "switches" in change:
            body = {"switches": [{"axis": 0, **change["switches"]}]}
        return body

    async def at_rest(self, within_s: float = 30.0) -> list[str]:
        """Let time pass until the axis rests; the kinds that were told on the way, each once."""
        kinds: list[str] = []
        for _ in range(round(within_s / 0.25)):
            await self.clock.advance(0.25)
            kinds.append(await self.kind())
            if not (await self.client.get(f"{self.url}/axes/0")).json()["moving"]:
                return list(dict.fromkeys(kinds))
        raise AssertionError(f"it still moves after {within_s} s")


async def rig(app: FastAPI, client: httpx.AsyncClient, clock: VirtualClock, model: str, *, encoder: bool = True) -> Rig:
    added = await client.post("devices", json={"name": "rig", "model": model, "link": {"kind": "emulator"}})
    assert added.status_code == 201, added.text
    device = bench_of(app).manager.get("rig")
    counts = 40_000 if encoder and model in WITH_ENCODER else 0
    if model in SIX_POINT:
        start = six_point_start.Start(vmax=50_000, amax=200_000, counts_per_rev=counts)
        await six_point_start.start_up(device, [start])
    elif model == "tmc4361":
        await s_ramp_start.start_up(device, s_ramp_start.Start(vmax=50_000, amax=200_000, counts_per_rev=counts))
    elif model != "pd42-1241":
        setting = ramp_start.AxisStart(v_max=1000, a_max=500, pulse_div=5, ramp_div=7)
        await ramp_start.start_up(device, [setting])
    made = Rig(client, clock, device)
    await clock.advance(TOLD_S)
    assert await made.kind() == "ready"
    return made


@pytest.mark.parametrize("model", WITH_ENCODER)
async def test_a_blocked_shaft_is_a_following_error_and_then_lost_steps_and_never_an_arrival(
    app: FastAPI, client: httpx.AsyncClient, clock: VirtualClock, model: str
) -> None:
    one = await rig(app, client, clock, model)
    await one.change_emulator(blocked=True)
    await one.post("axes/0/move", {"target": 86_496})
    await clock.advance(TOLD_S)
    assert await one.kind() == "following_error"
    kinds = await one.at_rest()
    await clock.advance(TOLD_S)
    axis = await one.told()
    assert "on_target" not in (*kinds, axis["condition"]["kind"])
    if model == "pd42-1241" and axis["condition"]["kind"] == "following_error":
        return  # the module stops by itself at a deviation
    assert axis["condition"]["kind"] == "lost_steps"
    assert axis["referenced"] is False
    assert axis["ground_truth"]["lost_steps"] == pytest.approx(86_496, abs=1024)
    assert axis["ground_truth"]["blocked"] is True
    assert axis["condition"]["remedy"]["label"] == "set position from encoder"
    state = await one.post("axes/0/position-from-encoder")
    assert state["condition"]["kind"] == "ready"
    assert abs(state["position"]) <= 512
    await clock.advance(2.0)
    assert abs((await one.client.get(f"{one.url}/axes/0")).json()["position"]) <= 512  # it did not set off
    axis = await one.told()
    assert (axis["condition"]["remedies"], axis["referenced"]) == ([], True)


async def test_an_encoder_counts_as_soon_as_its_resolution_is_written(
    app: FastAPI, client: httpx.AsyncClient, clock: VirtualClock
) -> None:
    one = await rig(app, client, clock, "tmc4361", encoder=False)
    written = await client.put(f"{one.url}/registers/ENC_IN_RES", json={"fields": {"ENC_IN_RES": 40_000}})
    assert written.status_code == 200, written.text
    await one.post("axes/0/position-from-encoder")


async def test_a_module_that_moves_keeps_its_position_whatever_its_encoder_says(
    app: FastAPI, client: httpx.AsyncClient, clock: VirtualClock
) -> None:
    one = await rig(app, client, clock, "pd42-1241")
    await one.post("axes/0/rotate", {"velocity": 20_000})
    await clock.advance(0.5)
    refused = await client.post(f"{one.url}/axes/0/position-from-encoder")
    assert (refused.status_code, refused.json()["detail"]) == (409, "axis 0 moves; stop it first")


@pytest.mark.parametrize("model", SIX_POINT)
async def test_without_an_encoder_an_arrival_says_what_would_not_be_seen(
    app: FastAPI, client: httpx.AsyncClient, clock: VirtualClock, model: str
) -> None:
    one = await rig(app, client, clock, model, encoder=False)
    await one.change_emulator(blocked=True)
    await one.post("axes/0/move", {"target": 86_496})
    await one.at_rest()
    await clock.advance(TOLD_S)
    axis = await one.told()
    assert axis["condition"]["kind"] == "on_target"
    assert axis["condition"]["cause"] == "at its target; lost steps would not be seen"
    assert axis["ground_truth"]["lost_steps"] == pytest.approx(86_496, abs=1024)


@pytest.mark.parametrize("model", ALL)
async def test_a_switch_that_holds_it_is_told_with_the_way_that_is_free(
    app: FastAPI, client: httpx.AsyncClient, clock: VirtualClock, model: str
) -> None:
    one = await rig(app, client, clock, model)
    await one.post("axes/0/move", {"target": -100_000})
    await clock.advance(TOLD_S)
    assert await one.kind() == "moving"
    await one.change_emulator(switches={"left": True})
    await one.at_rest()
    await clock.advance(TOLD_S)
    condition = (await one.told())["condition"]
    assert condition["kind"] == "held"
    assert "left switch" in condition["cause"]
    assert "greater positions" in condition["cause"]


@pytest.mark.parametrize("model", ALL)
async def test_a_power_cycle_and_a_dead_link_are_told(
    app: FastAPI, client: httpx.AsyncClient, clock: VirtualClock, model: str
) -> None:
    one = await rig(app, client, clock, model)
    await clock.advance(2.0)
    await one.change_emulator(power_cycle=True)
    await clock.advance(TOLD_S)
    axis = await one.told()
    assert axis["condition"]["kind"] == ("unknown" if model == "pd42-1241" else "cannot_move")
    assert "was reset" in axis["condition"]["cause"]
    assert axis["condition"]["remedy"]["label"] == "start up"
    assert axis["referenced"] is False
    await one.change_emulator(faults={"unplugged": True})
    await clock.advance(TOLD_S)
    condition = (await one.told())["condition"]
    assert (condition["kind"], condition["remedy"]["label"]) == ("not_connected", "connect")


@pytest.mark.parametrize("model", SIX_POINT)
async def test_a_stall_is_told_and_its_flag_can_be_cleared(
    app: FastAPI, client: httpx.AsyncClient, clock: VirtualClock, model: str
) -> None:
    one = await rig(app, client, clock, model, encoder=False)
    await one.device.registers.write("SW_MODE", 0, fields={"sg_stop": 1, "stop_l_enable": 0, "stop_r_enable": 0})
    if one.device.axes and model in ("tmc5130", "tmc5160"):
        await one.device.registers.write("TCOOLTHRS", 0, 2_000)
    else:
        await one.device.registers.write("VCOOLTHRS", 0, 10_000)
        await one.device.registers.write("VHIGH", 0, (1 << 23) - 1)
    await one.post("axes/0/rotate", {"velocity": 40_000})
    for _ in range(10):
        await clock.advance(0.05)
    await one.change_emulator(blocked=True)
    await one.at_rest()
    stopped_s = one.device.monitor.motion_ends(0)[-1].time_s if one.device.monitor.motion_ends(0) else clock.now()
    await clock.advance(TOLD_S)
    condition = (await one.told())["condition"]
    assert (condition["kind"], condition["remedy"]["label"]) == ("stalled", "clear the flag")
    assert condition["since_s"] - stopped_s <= TOLD_S
    await one.change_emulator(blocked=False)
    await one.post("axes/0/clear-flags")
    await clock.advance(TOLD_S)
    assert "RAMP_STAT.event_stop_sg" not in str((await one.told())["condition"]["evidence"])


@pytest.mark.parametrize("model", ["tmc5130", "tmc5160", "pd42-1241"])
async def test_a_driver_that_shuts_down_is_a_fault(
    app: FastAPI, client: httpx.AsyncClient, clock: VirtualClock, model: str
) -> None:
    one = await rig(app, client, clock, model)
    await one.change_emulator(motor={"temperature_c": 130})
    await clock.advance(TOLD_S)
    condition = (await one.told())["condition"]
    assert (condition["kind"], "the driver warns that it is hot" in condition["cause"]) == ("ready", True)
    await one.change_emulator(motor={"temperature_c": 160})
    await clock.advance(TOLD_S)
    condition = (await one.told())["condition"]
    assert condition["kind"] == "driver_fault"
    assert "warns" not in condition["cause"]
    assert "too hot" in condition["cause"]
    await one.change_emulator(motor={"temperature_c": 40})
    await clock.advance(TOLD_S)
    if model != "pd42-1241":
        condition = (await one.told())["condition"]
        assert (condition["kind"], condition["remedy"]["label"]) == ("driver_fault", "clear the flag")
        await one.post("axes/0/clear-flags")
        await clock.advance(TOLD_S)
    assert await one.kind() == "ready"


async def remedied(one: Rig) -> str:
    """Make the first remedy of the condition that is told; its label."""
    remedy = (await one.told())["condition"]["remedy"]
    done = await one.client.request(remedy["method"], remedy["path"].removeprefix("/api/v1/"), json=remedy["body"])
    assert done.status_code == 200, done.text
    await one.clock.advance(TOLD_S)
    return str(remedy["label"])


@pytest.mark.parametrize("coil", ["a", "b"])
@pytest.mark.parametrize("model", [*SIX_POINT, "pd42-1241", "tmc4361"])
async def test_a_coil_that_is_shorted_is_a_fault_that_its_remedies_end(
    app: FastAPI, client: httpx.AsyncClient, clock: VirtualClock, model: str, coil: str
) -> None:
    one = await rig(app, client, clock, model)
    await one.change_emulator(motor={"short_to_ground": coil})
    await clock.advance(TOLD_S)
    condition = (await one.told())["condition"]
    assert condition["kind"] == "driver_fault"
    assert f" {coil.upper()}" in condition["cause"]
    assert "short" in condition["cause"]
    if model == "tmc4361":  # its driver is beside it: nothing here switches that off
        await one.change_emulator(motor={"short_to_ground": "none"})
        await clock.advance(TOLD_S)
        assert await one.kind() == "ready"
        return
    assert "0" in await remedied(one)  # the driver is switched off
    kind = await one.kind()
    if kind == "driver_fault":
        assert await remedied(one) == "clear the flag"
    assert await one.kind() == "cannot_move"
    assert await remedied(one) == "start up"
    assert await one.kind() == "driver_fault"  # the short is still there
    await one.change_emulator(motor={"short_to_ground": "none"})
    for _ in range(6):
        if await one.kind() == "ready":
            return
        await remedied(one)
    raise AssertionError(await one.told())


@pytest.mark.parametrize("model", SIX_POINT)
async def test_too_little_supply_voltage_is_a_fault(
    app: FastAPI, client: httpx.AsyncClient, clock: VirtualClock, model: str
) -> None:
    one = await rig(app, client, clock, model)
    answer = await client.patch(f"{one.url}/emulator", json={"supply_v": 5.0})
    assert answer.status_code == 200
    await clock.advance(TOLD_S)
    condition = (await one.told())["condition"]
    assert condition["kind"] == "driver_fault"
    assert "too little voltage" in condition["cause"]
    await client.patch(f"{one.url}/emulator", json={"supply_v": 24.0})
    await clock.advance(TOLD_S)
    if await one.kind() == "driver_fault":
        assert await remedied(one) == "clear the flag"
    assert await one.kind() == "ready"


async def test_a_hot_driver_of_a_chip_that_has_its_driver_beside_it_is_a_fault(
    app: FastAPI, client: httpx.AsyncClient, clock: VirtualClock
) -> None:
    one = await rig(app, client, clock, "tmc4361")
    await one.change_emulator(motor={"temperature_c": 160})
    await clock.advance(TOLD_S)
    condition = (await one.told())["condition"]
    assert (condition["kind"], "too hot" in condition["cause"]) == ("driver_fault", True)
    await one.change_emulator(motor={"temperature_c": 40})
    await clock.advance(TOLD_S)
    assert await one.kind() == "ready"


async def test_what_a_stall_still_holds_when_its_flag_is_cleared_says_what_lets_it_go(
    app: FastAPI, client: httpx.AsyncClient, clock: VirtualClock
) -> None:
    one = await rig(app, client, clock, "tmc4361", encoder=False)
    await one.device.registers.write("VSTALL_LIMIT", 0, 1000)
    await one.device.registers.write("REFERENCE_CONF", 0, fields={"stop_on_stall": 1})
    await one.post("axes/0/rotate", {"velocity": 40_000})
    await clock.advance(1.0)
    await one.change_emulator(blocked=True)
    await clock.advance(2.0)
    assert await one.kind() == "stalled"
    await one.change_emulator(blocked=False)
    assert await remedied(one) == "clear the flag"
    condition = (await one.told())["condition"]
    assert condition["kind"] == "stalled"  # REFERENCE_CONF.drv_after_stall is 0
    assert await remedied(one) == "write REFERENCE_CONF.drv_after_stall 1"
    assert await one.kind() == "moving"
    await one.post("axes/0/stop")


@pytest.mark.parametrize("model", SIX_POINT)
async def test_a_driver_that_its_pin_switches_off_cannot_move(
    app: FastAPI, client: httpx.AsyncClient, clock: VirtualClock, model: str
) -> None:
    one = await rig(app, client, clock, model)
    for level, kind in ((True, "cannot_move"), (False, "ready")):
        answer = await client.patch(f"{one.url}/emulator", json={"pins": {"drv_enn": level}})
        assert answer.status_code == 200, answer.text
        await clock.advance(TOLD_S)
        assert await one.kind() == kind
        assert ("DRV_ENN" in (await one.told())["condition"]["cause"]) is level


async def test_a_module_whose_motor_gets_no_current_cannot_move(
    app: FastAPI, client: httpx.AsyncClient, clock: VirtualClock
) -> None:
    one = await rig(app, client, clock, "pd42-1241")
    await one.device.registers.write("maximum_current", 0, 0)
    await clock.advance(TOLD_S)
    condition = (await one.told())["condition"]
    assert condition["kind"] == "cannot_move"
    assert "maximum_current is 0" in condition["cause"]
    other = condition["remedies"][1]
    done = await client.request(other["method"], other["path"].removeprefix("/api/v1/"), json=other["body"])
    assert done.status_code == 200, done.text
    await clock.advance(TOLD_S)
    assert await one.kind() == "ready"


async def test_the_thresholds_are_settings_of_the_axis(
    app: FastAPI, client: httpx.AsyncClient, clock: VirtualClock
) -> None:
    one = await rig(app, client, clock, "tmc5160")
    axis = {"lost_steps_microsteps": 200_000, "following_error_microsteps": 300_000}
    answer = await client.patch(one.url, json={"axes": [axis]})
    assert answer.status_code == 200, answer.text
    assert answer.json()["axes"][0]["lost_steps_microsteps"] == 200_000
    await one.change_emulator(blocked=True)
    await one.post("axes/0/move", {"target": 86_496})
    assert "following_error" not in await one.at_rest()
    await clock.advance(TOLD_S)
    assert await one.kind() == "on_target"


async def test_a_soft_limit_that_stops_it_holds_it(
    app: FastAPI, client: httpx.AsyncClient, clock: VirtualClock
) -> None:
    one = await rig(app, client, clock, "tmc5160")
    await client.patch(one.url, json={"axes": [{"limits": {"position_max": 60_000}}]})
    await one.post("axes/0/rotate", {"velocity": 40_000})
    await one.at_rest()
    await clock.advance(TOLD_S)
    condition = (await one.told())["condition"]
    assert condition["kind"] == "held"
    assert "soft limit" in condition["cause"]
    assert "smaller positions" in condition["cause"]


async def test_referenced_is_what_somebody_here_has_seen(
    app: FastAPI, client: httpx.AsyncClient, clock: VirtualClock
) -> None:
    one = await rig(app, client, clock, "tmc5160")
    assert (await one.told())["referenced"] is False  # its power-on was seen
    await one.post("axes/0/position-from-encoder")
    await clock.advance(TOLD_S)
    assert (await one.told())["referenced"] is True
    await one.change_emulator(power_cycle=True)
    await clock.advance(TOLD_S)
    assert (await one.told())["referenced"] is False
