import type { Schemas } from "../../../api/client";
import { compact } from "../../../lib/format";
import type { Study } from "../study";
import { type Trials, trialsOf } from "../trials/points";
import { FIGURES } from "./form";

export type CustomFound = Schemas["CustomFound"];

/** The objectives of each trial, the first one first. */
export function pointsOf(study: Study, { objectives, tried }: CustomFound): Trials {
  const figures = new Map(tried.map((one) => [one.number, one.figures]));
  return trialsOf(
    study,
    objectives.map((figure) => {
      const { label: name, unit } = FIGURES[figure];
      return { name, unit, more: figure === "load_min", of: ({ number }) => figures.get(number)?.[figure] };
    }),
  );
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
