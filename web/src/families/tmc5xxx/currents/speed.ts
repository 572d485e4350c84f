/** TSTEP is counted in 20 bits; all of them set: it stands, or is slower than can be told. */
export const TSTEP_MOST = 2 ** 20 - 1;
/** VCOOLTHRS and VHIGH: velocity units, of which the lowest 8 bits are not compared. */
export const V_MOST = 2 ** 23 - 1;
export const V_GRAIN = 256;

export interface SpeedScale {
  clockHz: number;
  /** of a full step; TSTEP is always of 256 */
  microsteps: number;
  fullStepsPerTurn: number;
}

export type ThresholdKind = "tstep" | "velocity";

/** The speed at which steps are that many clocks apart [pps]. */
export function ppsOfTstep(tstep: number, { clockHz, microsteps }: SpeedScale): number {
  return tstep <= 0 ? Number.POSITIVE_INFINITY : (clockHz / tstep) * (microsteps / 256);
}

/** Clocks between two 256ths of a full step at that speed, as the register can hold it; 0 beyond every speed. */
export function tstepOfPps(pps: number, { clockHz, microsteps }: SpeedScale): number {
  if (!(pps > 0)) return TSTEP_MOST;
  if (!Number.isFinite(pps)) return 0;
  return Math.min(TSTEP_MOST, Math.max(1, Math.round((clockHz * microsteps) / (256 * pps))));
}

export function ppsOfVelocity(units: number, { clockHz }: SpeedScale): number {
  return (units * clockHz) / 2 ** 24;
}

export function velocityOfPps(pps: number, { clockHz }: SpeedScale): number {
  if (!(pps > 0)) return 0;
  const units = Math.round((pps * 2 ** 24) / clockHz / V_GRAIN) * V_GRAIN;
  return Math.min(V_MOST - (V_GRAIN - 1), Math.max(V_GRAIN, units));
}

/**
 * What a threshold register's value is as a speed [pps]; null where it is not known, and for a TSTEP of 0, which no
 * motor gets to. A velocity of 0 is passed always.
 */
export function ppsOf(kind: ThresholdKind, value: number | null, scale: SpeedScale): number | null {
  if (value === null) return null;
  if (kind === "velocity") return ppsOfVelocity(value, scale);
  return value === 0 ? null : ppsOfTstep(value, scale);
}

export function registerOf(kind: ThresholdKind, pps: number, scale: SpeedScale): number {
  return kind === "tstep" ? tstepOfPps(pps, scale) : velocityOfPps(pps, scale);
}

export function rpmOf(pps: number, { microsteps, fullStepsPerTurn }: SpeedScale): number {
  return (60 * pps) / (microsteps * fullStepsPerTurn);
}

/** The axis of speeds: logarithmic, from a turn in minutes to more than any motor does. */
export interface LogAxis {
  least: number;
  most: number;
}

export function axisFor({ microsteps, fullStepsPerTurn, clockHz }: SpeedScale): LogAxis {
  const turn = microsteps * fullStepsPerTurn;
  return { least: turn / 60, most: Math.min(clockHz / 2, turn * 50) };
}

/** Where a speed is on it, 0..1; what lies beyond stands at its ends. */
export function shareOf(pps: number, { least, most }: LogAxis): number {
  if (!(pps > 0)) return 0;
  return Math.min(1, Math.max(0, Math.log(pps / least) / Math.log(most / least)));
}

export function speedAt(share: number, { least, most }: LogAxis): number {
  return least * (most / least) ** share;
}

/** Round speeds for its ticks: 1, 2 and 5 of every decade [rpm], as pps. */
export function ticksOf(axis: LogAxis, scale: SpeedScale): { pps: number; rpm: number }[] {
  const perRpm = (scale.microsteps * scale.fullStepsPerTurn) / 60;
  const ticks: { pps: number; rpm: number }[] = [];
  for (let decade = -3; decade < 7; decade++)
    for (const digit of [1, 2, 5]) {
      const rpm = digit * 10 ** decade;
      const pps = rpm * perRpm;
      if (pps >= axis.least * 0.999 && pps <= axis.most * 1.001) ticks.push({ pps, rpm });
    }
  return ticks;
}

/** On which line each name stands, 0 next to the lanes, so that none covers another. Their ends are in pixels. */
export function linesOf(names: readonly { from: number; to: number }[]): number[] {
  const lines: number[] = [];
  for (const [index, name] of names.entries()) {
    const taken = names.slice(0, index).flatMap((other, at) => {
      const apart = other.to <= name.from || name.to <= other.from;
      return apart ? [] : [lines[at]];
    });
    let line = 0;
    while (taken.includes(line)) line++;
    lines.push(line);
  }
  return lines;
}

/** What the driver does at a speed, by its settings. */
export interface Modes {
  /** it is switched on: en_pwm_mode, or a PWM_AMPL of a TMC5072 */
  stealth: boolean;
  /** TPWMTHRS; null: none, or there is no such register */
  stealthBelow: number | null;
  coolAbove: number | null;
  highAbove: number | null;
  /** vhighchm, vhighfs */
  highChopper: boolean;
  highFullstep: boolean;
}

export interface Zone {
  from: number;
  to: number;
  name: string;
  kind: "stealth" | "spread" | "high" | "cool" | "off";
}

/**
 * The chopper over the axis, slow to fast. StealthChop ends at the first of the three thresholds: with CoolStep, and
 * above the high one, it is off (TMC5160 data sheet, 6.2, TCOOLTHRS and THIGH).
 */
export function chopperZones(modes: Modes, axis: LogAxis): Zone[] {
  const high = modes.highChopper || modes.highFullstep ? (modes.highAbove ?? axis.most) : axis.most;
  const ends = [modes.stealthBelow, modes.coolAbove, modes.highAbove].map((end) => end ?? axis.most);
  const stealth = modes.stealth ? Math.min(...ends) : axis.least;
  const name = [modes.highFullstep && "full steps", modes.highChopper && "constant off time"]
    .filter(Boolean)
    .join(", ");
  return kept(
    [
      { from: axis.least, to: stealth, name: "StealthChop", kind: "stealth" },
      { from: Math.max(axis.least, stealth), to: high, name: "SpreadCycle", kind: "spread" },
      { from: high, to: axis.most, name, kind: "high" },
    ],
    axis,
  );
}

/** CoolStep and StallGuard over the axis: between the two thresholds. */
export function coolZones(modes: Modes, axis: LogAxis): Zone[] {
  const to = modes.highAbove ?? axis.most;
  if (modes.coolAbove === null || modes.coolAbove >= to)
    return [{ from: axis.least, to: axis.most, name: "off", kind: "off" }];
  return kept(
    [
      { from: axis.least, to: modes.coolAbove, name: "off", kind: "off" },
      { from: modes.coolAbove, to, name: "CoolStep, StallGuard", kind: "cool" },
      { from: to, to: axis.most, name: "off", kind: "off" },
    ],
    axis,
  );
}

function kept(zones: Zone[], axis: LogAxis): Zone[] {
  return zones
    .map((zone) => ({ ...zone, from: Math.max(axis.least, zone.from), to: Math.min(axis.most, zone.to) }))
    .filter(({ from, to }) => to > from);
}
