"""The base of all models: pydantic's, with validators that are made when they are first used, not at import.

A start imports 600 models, and uses some thirty until the page is there: the others would hold it up by half a second.
"""

from __future__ import annotations

from typing import TypeVar

from pydantic import BaseModel, ConfigDict, RootModel

RootT = TypeVar("RootT")


class DeferredModel(BaseModel):
    """pydantic's BaseModel otherwise."""

    model_config = ConfigDict(defer_build=True)


class DeferredRootModel(RootModel[RootT]):
    """pydantic's RootModel otherwise."""

    model_config = ConfigDict(defer_build=True)


DEFERRED = ConfigDict(defer_build=True)
"""For a TypeAdapter, which takes no model."""
