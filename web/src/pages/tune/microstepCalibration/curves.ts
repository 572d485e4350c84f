import type { Schemas } from "../../../api/client";
import type { PlotData } from "../../../plots/series";

export type Microsteps = Schemas["MicrostepFigures"];
export type AngleFigures = Schemas["AngleFigures"];

/** The error over the electrical angle [deg]: before, expected of the new table, and measured with it. */
export function errorOf({ before, predicted_deg: predicted, after }: Microsteps): PlotData {
  const places = before.curve_deg.length;
  const nothing = before.curve_deg.map(() => null);
  return [
    before.curve_deg.map((_, index) => ((index + 0.5) * 360) / places),
    before.curve_deg,
    predicted.length === places ? predicted : nothing,
    after?.curve_deg ?? nothing,
  ];
}

/** What the new table adds to the one before, over the place in the quarter wave [counts]. */
export function addedOf({ wave_before: before, wave }: Microsteps): PlotData {
  return [before.map((_, place) => place), before.map((value, place) => (wave?.[place] ?? value) - value)];
}

export interface HarmonicRow {
  order: number;
  before: number;
  beforeHalf: number;
  after: number | null;
  afterHalf: number | null;
}

/** Amplitudes of those harmonics that are more than their interval leaves open, before or after [deg electrical]. */
export function harmonicsOf({ before, after }: Microsteps): HarmonicRow[] {
  return before.harmonics
    .map((was, index) => {
      const now = after?.harmonics[index];
      return {
        order: was.order,
        before: was.amplitude_deg,
        beforeHalf: was.half_deg,
        after: now?.amplitude_deg ?? null,
        afterHalf: now?.half_deg ?? null,
      };
    })
    .filter(({ before: was, beforeHalf, after: now, afterHalf }) => was > beforeHalf || (now ?? 0) > (afterHalf ?? 0));
}
