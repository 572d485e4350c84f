import type { Schemas } from "../../../api/client";
import type { ChipRows } from "../../../lib/rows/useChipRows";

export type SyncQuestion = Schemas["DriverSync"];
type Reader = Pick<ChipRows, "planned">;

export const TIMES = "DC_TIME___DC_SG___DC_BLKTIME";
const SHIFT_MOST = 8;

interface Motor {
  clockHz: number;
  fullStepsPerRev: number;
  wantedHz: number | null;
}

/** What is planned, as a question of the calculator. What cannot be read back counts as after power-on. */
export function syncQuestion(chip: Reader, { clockHz, fullStepsPerRev, wantedHz }: Motor): SyncQuestion {
  const read = (register: string, field?: string, unread = 0) => chip.planned(register, field) ?? unread;
  const divider = read("CHOPSYNC_DIV", undefined, 640) & 0xfff;
  return {
    clock_hz: clockHz,
    spi_output_format: read("SPI_OUT_CONF", "spi_output_format"),
    chopsync_div: divider,
    auto_double_chopsync: read("SPI_OUT_CONF", "auto_double_chopsync") === 1,
    stdby_clk_pin_assignment: read("GENERAL_CONF", "stdby_clk_pin_assignment"),
    wanted_hz: wantedHz,
    dcstep_mode: read("GENERAL_CONF", "dcstep_mode"),
    dc_vel: read("DC_VEL"),
    dc_time: read(TIMES, "DC_TIME"),
    dc_sg: read(TIMES, "DC_SG"),
    dc_blktime: read(TIMES, "DC_BLKTIME"),
    dc_lsptm: read("DC_LSPTM", undefined, 0xffffff),
    microsteps: 256 >> Math.min(read("STEP_CONF", "mstep_per_fs"), SHIFT_MOST),
    full_steps_per_rev: fullStepsPerRev,
    v_max_pps: Math.abs(read("VMAX")) / 256,
  };
}

/** DC_LSPTM for a lowest rate of full steps. */
export function slowestClocks(fullStepsPerS: number, clockHz: number): number {
  return Math.min(2 ** 32 - 1, Math.max(1, Math.round(clockHz / fullStepsPerS)));
}

/** DC_VEL for a speed of the shaft. */
export function dcVelocity(rpm: number, microsteps: number, fullStepsPerRev: number): number {
  return Math.min(2 ** 24 - 1, Math.max(0, Math.round((rpm / 60) * microsteps * fullStepsPerRev)));
}
