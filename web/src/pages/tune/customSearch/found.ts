import type { Schemas } from "../../../api/client";
import { compact } from "../../../lib/format";
import type { PlotData } from "../../../plots/series";
import type { Range } from "../fastestMove/trials";
import type { Study } from "../study";
import { FIGURES, type SearchedFigure } from "./form";

export type CustomFound = Schemas["CustomFound"];

/** A figure of each trial that has it, by the trial's number. */
export function valuesOf({ tried }: Pick<CustomFound, "tried">, figure: SearchedFigure): Map<number, number> {
  return new Map(
    tried.flatMap(({ number, figures }) => {
      const value = figures[figure];
      return value === null || value === undefined ? [] : [[number, value] as const];
    }),
  );
}

/** A figure over the trials: of those that held, and of those that did not. */
export function overTrials(study: Pick<Study, "trials">, found: CustomFound, figure: SearchedFigure): PlotData {
  const values = valuesOf(found, figure);
  const rows = study.trials.filter(({ number }) => values.has(number)).sort((one, other) => one.number - other.number);
  const of = (held: boolean) =>
    rows.map(({ number, state }) => ((state === "feasible") === held ? (values.get(number) ?? null) : null));
  return [rows.map(({ number }) => number), of(true), of(false)];
}

/** The second objective over the first, of those that held; and the front of both. */
export function frontOfBoth(study: Pick<Study, "trials" | "front">, found: CustomFound): PlotData {
  const [first, second] = found.objectives;
  if (first === undefined || second === undefined) return [[], [], []];
  const [x, y] = [valuesOf(found, first), valuesOf(found, second)];
  const rows = study.trials
    .filter(({ number, state }) => state === "feasible" && x.has(number) && y.has(number))
    .sort((one, other) => (x.get(one.number) ?? 0) - (x.get(other.number) ?? 0));
  return [
    rows.map(({ number }) => x.get(number) ?? 0),
    rows.map(({ number }) => y.get(number) ?? null),
    rows.map(({ number }) => (study.front.includes(number) ? (y.get(number) ?? null) : null)),
  ];
}

/** The objectives as axes of parallel coordinates. */
export function objectiveRanges(found: CustomFound): Range[] {
  return found.objectives.map((figure) => {
    const values = valuesOf(found, figure);
    const { label, unit } = FIGURES[figure];
    return { name: label, unit, low: Math.min(...values.values()), high: Math.max(...values.values()), values };
  });
}

/** Each objective before and after, by the pairs. */
export function evidenceRows({ effects }: Pick<CustomFound, "effects">): [string, ...string[]][] {
  return effects.map((one) => [
    FIGURES[one.figure].label,
    compact(one.baseline, 4, one.unit),
    compact(one.winner, 4, one.unit),
    compact(one.difference, 3, one.unit),
    `${compact(one.interval.low, 3)} to ${compact(one.interval.high, 3)}`,
    compact(one.p, 2),
    one.significant ? "better" : one.worse ? "may be worse" : "not shown",
  ]);
}
