"""Is the server there, and how is it."""

from __future__ import annotations

from fastapi import APIRouter, Response

from ... import __version__
from ..deps import CurrentBench
from ..router import operation_id, subject_router
from ..schemas import Health
from .details import health_of
from .schemas import HealthDetails

router = subject_router(tags=["server"])
metrics = APIRouter(tags=["server"], generate_unique_id_function=operation_id)
"""What stands outside of the API's base, where Prometheus looks."""


@router.get("/health")
async def get_health() -> Health:
    """Whether the server answers, and which version it is. Asks for no token."""
    return Health(version=__version__)


@router.get("/health/details")
async def get_health_details(bench: CurrentBench) -> HealthDetails:
    """How the server is: storage, descriptors, memory, event loop, links and their queues, sockets."""
    return await health_of(bench)


@metrics.get(
    "/metrics",
    response_class=Response,
    responses={
        200: {"description": "Prometheus' text format", "content": {"text/plain": {"schema": {"type": "string"}}}}
    },
)
async def get_metrics(bench: CurrentBench) -> Response:
    """The figures of `/api/v1/health/details` for Prometheus."""
    from .metrics import CONTENT_TYPE, metrics_text  # prometheus_client: where nobody asks, nobody waits for it

    return Response(metrics_text(await health_of(bench)), media_type=CONTENT_TYPE)
