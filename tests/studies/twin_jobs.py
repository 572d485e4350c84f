"""What tests try on twins: a loaded axis, and one setting of a fastest move on its twin."""

from __future__ import annotations

from typing import Any

from app.profiles.capture import capture
from app.studies.document import TwinMotor
from app.studies.search import Asked
from app.studies.twins.executor import TwinJob
from app.studies.twins.search import job_of
from tests.studies.harness import Studied

LOAD = {"inertia_kgm2": 5e-4, "friction_nm": 0.1}
MOTOR = {"holding_torque_nm": 0.45, "load_inertia_kgm2": 5e-4, "load_friction_nm": 0.1}
MOVE: dict[str, Any] = {"kind": "fastest_move", "distance": 12_800, "repeats": 1}
HELD = {"speed": 60_000.0, "acceleration": 300_000.0}


async def move_job(s: Studied, number: int = 0, distance: int = 12_800, **study: Any) -> TwinJob:
    """A setting that the twin holds."""
    document = s.document({**MOVE, "distance": distance, **study})
    motor = TwinMotor.model_validate(MOTOR)
    return job_of(s.device, 0, await capture(s.device), motor, document, Asked(number, HELD))
