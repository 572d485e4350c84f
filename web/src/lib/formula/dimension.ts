import { symbolOf } from "../units";

/** Powers of step, second, ampere, volt and kelvin. */
export type Dimension = readonly [step: number, s: number, ampere: number, volt: number, kelvin: number];

export const NUMBER: Dimension = [0, 0, 0, 0, 0];
export const SECOND: Dimension = [0, 1, 0, 0, 0];
export const PER_SECOND: Dimension = [0, -1, 0, 0, 0];

/** The units in which devices give samples, and how many of the dimension's own unit each is. */
const UNITS: Readonly<Record<string, readonly [Dimension, factor: number]>> = {
  microsteps: [[1, 0, 0, 0, 0], 1],
  pps: [[1, -1, 0, 0, 0], 1],
  "pps^2": [[1, -2, 0, 0, 0], 1],
  pps2: [[1, -2, 0, 0, 0], 1],
  s: [SECOND, 1],
  ms: [SECOND, 1e-3],
  Hz: [PER_SECOND, 1],
  A: [[0, 0, 1, 0, 0], 1],
  mA: [[0, 0, 1, 0, 0], 1e-3],
  V: [[0, 0, 0, 1, 0], 1],
  mV: [[0, 0, 0, 1, 0], 1e-3],
  K: [[0, 0, 0, 0, 1], 1],
};

/** What is measured in `unit`. Registers without one, and units that nothing is known of, are plain numbers. */
export function dimensionOf(unit: string): { dimension: Dimension; factor: number } {
  const [dimension, factor] = UNITS[unit] ?? [NUMBER, 1];
  return { dimension, factor };
}

export const same = (one: Dimension, other: Dimension) => one.every((power, index) => power === other[index]);
const map = (one: Dimension, of: (power: number, index: number) => number) => one.map(of) as unknown as Dimension;
export const times = (one: Dimension, other: Dimension) => map(one, (power, index) => power + (other[index] ?? 0));
export const raised = (one: Dimension, by: number) => map(one, (power) => power * by);
export const isNumber = (one: Dimension) => same(one, NUMBER);

const NAMES = ["µstep", "s", "A", "V", "K"] as const;
const SMALL = "⁰¹²³⁴⁵⁶⁷⁸⁹";

function power(of: number): string {
  if (of === 1) return "";
  const text = [...String(of).replace("-", "")].map((digit) => SMALL[Number(digit)] ?? (digit === "." ? "·" : digit));
  return `${of < 0 ? "⁻" : ""}${text.join("")}`;
}

/** As it is written beside a number; "" for a plain number. */
export function unitText(dimension: Dimension): string {
  const known = Object.entries(UNITS).find(([, [of, factor]]) => factor === 1 && same(of, dimension));
  if (known) return symbolOf(known[0]);
  return NAMES.flatMap((name, index) => (dimension[index] ? [`${name}${power(dimension[index])}`] : [])).join("·");
}

/** In words, for a message. */
export function dimensionText(dimension: Dimension): string {
  return isNumber(dimension) ? "a plain number" : unitText(dimension);
}
