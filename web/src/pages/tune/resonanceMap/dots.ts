import type { Schemas } from "../../../api/client";
import { compact } from "../../../lib/format";
import type { PlotData } from "../../../plots/series";

export type ResonanceFound = Schemas["ResonanceFound"];
export type Change = ResonanceFound["changes"][number];

/** The map cividis, dark to light: alike to all eyes (Nunez, Anderton, Renslow 2018). */
export const CIVIDIS = ["#00224e", "#35456c", "#666970", "#948e77", "#c8b866", "#fee838"] as const;

/** The amplitude of one order at one speed; places are shares of the plot, from its lower left corner. */
export interface Dot {
  /** of the speed, from the slowest */
  column: number;
  /** of the order, from the first */
  row: number;
  order: number;
  speed: number;
  frequency: number;
  amplitude: number;
  x: number;
  y: number;
  /** 0 to 1 of the greatest, by the root */
  level: number;
}

export interface Campbell {
  dots: Dot[];
  /** of the resonance, above the lower edge; null: none was told, or it lies outside */
  resonance: number | null;
  /** what stands at the axes */
  speeds: Tick[];
  frequencies: Tick[];
  greatest: number;
}

export interface Tick {
  at: number;
  label: string;
}

/** 1, 2 and 5 times each power of ten between both. */
function ticks(low: number, high: number, place: (value: number) => number): Tick[] {
  const found: Tick[] = [];
  for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); power++)
    for (const digit of [1, 2, 5]) {
      const value = digit * 10 ** power;
      if (value >= low && value <= high) found.push({ at: place(value), label: compact(value, 2) });
    }
  return found;
}

/** A place for each value between both ends, by its logarithm, with a margin. */
function placing(low: number, high: number): (value: number) => number {
  const width = Math.log(high / low) || 1;
  return (value) => 0.04 + (0.92 * Math.log(value / low)) / width;
}

/** All that the plot shows, the weakest dots first; null while there is nothing. */
export function campbellOf({ points, orders, resonance_hz: resonance }: ResonanceFound): Campbell | null {
  const told = points.filter(({ electrical_hz: hz }) => hz > 0);
  const frequencies = told.flatMap(({ electrical_hz: hz }) => orders.map((order) => order * hz));
  if (told.length === 0 || frequencies.length === 0) return null;
  const speeds = told.map(({ speed_rps: speed }) => speed);
  const [slowest, fastest] = [Math.min(...speeds), Math.max(...speeds)];
  const [low, high] = [Math.min(...frequencies), Math.max(...frequencies)];
  const [across, up] = [placing(slowest, fastest), placing(low, high)];
  const greatest = Math.max(0, ...told.flatMap(({ amplitudes_deg: all }) => all.map((one) => one ?? 0))) || 1;
  const dots = told.flatMap(({ speed_rps: speed, electrical_hz: hz, amplitudes_deg: amplitudes }, column) =>
    orders.flatMap((order, row) => {
      const amplitude = amplitudes[row] ?? null;
      if (amplitude === null) return [];
      const frequency = order * hz;
      const level = Math.sqrt(amplitude / greatest);
      return [{ column, row, order, speed, frequency, amplitude, x: across(speed), y: up(frequency), level }];
    }),
  );
  const at = resonance === null || resonance.value < low || resonance.value > high ? null : up(resonance.value);
  return {
    dots: dots.sort((one, other) => one.level - other.level),
    resonance: at,
    speeds: ticks(slowest, fastest, across),
    frequencies: ticks(low, high, up),
    greatest,
  };
}

export function colourOf({ level }: Pick<Dot, "level">): string {
  return CIVIDIS[Math.min(Math.floor(level * CIVIDIS.length), CIVIDIS.length - 1)] ?? CIVIDIS[0];
}

/** A dot in words. */
export function saidOf({ order, speed, frequency, amplitude }: Dot): string {
  return `order ${order} at ${compact(speed, 3)} turns/s, ${compact(frequency, 3, "Hz")}: ${compact(amplitude, 3)}°`;
}

const STEPS: Readonly<Record<string, readonly [column: number, row: number]>> = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowDown: [0, -1],
  ArrowUp: [0, 1],
};

/** The dot where an arrow key leads: the next one in its line or its column; the same where there is none. */
export function walked(dots: readonly Dot[], from: Dot | null, key: string): Dot | null {
  const step = STEPS[key];
  if (step === undefined) return from;
  if (from === null) return dots.at(-1) ?? null;
  const ahead = (dot: Dot) => (dot.column - from.column) * step[0] + (dot.row - from.row) * step[1];
  const inLine = dots.filter((dot) => (step[0] === 0 ? dot.column === from.column : dot.row === from.row));
  const next = inLine.filter((dot) => ahead(dot) > 0).sort((one, other) => ahead(one) - ahead(other));
  return next[0] ?? from;
}

/** Ripple over speed, without a change and with it. */
export function changeOf({ points }: Change): PlotData {
  return [
    points.map(({ speed_rps: speed }) => speed),
    points.map(({ before_deg: before }) => before),
    points.map(({ after_deg: after }) => after),
  ];
}
