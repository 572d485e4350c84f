import type { PlotData } from "../../../plots/series";
import type { Study, Trial, Wish } from "../study";

function moved({ state }: Trial): boolean {
  return state === "feasible" || state === "infeasible";
}

/** Trials over their number: the time of those that held, what the others would have taken, and the best so far [s]. */
export function historyOf(trials: readonly Trial[]): PlotData {
  const tried = trials.filter(moved).sort((one, other) => one.number - other.number);
  let best = Number.NaN;
  const bests = tried.map(({ state, figures }) => {
    const time = state === "feasible" ? figures.time_s : null;
    if (time !== null && !(best <= time)) best = time;
    return best;
  });
  return [
    tried.map(({ number }) => number),
    tried.map(({ state, figures }) => (state === "feasible" ? figures.time_s : null)),
    tried.map(({ state, expected_s: expected }) => (state === "infeasible" ? expected : null)),
    bests,
  ];
}

/** The space of the first two settings: the second one over the first, of those that held and of those that did not. */
export function spaceOf(trials: readonly Trial[], names: readonly string[]): PlotData {
  const [first = "", second = ""] = names;
  const tried = trials.filter(moved).sort((one, other) => (one.setting[first] ?? 0) - (other.setting[first] ?? 0));
  const over = (state: Trial["state"]) =>
    tried.map((trial) => (trial.state === state ? (trial.setting[second] ?? null) : null));
  return [tried.map(({ setting }) => setting[first] ?? 0), over("feasible"), over("infeasible")];
}

/** The trials that held, the fastest first. */
function heldOf(trials: readonly Trial[]): Trial[] {
  return trials
    .filter(({ state, figures }) => state === "feasible" && figures.time_s !== null)
    .sort((one, other) => (one.figures.time_s ?? 0) - (other.figures.time_s ?? 0));
}

/** Of two objectives: deviation over time, of those that held; those that none beats in both; and the one chosen. */
export function frontOf(trials: readonly Trial[], front: readonly number[], chosen: number | null): PlotData {
  const held = heldOf(trials);
  const off = (wanted: (number: number) => boolean) =>
    held.map(({ number, figures }) => (wanted(number) ? figures.deviation_fullsteps : null));
  return [
    held.map(({ figures }) => figures.time_s ?? 0),
    off(() => true),
    off((number) => front.includes(number)),
    off((number) => number === chosen),
  ];
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

/** The least and greatest value of a setting among all trials: where an axis of parallel coordinates ends. */
export interface Range {
  name: string;
  unit: string;
  low: number;
  high: number;
  /** of an axis that is no setting: its value of each trial that has one, by the trial's number */
  values?: ReadonlyMap<number, number>;
}

/** The axes of parallel coordinates: each setting, then `figures`, by default the time. */
export function rangesOf(study: Study, figures?: readonly Range[]): Range[] {
  const tried = study.trials.filter(moved);
  const range = (name: string, unit: string, values: number[]): Range => ({
    name,
    unit,
    low: Math.min(...values),
    high: Math.max(...values),
  });
  const settings = Object.entries(study.units).map(([name, unit]) =>
    range(
      name,
      unit,
      tried.map(({ setting }) => setting[name] ?? 0),
    ),
  );
  return tried.length < 2
    ? []
    : [
        ...settings,
        ...(figures ?? [
          range(
            "time",
            "s",
            tried.map(({ figures, expected_s: expected }) => figures.time_s ?? expected ?? 0),
          ),
        ]),
      ];
}

/** How high a trial crosses each axis: 0 at its lower end, 1 at its upper one; settings in equal ratios where all are above 0. */
export function crossings(trial: Trial, ranges: readonly Range[]): number[] {
  return ranges.map(({ name, low, high, values }) => {
    if (!(high > low)) return 0.5;
    if (values) return ((values.get(trial.number) ?? high) - low) / (high - low);
    if (low <= 0 && name !== "time") return ((trial.setting[name] ?? low) - low) / (high - low);
    if (name === "time") return ((trial.figures.time_s ?? trial.expected_s ?? 0) - low) / (high - low);
    return Math.log((trial.setting[name] ?? low) / low) / Math.log(high / low);
  });
}
