"""Errors at the edge: ONE table from what the program raises to application/problem+json (RFC 9457).

Status codes live here and nowhere else. `type` is stable and made for code, `detail` for people, and
`facts` carries the attributes of the error (limits, known names, raw words), so that nobody parses text.
"""

from __future__ import annotations

import http
import logging
import math
from collections.abc import Mapping, Sequence

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from pydantic import ValidationError
from starlette.exceptions import HTTPException

from ...devices.core.signs import start_up
from ...errors import (
    BadReply,
    BenchError,
    CannotMove,
    DownloadMode,
    LinkDown,
    LinkError,
    LinkTimeout,
    OtherModel,
    OutOfRange,
    SoftLimit,
    StoreUnavailable,
    UnknownParameter,
    UnknownThing,
    UnreadableModel,
    UsageError,
    WriteRefused,
    WrongState,
)
from ...lease.errors import BenchNotTaken, BenchTaken
from ...procedures.start_together import NotReady
from ...profiles.errors import ProfileLeft, ProfileMisfit, ProfileTakenBack, UnreadableProfile
from ...profiles.scripts.errors import ScriptFailed
from ...registers.maps.findings import UnreadableMap
from ...store.layouts import LayoutChanged
from ...store.macros import MacroChanged
from ...store.revisions import RevisionChanged
from ...twin.process import TwinFailed
from ..conditions.views import condition_out, remedy_out
from ..schemas import AxisProblem, Condition, Problem, Remedy
from .errors import ForeignPage, RoleTooLow, UnencodableWave
from .problem_document import (
    FOREIGN,
    INTERNAL,
    INVALID,
    MEDIA_TYPE,
    TOO_LARGE,
    UNDECODABLE,
    Kind,
    answer,
    document_of,
    problem_answer,
)

log = logging.getLogger("stepscope.api")


KINDS: dict[type[Exception], Kind] = {
    UnknownThing: Kind(404, "/problems/unknown-thing", "There is no such thing"),
    WriteRefused: Kind(409, "/problems/write-refused", "The chip did not take the write"),
    ScriptFailed: Kind(409, "/problems/script-failed", "The script did not pass its trial"),
    BenchTaken: Kind(409, "/problems/bench-taken", "Another session has the bench"),
    BenchNotTaken: Kind(409, "/problems/bench-not-taken", "This session has not taken the bench"),
    DownloadMode: Kind(409, "/problems/download-mode", "Download mode: polling paused"),
    OtherModel: Kind(409, "/problems/other-model", "This is another model"),
    UnknownParameter: Kind(409, "/problems/unknown-parameter", "This module has no such parameter"),
    ForeignPage: FOREIGN,
    RoleTooLow: Kind(403, "/problems/role-too-low", "This token may not do that"),
    LayoutChanged: Kind(409, "/problems/layout-changed", "The layout was saved by somebody else meanwhile"),
    MacroChanged: Kind(409, "/problems/macro-changed", "The macro was saved by somebody else meanwhile"),
    RevisionChanged: Kind(409, "/problems/wrong-state", "Not possible now"),
    WrongState: Kind(409, "/problems/wrong-state", "Not possible now"),
    CannotMove: Kind(409, "/problems/wrong-state", "Not possible now"),  # with the remedy beside it
    NotReady: Kind(409, "/problems/wrong-state", "Not possible now"),  # of a start together that a stop has ended
    LinkDown: Kind(
        409,
        "/problems/not-connected",
        "The device is not connected",
        "check its power and cable, then connect it again",
    ),
    OutOfRange: Kind(422, "/problems/out-of-range", "A value is out of range"),
    SoftLimit: Kind(422, "/problems/soft-limit", "Beyond a soft limit of the axis"),
    UnencodableWave: Kind(422, "/problems/unencodable-wave", "The chip's table cannot hold this wave"),
    UnreadableModel: Kind(422, "/problems/unreadable-model", "This model cannot be read from its package"),
    UnreadableMap: Kind(422, "/problems/unreadable-map", "This is no register map, or says what cannot be"),
    UsageError: Kind(422, "/problems/unusable-request", "The request asks for what cannot be"),
    BadReply: Kind(502, "/problems/bad-reply", "The device answered wrongly", "check the wiring, then ask again"),
    LinkError: Kind(502, "/problems/link-failed", "The link to the device failed"),
    UnreadableProfile: Kind(422, "/problems/unreadable-profile", "This is no profile, or says what cannot be"),
    ProfileMisfit: Kind(409, "/problems/profile-misfit", "This profile does not fit the device"),
    ProfileTakenBack: Kind(409, "/problems/profile-taken-back", "Not applied: all is as it was before"),
    ProfileLeft: Kind(502, "/problems/profile-left", "Not applied, and not all is as it was before"),
    StoreUnavailable: Kind(503, "/problems/store-unavailable", "Nothing can be kept or looked up now"),
    LinkTimeout: Kind(
        504, "/problems/no-reply", "The device did not answer", "read before you write again: it may have happened"
    ),
    TwinFailed: Kind(503, "/problems/twin-failed", "The 3D view cannot be shown"),
    BenchError: Kind(500, "/problems/internal", "stepscope failed"),
}
"""Every class of the BenchError tree; a test walks the tree for one that is missing."""


def kind_of(error: type[BaseException]) -> Kind:
    """The nearest entry of `KINDS` on the way up from `error`."""
    for ancestor in error.__mro__:
        if issubclass(ancestor, Exception) and ancestor in KINDS:
            return KINDS[ancestor]
    return INTERNAL


def problem_of(error: Exception, instance: str | None = None) -> Problem:
    """An error as the document that a client gets; also inside of other answers (batches, stop reports)."""
    kind = kind_of(type(error))
    facts = {key: _plain(value) for key, value in vars(error).items() if key != "way_out"}
    way_out = getattr(error, "way_out", "") or kind.way_out
    return Problem.model_validate(document_of(kind, str(error) or kind.title, instance, facts, way_out))


def _plain(value: object) -> object:
    """A fact as JSON can bear it: no NaN, no bytes, no surprises."""
    if isinstance(value, bool | str) or value is None:
        return value
    if isinstance(value, int):
        return value if abs(value) < 1 << 63 else str(value)[:40]
    if isinstance(value, float):
        return value if math.isfinite(value) else str(value)
    if isinstance(value, bytes):
        return value.hex(" ")
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, Sequence | set | frozenset):
        return [_plain(item) for item in value]
    return str(value)


def findings(error: ValidationError) -> str:
    """What pydantic found, in one line."""
    return "; ".join(
        f"{'.'.join(str(part) for part in finding['loc']) or 'body'}: {finding['msg']}" for finding in error.errors()
    )


# --- handlers -----------------------------------------------------------------------------------


def error_answer(
    error: BenchError, instance: str | None, condition: Condition | None = None, remedies: Sequence[Remedy] = ()
) -> JSONResponse:
    """An error of the tree as a response; `condition` is that of the axis which it is about, `remedies` what helps."""
    problem = problem_of(error, instance).model_copy(update={"remedies": list(remedies)})
    told = problem if condition is None else AxisProblem(**problem.model_dump(), condition=condition)
    return answer(told.model_dump(), told.status)


async def _bench_error(request: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, BenchError)
    return error_answer(error, request.url.path, _condition(request, error), _remedies(request, error))


def _remedies(request: Request, error: BenchError) -> list[Remedy]:
    """Calls that put the error right."""
    if not isinstance(error, CannotMove) or "device" not in request.path_params:
        return []
    device = request.app.state.bench.manager.get(request.path_params["device"])
    return [remedy_out(device, start_up(error.axis))]


def _condition(request: Request, error: BenchError) -> Condition | None:
    """That of the axis which the request is about, where its link or its state kept it from being done."""
    if not isinstance(error, LinkError | WrongState):
        return None
    names = request.path_params
    if "device" not in names or "axis" not in names:  # the control port of an emulator has neither
        return None
    bench = request.app.state.bench
    try:
        device = bench.manager.get(names["device"])
        axis = device.axis(int(names["axis"]))
    except (ValueError, UnknownThing):
        return None
    return condition_out(device, bench.conditions.standing(device, axis.index).condition)


LIMITS = {
    "ge": "minimum",
    "gt": "above",
    "le": "maximum",
    "lt": "below",
    "min_length": "minimum_length",
    "max_length": "maximum_length",
    "expected": "expected",
}
"""Pydantic's names of limits, and ours."""


async def _invalid(request: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, RequestValidationError)
    findings = error.errors()
    if any(finding["type"] == "json_invalid" for finding in findings):
        where = findings[0]["loc"][-1]
        reason = findings[0].get("ctx", {}).get("error", "no JSON")
        return problem_answer(UNDECODABLE, f"no JSON at character {where}: {reason}", request.url.path)
    details, errors = [], []
    for finding in findings[:20]:
        path = ".".join(str(part) for part in finding["loc"])
        details.append(f"{path}: {finding['msg']}")
        limits = {LIMITS[key]: _plain(value) for key, value in finding.get("ctx", {}).items() if key in LIMITS}
        errors.append({"where": path, "message": finding["msg"], "rule": finding["type"], **limits})
    return problem_answer(INVALID, "; ".join(details), request.url.path, {"errors": errors})


HTTP_KINDS = {
    400: UNDECODABLE,
    404: Kind(
        404, "/problems/no-such-path", "There is nothing at this address", "GET /openapi.json lists what there is"
    ),
    405: Kind(405, "/problems/method-not-allowed", "This address does not take that method"),
    413: TOO_LARGE,
}


async def _http_error(request: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, HTTPException)
    fallback = Kind(error.status_code, f"/problems/http-{error.status_code}", http.HTTPStatus(error.status_code).phrase)
    kind = HTTP_KINDS.get(error.status_code, fallback)
    phrase = http.HTTPStatus(error.status_code).phrase
    detail = f"{request.method} {request.url.path}: {error.detail or phrase}"
    headers = dict(error.headers or {})
    if error.status_code == 405:
        # The framework names the methods of one of the routes at this path; all of them is right.
        methods = request.app.state.allowed_methods(request.url.path)
        headers["Allow"] = ", ".join(methods) or headers.get("Allow", "GET")
    return answer(document_of(kind, detail, request.url.path, {}, kind.way_out), kind.status, headers)


async def _crash(request: Request, error: Exception) -> JSONResponse:
    log.error("%s %s failed", request.method, request.url.path, exc_info=error)
    return problem_answer(INTERNAL, f"{type(error).__name__} while answering", request.url.path)


def install(app: FastAPI) -> None:
    """Let every error of `app` leave as a problem."""
    app.add_exception_handler(BenchError, _bench_error)
    app.add_exception_handler(RequestValidationError, _invalid)
    app.add_exception_handler(HTTPException, _http_error)
    app.add_exception_handler(Exception, _crash)


# --- the schema ---------------------------------------------------------------------------------

Responses = dict[int | str, dict[str, object]]

DEVICE_PROBLEMS: tuple[type[BenchError], ...] = (UnknownThing, WrongState, OutOfRange, BadReply, LinkTimeout)
"""What any call that talks to a chip may end in."""


def problems(*errors: type[BenchError] | Kind, shape: type[Problem] = Problem) -> Responses:
    """`responses` of a route: these errors, under their status codes, as problem documents of that `shape`."""
    answers: Responses = {}
    for error in errors:
        kind = error if isinstance(error, Kind) else kind_of(error)
        known = answers.setdefault(kind.status, _documented(shape))
        known["description"] = "; ".join(filter(None, (str(known["description"]), f"{kind.title} ({kind.type})")))
    return answers


def _documented(shape: type[Problem]) -> dict[str, object]:
    return {"description": "", "content": {MEDIA_TYPE: {"schema": {"$ref": f"#/components/schemas/{shape.__name__}"}}}}
