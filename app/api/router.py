"""Where the routes of a subject are put together."""

from __future__ import annotations

import warnings
from typing import Any

from fastapi import APIRouter
from fastapi.routing import APIRoute
from pydantic.warnings import UnsupportedFieldAttributeWarning

# FastAPI silences it where it makes its fields; those of deferred models pydantic makes later.
warnings.filterwarnings("ignore", category=UnsupportedFieldAttributeWarning)

BASE = "/api/v1"


def operation_id(route: APIRoute) -> str:
    """The function's name: what generated clients call the call."""
    return route.name


def subject_router(
    prefix: str = "", *, tags: list[str], responses: dict[int | str, dict[str, Any]] | None = None
) -> APIRouter:
    """A router whose routes stand below `BASE`, and `prefix` there.

    They are whole as they are declared: those of a router that is included in another one FastAPI works out twice.
    """
    return APIRouter(prefix=BASE + prefix, tags=[*tags], responses=responses, generate_unique_id_function=operation_id)
