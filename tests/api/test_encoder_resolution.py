"""An encoder whose resolution is set wrong is called so, and no step lost; the remedy sets the right one."""

from __future__ import annotations

import httpx
import pytest
from fastapi import FastAPI

from app.clock import VirtualClock
from tests.api.test_conditions_found import SIX_POINT, TOLD_S, Rig, remedied, rig

FAR = 102_400
"""Two turns."""


async def set_resolution(one: Rig, counts: int) -> None:
    """Set the encoder to `counts` a turn, which has 40,000 (the external one of a module 4,000)."""
    write = one.device.registers.write
    if one.device.model in SIX_POINT:
        await write("ENCMODE", 0, fields={"enc_sel_decimal": 1})
        await write("ENC_CONST", 0, (51_200 // counts << 16) + round(51_200 % counts / counts * 10_000))
    elif one.device.model == "tmc4361":
        await write("ENC_IN_RES", 0, counts)
    else:
        await write("external_encoder_resolution", 0, counts // 10)
    await one.clock.advance(TOLD_S)


async def go(one: Rig, target: int) -> set[tuple[str, str]]:
    """Go there; every kind and cause that was told on the way and after it."""
    await one.post("axes/0/move", {"target": target})
    told = set()
    for _ in range(100):
        await one.clock.advance(0.1)
        condition = (await one.told())["condition"]
        told.add((condition["kind"], condition["cause"]))
        if not (await one.client.get(f"{one.url}/axes/0")).json()["moving"]:
            await one.clock.advance(TOLD_S)
            condition = (await one.told())["condition"]
            return told | {(condition["kind"], condition["cause"])}
    raise AssertionError("it does not arrive")


@pytest.mark.parametrize(("counts", "much"), [(20_000, "100 % too many"), (50_000, "20 % too few")])
@pytest.mark.parametrize("model", ["tmc4361", "tmc5072", "tmc5160", "pd42-1241"])
async def test_a_wrong_resolution_is_called_so_and_its_remedy_sets_it_right(
    app: FastAPI, client: httpx.AsyncClient, clock: VirtualClock, model: str, counts: int, much: str
) -> None:
    one = await rig(app, client, clock, model)
    await set_resolution(one, counts)
    for target in (FAR, 0, FAR, 0, FAR):
        told = await go(one, target)
    condition = (await one.told())["condition"]
    assert condition["kind"] == "lost_steps", told
    assert f"the encoder counts {much}" in condition["cause"]
    assert "steps are not lost" in condition["cause"]
    evidence = {piece["what"]: piece["value"] for piece in condition["evidence"]}
    assert float(evidence["deviation over position"].split(",")[0]) == pytest.approx(40_000 / counts - 1, abs=0.01)
    right = 4_000 if model == "pd42-1241" else 40_000
    assert f"{right:,} counts" in condition["remedy"]["label"]
    await remedied(one)
    assert await one.kind() == "on_target"
    for target in (0, FAR, -FAR, 0, FAR):
        assert {kind for kind, _ in await go(one, target)} <= {"moving", "on_target", "ready"}
        assert await one.kind() == "on_target"


@pytest.mark.parametrize("model", ["tmc4361", "tmc5160", "pd42-1241"])
async def test_a_shaft_that_is_blocked_on_a_part_of_each_way_is_never_a_wrong_resolution(
    app: FastAPI, client: httpx.AsyncClient, clock: VirtualClock, model: str
) -> None:
    one = await rig(app, client, clock, model)
    causes = set()
    for target in (FAR, 0, FAR, 0, FAR):
        await one.post("axes/0/move", {"target": target})
        for step in range(40):
            if step in (10, 20):
                await one.change_emulator(blocked=step == 10)
            await clock.advance(0.1)
            condition = (await one.told())["condition"]
            causes.add((condition["kind"], condition["cause"]))
    assert {kind for kind, _ in causes} & {"lost_steps", "following_error"}
    assert not [cause for _, cause in causes if "looks wrong" in cause]


@pytest.mark.parametrize("model", ["tmc4361", "tmc5160"])
async def test_an_encoder_that_counts_the_other_way_is_turned_round(
    app: FastAPI, client: httpx.AsyncClient, clock: VirtualClock, model: str
) -> None:
    one = await rig(app, client, clock, model)
    if model == "tmc4361":
        await one.device.registers.write("ENC_IN_CONF", 0, fields={"invert_enc_dir": 1})
    else:
        await one.device.registers.write("ENC_CONST", 0, -round(1.28 * 65536))
        await one.device.registers.write("ENCMODE", 0, fields={"enc_sel_decimal": 0})
    for target in (FAR, 0, FAR):
        await go(one, target)
    condition = (await one.told())["condition"]
    assert condition["cause"] == "the encoder counts the other way: its direction looks wrong, steps are not lost"
    await remedied(one)
    for target in (0, FAR):
        await go(one, target)
        assert await one.kind() == "on_target"


async def test_a_built_in_encoder_that_is_off_has_the_full_steps_of_the_motor_set_right(
    app: FastAPI, client: httpx.AsyncClient, clock: VirtualClock
) -> None:
    one = await rig(app, client, clock, "pd42-1241")
    await one.device.registers.write("motor_fullstep_resolution", 0, 400)
    for target in (FAR, 0, FAR):
        await go(one, target)
    assert "counts 100 % too many" in (await one.told())["condition"]["cause"]
    assert await remedied(one) == "set the motor to 200 full steps a turn"
    for target in (0, FAR):
        await go(one, target)
        assert await one.kind() == "on_target"


async def test_places_of_before_a_counter_was_written_or_the_power_was_off_count_no_more(
    app: FastAPI, client: httpx.AsyncClient, clock: VirtualClock
) -> None:
    one = await rig(app, client, clock, "tmc5160")
    await set_resolution(one, 20_000)
    for target in (FAR, 0, FAR):
        await go(one, target)
    assert "looks wrong" in (await one.told())["condition"]["cause"]
    await one.device.registers.write("X_ENC", 0, 0)
    await clock.advance(TOLD_S)
    assert "steps are lost" in (await one.told())["condition"]["cause"]
    for target in (0, FAR, 0):
        await go(one, target)
    assert "looks wrong" in (await one.told())["condition"]["cause"]
    await one.post("axes/0/position-from-encoder")
    await clock.advance(TOLD_S)
    assert await one.kind() == "ready"
    await one.device.registers.write("X_ENC", 0, 90_000)
    await clock.advance(TOLD_S)
    assert "steps are lost" in (await one.told())["condition"]["cause"]
