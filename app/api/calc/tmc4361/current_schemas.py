"""Shapes of the current scales and PWM outputs of a TMC4361: over a planned move, over speed and electrical turn."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from ...schemas import Answer, Body, Flag
from ..schemas import Phase, Ramp

Scale = Annotated[int, Field(strict=True, ge=0, le=255)]
Clocks = Annotated[int, Field(strict=True, ge=0, le=2**24 - 1)]
LongClocks = Annotated[int, Field(strict=True, ge=0, le=2**32 - 1)]
ChipClock = Annotated[float, Field(strict=True, ge=4.2e6, le=32e6, allow_inf_nan=False)]
Pps = Annotated[int, Field(strict=True, ge=0, le=2**24 - 1)]


class CurrentScales(Body):
    """CURRENT_CONF, SCALE_VALUES and the delays of an open loop, as the registers hold them."""

    boost: Scale = Field(default=255, description="BOOST_SCALE_VAL")
    drive: Scale = Field(default=255, description="DRV1_SCALE_VAL")
    drive_2: Scale = Field(default=255, description="DRV2_SCALE_VAL")
    hold: Scale = Field(default=255, description="HOLD_SCALE_VAL")
    hold_en: Flag = Field(default=False, description="hold_current_scale_en")
    drive_en: Flag = Field(default=False, description="drive_current_scale_en; without it the scale in motion is 255")
    boost_on_acceleration: Flag = Field(default=False, description="boost_current_on_acc_en")
    boost_on_deceleration: Flag = Field(default=False, description="boost_current_on_dec_en")
    boost_after_start: Flag = Field(default=False, description="boost_current_after_start_en")
    drive_2_en: Flag = Field(default=False, description="sec_drive_current_scale_en")
    freewheeling_en: Flag = False
    drive_2_above_pps: Pps = Field(default=0, description="VDRV_SCALE_LIMIT [pps]")
    up_delay: Clocks = Field(default=0, description="UP_SCALE_DELAY [clocks a step]; 0: at once")
    hold_delay: Clocks = Field(default=0, description="HOLD_SCALE_DELAY [clocks a step]")
    drive_delay: Clocks = Field(default=0, description="DRV_SCALE_DELAY [clocks a step]")
    boost_time: Clocks = Field(default=0, description="BOOST_TIME [clocks]")
    standby_delay: LongClocks = Field(default=0, description="STDBY_DELAY [clocks]")
    freewheel_delay: LongClocks = Field(default=0, description="FREEWHEEL_DELAY [clocks]")


class DriveCurrent(Body):
    """A motion and the current scales that it is made with."""

    ramp: Ramp = Field(description='of model "s_ramp": the motion, from rest')
    scales: CurrentScales
    clock_hz: ChipClock = Field(default=16e6, description="fCLK [Hz]")
    full_scale_rms_a: Annotated[float, Field(strict=True, gt=0, le=1000, allow_inf_nan=False)] | None = Field(
        default=None, description="coil current of the driver at scale 255, RMS [A]; null: not known"
    )


class ScaleStretch(Answer):
    """A time in which one scale is asked for."""

    start_s: float
    end_s: float
    situation: Literal["drive", "drive 2", "boost", "hold", "freewheeling"]
    scale_from: int
    scale_to: int
    wanted: int


class DriveCurrentResult(Answer):
    """The scale and the current over the motion and the rest after it."""

    motion_s: float = Field(description="when the motor is at rest [s]")
    duration_s: float
    time_s: list[float]
    velocity_pps: list[float]
    scale: list[float] = Field(description="0..255; -1 where the bridges are open")
    current_rms_a: list[float] | None = Field(description="of a coil, RMS [A]; null without a full scale")
    mean_square: float = Field(description="of (scale + 1) / 256 in motion: what heats the coils, of full scale's heat")
    rest_square: float = Field(description="the same at the end of the time: what heats the coils at rest")
    scale_at_first: int
    stretches: list[ScaleStretch]
    phases: list[Phase]
    findings: list[str]


class PwmDuty(Body):
    """PWM outputs, and the speed at which their duty is looked at."""

    period_clocks: Annotated[int, Field(strict=True, ge=1, le=0xFFFF)] = Field(
        default=0x280, description="PWM_FREQ [clocks]"
    )
    amplitude: Annotated[int, Field(strict=True, ge=0, le=0xFFFF)] = Field(default=0, description="PWM_AMPL")
    full_at_pps: Pps = Field(default=0, description="PWM_VMAX [pps]")
    offset: Annotated[int, Field(strict=True, ge=0, le=1023)] = Field(default=0, description="MS_OFFSET")
    scales: Flag = Field(default=False, description="pwm_scale_en")
    clock_hz: ChipClock = 16e6
    speed_pps: Annotated[float, Field(strict=True, ge=0, le=1.6e7, allow_inf_nan=False)] = Field(
        default=0.0, description="at which the duty over the turn is told [pps]"
    )
    samples: Annotated[int, Field(strict=True, ge=2, le=2000)] = 200


class PwmDutyResult(Answer):
    frequency_hz: float
    steps: int = Field(description="duties that there are: whole clocks of the period")
    speed_pps: list[float]
    amplitude: list[float] = Field(description="of the duty over speed, 0..0.5")
    place: list[int] = Field(description="in the electrical turn, 0..1023")
    duty_a: list[float]
    duty_b: list[float] = Field(
        description="share of the period in which an output is high, at the `speed_pps` asked for"
    )
    amplitude_there: float
    findings: list[str]
