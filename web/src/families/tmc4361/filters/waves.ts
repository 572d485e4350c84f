import type { Schemas } from "../../../api/client";
import { coordinate, exactText, rounded } from "../../../lib/format";

export type Bounds = Schemas["FilterBounds"];
export type Filtered = Schemas["InputFilterResult"];
export type Filters = Schemas["InputFilters"];
export type FilterGroup = Schemas["FilterGroup"];

export interface Setting {
  /** SR: a sample every 2^SR clocks */
  sampleRate: number;
  /** FILT_L: so many equal samples and one more */
  length: number;
}

export function periodOf(sampleRate: number): number {
  return 2 ** sampleRate;
}

/** Clocks of a level that always gets through. */
export function passedOf({ sampleRate, length }: Setting): number {
  return (length + 1) * periodOf(sampleRate);
}

/** Levels of so many clocks, from the clocks at which they change. */
export function levelsOf(edges: readonly number[], clocks: number, first = 0): number[] {
  const levels = new Array<number>(clocks).fill(first);
  let level = first;
  edges.forEach((edge, index) => {
    level = 1 - level;
    levels.fill(level, edge, edges[index + 1] ?? clocks);
  });
  return levels;
}

/** The clocks at which a waveform changes. */
export function edgesOf(levels: readonly number[]): number[] {
  const edges: number[] = [];
  for (let clock = 1; clock < levels.length; clock++) if (levels[clock] !== levels[clock - 1]) edges.push(clock);
  return edges;
}

/** When a switch changes, in shares of what always gets through: it bounces as it closes and as it opens. */
const BOUNCES = [1.5, 1.85, 2.2, 2.45, 2.95, 3.1, 3.4, 8, 8.4, 8.7, 8.9, 9.3] as const;
const BOUNCE_SPAN = 13;
/** A long level with short disturbances on both sides of what gets through, each as a share of that. */
const GLITCHES = [
  [1, 0.25],
  [3, 0.6],
  [5, 0.95],
  [7.5, 1.05],
  [10.5, 1.6],
] as const;
const GLITCH_SPAN = 13.5;

export type Example = "bounce" | "glitches";

/** An example that fits the filter: its stretches are shares of what the filter lets through, whole clocks all. */
export function exampleOf(kind: Example, setting: Setting): number[] {
  const unit = Math.max(4, passedOf(setting));
  const clocks = Math.round(unit * (kind === "bounce" ? BOUNCE_SPAN : GLITCH_SPAN));
  const wanted =
    kind === "bounce"
      ? BOUNCES.map((share) => share * unit)
      : GLITCHES.flatMap(([from, width]) => [from * unit, (from + width) * unit]);
  const edges: number[] = [];
  for (const place of wanted) edges.push(Math.max((edges.at(-1) ?? 0) + 1, Math.round(place)));
  return levelsOf(edges, clocks);
}

/** The stretch that one stroke of the pen sets: a clock where there are few, more where a clock is too small to hit. */
export function cellOf(clocks: number): number {
  return 2 ** Math.max(0, Math.ceil(Math.log2(clocks / 160)));
}

/** `levels` with the cells from one clock to another set to `level`. */
export function painted(levels: readonly number[], from: number, to: number, level: number): number[] {
  const cell = cellOf(levels.length);
  const low = Math.floor(Math.min(from, to) / cell) * cell;
  const high = (Math.floor(Math.max(from, to) / cell) + 1) * cell;
  return levels.map((old, clock) => (clock >= low && clock < high ? level : old));
}

export interface Passed {
  /** clock of the edge at the pin, and of the edge behind the filter */
  from: number;
  to: number;
}

export interface Stopped {
  from: number;
  to: number;
}

/** What became of the edges of a pin: those that got through, and pulses that did not. */
export function fates(result: Pick<Filtered, "input" | "output" | "bounds">): { passed: Passed[]; stopped: Stopped[] } {
  const { input, output, bounds } = result;
  const inputEdges = edgesOf(input);
  const passed: Passed[] = [];
  for (const to of edgesOf(output)) {
    const level = output[to];
    // The level was there when the first of the samples that decided was taken: the latest edge to it before that.
    const latest = to - bounds.stopped_clocks;
    const from = inputEdges.filter((edge) => edge <= latest && input[edge] === level).at(-1);
    if (from !== undefined) passed.push({ from, to });
  }
  // A pulse that gets through does so at a sample of its own: while it lasts.
  const stopped = inputEdges.flatMap((from, index): Stopped[] => {
    const to = inputEdges[index + 1];
    const level = input[from];
    if (to === undefined || output.slice(from - 1, to).some((behind) => behind === level)) return [];
    return [{ from, to }];
  });
  return { passed, stopped };
}

/** A waveform as an SVG path: `x` and `y` are the places of clocks and levels. */
export function wavePath(
  levels: readonly number[],
  x: (clock: number) => number,
  y: (level: number) => number,
): string {
  const first = levels[0] ?? 0;
  let path = `M${coordinate(x(0))} ${y(first)}`;
  for (const edge of edgesOf(levels)) path += `H${coordinate(x(edge))}V${y(levels[edge] ?? 0)}`;
  return `${path}H${coordinate(x(levels.length))}`;
}

/** Nanoseconds as a data sheet writes them: 62.5 ns, 1.5 µs, 0.512 ms. */
export function timeText(seconds: number): string {
  const ns = seconds * 1e9;
  const [value, unit] = ns < 1e3 ? [ns, "ns"] : ns < 1e6 ? [ns / 1e3, "µs"] : [ns / 1e6, "ms"];
  return exactText(rounded(value, 4), unit);
}

/** Ticks of a time axis: at most so many, at round times [s]. */
export function ticksOf(spanS: number, most: number): number[] {
  const rough = spanS / Math.max(1, most);
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((size) => size * power).find((size) => size >= rough * 0.999) ?? 10 * power;
  return Array.from({ length: Math.floor(spanS / step + 1e-9) + 1 }, (_, index) => index * step);
}
