"""What the procedures of a closed loop tell of themselves, and what a calibration of one is."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ..calc.signals.step_response import Score
from .procedure import Procedure, State

Regulation = Literal["off", "closed_loop", "pid_around_zero", "pid_around_velocity"]
REGULATIONS: tuple[Regulation, ...] = ("off", "closed_loop", "pid_around_zero", "pid_around_velocity")
"""By the value of ENC_IN_CONF.regulation_modus."""
FloatArray = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Load:
    """A torque on an axis [Nm]: `apply` puts it on top of what is there already, `release` takes it away again."""

    torque_nm: float
    apply: Callable[[], None]
    release: Callable[[], None]


@dataclass(frozen=True, slots=True)
class EncoderFound:
    """An encoder that is not what the chip has been told, as a move has shown, and what would put that right."""

    counts_per_turn: float
    uncertainty: float
    usual_counts: int | None
    set_counts: float
    """What ENC_CONST makes of it now."""
    writes: dict[str, dict[str, int]]
    """Fields by register; empty where nothing is sure enough."""


@dataclass(frozen=True, slots=True)
class CalibrationState:
    """Names as in the REST contract; offsets are CL_OFFSET [microsteps]."""

    state: State
    phase: str
    progress: float
    offset: int | None
    offset_before: int | None
    regulation: Regulation | None
    message: str
    encoder: EncoderFound | None = None


@dataclass(frozen=True, slots=True)
class Recording:
    """Columns of one length. `time_s` counts from the step or the load [s]; positions in microsteps; NaN: not known."""

    time_s: FloatArray
    target: FloatArray
    commanded: FloatArray
    encoder: FloatArray
    deviation: FloatArray
    velocity_pps: FloatArray
    encoder_velocity_pps: FloatArray
    load_angle_deg: FloatArray
    load_torque_nm: FloatArray


@dataclass(frozen=True, slots=True)
class ResponseState:
    """A step response or a disturbance; `started_at_s` is device time of the step or the load [s]."""

    state: State
    phase: str
    progress: float
    message: str
    started_at_s: float | None = None
    recording: Recording | None = None
    score: Score | None = None


NOT_CALIBRATED = CalibrationState("idle", "", 0.0, None, None, None, "")
NOT_RECORDED = ResponseState("idle", "", 0.0, "")


class Calibration(Procedure):
    """Teaches a chip how its encoder stands to the field, however its family does that."""

    kind = "closed-loop calibration"

    @property
    @abstractmethod
    def state(self) -> CalibrationState:
        """How far it is, or how it ended."""
