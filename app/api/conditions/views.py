"""Conditions of axes for clients."""

from __future__ import annotations

from typing import Any

from ...conditions.judge import Condition
from ...conditions.service import AxisAssessment
from ...devices.core import signs
from ...devices.core.device import Device
from ..schemas import Condition as ConditionOut
from ..schemas import Evidence, GroundTruth, Remedy


def condition_out(device: Device, condition: Condition) -> ConditionOut:
    """A condition for clients: the paths of its remedies from the root."""
    remedies = [remedy_out(device, remedy) for remedy in condition.remedies]
    return ConditionOut(
        kind=condition.kind,
        cause=condition.cause,
        evidence=[Evidence.model_validate(piece) for piece in condition.evidence],
        remedies=remedies,
        remedy=remedies[0] if remedies else None,
        since_s=condition.since_s,
    )


def remedy_out(device: Device, remedy: signs.Remedy) -> Remedy:
    """A remedy for clients, as a button would make it."""
    return Remedy(
        label=remedy.label,
        method=remedy.method,
        path="/".join(filter(None, ("/api/v1/devices", device.id, remedy.path))),
        body=None if remedy.body is None else dict(remedy.body),
        moves=remedy.moves,
    )


def standing_out(device: Device, standing: AxisAssessment) -> dict[str, Any]:
    """The members that every answer about an axis has."""
    ground_truth = standing.ground_truth
    return {
        "condition": condition_out(device, standing.condition),
        "referenced": standing.referenced,
        "ground_truth": None if ground_truth is None else GroundTruth.model_validate(ground_truth),
    }
