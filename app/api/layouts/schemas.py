"""Shapes of layouts. What a layout says is the page's business: the server knows its format, version and name."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, StringConstraints

from ..revisions import BasedOn, SavedRevision
from ..schemas import Answer, Body

LayoutName = Annotated[str, StringConstraints(strict=True, min_length=1, max_length=80)]


class LayoutDocument(BaseModel):
    """A layout: which panels there are, how each is set, and where they stand. Further keys are kept as they are."""

    model_config = ConfigDict(extra="allow")

    format: Literal["stepscope.layout"]
    version: Annotated[int, Field(strict=True, ge=1, le=1000)]
    name: LayoutName
    screens: dict[str, Any]
    panels: dict[str, Any]


class LayoutNew(Body):
    """A layout to be kept under an id of its own."""

    document: LayoutDocument


class LayoutSave(BasedOn):
    """A layout to be kept over a revision of it."""

    document: LayoutDocument


class LayoutInfo(SavedRevision):
    """A kept layout, by its latest revision."""

    id: str
    name: str


class LayoutList(Answer):
    """All kept layouts."""

    layouts: list[LayoutInfo]


class LayoutDetail(LayoutInfo):
    """A kept layout with its document, and which of its revisions are still there, the latest first."""

    revisions: list[SavedRevision]
    document: LayoutDocument
