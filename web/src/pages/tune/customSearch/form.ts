import type { Schemas } from "../../../api/client";
import { rounded } from "../../../lib/format";
import type { KindForm } from "../kind";

export type Searchable = Schemas["Searchable"];
export type SearchedFigure = Schemas["CustomFound"]["objectives"][number];

/** What is made better, and its unit; of a load value more is better, of all else less. */
export const FIGURES: Readonly<Record<SearchedFigure, { label: string; unit: string }>> = {
  time_s: { label: "time until it rests", unit: "s" },
  peak_fullsteps: { label: "greatest deviation", unit: "full steps" },
  vibration_fullsteps: { label: "vibration under way", unit: "full steps" },
  overshoot_fullsteps: { label: "overshoot", unit: "full steps" },
  rest_fullsteps: { label: "vibration at the end", unit: "full steps" },
  load_min: { label: "least load value", unit: "" },
};

/** A setting that is searched. */
export interface Searched {
  name: string;
  unit: string;
  low: number;
  high: number;
  log: boolean;
}

export interface CustomSearchForm {
  settings: readonly Searched[];
  /** of a move [microsteps] */
  distance: number;
  first: SearchedFigure;
  second: SearchedFigure | "";
  /** null: no bound */
  timeMost: number | null;
  deviationMost: number | null;
  repeats: number;
  trials: number;
  moreCurrent: boolean;
}

const DIGITS = 3;

/** A setting as it is offered: half to twice what it is now where it has a unit, else all that its register takes. */
export function presetOf({ name, unit, low, high, now }: Searchable): Searched {
  const around = unit !== "" && now > 0;
  const least = around ? Math.max(low, rounded(now / 2, DIGITS)) : low;
  const most = around ? Math.min(high, rounded(2 * now, DIGITS)) : high;
  const [from, to] = least < most ? [least, most] : [low, high];
  return { name, unit, low: from, high: to, log: around && from > 0 };
}

export const CUSTOM_SEARCH: KindForm<CustomSearchForm> = {
  label: "As you say",
  text: "Your own search: any settings of this axis, from where to where, and what they shall make better.",
  title: "Own search",
  first: (microstepsPerTurn) => ({
    settings: [],
    distance: microstepsPerTurn ?? 51_200,
    first: "peak_fullsteps",
    second: "",
    timeMost: null,
    deviationMost: null,
    repeats: 2,
    trials: 30,
    moreCurrent: false,
  }),
  wish: (form) => ({
    budget: { trials: form.trials, time_s: 3600 },
    study: {
      kind: "custom_search",
      space: form.settings.map(({ name, low, high, log }) => ({ name, low, high, log: log && low > 0 })),
      distances: [Math.round(form.distance)],
      objectives: form.second === "" || form.second === form.first ? [form.first] : [form.first, form.second],
      bounds: [
        ...(form.timeMost === null ? [] : [{ figure: "time_s", most: form.timeMost } as const]),
        ...(form.deviationMost === null ? [] : [{ figure: "peak_fullsteps", most: form.deviationMost } as const]),
      ],
      repeats: form.repeats,
      more_current: form.moreCurrent,
    },
  }),
};
