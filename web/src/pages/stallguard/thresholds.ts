import type { CurrentScale } from "./load";

/**
 * What CoolStep and StallGuard2 hang on, from axis parameters. Speeds are in pps where the module's unit mode (AP 255)
 * is pps. Document FM-PD42-1241 7.3 and chapter 4 in outline; the formula of the upper threshold is TMCM-1290's table.
 */
export interface Tuning {
  /** AP 172, 0..15: 0 switches CoolStep off */
  hysteresisStart: number | null;
  /** AP 170, 0..15 */
  hysteresis: number | null;
}

export const LOAD_MAX = 1023;
const STEP = 32;
const FIELD_MAX = 15;

/** The load value below which CoolStep raises the current; null while unknown, and where CoolStep is off. */
export function lowerLoad({ hysteresisStart }: Tuning): number | null {
  return hysteresisStart === null || hysteresisStart === 0 ? null : hysteresisStart * STEP;
}

/** The load value above which it lowers the current. */
export function upperLoad({ hysteresisStart, hysteresis }: Tuning): number | null {
  if (hysteresisStart === null || hysteresisStart === 0 || hysteresis === null) return null;
  return (hysteresisStart + hysteresis + 1) * STEP;
}

function field(value: number): number {
  return Math.max(0, Math.min(FIELD_MAX, Math.round(value)));
}

/** AP 172 for a lower threshold near `load`: at least 1, since 0 would switch CoolStep off. */
export function startFor(load: number): number {
  return Math.max(1, field(load / STEP));
}

/** AP 170 for an upper threshold near `load`. */
export function hysteresisFor(load: number, hysteresisStart: number): number {
  return field(load / STEP - hysteresisStart - 1);
}

/** Full scale of the module's current [A rms]: 3 A (FM-PD42-1241 1). */
export const MODULE_MAX_A = 3;

export interface CurrentSetting {
  /** AP 6, 0..255 of the module's full scale */
  run: number | null;
  /** AP 178: 0 is full scale, else n/256 */
  scaler: number | null;
}

/** The run current that is set [A rms]: 32 steps of AP 6, scaled by AP 178. */
export function runCurrentA({ run, scaler }: CurrentSetting): number {
  return run === null ? Number.NaN : currentA(Math.floor(run / 8), scaler);
}

/** The current of a scale of 0..31 (AP 180) [A rms]. */
export function currentA(scale: number, scaler: number | null): number {
  const global = scaler === null ? Number.NaN : scaler === 0 ? 1 : scaler / 256;
  return MODULE_MAX_A * global * ((scale + 1) / 32);
}

/** What the module's current scale stands for. */
export function moduleCurrent(setting: CurrentSetting): CurrentScale {
  return {
    name: "current, rms",
    step: currentA(0, setting.scaler), // of one count, and that of count 0
    run: runCurrentA(setting),
    unit: "A rms",
    symbol: "A",
    decimals: 2,
    most: MODULE_MAX_A,
    shares: true,
  };
}

export type Zone = "stealthchop" | "spreadcycle" | "coolstep" | "high speed";

export interface SpeedLimits {
  /** AP 186: StealthChop below */
  stealth: number | null;
  /** AP 187 above 0: StealthChop at all */
  stealthOn: boolean;
  /** AP 182: CoolStep above */
  coolOn: number | null;
  /** AP 22: CoolStep off above */
  coolOff: number | null;
  /** AP 172 above 0: CoolStep at all */
  coolStepOn: boolean;
}

/** Which of its modes the driver works in at a speed [pps]. Unknown limits leave SpreadCycle. */
export function zoneAt(speedPps: number, limits: SpeedLimits): Zone {
  const speed = Math.abs(speedPps);
  if (limits.coolOff !== null && speed >= limits.coolOff) return "high speed";
  if (limits.stealthOn && limits.stealth !== null && speed < limits.stealth) return "stealthchop";
  if (limits.coolStepOn && limits.coolOn !== null && speed >= limits.coolOn) return "coolstep";
  return "spreadcycle";
}
