"""The 3D view of one axis: on, off, and where in a recording it is."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

from ...devices.core.config import AxisSettings
from ...errors import UnknownThing, WrongState
from ...store.recordings.opened import thinned
from ...twin.process import TwinFailed
from ...twin.recorded import RecordedAxis
from ...twin.service import UPDATES_PER_S, TwinInfo
from ...twin.shape import CHANNELS, Shape, sine_coil_of
from ..deps import CurrentBench
from ..http.problems import problem_of, problems
from ..policy import policy
from ..recordings.views import zero_of
from ..router import subject_router
from ..server_state import ServerState
from .proxy import VIEW
from .schemas import TwinCursor, TwinLook, TwinShow, TwinState

router = subject_router(prefix="/twin", tags=["twin"])

ROWS_MAX = 4_000_000
"""So many of a recording's rows are kept for the view; of a longer one every second, or every third, and so on."""


@router.get("")
async def read_twin(bench: CurrentBench) -> TwinState:
    """How the 3D view is, and the numbers that it shows now."""
    return _state(bench.twin.info)


@router.post("", responses=problems(UnknownThing, WrongState, TwinFailed))
@policy(lease="free", audit="silent")
async def show_twin(bench: CurrentBench, body: TwinShow) -> TwinState:
    """Show an axis, live; starts the process that draws where it does not run. Everybody sees the same view."""
    await bench.twin.show(bench.manager.get(body.device), body.axis, body.scheme)
    return _state(bench.twin.info)


@router.delete("")
@policy(lease="free", audit="silent")
async def end_twin(bench: CurrentBench) -> TwinState:
    """End the view and the process that draws it."""
    await bench.twin.off()
    return _state(bench.twin.info)


@router.post("/cursor", responses=problems(UnknownThing, WrongState, TwinFailed))
@policy(lease="free", audit="silent")
async def scrub_twin(bench: CurrentBench, body: TwinCursor) -> TwinState:
    """Show a moment of a recording, for which the view is started where it is off; or with null what happens now."""
    if body.recording is None:
        await bench.twin.follow()
        return _state(bench.twin.info)
    recorded = bench.twin.recorded(body.recording)
    if recorded is None or body.time_s > recorded.span_s[1]:  # one that is being written may have grown meanwhile
        asked, known = body.recording, recorded
        recorded = await bench.recordings.readers.do(lambda: _recorded(bench, asked, known))
    await bench.twin.scrub(recorded, body.time_s, body.scheme)
    return _state(bench.twin.info)


def _recorded(bench: ServerState, recording: str, known: RecordedAxis | None) -> RecordedAxis:
    """One axis of a recording: the one that is shown, where it was recorded; `known` where nothing was added to that.

    Raises UnknownThing, WrongState.
    """
    library = bench.recordings.library
    opened = library.open(recording)
    if known is not None and known.rows == opened.rows:
        return known
    head = opened.head
    names = [column.name for column in head.columns]
    recorded = sorted({int(axis) for quantity, _, axis in (name.rpartition(".") for name in names) if axis.isdecimal()})
    if not recorded:
        raise WrongState(f"recording {recording} is of no axis", "record channels like position.0")
    shown = bench.twin.info.shape
    axis = shown.axis if shown is not None and shown.axis in recorded else recorded[0]
    told: dict[str, Any] = dict(head.axes[axis]) if axis < len(head.axes) else {}
    settable = {entry.name for entry in fields(AxisSettings)}
    settings = AxisSettings.of({key: value for key, value in told.get("settings", {}).items() if key in settable})
    microsteps = told.get("microsteps_per_full_step")
    if microsteps is None:  # recordings of before know neither; the device may still be there, as it was
        device = next(
            (each for each in bench.manager.devices if (each.id, each.model) == (head.device, head.model)), None
        )
        if device is not None and axis < len(device.axes):
            settings, microsteps = device.axes[axis].settings, device.axes[axis].microsteps_per_full_step
    shape = Shape(
        device=head.device,
        axis=axis,
        name=settings.name,
        full_steps_per_rev=settings.full_steps_per_rev,
        microsteps=microsteps,
        gear_ratio=settings.gear_ratio,
        travel_mm_per_rev=settings.travel_mm_per_rev,
        sine_coil=sine_coil_of(head.model),
    )
    wanted = [
        index
        for index, name in enumerate(names)
        if name.endswith(f".{axis}") and name.removesuffix(f".{axis}") in CHANNELS
    ]
    rows = opened.rows  # of this moment: it may be growing
    time_s, columns = thinned(opened.pieces(0, rows), wanted, max(1, -(-rows // ROWS_MAX)))
    quantities = (names[index].removesuffix(f".{axis}") for index in wanted)
    zero_s = zero_of(opened, library.marks(recording)) or 0.0
    return RecordedAxis(recording, shape, zero_s, time_s, dict(zip(quantities, columns, strict=True)), rows)


def _state(info: TwinInfo) -> TwinState:
    shape = info.shape
    return TwinState(
        state=info.state,
        device=shape.device if shape else None,
        axis=shape.axis if shape else None,
        name=shape.name if shape else None,
        place_unit=None if shape is None else "mm" if shape.linear else "deg",
        channels=sorted(shape.channels) if shape else [],
        scheme=info.scheme,
        path=f"{VIEW}/" if info.state == "on" else None,
        following=info.following,
        recording=info.recording,
        recording_time_s=info.recording_s,
        updates_per_s=info.updates_per_s,
        updates_per_s_max=UPDATES_PER_S,
        viewers=info.viewers,
        look=None if info.look is None else TwinLook.model_validate(info.look),
        problem=None if info.problem is None else problem_of(info.problem),
    )
