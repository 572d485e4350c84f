"""What documents and records of studies are made of."""

from __future__ import annotations

from typing import Literal

from pydantic import ConfigDict

from ..deferred import DeferredModel

PairOrder = Literal["AB", "BA"]
"""Which of a pair came first: A is the old setting, B the new one."""


class Part(DeferredModel):
    """A part of a document or a record: an unknown key is an error."""

    model_config = ConfigDict(extra="forbid", json_schema_serialization_defaults_required=True)


class Interval(Part):
    """From where to where something lies, 95 %."""

    low: float
    high: float
