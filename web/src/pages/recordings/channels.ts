import { colorOf } from "../../lib/palette";
import { symbolOf } from "../../lib/units";
import type { PlotSeries } from "../../plots/types";

export interface Channel {
  name: string;
  quantity: string;
  axis: number;
  unit: string;
}

/** Channels that share a plot, with their places among the recording's columns. */
export interface Lane {
  id: string;
  title: string;
  unit: string;
  columns: number[];
  series: PlotSeries[];
  /** on and off */
  logic: boolean;
}

/** Which quantities share a plot: those that are read against each other. */
const PLOTS: readonly (readonly [id: string, title: string, quantities: readonly string[]])[] = [
  [
    "position",
    "Position",
    ["predicted_position", "target_position", "external_encoder_position", "encoder_position", "position"],
  ],
  ["velocity", "Velocity", ["predicted_velocity", "target_velocity", "measured_speed", "encoder_velocity", "velocity"]],
  ["acceleration", "Acceleration", ["acceleration"]],
  ["deviation", "Deviation", ["residual", "external_deviation", "deviation", "following_error"]],
  ["load", "Load", ["load_value"]],
  ["angle", "Load angle", ["load_angle"]],
  ["current", "Current scale", ["actual_current_scale", "current_scale"]],
  ["coils", "Coil currents", ["current_a", "current_b"]],
  ["switches", "Switches", ["switch_left", "switch_right", "switch_reference", "switch_home", "position_reached"]],
];
const LOGIC = "switches";
/** Further axes are paler: a quantity keeps its colour. Dashes, of thousands of points, cost a browser its frames. */
const PALER = ["", "a6", "73", "59"];

export function labelOf({ quantity, axis }: Channel, several: boolean): string {
  const words = quantity.replaceAll("_", " ");
  return several ? `${words} ${axis}` : words;
}

/** The colour of a quantity. */
export function colorOfQuantity(quantity: string, scheme: "light" | "dark"): string {
  return colorOf(quantity === "following_error" ? "residual" : quantity, scheme);
}

export function severalAxes(channels: readonly Channel[]): boolean {
  return new Set(channels.map(({ axis }) => axis)).size > 1;
}

/** The plots of a recording from top to bottom; within one, what is measured lies on what was planned. */
export function lanesOf(channels: readonly Channel[], scheme: "light" | "dark"): Lane[] {
  const several = severalAxes(channels);
  const axes = [...new Set(channels.map(({ axis }) => axis))].sort((one, other) => one - other);
  const lanes = new Map<string, Lane & { ranks: number[] }>();
  channels.forEach((channel, column) => {
    const plot = PLOTS.find(([, , quantities]) => quantities.includes(channel.quantity));
    // what has another unit has no scale in common
    const id = `${plot?.[0] ?? channel.quantity}/${channel.unit}`;
    const lane = lanes.get(id) ?? {
      id,
      title: plot?.[1] ?? channel.quantity.replaceAll("_", " "),
      unit: channel.unit,
      columns: [],
      series: [],
      logic: plot?.[0] === LOGIC,
      ranks: [],
    };
    const series: PlotSeries = {
      label: labelOf(channel, several),
      color: `${colorOfQuantity(channel.quantity, scheme)}${PALER[axes.indexOf(channel.axis) % PALER.length]}`,
      unit: channel.unit,
    };
    if (lane.logic || channel.quantity.startsWith("target_")) series.stepped = true;
    const rank = plot?.[2].indexOf(channel.quantity) ?? 0;
    const place = lane.ranks.filter((other) => other <= rank).length;
    lane.ranks.splice(place, 0, rank);
    lane.columns.splice(place, 0, column);
    lane.series.splice(place, 0, series);
    lanes.set(id, lane);
  });
  const order = (lane: Lane) => {
    const at = PLOTS.findIndex(([id]) => lane.id.startsWith(`${id}/`));
    return at < 0 ? PLOTS.length : at;
  };
  return [...lanes.values()].sort((one, other) => order(one) - order(other));
}

export function unitText(unit: string): string {
  return unit === "" ? "" : symbolOf(unit);
}
