"""A problem as a document (RFC 9457), and those kinds of them that need no error of the program.

Apart from `problems`, which knows every error there is and so imports most of the program: the page is served before
that is there.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from starlette.responses import JSONResponse

MEDIA_TYPE = "application/problem+json"


@dataclass(frozen=True, slots=True)
class Kind:
    """What one class of error is to a client."""

    status: int
    type: str
    title: str
    way_out: str | None = None


FOREIGN = Kind(403, "/problems/foreign-origin", "Refused: this request comes from another web site")
UNDECODABLE = Kind(400, "/problems/undecodable-body", "The body is not JSON", "send JSON with its content type")
INVALID = Kind(422, "/problems/invalid-request", "The request does not fit the contract")
TOO_LARGE = Kind(413, "/problems/body-too-large", "The body is too long")
INTERNAL = Kind(500, "/problems/internal", "stepscope failed", "the server's log says more; please report it")


def document_of(
    kind: Kind, detail: str, instance: str | None, facts: Mapping[str, object], way_out: str | None
) -> dict[str, object]:
    """The members of `schemas.Problem`, in its order."""
    return {
        "type": kind.type,
        "title": kind.title,
        "status": kind.status,
        "detail": detail,
        "instance": instance,
        "way_out": way_out or None,
        "facts": dict(facts),
        "remedies": [],
    }


def answer(document: Mapping[str, object], status: int, headers: Mapping[str, str] | None = None) -> JSONResponse:
    """Such a document as a response."""
    return JSONResponse(document, status, headers=dict(headers or {}), media_type=MEDIA_TYPE)


def problem_answer(
    kind: Kind, detail: str, instance: str | None, facts: Mapping[str, object] | None = None, **headers: str
) -> JSONResponse:
    """A problem as a response, for the few places that answer without an error of the tree."""
    return answer(document_of(kind, detail, instance, facts or {}, kind.way_out), kind.status, headers)
