import type { FieldsProps, KindForm } from "../kind";
import { firstSeenBy, type SeenBy } from "../seenBy";
import { FIRST_TWIN, type TwinForm, twinOf } from "../twin/form";

/** What of a ramp's shape is searched beside speed and acceleration. */
export type Shape = "six points" | "bows";

/** The shapes that a chip offers, "" for none, each with what it is called; empty where there is no choice. */
export function shapesOf(can: FieldsProps<never>["can"]): { value: Shape | ""; label: string }[] {
  if (can("ramp.sixpoint")) {
    return [
      { value: "", label: "a trapezoid" },
      { value: "six points", label: "six points: V1, A1, D1 and DMAX too" },
    ];
  }
  if (can("ramp.s")) {
    return [
      { value: "", label: "all bows alike, if any" },
      { value: "bows", label: "bows near rest and near full speed apart" },
    ];
  }
  return [];
}

export interface FastestMoveForm {
  seenBy: SeenBy;
  /** of a move [microsteps] */
  distance: number;
  /** further distances as typed, and what they are [microsteps] */
  further: string;
  distances: number[];
  marginPercent: number;
  trials: number;
  shape: Shape | null;
  /** bound of the share of moves that lose a step; null: what the pairs show */
  lossPercent: number | null;
  quiet: boolean;
  /** with quiet: never more off under way [full steps]; null: the knee of the front */
  deviationMax: number | null;
  /** what asks for settings; "": the usual one */
  sampler: Sampler;
  velocityMaxPps: number | null;
  accelerationMaxPps2: number | null;
  twin: TwinForm;
}

export type Sampler = "" | "tpe" | "cmaes" | "nsga2";

/** Two objectives, and what asks for settings: CMA-ES knows one alone, and an encoder alone tells of the other. */
function asked({ quiet, seenBy, deviationMax, sampler }: FastestMoveForm) {
  const both = quiet && seenBy === "encoder";
  return {
    quiet: both,
    deviation_max_fullsteps: both ? deviationMax : null,
    sampler: sampler === "" || (both && sampler === "cmaes") ? null : sampler,
  };
}

const AWAY: Record<SeenBy, (distance: number) => number> = {
  encoder: (distance) => distance,
  "left switch": Math.abs,
  "right switch": (distance) => -Math.abs(distance),
};

/** Numbers as typed, in their order: "1, 0.5 2" is 1, 0.5, 2; null where something is none, is 0, or there are too many. */
export function furtherOf(text: string): number[] | null {
  const typed = text.split(/[\s,;]+/).filter((part) => part !== "");
  const numbers = typed.map(Number);
  return numbers.length <= 8 && numbers.every((each) => Number.isFinite(each) && each !== 0) ? numbers : null;
}

export const FASTEST_MOVE: KindForm<FastestMoveForm> = {
  label: "Faster",
  text: "The shortest move by a distance at which no step is lost, with a margin.",
  title: "Fastest move",
  first: (microstepsPerTurn, sees) => ({
    seenBy: firstSeenBy(sees),
    distance: 2 * (microstepsPerTurn ?? 51_200),
    further: "",
    distances: [],
    marginPercent: 10,
    trials: 30,
    shape: null,
    lossPercent: null,
    quiet: false,
    deviationMax: null,
    sampler: "",
    velocityMaxPps: null,
    accelerationMaxPps2: null,
    twin: FIRST_TWIN,
  }),
  wish: (form) => ({
    budget: { trials: form.trials, ...(form.lossPercent !== null && { time_s: 14_400 }) },
    study: {
      kind: "fastest_move",
      seen_by: form.seenBy,
      distance: Math.round(AWAY[form.seenBy](form.distance)),
      // To the side of the first one, whatever their signs: the server takes no others.
      distances: form.distances.map((each) => Math.sign(AWAY[form.seenBy](form.distance)) * Math.abs(Math.round(each))),
      margin: form.marginPercent / 100,
      shape: form.shape,
      loss_rate_max: form.lossPercent === null ? null : form.lossPercent / 100,
      ...asked(form),
      velocity_max_pps: form.velocityMaxPps,
      acceleration_max_pps2: form.accelerationMaxPps2,
      twin: form.seenBy === "encoder" ? twinOf(form.twin) : null,
    },
  }),
};
