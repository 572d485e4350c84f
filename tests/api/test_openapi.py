"""The schema: complete, readable, and the one that the page's types were made from."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from app.main import create_app
from app.settings import Settings

COMMITTED = Path(__file__).parents[2] / "web" / "src" / "api" / "openapi.json"


@pytest.fixture(scope="module")
def schema() -> dict[str, Any]:
    return create_app(Settings()).openapi()


def operations(schema: dict[str, Any]) -> list[tuple[str, dict[str, Any]]]:
    return [(f"{method} {path}", op) for path, ops in schema["paths"].items() for method, op in ops.items()]


def test_the_committed_schema_is_this_one(schema: dict[str, Any]) -> None:
    assert json.loads(COMMITTED.read_text()) == json.loads(json.dumps(schema)), (
        "web/src/api/openapi.json is stale: run `make types` and commit it"
    )


def test_operation_ids_are_the_functions_names_and_unique(schema: dict[str, Any]) -> None:
    names = [operation["operationId"] for _, operation in operations(schema)]
    assert len(names) == len(set(names))
    assert {"list_devices", "stop_everything", "calculate_ramp"} <= set(names)


def test_every_operation_says_what_it_does_and_how_it_fails(schema: dict[str, Any]) -> None:
    for where, operation in operations(schema):
        assert operation["description"], where
        errors = {status: answer for status, answer in operation["responses"].items() if status >= "400"}
        assert "403" in errors, where
        if "requestBody" in operation:
            assert {"400", "413", "422"} <= errors.keys(), where
        if operation.get("parameters"):
            assert "422" in errors, where
        for status, answer in errors.items():
            assert list(answer["content"]) == ["application/problem+json"], (where, status)
            assert answer["description"], (where, status)
            shape = answer["content"]["application/problem+json"]["schema"]["$ref"].rpartition("/")[2]
            assert shape in ("Problem", "AxisProblem")


def test_every_reference_leads_somewhere_and_nothing_is_left_of_the_frameworks_errors(schema: dict[str, Any]) -> None:
    text = json.dumps(schema)
    known = schema["components"]["schemas"]
    for part in text.split('"#/components/schemas/')[1:]:
        assert part.partition('"')[0] in known
    assert "HTTPValidationError" not in text


def test_models_are_named_by_what_they_are_and_not_by_where_they_lie(schema: dict[str, Any]) -> None:
    names = schema["components"]["schemas"]
    assert {"TmclSwitchesState", "Tmc4361SwitchesState", "Tmc5xxxSwitchesState"} <= set(names)
    assert not [name for name in names if "__" in name]


def test_the_sockets_messages_are_in_it(schema: dict[str, Any]) -> None:
    known = schema["components"]["schemas"]
    union = known["TelemetryMessage"]["oneOf"]
    names = {part["$ref"].rpartition("/")[2] for part in union}
    kinds = ("Start", "Status", "Gap", "Move", "Stopped", "Event", "Program", "Problem")
    assert names == {f"Telemetry{kind}" for kind in kinds}
    assert all("type" in known[name]["required"] for name in names)


def test_every_option_of_an_emulator_is_explained(schema: dict[str, Any]) -> None:
    options = schema["components"]["schemas"]["EmulatorLink"]["properties"]
    assert all(option.get("description") for name, option in options.items() if name != "kind")
