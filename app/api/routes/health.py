"""Is the server there."""

from __future__ import annotations

from fastapi import APIRouter

from app import __version__
from app.api.schemas import Health

router = APIRouter(tags=["server"])


@router.get("/health")
async def get_health() -> Health:
    """Whether the server answers, and which version it is."""
    return Health(version=__version__)
