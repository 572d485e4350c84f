import type { Schemas } from "../../../api/client";
import { Shared, useShared } from "../../../lib/shared";

export type ResponseState = Schemas["ResponseState"];
export type Recording = Schemas["Recording"];
export type Score = Schemas["Score"];
export type Kind = "step" | "load";

/** A response that was recorded, with what it was recorded with: to be compared with the next one. */
export interface Run {
  /** device time of the step: tells runs apart */
  id: number;
  kind: Kind;
  number: number;
  recording: Recording;
  score: Score;
  /** the gains of the moment, as far as they were known: "β 255 · P 1.00" */
  settings: string;
}

/** So many curves can still be told apart. */
export const KEPT = 6;

const none: readonly Run[] = [];
const kept = new Shared<ReadonlyMap<string, readonly Run[]>>(new Map());

/** Another run is the newest; the oldest is forgotten. One that is known is not taken twice. */
export function withRun(runs: readonly Run[], run: Omit<Run, "number">): readonly Run[] {
  if (runs.some((known) => known.id === run.id && known.kind === run.kind)) return runs;
  const number = Math.max(0, ...runs.map((known) => known.number)) + 1;
  return [...runs, { ...run, number }].slice(-KEPT);
}

const runsOf = (key: string) => kept.get().get(key) ?? none;

function change(key: string, next: readonly Run[]): void {
  if (next !== runsOf(key)) kept.set(new Map(kept.get()).set(key, next));
}

/** Outside of React: curves to compare with outlive a look at another page. */
export function useRuns(key: string) {
  return {
    runs: useShared(kept).get(key) ?? none,
    add: (run: Omit<Run, "number">) => change(key, withRun(runsOf(key), run)),
    forget: (id: number) =>
      change(
        key,
        runsOf(key).filter((run) => run.id !== id),
      ),
    clear: () => change(key, none),
  };
}

/** The columns that are compared, for runs that are drawn over one another. */
export type View = "position" | "deviation" | "velocity" | "angle";

/** The direction of a step, so that there and back can be laid over one another; of a load +1. */
export function wayOf(recording: Recording): 1 | -1 {
  const last = recording.target.findLast((value) => value !== null) ?? 0;
  return last < originOf(recording) ? -1 : 1;
}

/**
 * A column of a recording for a view, position relative to where the motor was, all in the direction of the step: null
 * becomes NaN.
 */
export function columnOf(recording: Recording, view: View, which: "measured" | "commanded" = "measured"): Float64Array {
  const raw = {
    position: which === "measured" ? recording.encoder : recording.commanded,
    deviation: recording.deviation,
    velocity: which === "measured" ? recording.encoder_velocity_pps : recording.velocity_pps,
    angle: recording.load_angle_deg,
  }[view];
  const start = view === "position" ? originOf(recording) : 0;
  const way = wayOf(recording);
  return Float64Array.from(raw, (value) => (value === null ? Number.NaN : way * (value - start)));
}

/** XACTUAL before the step: positions are told from there. */
export function originOf(recording: Recording): number {
  return recording.commanded.find((value) => value !== null) ?? 0;
}

/** How far a curve reaches: its smallest and largest value, null where it has none. */
export function reachOf(columns: readonly ArrayLike<number>[]): readonly [number, number] | null {
  let low = Number.POSITIVE_INFINITY;
  let high = Number.NEGATIVE_INFINITY;
  for (const column of columns)
    for (let row = 0; row < column.length; row++) {
      const value = column[row] as number;
      if (value < low) low = value;
      if (value > high) high = value;
    }
  return low <= high ? [low, high] : null;
}

/** A run that reaches so many times further than most is drawn beyond the plot: what the others differ by is small. */
const FAR = 5;

/** The places of the runs that reach far beyond the others: beyond the lower half of them, so that one is never all. */
export function farOnes(reaches: readonly (readonly [number, number] | null)[]): number[] {
  const sizes = reaches.map((reach) => (reach ? Math.max(Math.abs(reach[0]), Math.abs(reach[1])) : 0));
  const usual = sizes.filter((size) => size > 0).sort((one, other) => one - other);
  const middle = usual[Math.floor((usual.length - 1) / 2)];
  if (middle === undefined) return [];
  return sizes.flatMap((size, index) => (size > FAR * middle ? [index] : []));
}

/** Which of two scores is the better one, by a figure that should be small; null where that cannot be said. */
export function bestOf(runs: readonly Run[], figure: (score: Score) => number | null): number | null {
  const known = runs.flatMap((run) => {
    const value = figure(run.score);
    return value === null ? [] : [{ id: run.id, value: Math.abs(value) }];
  });
  if (known.length < 2 || known.length < runs.length) return null;
  const least = Math.min(...known.map(({ value }) => value));
  const first = known.filter(({ value }) => value === least);
  return first.length === 1 ? (first[0]?.id ?? null) : null;
}
