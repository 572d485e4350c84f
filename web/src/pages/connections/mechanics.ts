import { parseNumber, withUnit } from "../../lib/format";
import { type AxisScale, fromSteps } from "../../lib/units";
import type { Values } from "./form";

/** Soft limits in the units of what the axis moves, as far as it is known; empty where that says no more than the fields. */
export function inMechanics(axis: Values, scale: AxisScale | undefined): string {
  if (scale === undefined) return "";
  const [place, rate] = scale.travelMmPerRev === null ? ["deg", "rpm"] : ["mm", "mm_per_s"];
  const shown = (word: string, part: string, unit: string, motion: "position" | "velocity") => {
    const value = parseNumber(axis[`limits.${part}`] ?? "");
    const own = value === null ? Number.NaN : fromSteps(value, unit, scale, motion);
    return Number.isNaN(own) ? [] : [`${word} ${withUnit(own, unit)}`];
  };
  return [
    ...shown("from", "position_min", place, "position"),
    ...shown("to", "position_max", place, "position"),
    ...shown("at most", "velocity_max_pps", rate, "velocity"),
  ].join(", ");
}
