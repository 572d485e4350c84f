"""Shapes of closed loop: calibrating it, and what a step or a load does to the axis, recorded and scored."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from ...procedures.step_response import Window
from ..schemas import Answer, Body, Flag

ProcedureState = Literal["idle", "running", "done", "failed", "aborted"]
Regulation = Literal["off", "closed_loop", "pid_around_zero", "pid_around_velocity"]
Distance = Annotated[int, Field(strict=True, ge=-(1 << 30), le=1 << 30)]
Seconds = Annotated[float, Field(strict=True, ge=0.05, le=30, allow_inf_nan=False)]
Band = Annotated[float, Field(strict=True, gt=0, le=1e6, allow_inf_nan=False)]
Torque = Annotated[float, Field(strict=True, ge=-50, le=50, allow_inf_nan=False)]
Rate = Annotated[float, Field(strict=True, ge=10, le=1000, allow_inf_nan=False)]


class CalibrationStart(Body):
    """The motor turns to a full step, and there the chip takes the encoder's offset. It needs an encoder that counts
    the right way, 256 microsteps per full step, and no load on the shaft. One that does not is measured over 16 full
    steps there and back."""

    velocity_pps: Annotated[float, Field(strict=True, gt=0, le=1e6, allow_inf_nan=False)] = Field(
        default=10_000.0, description="speed on the way to a full step [pps]"
    )
    settle_s: Annotated[float, Field(strict=True, ge=0.01, le=10, allow_inf_nan=False)] = Field(
        default=0.1, description="rest on the full step before the offset is taken, and as long until it is there [s]"
    )
    switch_on: Flag = Field(default=True, description="leave closed loop on when done; else the regulation is off")


class EncoderFound(Answer):
    """An encoder that is not what the chip has been told, as a move of 16 full steps has shown."""

    counts_per_turn: float = Field(description="as measured; below 0: it counts against the motor")
    uncertainty: float = Field(description="it may be so much more or less [counts a turn]")
    usual_counts: int | None = Field(description="the one usual resolution that fits; null: none, or more than one")
    set_counts: float = Field(description="counts a turn that the chip reckons with now")
    writes: dict[str, dict[str, int]] = Field(
        description="fields by register that put it right; empty where nothing is sure enough"
    )


class CalibrationState(Answer):
    """The calibration that runs, or the latest one."""

    state: ProcedureState
    phase: str
    progress: float
    offset: int | None = Field(description="CL_OFFSET as the chip has taken it [microsteps]; null before")
    offset_before: int | None
    regulation: Regulation | None = Field(description="what is on now; null before anything was seen")
    message: str
    encoder: EncoderFound | None = Field(description="what encoder there is instead; null where that was not measured")


class _ResponseStart(Body):
    seconds: Seconds = Field(default=1.0, description="length of the recording after the step or the load [s]")
    before_s: Annotated[float, Field(strict=True, ge=0, le=5, allow_inf_nan=False)] = Field(
        default=0.05, description="length of the recording before it [s]"
    )
    rate_hz: Rate = Field(default=1000.0, description="samples a second; less where the link carries no more")
    band: Band = Field(default=50.0, description="how near the encoder has to stay to count as settled [microsteps]")

    @property
    def window(self) -> Window:
        """What is recorded."""
        return Window(self.seconds, self.before_s, self.rate_hz, self.band)


class StepResponseStart(_ResponseStart):
    """Go by `distance` and record. "ramp" goes as the axis is set, "step" lets the command jump (hold mode at VMAX),
    which an axis without closed loop follows only as far as its motor can."""

    distance: Distance = Field(description="[microsteps], not 0")
    shape: Literal["ramp", "step"] = "ramp"


class DisturbanceStart(_ResponseStart):
    """Load the axis where it stands and record. On hardware nobody can but a hand: without `load_torque_nm` the
    recording waits for none and applies none."""

    load_torque_nm: Torque | None = Field(default=None, description="emulated axes: torque of the load [Nm]")
    load_s: Seconds | None = Field(default=None, description="how long it lasts [s]; null: half of `seconds`")


class Recording(Answer):
    """Columns of one length. `time_s` counts from the step, or from the beginning of the load."""

    time_s: list[float]
    target: list[float | None] = Field(description="XTARGET [microsteps]")
    commanded: list[float | None] = Field(description="XACTUAL [microsteps]")
    encoder: list[float | None] = Field(description="ENC_POS [microsteps]")
    deviation: list[float | None] = Field(description="encoder - commanded [microsteps]")
    velocity_pps: list[float | None]
    encoder_velocity_pps: list[float | None]
    load_angle_deg: list[float | None] = Field(description="electrical")
    load_torque_nm: list[float | None] = Field(description="as it was applied; null where nobody knows it")


class Score(Answer):
    """How well the encoder did. Distances in microsteps, times in seconds from the step or the load."""

    overshoot: float = Field(description="farthest beyond the target; after a load: on the rebound")
    overshoot_ratio: float | None = Field(description="of the distance; null for a load")
    arrival_s: float | None = Field(description="when the command was there; null for a load, or where it never was")
    settling_s: float | None = Field(description="from when on the encoder stays within `band`; null where it does not")
    rms: float = Field(description="of the deviation from the step or the load on")
    peak: float = Field(description="largest |deviation|")
    iae: float = Field(description="integral of |deviation| over time [microsteps s]")
    final_error: float = Field(description="encoder - target at the end")
    band: float


class ResponseState(Answer):
    """A step response or a disturbance: the one that runs, or the latest one."""

    state: ProcedureState
    phase: str
    progress: float
    message: str
    started_at_s: float | None = Field(description="device time of the step or the load [s]")
    recording: Recording | None
    score: Score | None
