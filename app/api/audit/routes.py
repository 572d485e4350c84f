"""The audit log: who did what, when, from where, and what came of it."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import Annotated, Literal

from fastapi import Query
from fastapi.responses import StreamingResponse
from pydantic import BeforeValidator

from ...audit.csv_text import PIECE, csv_pieces
from ...errors import StoreUnavailable
from ...store.audit_entries import EntryFilter
from ..deps import CurrentBench
from ..http.problems import problems
from ..router import subject_router
from .schemas import AuditFilters, AuditPage, Outcome
from .views import shown

router = subject_router(prefix="/audit", tags=["audit"])


def _moment(given: object) -> object:
    if isinstance(given, str):
        if given[10:11] not in ("T", "t"):
            raise ValueError("a moment is said in ISO 8601, e.g. 2026-11-21T18:00:00Z")
        # A plus sign in an address is a space: `2026-11-21T21:00:00+01:00` arrives as one.
        return given.replace(" ", "+")
    return given


Moment = Annotated[datetime, BeforeValidator(_moment)]


@router.get(
    "",
    responses={
        **problems(StoreUnavailable),
        200: {"content": {"text/csv": {"schema": {"type": "string", "format": "binary"}}}},
    },
)
async def list_audit(
    bench: CurrentBench,
    q: Annotated[str, Query(description="words, all of which an entry has somewhere", max_length=200)] = "",
    device: Annotated[str, Query(max_length=200)] = "",
    who: Annotated[str, Query(max_length=200)] = "",
    action: Annotated[str, Query(max_length=100)] = "",
    outcome: Annotated[Outcome | None, Query()] = None,
    since: Annotated[Moment | None, Query(description="ISO 8601, UTC where it says nothing else")] = None,
    until: Annotated[Moment | None, Query(description="as `since`; entries before it")] = None,
    after: Annotated[int | None, Query(description="entries with higher ids", ge=0, lt=1 << 63)] = None,
    before: Annotated[int | None, Query(description="entries with lower ids", ge=0, lt=1 << 63)] = None,
    limit: Annotated[int, Query(description="entries of a page; of a file all are given", ge=1, le=2000)] = 200,
    format: Annotated[Literal["json", "csv"], Query()] = "json",  # noqa: A002
) -> AuditPage:
    """Entries, the newest first."""
    wanted = EntryFilter(q, device, who, action, outcome or "", _unix_s(since), _unix_s(until), after)
    if format == "csv":
        first = await bench.audit.search(wanted, PIECE, before)  # here, so that a failure is an answer of its own
        named = {"content-disposition": 'attachment; filename="stepscope-audit.csv"'}
        pieces = csv_pieces(bench.audit, wanted, first)
        return StreamingResponse(pieces, media_type="text/csv", headers=named)  # type: ignore[return-value]  # no JSON
    entries = await bench.audit.search(wanted, limit + 1, before)
    return AuditPage(entries=[shown(entry) for entry in entries[:limit]], more=len(entries) > limit)


@router.get("/filters", responses=problems(StoreUnavailable))
async def list_audit_filters(bench: CurrentBench) -> AuditFilters:
    """Devices, people and actions that there are entries of."""
    return AuditFilters.model_validate(await bench.audit.known(), from_attributes=True)


def _unix_s(moment: datetime | None) -> float | None:
    if moment is None:
        return None
    return (moment if moment.tzinfo else moment.replace(tzinfo=UTC)).timestamp()
