"""Layouts of the page's panels: kept on the server, so that every browser has them."""

from __future__ import annotations

import asyncio

from ...errors import StoreUnavailable, UnknownThing, UsageError, WrongState
from ...store.layouts import LayoutChanged
from ...store.revisions import Revision, Saved
from ..audit import wording
from ..deps import CurrentBench
from ..http.problems import problems
from ..policy import policy
from ..revisions import KeptId, RevisionNumber, revisions_of, told
from ..router import subject_router
from .schemas import (
    LayoutDetail,
    LayoutDocument,
    LayoutInfo,
    LayoutList,
    LayoutNew,
    LayoutSave,
)

router = subject_router(prefix="/layouts", tags=["layouts"])


@router.get("", responses=problems(StoreUnavailable))
async def list_layouts(bench: CurrentBench) -> LayoutList:
    """All kept layouts, by id."""
    return LayoutList(layouts=[_info(saved) for saved in await asyncio.to_thread(bench.layouts.all)])


@router.post("", status_code=201, responses=problems(UsageError, StoreUnavailable))
@policy(lease="free", words=wording.named("keep layout"))
async def add_layout(bench: CurrentBench, body: LayoutNew) -> LayoutDetail:
    """Keep a new layout; its id is made of its name."""
    return _detail(await asyncio.to_thread(bench.layouts.add, body.document.model_dump()))


@router.get("/{layout}", responses=problems(UnknownThing, WrongState, StoreUnavailable))
async def get_layout(
    bench: CurrentBench,
    layout: KeptId,
    revision: RevisionNumber = None,
) -> LayoutDetail:
    """A kept layout with its document."""
    return _detail(*await asyncio.to_thread(bench.layouts.revision, layout, revision))


@router.put("/{layout}", responses=problems(UnknownThing, LayoutChanged, WrongState, UsageError, StoreUnavailable))
@policy(lease="free", words=wording.named("save layout"))
async def put_layout(bench: CurrentBench, layout: KeptId, body: LayoutSave) -> LayoutDetail:
    """Keep a further revision, made from `based_on`. Another one that was saved since is never written over."""
    return _detail(await asyncio.to_thread(bench.layouts.put, layout, body.based_on, body.document.model_dump()))


@router.delete("/{layout}", status_code=204, responses=problems(UnknownThing, StoreUnavailable))
@policy(lease="free", words=wording.named("delete layout"))
async def delete_layout(bench: CurrentBench, layout: KeptId) -> None:
    """Forget a layout with its revisions."""
    await asyncio.to_thread(bench.layouts.delete, layout)


def _info(saved: Saved) -> LayoutInfo:
    latest = saved.latest
    return LayoutInfo(name=latest.document["name"], **told(saved))


def _detail(saved: Saved, of: Revision | None = None) -> LayoutDetail:
    shown = of or saved.latest
    return LayoutDetail(
        name=str(shown.document["name"]),
        **told(saved, of),
        revisions=revisions_of(saved),
        document=LayoutDocument.model_validate(shown.document),
    )
