"""Studies: what is looked for on an axis, told before it moves, and what came of it."""

from __future__ import annotations

from functools import partial
from typing import Annotated

from fastapi import HTTPException, Path
from fastapi.responses import Response

from ...errors import OutOfRange, SoftLimit, StoreUnavailable, UnknownThing, UsageError, WrongState
from ...profiles.errors import ProfileLeft, ProfileMisfit, ProfileTakenBack
from ...studies.document import StudyDocument
from ...studies.kinds import KINDS
from ...studies.plan import StudyPlan
from ...studies.record import StudyRecord
from ...studies.report import html_of
from ...studies.scored_move.watch import MoveWatch
from ..audit import wording
from ..deps import CurrentBench
from ..http.problems import DEVICE_PROBLEMS, problems
from ..policy import policy
from ..profiles.views import info as profile_info
from ..router import subject_router
from ..server_state import ServerState
from .schemas import (
    MoveWatchInfo,
    SearchableList,
    StudyInfo,
    StudyKindInfo,
    StudyLeft,
    StudyList,
    StudyProfiles,
    StudyTake,
)

router = subject_router(prefix="/studies", tags=["studies"])

StudyId = Annotated[str, Path(description="as in the list", max_length=60)]
LOOK = problems(UnknownThing)
BEGIN = problems(*DEVICE_PROBLEMS, SoftLimit, UsageError, OutOfRange, StoreUnavailable)
TAKE = problems(*DEVICE_PROBLEMS, SoftLimit, ProfileMisfit, ProfileTakenBack, ProfileLeft, StoreUnavailable)


def _info(record: StudyRecord) -> StudyInfo:
    document = record.document
    best = record.trial(record.best)
    return StudyInfo(
        id=record.id,
        kind=document.study.kind,
        title=document.title,
        device=document.device,
        axis=document.axis,
        state=record.state,
        progress=record.progress,
        message=record.message,
        verdict=record.verdict,
        improved=record.improved,
        started_unix_s=record.started_unix_s,
        ended_unix_s=record.ended_unix_s,
        left=record.left,
        setting={} if best is None or record.scored is None else best.setting,
        scored=record.scored,
        noticed=record.noticed,
    )


def watch_info(watch: MoveWatch) -> MoveWatchInfo:
    return MoveWatchInfo(
        device=watch.device.id,
        axis=watch.axis,
        noticed=watch.noticed,
        missed=watch.missed,
        message=watch.message,
    )


async def _require_speed(bench: ServerState, device: str) -> None:
    """Raises WrongState for an emulator that plain Python runs until it is compiled: a trial would time how slow that
    is."""
    behind = bench.manager.get(device).config.link["kind"] == "emulator"
    if behind and not await bench.compiled():
        raise WrongState(
            "the emulators are still being compiled, and slower than real motors until then",
            "start the study again in a minute or two; GET /api/v1/health/details shows how far it is",
        )


@router.get("")
async def list_studies(bench: CurrentBench) -> StudyList:
    """All studies, the latest first, and which kinds there are."""
    kinds = [
        StudyKindInfo(kind=kind.kind, title=kind.title, purpose=kind.purpose, goes_on=kind.goes_on)
        for kind in KINDS.values()
    ]
    watches = [watch_info(watch) for watch in bench.studies.watches]
    return StudyList(studies=[_info(record) for record in bench.studies.all()], kinds=kinds, watches=watches)


@router.post("/plan", responses=problems(*DEVICE_PROBLEMS))
@policy(lease="free", role="look", audit="silent")
async def plan_study(bench: CurrentBench, body: StudyDocument) -> StudyPlan:
    """What a study would do to the machine, and what is missing before it can. Nothing moves."""
    return await bench.studies.plan(body)


@router.api_route("/plan", methods=["GET", "PUT", "PATCH", "DELETE"], include_in_schema=False)
async def no_study_is_called_plan() -> None:
    """Keep `/studies/{study}` from taking this address for a study."""
    raise HTTPException(405, headers={"Allow": "POST"})


@router.get("/searchable/{device}/{axis}", responses=problems(*DEVICE_PROBLEMS))
async def list_searchable(bench: CurrentBench, device: str, axis: Annotated[int, Path(ge=0, le=31)]) -> SearchableList:
    """Which settings of an axis an own search (`custom_search`) may try, and what each takes. Nothing is written."""
    return SearchableList(settings=await bench.studies.searchable(bench.manager.get(device), axis))


@router.post("", status_code=201, responses=BEGIN)
@policy(words=wording.named("start study"))
async def start_study(bench: CurrentBench, body: StudyDocument) -> StudyRecord:
    """Begin a study. Answers when it has started; a stop, or any other command to the axis, ends it."""
    return await bench.studies.start(body, partial(_require_speed, bench, body.device))


@router.get("/{study}", responses=LOOK)
async def get_study(bench: CurrentBench, study: StudyId) -> StudyRecord:
    """A study with all that came of it so far."""
    return bench.studies.get(study)


@router.delete("/{study}", status_code=204, responses=problems(UnknownThing, WrongState, StoreUnavailable))
@policy(words=wording.named("delete study"))
async def delete_study(bench: CurrentBench, study: StudyId) -> None:
    """Delete it for good; its recording stays."""
    await bench.studies.delete(study)


@router.post("/{study}/stop", responses=LOOK)
@policy(stops=True)
async def stop_study(bench: CurrentBench, study: StudyId) -> StudyRecord:
    """End it at once: the motor stops, and the setting before goes back."""
    return await bench.studies.stop(study)


@router.post("/{study}/resume", responses=BEGIN)
@policy(words=wording.named("resume study"))
async def resume_study(bench: CurrentBench, study: StudyId) -> StudyRecord:
    """Put the axis back as it was, and go on with a study that was cut off.

    Kinds that `goes_on` names in the list and in the plan keep what is whole, and spend what is left of the budget;
    the others begin anew, from where the axis stands. Those that go on move back to where they began first; one that
    stands in the switch that sees its lost steps leaves it before that, slowly, by a turn of the motor at most.
    """
    device = bench.studies.get(study).document.device
    return await bench.studies.resume(study, partial(_require_speed, bench, device))


@router.post("/{study}/take", responses=TAKE)
@policy(whole=True, words=wording.named("take study"))
async def take_study(bench: CurrentBench, study: StudyId, body: StudyTake) -> StudyRecord:
    """Set the axis to what the study found, to a trial of its front or a threshold that is proved at one speed, or to
    what it was before: one transaction."""
    return await bench.studies.take(study, body.which if body.which != "trial" else body.trial or 0)


@router.get("/{study}/left", responses=problems(*DEVICE_PROBLEMS))
async def get_study_left(bench: CurrentBench, study: StudyId) -> StudyLeft:
    """What a study that was cut off has left: register by register, as it is now."""
    return StudyLeft(left=await bench.studies.left(study))


@router.post("/{study}/profiles", status_code=201, responses=problems(*DEVICE_PROBLEMS, StoreUnavailable))
@policy(lease="free", words=wording.named("keep study as profiles"))
async def keep_study(bench: CurrentBench, study: StudyId) -> StudyProfiles:
    """Keep the setting before and the best one as profiles of the whole device."""
    return StudyProfiles(profiles=[profile_info(saved) for saved in await bench.studies.keep(study)])


@router.get(
    "/{study}/report",
    response_class=Response,
    responses={**problems(UnknownThing), 200: {"content": {"text/html": {"schema": {"type": "string"}}}}},
)
async def get_study_report(bench: CurrentBench, study: StudyId) -> Response:
    """The report as one HTML file that needs nothing else. The same as JSON is the study itself."""
    named = {"content-disposition": f'attachment; filename="study-{study}.html"'}
    return Response(html_of(bench.studies.get(study)), media_type="text/html", headers=named)
