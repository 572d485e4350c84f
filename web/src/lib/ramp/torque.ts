import { roundRange } from "../../plots/ranges";
import type { PlotScale, PlotSeries } from "../../plots/types";
import type { Answer } from "./answer";
import type { Scheme } from "./phases";

/** Of everything that is torque, wherever it is drawn. */
export function torqueColor(scheme: Scheme): string {
  return scheme === "light" ? "#4a7d00" : "#9bd14f";
}

/** 0 in the middle, as of the acceleration on the other side: both lines may be compared by eye. */
function around(min: number, max: number): [number, number] {
  const size = Math.max(Math.abs(min), Math.abs(max));
  return roundRange(-size, size);
}

export const TORQUE_SCALE: PlotScale = { side: "right", unit: "Nm", range: around };
/** Where there is no room for numbers. */
export const UNSEEN_SCALE: PlotScale = { ...TORQUE_SCALE, axis: false };
/** An empty axis on the right: plots above each other keep one width. */
export const NO_SCALE: PlotScale = { side: "right", range: [0, 1], at: [] };

/** Torque over time beside the acceleration: what is asked for, within what there is, either way. */
export function torqueLines(
  torque: NonNullable<Answer["torque"]>,
  scheme: Scheme,
): { series: PlotSeries[]; columns: (readonly number[])[] } {
  const color = torqueColor(scheme);
  const limit = { color, scale: "right", unit: "Nm", dash: [6, 3], width: 1, fill: `${color}14` };
  return {
    series: [
      { label: "torque there is", ...limit },
      { label: "torque there is, braking", ...limit, unnamed: true },
      { label: "torque asked for", color, scale: "right", unit: "Nm", width: 1.5 },
    ],
    columns: [torque.available_nm, torque.available_nm.map((value) => -value), torque.required_nm],
  };
}
