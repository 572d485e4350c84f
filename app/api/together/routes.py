"""Wires between emulated devices."""

from __future__ import annotations

from fastapi import APIRouter

from ..deps import CurrentBench
from .schemas import Net, Wiring

router = APIRouter(tags=["together"])


@router.get("/wiring")
async def get_wiring(bench: CurrentBench) -> Wiring:
    """Which pins of emulated devices are wired together, and whether that works. It is set with their links."""
    return Wiring(nets=[Net.model_validate(net) for net in bench.wiring.nets])
