"""Macros as the API tells them."""

from __future__ import annotations

import asyncio
from typing import Any

from pydantic import ValidationError

from ...errors import WrongState
from ...macros.document import MacroDocument
from ...macros.service import Kept
from ...macros.trial import TrialResult
from ..http.problems import findings
from ..server_state import ServerState
from .schemas import MacroAxisTrial, MacroOrder, MacroRunState, MacroTrial, MacroTrialWrite


def document_of(kept: dict[str, Any]) -> MacroDocument:
    """A document as it is kept. Raises WrongState for one that this program does not understand."""
    given = {name: value for name, value in kept.items() if name not in ("id", "revision")}
    try:
        return MacroDocument.model_validate(given)
    except ValidationError as error:
        raise WrongState(f"the macro cannot be read: {findings(error)}", "save it anew, or delete it") from error


def texts_of(document: MacroDocument) -> list[str]:
    """Each step in words."""
    return [step.text for step in document.steps]


async def wanted(bench: ServerState, order: MacroOrder) -> Kept:
    """The macro that a request means. Raises UnknownThing, WrongState."""
    if order.document is not None:
        return Kept(MacroDocument.model_validate(order.document.model_dump()))
    saved, revision = await asyncio.to_thread(bench.macro_store.revision, order.macro or "", order.revision)
    return Kept(document_of(revision.document), saved.id, revision.revision)


def trial_out(result: TrialResult) -> MacroTrial:
    """What came of a trial."""
    return MacroTrial(
        passed=result.passed,
        why_not=result.why_not,
        run=MacroRunState.model_validate(result.run),
        axes=[MacroAxisTrial.model_validate(axis) for axis in result.axes],
        writes=[MacroTrialWrite.model_validate(write) for write in result.writes],
        warnings=result.warnings,
    )
