"""Messages of the socket of conditions."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, RootModel

from app.api.schemas import Answer, Standing

SUBPROTOCOL = "stepscope.conditions.v1"


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


ConditionsText = ConditionsSnapshot | AxisCondition | DeviceRemoved


class ConditionsMessage(RootModel[ConditionsText]):
    """Any message of the socket."""

    root: Annotated[ConditionsText, Field(discriminator="type")]
