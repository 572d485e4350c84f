import type { Schemas } from "../../../api/client";
import type { PlotData } from "../../../plots/series";

export type TorqueFound = Schemas["TorqueFound"];
export type TorquePoint = TorqueFound["points"][number];

export interface TorqueRow {
  speed: number;
  value: number;
  low: number;
  high: number;
}

/** Torque [N m] where the inertia was told, else acceleration [rad/s²]; with its interval. */
export function rowsOf(points: readonly TorquePoint[]): TorqueRow[] {
  return points.map((point) => {
    const { torque_nm: torque, interval_nm: around } = point;
    const [value, between] =
      torque !== null && around !== null ? [torque, around] : [point.acceleration_radps2, point.interval_radps2];
    return { speed: point.speed_rps, value, low: between.low, high: between.high };
  });
}

/** Over speed: the figure, both ends of its interval. */
export function curveOf(rows: readonly TorqueRow[]): PlotData {
  return [
    rows.map(({ speed }) => speed),
    rows.map(({ value }) => value),
    rows.map(({ low }) => low),
    rows.map(({ high }) => high),
  ];
}
