"""Where the routes of a subject are put together."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any

from fastapi import APIRouter
from fastapi.routing import APIRoute
from pydantic.warnings import UnsupportedFieldAttributeWarning
from starlette.routing import compile_path, get_name

# FastAPI silences it where it makes its fields; those of deferred models pydantic makes later.
warnings.filterwarnings("ignore", category=UnsupportedFieldAttributeWarning)

BASE = "/api/v1"


class DeferredRoute(APIRoute):
    """FastAPI's route, whose parameters, body and answers are worked out at its first call, or for the schema.

    That takes 2 ms each, of which a start would make 0.4 s; the page's first calls are twenty.
    """

    def __init__(self, path: str, endpoint: Callable[..., Any], *, methods: list[str] | None = None, **options: Any):
        """Only what addresses are matched by, and methods told by."""
        self.path, self.endpoint, self.name = path, endpoint, options.get("name") or get_name(endpoint)
        self.methods = {method.upper() for method in methods or ["GET"]}
        self.path_regex, self.path_format, self.param_convertors = compile_path(path)
        self.include_in_schema = options.get("include_in_schema", True)
        self._options = {**options, "methods": methods}

    def work_out(self) -> None:
        """Do it now; again changes nothing."""
        APIRoute.__init__(self, self.path, self.endpoint, **self._options)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__") or "app" in vars(self):  # `app` is what FastAPI makes last
            raise AttributeError(name)
        self.work_out()
        return getattr(self, name)


def operation_id(route: APIRoute) -> str:
    """The function's name: what generated clients call the call."""
    return route.name


def subject_router(
    prefix: str = "", *, tags: list[str], responses: dict[int | str, dict[str, Any]] | None = None
) -> APIRouter:
    """A router whose routes stand below `BASE`, and `prefix` there.

    They are whole as they are declared: those of a router that is included in another one FastAPI works out twice.
    """
    return APIRouter(
        prefix=BASE + prefix,
        tags=[*tags],
        responses=responses,
        generate_unique_id_function=operation_id,
        route_class=DeferredRoute,
    )


def work_out(router: APIRouter) -> None:
    """Work out its routes now: for calls that may not take longer the first time."""
    for route in router.routes:
        if isinstance(route, DeferredRoute):
            route.work_out()
