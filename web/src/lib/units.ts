import type { Schemas } from "../api/client";
import type { Axis } from "../api/queries";

export type PositionUnit = Schemas["Move"]["unit"];
export type VelocityUnit = Schemas["Rotate"]["unit"];
export type AccelerationUnit = "pps2" | "chip" | "fullsteps_per_s2" | "rpm_per_s" | "rad_per_s2" | "mm_per_s2";
export type Unit = NonNullable<PositionUnit> | NonNullable<VelocityUnit> | AccelerationUnit | "s" | "Hz" | "";

/** How units are written beside a number. */
const SYMBOLS: Record<string, string> = {
  microsteps: "µsteps",
  fullsteps: "full steps",
  rev: "rev",
  deg: "°",
  rad: "rad",
  mm: "mm",
  pps: "pps",
  chip: "chip",
  internal: "internal",
  fullsteps_per_s: "fs/s",
  rpm: "rpm",
  rev_per_s: "rev/s",
  rev_per_s2: "rev/s²",
  rev_per_s3: "rev/s³",
  rpm_per_s2: "rpm/s²",
  rad_per_s: "rad/s",
  mm_per_s: "mm/s",
  pps2: "pps²",
  "pps^2": "pps²",
  pps3: "pps³",
  "pps^3": "pps³",
  fullsteps_per_s2: "fs/s²",
  fullsteps_per_s3: "fs/s³",
  rpm_per_s: "rpm/s",
  rad_per_s2: "rad/s²",
  mm_per_s2: "mm/s²",
  mm_per_s3: "mm/s³",
  deg_per_s: "°/s",
  deg_per_s2: "°/s²",
  deg_per_s3: "°/s³",
};

export function symbolOf(unit: string): string {
  return SYMBOLS[unit] ?? unit;
}

/** What unit conversions depend on: the motor, the gear, the travel, and how the chip is set now. */
export interface AxisScale {
  fullStepsPerRev: number;
  /** null while the chip's setting is unknown: then only microsteps and pps can be shown */
  microstepsPerFullStep: number | null;
  gearRatio: number;
  travelMmPerRev: number | null;
  pulseDiv: number | null;
  rampDiv: number | null;
  clockHz: number;
  /** false: velocities and accelerations are the device's own numbers, shown as they are */
  ratesKnown?: boolean;
}

export function scaleOf(axis: Axis | undefined, clockHz: number | undefined): AxisScale {
  return {
    fullStepsPerRev: axis?.full_steps_per_rev ?? 200,
    microstepsPerFullStep: axis?.microsteps_per_full_step ?? null,
    gearRatio: axis?.gear_ratio ?? 1,
    travelMmPerRev: axis?.travel_mm_per_rev ?? null,
    pulseDiv: axis?.pulse_div ?? null,
    rampDiv: axis?.ramp_div ?? null,
    clockHz: clockHz ?? 16e6,
    ratesKnown: axis?.rates_known ?? true,
  };
}

export type Motion = "position" | "velocity" | "acceleration" | "jerk";

interface UnitRow {
  motion: Motion;
  /** how many microsteps (per second, per second²) one of this unit is; null where this axis does not know it */
  factor: (scale: AxisScale) => number | null;
}

function perRev(scale: AxisScale): number | null {
  return scale.microstepsPerFullStep === null
    ? null
    : scale.fullStepsPerRev * scale.microstepsPerFullStep * scale.gearRatio;
}

function part(value: number | null, divisor: number | null): number | null {
  return value === null || divisor === null ? null : value / divisor;
}

const fullStep = (scale: AxisScale) => scale.microstepsPerFullStep;
const radian = (scale: AxisScale) => part(perRev(scale), 2 * Math.PI);
const millimetre = (scale: AxisScale) => part(perRev(scale), scale.travelMmPerRev);
const degree = (scale: AxisScale) => part(perRev(scale), 360);
const perMinute = (scale: AxisScale) => part(perRev(scale), 60);

/** pps of one unit of a velocity register: f / (2^pulse_div * 2048 * 32), TMC428 data sheet 8.14. */
function velocityUnit(scale: AxisScale): number | null {
  return scale.pulseDiv === null ? null : scale.clockHz / (2 ** scale.pulseDiv * 65536);
}

/** pps² of one unit of a_max: f² / 2^(pulse_div + ramp_div + 29), same section. */
function accelerationUnit(scale: AxisScale): number | null {
  return scale.pulseDiv === null || scale.rampDiv === null
    ? null
    : scale.clockHz ** 2 / 2 ** (scale.pulseDiv + scale.rampDiv + 29);
}

const ROWS: Record<string, UnitRow> = {
  microsteps: { motion: "position", factor: () => 1 },
  fullsteps: { motion: "position", factor: fullStep },
  rev: { motion: "position", factor: perRev },
  deg: { motion: "position", factor: degree },
  rad: { motion: "position", factor: radian },
  mm: { motion: "position", factor: millimetre },
  pps: { motion: "velocity", factor: () => 1 },
  fullsteps_per_s: { motion: "velocity", factor: fullStep },
  rpm: { motion: "velocity", factor: perMinute },
  rev_per_s: { motion: "velocity", factor: perRev },
  rad_per_s: { motion: "velocity", factor: radian },
  mm_per_s: { motion: "velocity", factor: millimetre },
  pps2: { motion: "acceleration", factor: () => 1 },
  "pps^2": { motion: "acceleration", factor: () => 1 },
  fullsteps_per_s2: { motion: "acceleration", factor: fullStep },
  rpm_per_s: { motion: "acceleration", factor: perMinute },
  rev_per_s2: { motion: "acceleration", factor: perRev },
  rad_per_s2: { motion: "acceleration", factor: radian },
  mm_per_s2: { motion: "acceleration", factor: millimetre },
  deg_per_s: { motion: "velocity", factor: degree },
  deg_per_s2: { motion: "acceleration", factor: degree },
  pps3: { motion: "jerk", factor: () => 1 },
  rev_per_s3: { motion: "jerk", factor: perRev },
  rpm_per_s2: { motion: "jerk", factor: perMinute },
  fullsteps_per_s3: { motion: "jerk", factor: fullStep },
  mm_per_s3: { motion: "jerk", factor: millimetre },
  deg_per_s3: { motion: "jerk", factor: degree },
};

/**
 * How many microsteps (pps, pps²) one of `unit` is. "chip" is a register's own unit and needs to know of what.
 * null: this axis cannot say (no travel, or the chip's setting is not known yet).
 */
export function factorOf(unit: string, scale: AxisScale, motion: Motion): number | null {
  if (scale.ratesKnown === false && motion !== "position") return unit === "internal" ? 1 : null;
  if (unit === "chip") {
    if (motion === "velocity") return velocityUnit(scale);
    return motion === "acceleration" ? accelerationUnit(scale) : 1;
  }
  const row = ROWS[unit];
  return row && row.motion === motion ? row.factor(scale) : null;
}

/** Microsteps, pps or pps² in `unit`; NaN where the axis cannot say. */
export function fromSteps(value: number, unit: string, scale: AxisScale, motion: Motion): number {
  const factor = factorOf(unit, scale, motion);
  return factor === null ? Number.NaN : value / factor;
}

/** The other way. */
export function toSteps(value: number, unit: string, scale: AxisScale, motion: Motion): number {
  const factor = factorOf(unit, scale, motion);
  return factor === null ? Number.NaN : value * factor;
}

/** A quantity as it was typed: in its own unit, so that nothing is lost on the way to the server. */
export interface Entry {
  value: number;
  unit: string;
}

/** An entry in another unit, to be shown there. */
export function entryIn({ value, unit: typedIn }: Entry, unit: string, scale: AxisScale, motion: Motion): number {
  return unit === typedIn ? value : fromSteps(toSteps(value, typedIn, scale, motion), unit, scale, motion);
}

/** The units in which this axis can express a motion, chip units first. Jerk has its units by the position's. */
export function unitsFor(motion: Exclude<Motion, "jerk">, scale: AxisScale): string[] {
  const all =
    motion === "position"
      ? ["microsteps", "fullsteps", "rev", "deg", "mm"]
      : motion === "velocity"
        ? ["pps", "chip", "fullsteps_per_s", "rpm", "rad_per_s", "mm_per_s"]
        : ["pps2", "chip", "fullsteps_per_s2", "rpm_per_s", "rad_per_s2", "mm_per_s2"];
  return all.filter((unit) => factorOf(unit, scale, motion) !== null);
}

/** The velocity and acceleration that go with a position unit; the device's own numbers where their unit is not known. */
export function ratesOf(
  position: string,
  { ratesKnown }: Pick<AxisScale, "ratesKnown">,
): { velocity: string; acceleration: string } {
  if (ratesKnown === false) return { velocity: "internal", acceleration: "internal" };
  switch (position) {
    case "fullsteps":
      return { velocity: "fullsteps_per_s", acceleration: "fullsteps_per_s2" };
    case "rev":
      return { velocity: "rpm", acceleration: "rpm_per_s" };
    case "deg":
      return { velocity: "rpm", acceleration: "rpm_per_s" };
    case "mm":
      return { velocity: "mm_per_s", acceleration: "mm_per_s2" };
    default:
      return { velocity: "pps", acceleration: "pps2" };
  }
}
