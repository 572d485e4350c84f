"""Between the shapes of chopSync and dcStep and the calculator behind them, app/calc/tmc4361/driver_sync.py."""

from __future__ import annotations

from ....calc.tmc4361.driver_sync import chopsync, dcstep
from ...devices.views import calculating
from .sync_schemas import ChopSyncResult, DcStepResult, DriverSync, DriverSyncResult


def driver_sync(body: DriverSync) -> DriverSyncResult:
    with calculating():
        chopper = chopsync(
            body.chopsync_div,
            body.clock_hz,
            output_format=body.spi_output_format,
            pin=body.stdby_clk_pin_assignment,
            doubled=body.auto_double_chopsync,
            wanted_hz=body.wanted_hz,
        )
        steps = dcstep(
            body.clock_hz,
            mode=body.dcstep_mode,
            dc_vel_pps=body.dc_vel,
            microsteps=body.microsteps,
            full_steps_per_rev=body.full_steps_per_rev,
            dc_time=body.dc_time,
            dc_sg=body.dc_sg,
            blank=body.dc_blktime,
            slowest=body.dc_lsptm,
            output_format=body.spi_output_format,
            v_max_pps=body.v_max_pps,
        )
    return DriverSyncResult(chopsync=ChopSyncResult.model_validate(chopper), dcstep=DcStepResult.model_validate(steps))
