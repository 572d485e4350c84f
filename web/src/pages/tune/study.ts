import type { Schemas } from "../../api/client";
import type { Remedy } from "../../lib/condition/remedy";
import { compact } from "../../lib/format";
import type { PlotData } from "../../plots/series";

export type Study = Schemas["StudyRecord"];
export type StudyInfo = Schemas["StudyInfo"];
export type Plan = Schemas["StudyPlan"];
export type Wish = Schemas["StudyDocument-Input"];
export type Kind = StudyInfo["kind"];
export type Trial = Study["trials"][number];
export type Finding = Study["findings"][number];

/** What a user can want, in their words. */
export const WISHES: readonly { value: Kind; label: string; text: string }[] = [
  {
    value: "first_look",
    label: "Look at it first",
    text: "Small moves tell how encoder and switches are, and what is missing.",
  },
  {
    value: "fastest_move",
    label: "Faster",
    text: "The shortest move by a distance at which no step is lost, with a margin.",
  },
];

export interface Form {
  kind: Kind;
  /** of a move [microsteps] */
  distance: number;
  marginPercent: number;
  trials: number;
  quiet: boolean;
  velocityMaxPps: number | null;
  accelerationMaxPps2: number | null;
  /** try on an emulated twin first, with this motor */
  twin: boolean;
  holdingTorqueNm: number;
  ratedCurrentA: number;
  loadInertiaKgm2: number;
  /** of the first look [turns of the motor] */
  turns: number;
  travelTurns: number;
}

/** What the form begins with: a move of two turns. */
export function firstForm(microstepsPerTurn: number | null): Form {
  return {
    kind: "first_look",
    distance: 2 * (microstepsPerTurn ?? 51_200),
    marginPercent: 10,
    trials: 30,
    quiet: false,
    velocityMaxPps: null,
    accelerationMaxPps2: null,
    twin: true,
    holdingTorqueNm: 0.45,
    ratedCurrentA: 1.5,
    loadInertiaKgm2: 0,
    turns: 1,
    travelTurns: 0,
  };
}

/** The document of a study as the server wants it. */
export function documentOf(form: Form, device: string, axis: number): Wish {
  if (form.kind === "first_look")
    return { device, axis, study: { kind: "first_look", turns: form.turns, travel_turns: form.travelTurns } };
  return {
    device,
    axis,
    budget: { trials: form.trials },
    study: {
      kind: "fastest_move",
      distance: Math.round(form.distance),
      margin: form.marginPercent / 100,
      quiet: form.quiet,
      velocity_max_pps: form.velocityMaxPps,
      acceleration_max_pps2: form.accelerationMaxPps2,
      twin: form.twin
        ? {
            motor: {
              holding_torque_nm: form.holdingTorqueNm,
              rated_current_a: form.ratedCurrentA,
              load_inertia_kgm2: form.loadInertiaKgm2,
            },
          }
        : null,
    },
  };
}

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

/** Of two objectives: deviation over time, of those that held; and those that none beats in both. */
export function frontOf(trials: readonly Trial[], front: readonly number[]): PlotData {
  const held = trials
    .filter(({ state, figures }) => state === "feasible" && figures.time_s !== null)
    .sort((one, other) => (one.figures.time_s ?? 0) - (other.figures.time_s ?? 0));
  return [
    held.map(({ figures }) => figures.time_s ?? 0),
    held.map(({ figures }) => figures.deviation_fullsteps),
    held.map(({ number, figures }) => (front.includes(number) ? figures.deviation_fullsteps : null)),
  ];
}

/** The least and greatest value of a setting among all trials: where an axis of parallel coordinates ends. */
export interface Range {
  name: string;
  unit: string;
  low: number;
  high: number;
}

/** The axes of parallel coordinates: each setting, then the time. */
export function rangesOf(study: Study): Range[] {
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
        range(
          "time",
          "s",
          tried.map(({ figures, expected_s: expected }) => figures.time_s ?? expected ?? 0),
        ),
      ];
}

/** How high a trial crosses each axis: 0 at its lower end, 1 at its upper one; settings in equal ratios. */
export function crossings(trial: Trial, ranges: readonly Range[]): number[] {
  return ranges.map(({ name, low, high }) => {
    if (high <= low) return 0.5;
    if (name === "time") return ((trial.figures.time_s ?? trial.expected_s ?? 0) - low) / (high - low);
    return Math.log((trial.setting[name] ?? low) / low) / Math.log(high / low);
  });
}

/** What of a finding stands beside its name: 0.25 deg, 0.2 to 0.3. */
export function figureOf({ value, unit, interval }: Finding): string {
  if (value === null) return "";
  const between = interval === null ? "" : ` (95 %: ${compact(interval.low)} to ${compact(interval.high)})`;
  return `${compact(value)} ${unit}`.trim() + between;
}

/** A cure as the page makes it: its address stands behind the device's own. */
export function remedyOf(device: string, { remedy }: Finding): Remedy | null {
  if (remedy === null) return null;
  return { ...remedy, path: `/api/v1/devices/${encodeURIComponent(device)}/${remedy.path}` };
}
