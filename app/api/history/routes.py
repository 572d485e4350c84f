"""A device's history, and undo: to a time, to before an entry, or of one request."""

from __future__ import annotations

from typing import Annotated

from fastapi import Query

from ...audit.csv_text import time_of
from ...audit.history import changes_of
from ...devices.core.actor import actor
from ...errors import SoftLimit, StoreUnavailable, UsageError
from ...profiles.errors import ProfileLeft, ProfileMisfit, ProfileTakenBack, UnreadableProfile
from ...profiles.undo import Aim, Before, Preview, PutBack, Since, Without
from ..audit import wording
from ..audit.views import shown
from ..deps import CurrentBench, CurrentDevice
from ..http.problems import DEVICE_PROBLEMS, problems
from ..policy import policy
from ..profiles.views import applied
from ..router import subject_router
from .schemas import DeviceHistory, HistoryChange, NotPutBack, RegisterPlace, UndoAnswer, UndoneRegister, UndoOrder

router = subject_router(prefix="/devices/{device}", tags=["history"])


@router.get("/history", responses=problems(*DEVICE_PROBLEMS, StoreUnavailable))
async def list_history(
    device: CurrentDevice,
    bench: CurrentBench,
    before: Annotated[int | None, Query(description="changes with lower entries", ge=0, lt=1 << 63)] = None,
    limit: Annotated[int, Query(description="changes of a page", ge=1, le=500)] = 100,
) -> DeviceHistory:
    """What was done to the device, the newest first: entries of the audit log, those of one request together."""
    page = await changes_of(bench.audit, device.id, limit, before)
    changes = [
        HistoryChange(entry=shown(each.entry), first=each.first, last=each.last, writes=each.writes)
        for each in page.changes
    ]
    return DeviceHistory(changes=changes, more=page.more)


@router.post(
    "/undo",
    responses=problems(
        *DEVICE_PROBLEMS,
        UsageError,
        UnreadableProfile,
        ProfileMisfit,
        SoftLimit,
        ProfileTakenBack,
        ProfileLeft,
        StoreUnavailable,
    ),
)
@policy(lease="free as a dry run", audit="silent as a dry run", whole=True, words=wording.undo)
async def undo(
    device: CurrentDevice,
    bench: CurrentBench,
    body: UndoOrder,
    dry_run: Annotated[bool, Query(description="only tell what would be put back: nothing is written")] = False,
) -> UndoAnswer:
    """Put registers back to what the audit log says that they held, as one transaction like that of a profile.

    What others have written since, and what was changed past the log, is put back only where `registers` name it. What
    cannot be put back (motion, flags, what nobody has seen) is told.
    """
    if dry_run:
        return _answer(await bench.undo.preview(device, _aim(body), actor.get()), None)
    places = None if body.registers is None else [(each.name, each.axis) for each in body.registers]
    done = await bench.undo.put_back(device, _aim(body), actor.get(), places, body.seen)
    return _answer(done.preview, done)


def _aim(body: UndoOrder) -> Aim:
    if body.since is not None:
        return Since(body.since.timestamp())
    if body.before is not None:
        return Before(body.before)
    assert body.without is not None
    return Without(body.without)


def _answer(preview: Preview, done: PutBack | None) -> UndoAnswer:
    outcome = None if done is None or done.outcome is None else applied(done.outcome)
    registers = [
        UndoneRegister(
            name=each.name,
            axis=each.axis,
            kind=each.kind,
            was=each.was,
            now=each.now,
            unit=each.unit,
            was_physical=each.was_physical,
            now_physical=each.now_physical,
            state=each.state,
            why=each.why,
            since=[shown(entry) for entry in each.since],
        )
        for each in preview.registers
    ]
    rest = [
        NotPutBack(
            action=each.action,
            subject=each.subject,
            count=each.count,
            time=time_of(each.latest),
            who=each.latest.who,
            why=each.why,
        )
        for each in preview.rest
    ]
    return UndoAnswer(
        state="dry run" if done is None else "unchanged" if outcome is None else "applied",
        registers=registers,
        rest=rest,
        same=preview.same,
        unseen=[RegisterPlace(name=name, axis=axis) for name, axis in preview.unseen],
        seen=preview.seen,
        applied=outcome,
    )
