"""Macros of one device: made of what was done to it, tried on its twin, and run."""

from __future__ import annotations

import asyncio
from typing import Annotated

from fastapi import Query

from ...errors import SoftLimit, StoreUnavailable, UnknownThing, UsageError, WrongState
from ...macros.document import FORMAT, MacroDocument
from ...macros.service import Kept
from ..audit import wording
from ..deps import CurrentBench, CurrentDevice
from ..http.problems import DEVICE_PROBLEMS, problems
from ..policy import policy
from ..router import subject_router
from .schemas import MacroDraft, MacroOrder, MacroRunState, MacroStanding, MacroTrial, MacroTried
from .views import document_of, texts_of, trial_out, wanted

router = subject_router(prefix="/devices/{device}", tags=["macros"])


@router.get("/macro-draft", responses=problems(UnknownThing, StoreUnavailable))
async def draft_macro(
    bench: CurrentBench,
    device: CurrentDevice,
    after: Annotated[int, Query(ge=0, lt=1 << 63, description="id of the audit entry before the first that counts")],
    until: Annotated[int | None, Query(ge=0, lt=(1 << 63) - 1, description="id of the last one; all without")] = None,
    longest_pause_s: Annotated[
        float, Query(ge=0, le=3600, allow_inf_nan=False, description="what was a longer pause is a wait for so long")
    ] = 5.0,
) -> MacroDraft:
    """Steps of what the audit log tells of the device: writes, moves, stops, recordings, profiles, and the pauses
    between them. Nothing is kept."""
    draft = await bench.macros.draft(device, after, until, longest_pause_s)
    document = MacroDocument(
        format=FORMAT, version=1, name=f"Macro of {device.name}"[:80], model=device.model, steps=draft.steps
    )
    return MacroDraft(document=document, texts=texts_of(document), left_out=draft.left_out)


@router.post("/macro-trial", responses=problems(UnknownThing, WrongState, UsageError, StoreUnavailable))
@policy(lease="free", audit="silent")
async def try_macro(bench: CurrentBench, device: CurrentDevice, body: MacroOrder) -> MacroTrial:
    """Try a macro on an emulated twin of the device, made of what it holds now. Nothing moves here.

    It takes a fraction of the time that the macro takes; recordings are left out.
    """
    return trial_out(await bench.macros.try_out(device, await wanted(bench, body)))


@router.get("/macro-run", responses=problems(UnknownThing, StoreUnavailable))
async def get_macro_run(bench: CurrentBench, device: CurrentDevice) -> MacroStanding:
    """How a macro goes on this device, or how the latest one went; and which kept ones have passed their trial."""
    tried = []
    for saved in await asyncio.to_thread(bench.macro_store.all):
        try:
            kept = Kept(document_of(saved.latest.document), saved.id, saved.latest.revision)
        except WrongState:
            continue
        tried.append(MacroTried(macro=kept.id, revision=kept.revision, passed=bench.macros.passed(device, kept)))
    return MacroStanding(run=MacroRunState.model_validate(bench.macros.state(device)), tried=tried)


@router.post("/macro-run", responses=problems(*DEVICE_PROBLEMS, SoftLimit, UsageError, StoreUnavailable))
@policy(words=wording.run_macro)
async def run_macro(bench: CurrentBench, device: CurrentDevice, body: MacroOrder) -> MacroRunState:
    """Do its steps one after the other, each once. Answers when it has begun; a stop, or any other command to an axis
    that it moves, ends it."""
    kept = await wanted(bench, body)
    return MacroRunState.model_validate(bench.macros.start(device, kept))


@router.delete("/macro-run", responses=problems(UnknownThing))
@policy(stops=True, words=wording.done("stop macro"))
async def stop_macro(bench: CurrentBench, device: CurrentDevice) -> MacroRunState:
    """End it at once, and stop what it has moved."""
    return MacroRunState.model_validate(await bench.macros.stop(device))
