"""Current scales and PWM outputs over REST: a move with its currents, duties, and plain refusals."""

from __future__ import annotations

from typing import Any

import httpx
import pytest

RAMP = {"vmax": 20_000, "amax": 400_000, "bow1": 8e6}


async def asked(client: httpx.AsyncClient, name: str, **body: object) -> dict[str, Any]:
    answer = await client.post(f"calc/{name}", json=body)
    assert answer.status_code == 200, answer.text
    result: dict[str, Any] = answer.json()
    return result


def ramp(**more: object) -> dict[str, object]:
    return {"model": "s_ramp", "parameters": {**RAMP, **more}, "distance": 4000, "samples": 400}


async def test_a_move_has_boost_drive_hold_and_then_no_current(client: httpx.AsyncClient) -> None:
    scales = {
        "boost": 255, "drive": 127, "hold": 63, "hold_en": True, "drive_en": True, "boost_on_acceleration": True,
        "freewheeling_en": True, "standby_delay": 160_000, "freewheel_delay": 3_200_000, "hold_delay": 16_000,
    }  # fmt: skip
    told = await asked(client, "drive-current", ramp=ramp(), scales=scales, full_scale_rms_a=1.5)
    situations = [stretch["situation"] for stretch in told["stretches"]]
    assert situations == ["boost", "drive", "hold", "freewheeling"]
    assert told["scale_at_first"] == 63
    assert max(told["current_rms_a"]) == pytest.approx(1.5)
    assert told["current_rms_a"][-1] == 0
    assert told["scale"][-1] == -1
    assert told["rest_square"] == 0
    hold = told["stretches"][2]
    assert hold["start_s"] == pytest.approx(told["motion_s"] + 0.01)
    assert (hold["scale_from"], hold["scale_to"]) == (127, 63)
    assert any("holds nothing" in text for text in told["findings"])


async def test_without_a_full_scale_no_amperes_are_told(client: httpx.AsyncClient) -> None:
    told = await asked(client, "drive-current", ramp=ramp(ramp_mode="velocity"), scales={"drive_en": True, "drive": 99})
    assert told["current_rms_a"] is None
    assert set(told["scale"]) == {99}


async def test_a_ramp_of_another_chip_is_refused(client: httpx.AsyncClient) -> None:
    other = {"model": "trapezoid", "parameters": {"vmax": 1, "amax": 1, "dmax": 1}, "distance": 1}
    answer = await client.post("calc/drive-current", json={"ramp": other, "scales": {}})
    assert answer.status_code == 422
    assert '"s_ramp"' in answer.json()["detail"]


async def test_duties_are_told_over_turn_and_speed(client: httpx.AsyncClient) -> None:
    told = await asked(
        client, "pwm-duty", period_clocks=640, amplitude=16_383, full_at_pps=10_000, scales=True, speed_pps=5_000.0
    )
    assert told["frequency_hz"] == 25_000
    assert told["amplitude"][0] == 0.125
    assert told["amplitude"][-1] == 0.5
    assert told["amplitude_there"] == pytest.approx(0.3125)
    assert max(told["duty_a"]) == pytest.approx(0.8125, abs=1 / 640)
    assert told["duty_b"][0] == pytest.approx(0.8125, abs=1 / 640)
    assert told["findings"] == []
    coarse = await asked(client, "pwm-duty", period_clocks=16)
    assert any("17 duties" in text for text in coarse["findings"])
