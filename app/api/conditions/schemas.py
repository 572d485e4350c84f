"""Messages of the socket of conditions."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from ...deferred import DeferredRootModel
from ..schemas import Answer, Body, Standing

SUBPROTOCOL = "stepscope.conditions.v1"


class ConditionsPage(Body):
    """What a page says of itself: its session has a page open for as long as the socket."""

    session: Annotated[str, Field(min_length=16, max_length=200, pattern="^[!-~]+$")]


class AxisCondition(Standing):
    """How an axis stands now."""

    type: Literal["condition"] = "condition"
    device: str
    axis: int


class ConditionsSnapshot(Answer):
    """The first message: how all axes stand."""

    type: Literal["snapshot"] = "snapshot"
    axes: list[AxisCondition]


class DeviceRemoved(Answer):
    """A device is no more, or has another id now; its axes then follow under that."""

    type: Literal["removed"] = "removed"
    device: str


class Alive(Answer):
    """Nothing has changed for a second, and the server goes on looking."""

    type: Literal["alive"] = "alive"


ConditionsText = ConditionsSnapshot | AxisCondition | DeviceRemoved | Alive


class ConditionsMessage(DeferredRootModel[ConditionsText]):
    """Any message of the socket."""

    root: Annotated[ConditionsText, Field(discriminator="type")]
