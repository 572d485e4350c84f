"""Shapes of chopSync and dcStep of a TMC4361: registers, and what they come to."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from ...schemas import Answer, Body, Flag

Byte = Annotated[int, Field(strict=True, ge=0, le=255)]


class DriverSync(Body):
    """Registers as they are planned."""

    clock_hz: Annotated[float, Field(strict=True, ge=4.2e6, le=32e6, allow_inf_nan=False)] = 16e6
    spi_output_format: Annotated[int, Field(strict=True, ge=0, le=15)] = 0
    chopsync_div: Annotated[int, Field(strict=True, ge=0, le=4095)] = 640
    auto_double_chopsync: Flag = False
    stdby_clk_pin_assignment: Annotated[int, Field(strict=True, ge=0, le=3)] = 0
    wanted_hz: Annotated[float, Field(strict=True, ge=1e3, le=1e6, allow_inf_nan=False)] | None = Field(
        default=None, description="a clock of the chopper to find a divider for"
    )
    dcstep_mode: Annotated[int, Field(strict=True, ge=0, le=3)] = 0
    dc_vel: Annotated[int, Field(strict=True, ge=0, lt=1 << 24)] = Field(default=0, description="pps")
    dc_time: Byte = 0
    dc_sg: Byte = 0
    dc_blktime: Annotated[int, Field(strict=True, ge=0, lt=1 << 16)] = 0
    dc_lsptm: Annotated[int, Field(strict=True, ge=0, lt=1 << 32)] = 0xFFFFFF
    microsteps: Annotated[int, Field(strict=True, ge=1, le=256)] = 256
    full_steps_per_rev: Annotated[int, Field(strict=True, ge=1, le=4095)] = 200
    v_max_pps: Annotated[float, Field(strict=True, ge=0, allow_inf_nan=False)] = Field(
        default=0, description="0: not known"
    )


class ChopSyncResult(Answer):
    hz: float
    rest_hz: float = Field(description="at standstill")
    nearest_div: int = Field(description="for wanted_hz")
    warnings: list[str]


class DcStepResult(Answer):
    full_steps_per_s: float = Field(description="at DC_VEL")
    full_step_s: float | None = Field(description="there; null where DC_VEL is 0")
    least_full_steps_per_s: float | None = Field(description="by DC_LSPTM; null where that is 0")
    rpm: float
    least_rpm: float | None
    on_time_s: float
    lost_s: float
    blank_s: float
    warnings: list[str]


class DriverSyncResult(Answer):
    chopsync: ChopSyncResult
    dcstep: DcStepResult
