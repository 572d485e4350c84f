import { type Place, type Places, placeIn, type Rows, type Settings, settingsIn } from "../../lib/rows/settings";
import type { CurrentScale } from "./load";
import { AP } from "./names";

/** How a register counts speeds: in clocks between two of 256 microsteps a full step, or as the ramp generator does. */
export type Counting = "tstep" | "velocity";

export interface SpeedUnits {
  clockHz: number;
  microstepsPerFullStep: number;
}

const TSTEP_MAX = 2 ** 20 - 1;
/** Of a threshold that counts like the ramp generator the lowest bits are not compared. */
const COARSE = 2 ** 8;
const VELOCITY_MAX = 2 ** 23 - COARSE;

/** The speed of a threshold [pps]; 0 where it is 0. */
export function speedOf(raw: number, counting: Counting, { clockHz, microstepsPerFullStep }: SpeedUnits): number {
  if (raw === 0) return 0;
  return counting === "tstep" ? (clockHz * microstepsPerFullStep) / 256 / raw : (raw * clockHz) / 2 ** 24;
}

/** The register's nearest value to a speed [pps]; 0 for 0, and never 0 for anything else. */
export function thresholdFor(pps: number, counting: Counting, units: SpeedUnits): number {
  if (pps === 0) return 0;
  if (counting === "tstep") {
    const clocks = Math.round((units.clockHz * units.microstepsPerFullStep) / 256 / pps);
    return Math.min(TSTEP_MAX, Math.max(1, clocks));
  }
  const raw = Math.round((pps * 2 ** 24) / units.clockHz / COARSE) * COARSE;
  return Math.min(VELOCITY_MAX, Math.max(COARSE, raw));
}

interface Where extends Place {
  counting?: Counting;
  /** 0 switches it on */
  inverted?: boolean;
}

/** Where a chip keeps what the page sets: of several places the first that it has. */
const PLACES: Places<Where> = {
  [AP.stallThreshold]: [
    { register: "COOLCONF", field: "sgt" },
    { register: "SGCSCONF", field: "sgt" },
    { register: "SGTHRS" },
  ],
  [AP.stallFilter]: [
    { register: "COOLCONF", field: "sfilt" },
    { register: "SGCSCONF", field: "sfilt" },
  ],
  [AP.stopOnStall]: [{ register: "SW_MODE", field: "sg_stop" }],
  [AP.coolStart]: [
    { register: "COOLCONF", field: "semin" },
    { register: "SMARTEN", field: "semin" },
  ],
  [AP.coolWidth]: [
    { register: "COOLCONF", field: "semax" },
    { register: "SMARTEN", field: "semax" },
  ],
  [AP.coolUp]: [
    { register: "COOLCONF", field: "seup" },
    { register: "SMARTEN", field: "seup" },
  ],
  [AP.coolDown]: [
    { register: "COOLCONF", field: "sedn" },
    { register: "SMARTEN", field: "sedn" },
  ],
  [AP.coolMinimum]: [
    { register: "COOLCONF", field: "seimin" },
    { register: "SMARTEN", field: "seimin" },
  ],
  [AP.coolOn]: [
    { register: "TCOOLTHRS", counting: "tstep" },
    { register: "VCOOLTHRS", counting: "velocity" },
  ],
  [AP.coolOff]: [
    { register: "THIGH", counting: "tstep" },
    { register: "VHIGH", counting: "velocity" },
  ],
  [AP.stealthBelow]: [{ register: "TPWMTHRS", counting: "tstep" }],
  [AP.stealthGradient]: [
    { register: "GCONF", field: "en_pwm_mode" },
    { register: "GCONF", field: "en_spreadcycle", inverted: true },
  ],
  [AP.runCurrent]: [
    { register: "IHOLD_IRUN", field: "IRUN" },
    { register: "SGCSCONF", field: "CS" },
  ],
  [AP.scaler]: [{ register: "GLOBAL_SCALER" }],
};

/** Where the chip keeps `name`; null where it has no such thing. */
export function placeOf(chip: Pick<Rows, "spot">, name: string): Where | null {
  return placeIn(chip, PLACES, name);
}

/**
 * The speed from which on a threshold is passed: 0 clocks never are (data sheets of the TMC5130 and TMC5160, TCOOLTHRS
 * and THIGH), while a velocity of 0 always is (TMC5072, VCOOLTHRS and VHIGH).
 */
export function passedFrom(chip: Pick<Rows, "spot">, settings: Settings, name: string): number | null {
  const speed = settings.held(name);
  return speed === 0 && placeOf(chip, name)?.counting === "tstep" ? Number.POSITIVE_INFINITY : speed;
}

/** The registers of a chip as the settings of the page: speeds in pps. */
export function chipSettings(chip: Rows, units: SpeedUnits): Settings {
  return settingsIn(
    chip,
    PLACES,
    (raw, { counting, inverted }) =>
      inverted ? 1 - raw : counting === undefined ? raw : speedOf(raw, counting, units),
    (value, { counting, inverted }) =>
      inverted ? 1 - value : counting === undefined ? value : thresholdFor(value, counting, units),
  );
}

/** IRUN counts 32nds of what sense resistor and reference allow, which the chip does not know: shares, no amperes. */
export function chipCurrent(settings: Settings): CurrentScale {
  const scaler = settings.planned(AP.scaler);
  const step = (100 / 32) * (scaler === null || scaler === 0 ? 1 : scaler / 256);
  const run = settings.planned(AP.runCurrent);
  return {
    name: "current",
    step,
    run: run === null ? Number.NaN : step * (run + 1),
    unit: "% of full scale",
    symbol: "%",
    decimals: 0,
    most: 100,
    shares: false,
  };
}
