"""Several devices as one machine: wires between emulated ones, and moves that start together."""

from __future__ import annotations

from fastapi import APIRouter

from ...devices.core.results import AxisMove
from ...errors import SoftLimit, UsageError
from ...procedures.start_together import StartNet, TogetherMove
from ..audit import wording
from ..deps import CurrentBench
from ..http.problems import DEVICE_PROBLEMS, problems
from ..policy import policy
from .schemas import Net, StartedTogether, StartTogether, Wiring

router = APIRouter(tags=["together"])

REAL_EDGE_S = 1e-4
"""How far apart real chips see an edge of START at the most: each by its own clock, behind its input filter, which
holds it for 1024 clocks at the longest (INPUT_FILT_CONF)."""


@router.get("/wiring")
async def get_wiring(bench: CurrentBench) -> Wiring:
    """Which pins of emulated devices are wired together, and whether that works. It is set with their links."""
    return Wiring(nets=[Net.model_validate(net) for net in bench.wiring.nets])


@router.post("/start-together", responses=problems(*DEVICE_PROBLEMS, SoftLimit, UsageError))
@policy(words=wording.start_together)
async def start_together(bench: CurrentBench, body: StartTogether) -> StartedTogether:
    """Start moves of axes of any devices together. All are judged before anything starts; answers when they have
    started, with how far apart. Where one does not start, all are stopped."""
    moves = [
        TogetherMove(bench.manager.get(one.device), AxisMove(one.axis, one.target, one.relative, one.unit))
        for one in body.moves
    ]
    nets = [
        StartNet([pin.key for pin in net.pins], net.seen_within_s)
        for net in bench.wiring.nets
        if net.open is None and net.pins[0].role == "level"
    ]
    nets += [StartNet(devices, REAL_EDGE_S) for devices in body.start_wires]
    started = await bench.procedures.start_together(moves, nets, use_wires=body.use_wires)
    return StartedTogether.model_validate(started)
