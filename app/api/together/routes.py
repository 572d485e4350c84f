"""Several devices as one machine: wires between emulated ones, and moves that start together."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated

from fastapi import Path

from ...devices.core.results import AxisMove
from ...emulators.core.pins import NET_PATTERN
from ...errors import SoftLimit, UnknownThing, UsageError
from ...procedures.start_together import StartNet, TogetherMove
from ...procedures.straight_line import LineAxis, plan_line
from ..audit import wording
from ..deps import CurrentBench
from ..http.problems import DEVICE_PROBLEMS, problems
from ..policy import policy
from ..router import subject_router
from ..server_state import ServerState
from .schemas import (
    AxisPath,
    LegPath,
    LinePath,
    LinePlan,
    LineState,
    Net,
    NetPins,
    StartedTogether,
    StartTogether,
    StraightLine,
    WirablePin,
    Wiring,
)

router = subject_router(tags=["together"])

NetId = Annotated[str, Path(pattern=NET_PATTERN, description="small letters, digits and dashes")]

REAL_EDGE_S = 1e-4
"""How far apart real chips see an edge of START at the most: each by its own clock, behind its input filter, which
holds it for 1024 clocks at the longest (INPUT_FILT_CONF)."""


@router.get("/wiring")
async def get_wiring(bench: CurrentBench) -> Wiring:
    """Which pins of emulated devices can be wired, which are wired together, and whether that works."""
    wiring = bench.wiring
    return Wiring(
        nets=[Net.model_validate(net) for net in wiring.nets],
        pins=[WirablePin.model_validate(pin) for pin in wiring.pins],
    )


@router.put("/wiring/{net}", responses=problems(UnknownThing, UsageError))
@policy(words=wording.named("wire pins"))
async def wire_pins(bench: CurrentBench, net: NetId, body: NetPins) -> Wiring:
    """Have exactly these pins of emulated devices on a net. The devices go on, and their links tell of it."""
    return await _assigned(bench, net, [(pin.device, pin.pin) for pin in body.pins])


@router.delete("/wiring/{net}", responses=problems(UnknownThing))
@policy(words=wording.named("remove wires"))
async def unwire_pins(bench: CurrentBench, net: NetId) -> Wiring:
    """Take all pins off a net."""
    return await _assigned(bench, net, [])


async def _assigned(bench: ServerState, net: str, pins: Sequence[tuple[str, str]]) -> Wiring:
    for device, wires in bench.wiring.assign(net, pins).items():
        bench.manager.describe_link(device, "wires", [wire.model_dump() for wire in wires])
    return await get_wiring(bench)


@router.post("/start-together", responses=problems(*DEVICE_PROBLEMS, SoftLimit, UsageError))
@policy(words=wording.start_together)
async def start_together(bench: CurrentBench, body: StartTogether) -> StartedTogether:
    """Start moves of axes of any devices together. All are judged before anything starts; answers when they have
    started, with how far apart. Where one does not start, all are stopped."""
    moves = [
        TogetherMove(bench.manager.get(one.device), AxisMove(one.axis, one.target, one.relative, one.unit))
        for one in body.moves
    ]
    nets = _start_nets(bench)
    nets += [StartNet(devices, REAL_EDGE_S) for devices in body.start_wires]
    started = await bench.procedures.start_together(moves, nets, use_wires=body.use_wires)
    return StartedTogether.model_validate(started)


def _start_nets(bench: ServerState) -> list[StartNet]:
    return [
        StartNet([pin.key for pin in net.pins], net.seen_within_s)
        for net in bench.wiring.nets
        if net.open is None and net.pins[0].role == "level"
    ]


def _line_axes(bench: ServerState, body: StraightLine) -> list[LineAxis]:
    return [LineAxis(bench.manager.get(one.device), one.axis) for one in body.axes]


@router.post("/straight-line/plan", responses=problems(*DEVICE_PROBLEMS, SoftLimit, UsageError))
@policy(lease="free", role="look", audit="silent")
async def plan_straight_line(bench: CurrentBench, body: StraightLine) -> LinePlan:
    """Plan a straight line of several axes: speeds, path and how far that leaves the line. Nothing is written."""
    plan, _ = await plan_line(_line_axes(bench, body), body.points, body.pace, body.duration_s)
    return LinePlan.model_validate(plan)


@router.get("/straight-line")
async def get_straight_line(bench: CurrentBench) -> LineState:
    """How the present line goes, or how the latest one went."""
    return LineState.model_validate(bench.procedures.line_state)


@router.get("/straight-line/path")
async def get_line_path(bench: CurrentBench) -> LinePath:
    """Where the axes of the present line were seen, or of the latest one, beside its plan: each sample has its time."""
    path = bench.procedures.line_path
    if path is None:
        return LinePath(plan=None, legs=[])
    legs = [LegPath(axes=[AxisPath.model_validate(axis) for axis in leg]) for leg in path.legs]
    return LinePath(plan=LinePlan.model_validate(path.plan), legs=legs)


@router.post("/straight-line", responses=problems(*DEVICE_PROBLEMS, SoftLimit, UsageError))
async def start_straight_line(bench: CurrentBench, body: StraightLine) -> LineState:
    """Go on straight lines, through all points, with ramps that are given back at the end. Planned and judged first;
    answers when it has begun."""
    state = await bench.procedures.start_line(
        _line_axes(bench, body), body.points, _start_nets(bench), body.pace, body.duration_s
    )
    return LineState.model_validate(state)


@router.delete("/straight-line")
@policy(stops=True)
async def stop_straight_line(bench: CurrentBench) -> LineState:
    """End it and stop its motors."""
    return LineState.model_validate(await bench.procedures.stop_line())
