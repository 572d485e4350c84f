import type { Study, Trial, Wish } from "../study";
import { type FigureOf, type Trials, trialsOf } from "../trials/points";

/** Of two objectives the deviation is one; what lost steps has the least time that its ramp can take. */
export function pointsOf(study: Study): Trials {
  const asked = study.document.study;
  const time: FigureOf = {
    name: "time",
    unit: "s",
    of: ({ state, figures, expected_s: expected }) => (state === "feasible" ? figures.time_s : expected),
  };
  const deviation: FigureOf = {
    name: "deviation",
    unit: "full steps",
    of: ({ figures }) => figures.deviation_fullsteps,
  };
  const quiet = asked.kind === "fastest_move" && asked.quiet;
  return { ...trialsOf(study, quiet ? [time, deviation] : [time]), lost: "lost steps (time of its ramp)" };
}

/** The trials that held, the fastest first. */
function heldOf(trials: readonly Trial[]): Trial[] {
  return trials
    .filter(({ state, figures }) => state === "feasible" && figures.time_s !== null)
    .sort((one, other) => (one.figures.time_s ?? 0) - (other.figures.time_s ?? 0));
}

/** What may be chosen: the trials of the front, the fastest first. */
export function choicesOf({ trials, front }: Study): Trial[] {
  return heldOf(trials).filter(({ number }) => front.includes(number));
}

/** The one whose time is nearest [s]. */
export function nearestOf(choices: readonly Trial[], time: number): Trial | undefined {
  const away = ({ figures }: Trial) => Math.abs((figures.time_s ?? 0) - time);
  return [...choices].sort((one, other) => away(one) - away(other))[0];
}

/** The study that proves one trial of another: its setting alone, without a search. */
export function proofOf({ document, id }: Study, { number, setting }: Trial): Wish | null {
  const { study, ...rest } = document;
  if (study.kind !== "fastest_move") return null;
  return {
    ...rest,
    name: `Proof of trial ${number} of ${id}`,
    study: { ...study, candidate: setting, deviation_max_fullsteps: null, twin: null },
  };
}
