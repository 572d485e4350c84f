import { duration, fixed, rounded } from "../format";
import { type AxisScale, factorOf, type Motion } from "../units";

/** In what a ramp is read and typed: one unit of way, and by it those of velocity, acceleration and jerk. */
export interface Units {
  key: string;
  label: string;
  position: string;
  velocity: string;
  acceleration: string;
  jerk: string;
}

const ALL: readonly Units[] = [
  { key: "pps", label: "pps", position: "microsteps", velocity: "pps", acceleration: "pps2", jerk: "pps3" },
  {
    key: "fullsteps",
    label: "full steps",
    position: "fullsteps",
    velocity: "fullsteps_per_s",
    acceleration: "fullsteps_per_s2",
    jerk: "fullsteps_per_s3",
  },
  {
    key: "rev",
    label: "turns",
    position: "rev",
    velocity: "rev_per_s",
    acceleration: "rev_per_s2",
    jerk: "rev_per_s3",
  },
  { key: "rpm", label: "rpm", position: "rev", velocity: "rpm", acceleration: "rpm_per_s", jerk: "rpm_per_s2" },
  {
    key: "deg",
    label: "degrees",
    position: "deg",
    velocity: "deg_per_s",
    acceleration: "deg_per_s2",
    jerk: "deg_per_s3",
  },
  { key: "mm", label: "mm", position: "mm", velocity: "mm_per_s", acceleration: "mm_per_s2", jerk: "mm_per_s3" },
];

/** The units that this axis knows: no millimetres without a travel, nothing but pps without the microsteps. */
export function unitChoices(scale: AxisScale): readonly Units[] {
  return ALL.filter((units) => factorOf(units.position, scale, "position") !== null);
}

export function unitsOf(key: string, scale: AxisScale): Units {
  const known = unitChoices(scale);
  return known.find((units) => units.key === key) ?? (known[0] as Units);
}

/** How many pps (pps², pps³, microsteps) one of the unit is. */
export function factor(motion: Motion, units: Units, scale: AxisScale): number {
  return factorOf(units[motion], scale, motion) ?? 1;
}

/** A time as people read it, without the dust of sums: 100 ms and not 100.0 ms. */
export function time(seconds: number): string {
  return duration(rounded(seconds, 9));
}

/** Tick labels of large numbers: 2.5 M instead of 2 500 000, all ticks of an axis alike. */
export function engineering(values: readonly (number | null)[]): string[] {
  const numbers = values.filter((value): value is number => value !== null);
  const most = Math.max(0, ...numbers.map(Math.abs));
  const [unit, symbol] = most >= 2e9 ? [1e9, "G"] : most >= 2e6 ? [1e6, "M"] : most >= 2e4 ? [1e3, "k"] : [1, ""];
  const thin = symbol === "" ? "" : "\u202f";
  return values.map((value) => {
    if (value === null) return "";
    if (value === 0) return "0";
    const scaled = rounded(value / unit, 6);
    const decimals = (String(scaled).split(".")[1] ?? "").length;
    return `${fixed(scaled, decimals)}${thin}${symbol}`;
  });
}
