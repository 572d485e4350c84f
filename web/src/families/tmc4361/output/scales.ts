import type { Schemas } from "../../../api/client";
import type { ChipRows } from "../../../lib/rows/useChipRows";
import { designOf } from "../sramp/chip";
import { OPTIONS, rampParameters, START, showingDistance } from "../sramp/design";

export type Scales = Schemas["CurrentScales"];
export type Course = Schemas["DriveCurrentResult"];
type Planned = Pick<ChipRows, "planned">;

/** Where each setting of the calculator is in the chip. */
const FLAGS = {
  hold_en: "hold_current_scale_en",
  drive_en: "drive_current_scale_en",
  boost_on_acceleration: "boost_current_on_acc_en",
  boost_on_deceleration: "boost_current_on_dec_en",
  boost_after_start: "boost_current_after_start_en",
  drive_2_en: "sec_drive_current_scale_en",
  freewheeling_en: "freewheeling_en",
} as const;
const SCALES = {
  boost: "boost_scale_val",
  drive: "drv1_scale_val",
  drive_2: "drv2_scale_val",
  hold: "hold_scale_val",
} as const;
const TIMES = {
  drive_2_above_pps: "VDRV_SCALE_LIMIT",
  up_delay: "UP_SCALE_DELAY",
  hold_delay: "HOLD_SCALE_DELAY",
  drive_delay: "DRV_SCALE_DELAY",
  boost_time: "BOOST_TIME",
  standby_delay: "STDBY_DELAY",
  freewheel_delay: "FREEWHEEL_DELAY",
} as const;

/** The current settings as they will be once what is staged is applied; null until all of them are known. */
export function scalesOf(chip: Planned): Scales | null {
  const found: Record<string, number | boolean> = {};
  for (const [name, field] of Object.entries(FLAGS)) {
    const value = chip.planned("CURRENT_CONF", field);
    if (value === null) return null;
    found[name] = value === 1;
  }
  for (const [name, field] of Object.entries(SCALES)) {
    const value = chip.planned("SCALE_VALUES", field);
    if (value === null) return null;
    found[name] = value;
  }
  for (const [name, register] of Object.entries(TIMES)) {
    const value = chip.planned(register);
    if (value === null) return null;
    found[name] = value;
  }
  return found as unknown as Scales;
}

const RAMP = [
  ...["VMAX", "AMAX", "DMAX", "BOW1", "BOW2", "BOW3", "BOW4"],
  ...["VSTART", "VSTOP", "VBREAK", "ASTART", "DFINAL"],
];
const RAMP_FIELDS = [
  ["RAMPMODE", "RAMP_PROFILE"],
  ["GENERAL_CONF", "use_astart_and_vstart"],
  ["GENERAL_CONF", "direct_acc_val_en"],
  ["GENERAL_CONF", "direct_bow_val_en"],
] as const;

export interface Move {
  parameters: Record<string, number | string>;
  /** a distance on which every phase of it can be seen [microsteps] */
  showing: number;
  /** the chip holds no ramp: it is one that the designer of ramps begins with */
  assumed: boolean;
}

/** The ramp that the chip holds, with what is staged; null where it holds none. */
export function heldRamp(chip: Planned, clockHz: number): ReturnType<typeof designOf> {
  const held = new Map<string, number>();
  const put = (name: string, value: number | null) => value !== null && held.set(name, value);
  for (const register of RAMP) put(register, chip.planned(register));
  for (const [register, field] of RAMP_FIELDS) put(field, chip.planned(register, field));
  return designOf(held, clockHz);
}

/** The ramp that the chip holds, as the calculator takes it. */
export function moveOf(chip: Planned, clockHz: number): Move {
  const found = heldRamp(chip, clockHz);
  const { design, options } = found ?? { design: START, options: OPTIONS };
  return {
    parameters: rampParameters(design, { ...options, mode: "position" }, clockHz, 1),
    showing: showingDistance(design),
    assumed: found === null,
  };
}

export interface SituationRow {
  situation: string;
  scale: string;
  fromS: number;
  untilS: number;
}

/** The times of a course for people: what is asked for, and how far the scale gets. */
export function rowsOf({ stretches }: Pick<Course, "stretches">): SituationRow[] {
  return stretches.map(({ situation, scale_from, scale_to, start_s, end_s }) => ({
    situation,
    scale:
      situation === "freewheeling"
        ? "off"
        : scale_from === scale_to
          ? String(scale_to)
          : `${scale_from} to ${scale_to}`,
    fromS: start_s,
    untilS: end_s,
  }));
}

export type Pwm = Schemas["PwmDuty"];

/** The PWM settings with what is staged; null until all of them are known. */
export function pwmOf(chip: Planned, clockHz: number, speedPps: number): Pwm | null {
  const [period, amplitude, full, scales] = [
    chip.planned("PWM_FREQ"),
    chip.planned("CURRENT_CONF", "pwm_ampl"),
    chip.planned("PWM_VMAX"),
    chip.planned("CURRENT_CONF", "pwm_scale_en"),
  ];
  if (period === null || amplitude === null || full === null || scales === null || period < 1) return null;
  return {
    period_clocks: period,
    amplitude,
    full_at_pps: full,
    offset: chip.planned("MSOFFSET") ?? 0,
    scales: scales === 1,
    clock_hz: clockHz,
    speed_pps: speedPps,
    samples: 200,
  };
}
