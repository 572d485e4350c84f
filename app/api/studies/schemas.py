"""The shapes of studies that are not those of their documents and records."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, model_validator

from ...studies.custom_search.found import Searchable
from ...studies.document import Kind
from ...studies.record import State
from ...studies.scored_move.found import Scored
from ..profiles.schemas import ProfileInfo
from ..schemas import Answer, Body


class StudyKindInfo(Answer):
    """A study that there is."""

    kind: Kind
    title: str
    purpose: str
    goes_on: bool = Field(
        description="cut off and resumed, it keeps what is whole and goes on with the rest; else it begins anew"
    )


class StudyInfo(Answer):
    """A study in the list."""

    id: str
    kind: Kind
    title: str
    device: str
    axis: int
    state: State
    progress: float
    message: str
    verdict: str
    improved: bool | None
    started_unix_s: float
    ended_unix_s: float | None
    left: list[str] = Field(description="what is not as it was before; empty where all is")
    setting: dict[str, float] = Field(description="of a scored move: what was in force")
    scored: Scored | None = Field(description="of a scored move: its figures")
    noticed: bool = Field(description="a move that somebody made, and that was noticed")


class MoveWatchInfo(Answer):
    """An axis whose moves are noticed, whoever makes them: each is recorded and scored."""

    device: str
    axis: int
    noticed: int = Field(description="moves that were scored since")
    missed: int = Field(
        description="that could not be: stopped but by a stall, to and fro without a rest, too short, or with gaps"
    )
    message: str = Field(description="why none is noticed now; empty while they are")


class StudyList(Answer):
    """All of them, the latest first."""

    studies: list[StudyInfo]
    kinds: list[StudyKindInfo]
    watches: list[MoveWatchInfo]


class SearchableList(Answer):
    """What an own search may try on an axis."""

    settings: list[Searchable]


class StudyTake(Body):
    """Which setting the axis shall have."""

    which: Literal["best", "baseline", "trial"] = Field(
        description="what the study found, what was before it, or a trial: of its front, or `own` of a speed of "
        "StallGuard"
    )
    trial: int | None = Field(
        default=None,
        description="its number, where a trial is taken: one of the front held when it was tried, and is not proved",
    )

    @model_validator(mode="after")
    def _one(self) -> StudyTake:
        if (self.which == "trial") != (self.trial is not None):
            raise ValueError("trial is its number where which is trial, and is left out elsewhere")
        return self


class StudyLeft(Answer):
    """What a study that was cut off has left."""

    left: list[str] = Field(description="register by register, as it is now; empty where all is as before")


class StudyProfiles(Answer):
    """The profiles that were kept."""

    profiles: list[ProfileInfo]
