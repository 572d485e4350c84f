"""The input filter over REST: waveforms as the calculator makes them, bounds in clocks and seconds, plain refusals."""

from __future__ import annotations

from typing import Any

import httpx
import pytest

from app.calc.signals.input_filter import EXAMPLES, GROUP_PINS, bounds, filtered, levels_of
from app.registers.tmc4361.table import TMC4361


async def asked(client: httpx.AsyncClient, **body: object) -> dict[str, Any]:
    answer = await client.post("calc/input-filter", json=body)
    assert answer.status_code == 200, answer.text
    result: dict[str, Any] = answer.json()
    return result


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: example.figure)
async def test_a_waveform_comes_back_filtered(client: httpx.AsyncClient, example: Any) -> None:
    levels = levels_of(example.edges, example.clocks)
    answer = await asked(client, sample_rate=example.sample_rate, length=example.length, input=levels.tolist())
    expected = filtered(levels, example.sample_rate, example.length)
    assert answer["input"] == levels.tolist()
    assert answer["output"] == expected.output.tolist()
    assert answer["sample_clocks"] == expected.sample_clocks.tolist()
    assert answer["samples"] == expected.samples.tolist()


async def test_phase_and_the_level_before_count(client: httpx.AsyncClient) -> None:
    answer = await asked(client, sample_rate=2, length=0, input=[1, 1, 1, 1, 1], initial=0, phase=3)
    assert answer["sample_clocks"] == [3]
    assert answer["output"] == [0, 0, 0, 1, 1]


@pytest.mark.sheet("DS-TMC4361", "6.1.2")
async def test_bounds_are_told_in_clocks_and_in_seconds(client: httpx.AsyncClient) -> None:
    answer = await asked(client, clock_hz=8e6, sample_rate=3, length=5, input=[0])
    limits = bounds(3, 5, 8e6)
    told = answer["bounds"]
    for name in ("period", "delay_min", "delay_max", "stopped", "passed"):
        clocks = getattr(limits, f"{name}_clocks")
        assert told[f"{name}_clocks"] == clocks
        assert told[f"{name}_s"] == pytest.approx(clocks / 8e6)


@pytest.mark.sheet("DS-TMC4361", "6.1")
async def test_the_filters_are_listed_with_fields_that_exist(client: httpx.AsyncClient) -> None:
    answer = (await client.get("calc/input-filter")).raise_for_status().json()
    register = TMC4361.get(answer["register_name"], 0)
    assert [(group["suffix"], tuple(group["pins"])) for group in answer["groups"]] == list(GROUP_PINS)
    named = [
        group[part] for group in answer["groups"] for part in ("sample_rate_field", "length_field", "step_input_field")
    ]
    assert sorted(named) == sorted(field.name for field in register.fields)
    assert [example["figure"] for example in answer["examples"]] == [example.figure for example in EXAMPLES]
    assert {example["group"] for example in answer["examples"]} <= {suffix for suffix, _ in GROUP_PINS}


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"sample_rate": 8}, "sample_rate"),
        ({"length": -1}, "length"),
        ({"input": []}, "input"),
        ({"input": [0, 2]}, "input"),
        ({"input": [0] * 32_769}, "input"),
        ({"clock_hz": 33e6}, "clock_hz"),
        ({"sample_rate": 2, "phase": 4}, "phase is 0 to 3 clocks"),
    ],
)
async def test_what_cannot_be_is_refused_by_name(
    client: httpx.AsyncClient, change: dict[str, object], word: str
) -> None:
    answer = await client.post("calc/input-filter", json={"sample_rate": 1, "length": 1, "input": [0], **change})
    assert answer.status_code == 422
    assert word in answer.text
