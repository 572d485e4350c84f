import { compact } from "../../../lib/format";
import { symbolOf } from "../../../lib/units";
import type { PlotData } from "../../../plots/series";
import type { Study, Trial } from "../study";

/** Pruned: passed over without a move. Undecided: cut short. */
export type State = "held" | "lost" | "pruned" | "undecided";

export interface Setting {
  name: string;
  unit: string;
}

export interface Figure extends Setting {
  /** more of it is better, not less */
  more?: boolean;
}

/** A trial as a point: the value of each setting, then of each figure; null where it has none. */
export interface Point {
  number: number;
  /** left out: trial and its number */
  name?: string;
  state: State;
  values: readonly (number | null)[];
}

/** What was tried, as points; the first figure is what is looked for. */
export interface Trials {
  settings: readonly Setting[];
  figures: readonly Figure[];
  points: readonly Point[];
  best: number | null;
  /** what a point that did not hold is called */
  lost?: string;
}

/** A figure of a trial, which stands at `index` of those of its study. */
export interface FigureOf extends Figure {
  of: (trial: Trial, index: number) => number | null | undefined;
}

const STATES: Readonly<Record<Trial["state"], State>> = {
  feasible: "held",
  infeasible: "lost",
  pruned: "pruned",
  failed: "undecided",
};

/** The trials of a study, with figures that may stand elsewhere in its record. */
export function trialsOf({ trials, units, best }: Study, figures: readonly FigureOf[]): Trials {
  const settings = Object.entries(units).map(([name, unit]) => ({ name, unit }));
  const points = trials.map((trial, index) => ({
    number: trial.number,
    state: STATES[trial.state],
    values: [...settings.map(({ name }) => trial.setting[name]), ...figures.map(({ of }) => of(trial, index))].map(
      (value) => value ?? null,
    ),
  }));
  return { settings, figures, points, best };
}

/** Those that moved to an end, as they came. */
export function movedOf({ points }: Pick<Trials, "points">): Point[] {
  return points.filter(({ state }) => state === "held" || state === "lost");
}

/** Columns over the values at `x`, rising: of those that held, and of those that did not. */
function parted(points: readonly Point[], x: (point: Point) => number | null, y: number): PlotData {
  const rows = points
    .flatMap((point) => {
      const at = x(point);
      return at === null ? [] : [{ at, state: point.state, value: point.values[y] ?? null }];
    })
    .sort((one, other) => one.at - other.at);
  const of = (wanted: State) => rows.map(({ state, value }) => (state === wanted ? value : null));
  return [rows.map(({ at }) => at), of("held"), of("lost")];
}

/** The first figure over the trials: of those that held, of those that did not, and the best so far. */
export function historyOf(trials: Trials): PlotData {
  const [numbers, held, lost] = parted(movedOf(trials), ({ number }) => number, trials.settings.length);
  const sign = trials.figures[0]?.more ? -1 : 1;
  let best: number | null = null;
  const bests = Array.from(held ?? [], (value) => {
    if (value !== null && (best === null || sign * value < sign * best)) best = value;
    return best;
  });
  return [numbers, held ?? [], lost ?? [], bests];
}

/** The second setting over the first, of one alone the first figure: of those that held, and of those that did not. */
export function spaceOf(trials: Trials): PlotData {
  return parted(movedOf(trials), ({ values }) => values[0] ?? null, 1);
}

/** The second figure over the first, of those that held; those that none beats in both; and the chosen one, if any. */
export function frontOf({ settings, points }: Trials, front: readonly number[], chosen: number | null): PlotData {
  const at = settings.length;
  const rows = points
    .flatMap(({ number, state, values }) => {
      const [x, y] = [values[at] ?? null, values[at + 1] ?? null];
      return state === "held" && x !== null && y !== null ? [{ number, x, y }] : [];
    })
    .sort((one, other) => one.x - other.x);
  const of = (wanted: (number: number) => boolean) => rows.map(({ number, y }) => (wanted(number) ? y : null));
  return [
    rows.map(({ x }) => x),
    of(() => true),
    of((number) => front.includes(number)),
    ...(chosen === null ? [] : [of((number) => number === chosen)]),
  ];
}

/** An axis of parallel coordinates, from the least to the greatest value; `log`: equal ratios are equally far apart. */
export interface Axis extends Setting {
  low: number;
  high: number;
  log: boolean;
}

/** A trial across parallel axes: how high it crosses each, 0 at its lower end and 1 at its upper one. */
export interface Line {
  point: Point;
  heights: readonly (number | null)[];
}

/** Parallel coordinates of what was tried, by axes that some trial has a value of. Settings with a unit go by ratios. */
export function parallelOf(trials: Trials): { axes: Axis[]; lines: Line[] } {
  const points = movedOf(trials);
  const every = [...trials.settings, ...trials.figures].flatMap(({ name, unit }, index) => {
    const values = points.map((point) => point.values[index] ?? null).filter((value) => value !== null);
    const [low, high] = [Math.min(...values), Math.max(...values)];
    const log = index < trials.settings.length && unit !== "" && low > 0;
    return values.length > 0 ? [{ name, unit, low, high, log, index }] : [];
  });
  const lines = points.map((point) => ({
    point,
    heights: every.map(({ low, high, log, index }) => {
      const value = point.values[index] ?? null;
      if (value === null) return null;
      if (!(high > low)) return 0.5;
      return log ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low);
    }),
  }));
  return { axes: every.map(({ index: _, ...axis }) => axis), lines };
}

const NEAR = 0.1;

/** The trial whose line passes nearest at `height`, so many axes behind the first one; none where none is near. */
export function nearestTo(lines: readonly Line[], at: number, height: number): Point | null {
  let nearest: { point: Point; away: number } | null = null;
  for (const { point, heights } of lines) {
    const left = Math.max(0, Math.min(Math.floor(at), heights.length - 2));
    const [from, to] = [heights[left] ?? null, heights[left + 1] ?? null];
    if (from === null || to === null) continue;
    const away = Math.abs(from + (to - from) * (at - left) - height);
    if (away < (nearest?.away ?? NEAR)) nearest = { point, away };
  }
  return nearest?.point ?? null;
}

/** A trial in words: what it is, what became of it, and all its values. */
export function saidOf(
  { settings, figures, best, lost = LOST }: Trials,
  { number, name, state, values }: Point,
): string {
  const told = [...settings, ...figures].flatMap(({ name: of, unit }, index) => {
    const value = values[index] ?? null;
    return value === null ? [] : [`${of} ${compact(value, 4, symbolOf(unit))}`];
  });
  const what = [name ?? `Trial ${number}`, number === best ? "the best" : "", state === "lost" ? lost : "held"];
  return `${what.filter(Boolean).join(", ")}: ${told.join(", ")}`;
}

export const LOST = "did not hold";
