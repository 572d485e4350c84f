"""The schema that clients are generated from: every error documented, the socket's messages with it."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from typing import Any, cast

from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi
from fastapi.routing import iter_route_contexts

from ... import __version__
from ...lease.errors import BenchNotTaken, BenchTaken
from ..conditions.schemas import ConditionsMessage, ConditionsPage
from ..programs.schemas import ProgramMessage, ProgramWatched
from ..schemas import AxisProblem, Problem
from ..telemetry.schemas import TelemetryMessage
from .errors import RoleTooLow
from .policies import Policies
from .problem_document import FOREIGN, INVALID, TOO_LARGE, UNDECODABLE, Kind
from .problems import kind_of, problems

REF = "#/components/schemas/{model}"


def customise(app: FastAPI, policies: Policies) -> None:
    """Let `app` describe itself as this module says; calls may be refused for want of the lease or of the role as
    `policies` have it.
    """
    made: list[dict[str, Any]] = []

    def schema() -> dict[str, Any]:
        if not made:
            made.append(_named(_schema(app, policies)))
        return made[0]

    app.openapi = schema  # type: ignore[method-assign]  # how FastAPI wants it to be replaced


def _schema(app: FastAPI, policies: Policies) -> dict[str, Any]:
    schema = get_openapi(
        title="stepscope",
        version=__version__,
        summary="Configure, tune and watch stepper motion controllers",
        description=(
            "Errors are RFC 9457 problem documents with a stable `type`. Telemetry is a WebSocket at "
            "`/api/v1/devices/{device}/telemetry`; its text messages are the schema `TelemetryMessage`, its binary "
            "frames little-endian: `SSC1`, u32 sequence, u32 rows, u32 columns, u64 rows dropped, then float64 time "
            "in seconds for each row, then float64 for each row, column after column. `/api/v1/conditions` is a "
            "WebSocket too: the condition of every axis, then each change (`ConditionsMessage`); a page may say which "
            "session it has open (`ConditionsPage`). `/api/v1/devices/{device}/program/watch` is one that tells what "
            "the device's program does (`ProgramMessage`); a client may say which variables it wants "
            "(`ProgramWatched`). A server on a network asks for a token (`Authorization: Bearer`): "
            "its own, or a named one with a role. `x-required-role` is the least role of a call: look, drive or "
            "administer; 403 tells where it is higher."
        ),
        routes=app.routes,
    )
    components = schema.setdefault("components", {}).setdefault("schemas", {})
    for model in (
        Problem,
        AxisProblem,
        TelemetryMessage,
        ConditionsMessage,
        ConditionsPage,
        ProgramMessage,
        ProgramWatched,
    ):
        described = model.model_json_schema(ref_template=REF, mode="serialization")
        components.update(described.pop("$defs", {}))
        components[model.__name__] = described
    for name in ("HTTPValidationError", "ValidationError"):
        components.pop(name, None)
    for address, path in schema["paths"].items():
        for method, operation in path.items():
            needed = operation["x-required-role"] = policies.role(method.upper(), address)
            _document_problems(
                operation, takes_lease=not policies.needs_no_lease(method.upper(), address), any_role=needed == "look"
            )
    return schema


_FULL_NAME = re.compile(r"\b[a-z]+__\w+?__(?P<room>[a-z0-9]+)\w*__(?P<model>[A-Z]\w*)\b")
"""Of a model that shares its name with another one: by its module, from the package on."""


def _named(schema: dict[str, Any]) -> dict[str, Any]:
    """The schema with such models called by their room: `TmclStageChange`. Where a module lies is nobody's business."""
    text = json.dumps(schema)
    short = {name[0]: f"{name['room'].capitalize()}{name['model']}" for name in _FULL_NAME.finditer(text)}
    if len({*short.values(), *schema["components"]["schemas"]}) < len(short) + len(schema["components"]["schemas"]):
        raise AssertionError(f"two models of one name: {sorted(short.values())}")
    return cast("dict[str, Any]", json.loads(_FULL_NAME.sub(lambda name: short[name[0]], text)))


def _document_problems(operation: dict[str, Any], *, takes_lease: bool, any_role: bool) -> None:
    """Add the errors that the edge itself gives to those of the route."""
    kinds: list[Kind] = [FOREIGN] if any_role else [FOREIGN, kind_of(RoleTooLow)]
    if takes_lease:
        kinds += [kind_of(BenchTaken), kind_of(BenchNotTaken)]
    if "requestBody" in operation:
        kinds += [UNDECODABLE, TOO_LARGE, INVALID]
    elif operation.get("parameters"):
        kinds.append(INVALID)
    responses = operation["responses"]
    if "HTTPValidationError" in str(responses.get("422")):
        del responses["422"]
    for status, answer in problems(*kinds).items():
        known = responses.setdefault(str(status), answer)
        if known is not answer:
            known["description"] = f"{known['description']}; {answer['description']}"


def allowed_methods(app: FastAPI) -> Callable[[str], list[str]]:
    """A function from a path to the methods of the routes in the schema: for the Allow header of a 405."""
    table: list[tuple[re.Pattern[str], set[str]]] = []

    def methods(path: str) -> list[str]:
        if not table:
            by_template: dict[str, set[str]] = {}
            for context in iter_route_contexts(app.routes):
                if context.path_format and context.methods and context.include_in_schema:
                    by_template.setdefault(context.path_format, set()).update(context.methods)
            # Those with fewer parameters first: /profiles/script is no profile's.
            for template, known in sorted(by_template.items(), key=lambda each: each[0].count("{")):
                pattern = "[^/]+".join(re.escape(part) for part in re.split(r"{[^}]*}", template))
                table.append((re.compile(f"{pattern}\\Z"), known))
        return sorted(next((known for pattern, known in table if pattern.match(path)), ()))

    return methods
