"""Shapes of macros. The document itself and its steps are in `app.macros.document`."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import ConfigDict, Field, JsonValue, model_validator

from ...macros.document import MacroDocument
from ..revisions import ID_MAX, ID_PATTERN, BasedOn, SavedRevision
from ..schemas import Answer, Body

EXAMPLE: dict[str, JsonValue] = {
    "format": "stepscope.macro",
    "version": 1,
    "name": "There and back",
    "steps": [
        {"do": "move", "axis": 0, "target": 1, "relative": True, "unit": "rev"},
        {"do": "wait position", "axis": 0, "at_most_s": 10},
        {"do": "wait", "seconds": 0.5},
        {"do": "move", "axis": 0, "target": -1, "relative": True, "unit": "rev"},
    ],
}
MacroName = Annotated[str, Field(min_length=1, max_length=ID_MAX, pattern=ID_PATTERN)]


class MacroIn(MacroDocument):
    """A macro as a request brings it."""

    model_config = ConfigDict(extra="forbid", json_schema_extra={"examples": [EXAMPLE]})


class MacroNew(Body):
    """A macro to be kept under an id of its own."""

    document: MacroIn


class MacroSave(BasedOn):
    """A macro to be kept over a revision of it."""

    document: MacroIn


class MacroInfo(SavedRevision):
    """A kept macro, by its latest revision."""

    id: str
    name: str
    note: str
    model: str = Field(description="what it was made for; empty: any")
    steps: int


class MacroList(Answer):
    """All kept macros."""

    macros: list[MacroInfo]


class MacroDetail(MacroInfo):
    """A kept macro with its document, and which of its revisions are still there, the latest first."""

    revisions: list[SavedRevision]
    document: MacroDocument
    texts: list[str] = Field(description="each step in words")


class MacroPython(Answer):
    """A macro as a Python program for stepscope's client."""

    text: str
    file_name: str


class MacroDraft(Answer):
    """Steps made of the audit log, and what it tells that none could be made of."""

    document: MacroDocument
    texts: list[str] = Field(description="each step in words")
    left_out: list[str]


class MacroOrder(Body):
    """A kept macro by its id, or a document that need not be kept."""

    macro: MacroName | None = None
    revision: Annotated[int, Field(strict=True, ge=1, le=1 << 53)] | None = Field(
        default=None, description="of a kept one: which; null for the latest"
    )
    document: MacroIn | None = None

    @model_validator(mode="after")
    def _one_of_both(self) -> MacroOrder:
        if (self.macro is None) == (self.document is None):
            raise ValueError("a macro's id, or a document")
        if self.revision is not None and self.macro is None:
            raise ValueError("a revision is of a kept macro")
        return self


class MacroStepDone(Answer):
    """A step that is done."""

    number: int = Field(description="from 1")
    text: str
    took_s: float
    came: str = Field(description="what came of it: where it stands, what was read back")


class MacroRunState(Answer):
    """How a run goes, or how the latest one of a device went."""

    state: Literal["idle", "running", "done", "failed", "aborted"]
    macro: str = Field(description="its id; empty for a document that is not kept")
    revision: int
    name: str
    by: str = Field(description="who began it")
    step: int = Field(description="the one under way, or where it ended, from 1; 0 before the first")
    steps: int
    text: str = Field(description="that step in words")
    left_s: float | None = Field(description="how long it takes yet, or may take at most [s]; null where nobody knows")
    started_unix_s: float | None
    took_s: float
    message: str = Field(description="where it did not come to its end: at which step, and why")
    way_out: str
    done: list[MacroStepDone]
    warnings: list[str]
    recordings: list[str] = Field(description="ids of the recordings that it has made")


class MacroAxisTrial(Answer):
    """What an axis of the twin did. Positions in microsteps."""

    axis: int
    start: int
    end: int
    least: int
    greatest: int
    top_speed_pps: float
    moving: bool = Field(description="it still turns at the macro's end")


class MacroTrialWrite(Answer):
    """A register that was written on the twin."""

    name: str
    axis: int | None
    old: int | None
    new: int | None


class MacroTrial(Answer):
    """What came of trying a macro on an emulated twin of a device: same model, registers, limits and places."""

    passed: bool = Field(description="it came to its end")
    why_not: str = Field(description="why it could not be tried at all; empty where it was")
    run: MacroRunState
    axes: list[MacroAxisTrial]
    writes: list[MacroTrialWrite]
    warnings: list[str]


class MacroTried(Answer):
    """Whether a kept macro, in its present revision, has come to its end on a twin of a device."""

    macro: str
    revision: int
    passed: bool | None = Field(description="null: it was not tried since the server began")


class MacroStanding(Answer):
    """Macros of a device: the present run, or the latest, and which ones were tried."""

    run: MacroRunState
    tried: list[MacroTried]
