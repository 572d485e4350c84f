"""Macros that are kept on the server, with their revisions."""

from __future__ import annotations

import asyncio
from typing import Annotated

from fastapi import Query

from ...errors import StoreUnavailable, UnknownThing, UsageError, WrongState
from ...macros.document import MacroDocument
from ...macros.python import render
from ...profiles.scripts.text import file_stem
from ...store.macros import MacroChanged
from ...store.revisions import Revision, Saved
from ..audit import wording
from ..deps import CurrentBench
from ..http.problems import problems
from ..policy import policy
from ..revisions import KeptId, RevisionNumber, revisions_of, told
from ..router import subject_router
from .schemas import MacroDetail, MacroInfo, MacroList, MacroNew, MacroPython, MacroSave
from .views import document_of, texts_of

router = subject_router(prefix="/macros", tags=["macros"])

LOOK = problems(UnknownThing, WrongState, StoreUnavailable)


@router.get("", responses=problems(StoreUnavailable))
async def list_macros(bench: CurrentBench) -> MacroList:
    """All kept macros, by id."""
    kept = await asyncio.to_thread(bench.macro_store.all)
    return MacroList(macros=[_info(saved) for saved in kept])


@router.post("", status_code=201, responses=problems(UsageError, StoreUnavailable))
@policy(lease="free", words=wording.named("keep macro"))
async def add_macro(bench: CurrentBench, body: MacroNew) -> MacroDetail:
    """Keep a new macro; its id is made of its name."""
    return _detail(await asyncio.to_thread(bench.macro_store.add, body.document.model_dump(mode="json")))


@router.get("/{macro}", responses=LOOK)
async def get_macro(bench: CurrentBench, macro: KeptId, revision: RevisionNumber = None) -> MacroDetail:
    """A kept macro with its document."""
    return _detail(*await asyncio.to_thread(bench.macro_store.revision, macro, revision))


@router.put("/{macro}", responses=problems(UnknownThing, MacroChanged, WrongState, UsageError, StoreUnavailable))
@policy(lease="free", words=wording.named("save macro"))
async def put_macro(bench: CurrentBench, macro: KeptId, body: MacroSave) -> MacroDetail:
    """Keep a further revision, made from `based_on`. Another one that was saved since is never written over."""
    document = body.document.model_dump(mode="json")
    return _detail(await asyncio.to_thread(bench.macro_store.put, macro, body.based_on, document))


@router.delete("/{macro}", status_code=204, responses=problems(UnknownThing, StoreUnavailable))
@policy(lease="free", words=wording.named("delete macro"))
async def delete_macro(bench: CurrentBench, macro: KeptId) -> None:
    """Forget a macro with its revisions."""
    await asyncio.to_thread(bench.macro_store.delete, macro)


@router.get("/{macro}/python", responses=LOOK)
async def get_macro_python(
    bench: CurrentBench,
    macro: KeptId,
    revision: RevisionNumber = None,
    device: Annotated[str, Query(max_length=200, description="the device that it is for, unless told otherwise")] = "",
) -> MacroPython:
    """The macro as a Python program for stepscope's client, which does the same from wherever it is run."""
    _, kept = await asyncio.to_thread(bench.macro_store.revision, macro, revision)
    document: MacroDocument = document_of(kept.document)
    return MacroPython(text=render(document, device or "bench"), file_name=f"{file_stem(document.name)}.py")


def _info(saved: Saved) -> MacroInfo:
    latest = saved.latest
    steps = latest.document.get("steps")
    return MacroInfo(
        name=str(latest.document["name"]),
        note=str(latest.document.get("note", "")),
        model=str(latest.document.get("model", "")),
        steps=len(steps) if isinstance(steps, list) else 0,
        **told(saved),
    )


def _detail(saved: Saved, of: Revision | None = None) -> MacroDetail:
    shown = of or saved.latest
    document = document_of(shown.document)
    return MacroDetail(
        name=document.name,
        note=document.note,
        model=document.model,
        steps=len(document.steps),
        **told(saved, of),
        revisions=revisions_of(saved),
        document=document,
        texts=texts_of(document),
    )
