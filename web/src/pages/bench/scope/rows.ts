import type { Device } from "../../../api/queries";
import type { Quantity } from "../../../lib/palette";
import { type AxisScale, ratesOf } from "../../../lib/units";

export type RowId =
  | "position"
  | "residual"
  | "deviation"
  | "velocity"
  | "acceleration"
  | "load"
  | "angle"
  | "current"
  | "coils"
  | "switches"
  | "more";
export type Motion = "position" | "velocity" | "acceleration";

export interface RowChannel {
  /** a known one, or the name of any register or parameter */
  quantity: Quantity | (string & {});
  label: string;
  /** shown for axes that are only added to the plot too */
  shared?: boolean;
  /** the cursors give its difference */
  measured?: boolean;
  /** a broad pale band that the measured line lies on: both are seen where they agree */
  band?: boolean;
  thin?: boolean;
}

export interface Row {
  id: RowId;
  title: string;
  motion: Motion | null;
  /** the share of the height */
  grow: number;
  channels: readonly RowChannel[];
}

/** The plots of the scope from top to bottom. What is drawn first lies lowest. */
export const ROWS: readonly Row[] = [
  {
    id: "position",
    title: "Position",
    motion: "position",
    grow: 3,
    channels: [
      { quantity: "predicted_position", label: "predicted", band: true },
      { quantity: "target_position", label: "target", thin: true },
      { quantity: "external_encoder_position", label: "external enc." },
      { quantity: "encoder_position", label: "encoder", measured: true },
      { quantity: "position", label: "position", shared: true, measured: true },
    ],
  },
  {
    id: "residual",
    title: "Residual",
    motion: null,
    grow: 1.4,
    channels: [{ quantity: "residual", label: "residual", measured: true }],
  },
  {
    id: "deviation",
    title: "Deviation",
    motion: null,
    grow: 1.6,
    channels: [
      { quantity: "external_deviation", label: "external enc.", measured: true },
      { quantity: "deviation", label: "encoder", measured: true },
    ],
  },
  {
    id: "velocity",
    title: "Velocity",
    motion: "velocity",
    grow: 2.2,
    channels: [
      { quantity: "predicted_velocity", label: "predicted", band: true },
      { quantity: "target_velocity", label: "target", thin: true },
      { quantity: "measured_speed", label: "measured" },
      { quantity: "encoder_velocity", label: "encoder" },
      { quantity: "velocity", label: "velocity", shared: true, measured: true },
    ],
  },
  {
    id: "acceleration",
    title: "Acceleration",
    motion: "acceleration",
    grow: 1.5,
    channels: [{ quantity: "acceleration", label: "acceleration", shared: true, measured: true }],
  },
  {
    id: "load",
    title: "Load value",
    motion: null,
    grow: 1.4,
    channels: [{ quantity: "load_value", label: "load value", measured: true }],
  },
  {
    id: "angle",
    title: "Load angle",
    motion: null,
    grow: 1.4,
    channels: [{ quantity: "load_angle", label: "electrical", measured: true }],
  },
  {
    id: "current",
    title: "Current scale",
    motion: null,
    grow: 1.2,
    channels: [
      { quantity: "actual_current_scale", label: "of 0..31", measured: true },
      { quantity: "current_scale", label: "of 0..255", measured: true },
    ],
  },
  {
    id: "coils",
    title: "Coil currents",
    motion: null,
    grow: 1.4,
    channels: [
      { quantity: "current_a", label: "A, of ±255", measured: true },
      { quantity: "current_b", label: "B, of ±255", measured: true },
    ],
  },
  {
    id: "switches",
    title: "Switches",
    motion: null,
    grow: 0,
    channels: [
      { quantity: "switch_left", label: "left" },
      { quantity: "switch_reference", label: "reference" },
      { quantity: "switch_home", label: "home" },
      { quantity: "switch_right", label: "right" },
      { quantity: "position_reached", label: "reached" },
    ],
  },
];

const KNOWN: ReadonlySet<string> = new Set(ROWS.flatMap(({ channels }) => channels.map(({ quantity }) => quantity)));
/** So many colours there are, and lines that one can still tell apart. */
export const MORE_MAX = 8;

/** Channels of an axis that no plot of its own has: its other registers or parameters, by name. */
export function furtherOf(device: Device | undefined, axis: number): string[] {
  const own = device?.channels.filter((channel) => channel.axis === axis && !KNOWN.has(channel.quantity)) ?? [];
  return own.map(({ quantity }) => quantity);
}

/** The plot of those that the user chose. */
export function moreRow(chosen: readonly string[]): Row {
  const channels = chosen.map((quantity) => ({ quantity, label: quantity, measured: true, thin: false }));
  return { id: "more", title: "Registers and parameters", motion: null, grow: 2, channels };
}

/** The unit of a row, where positions are shown in `unit`. */
export function unitOf(row: Row, unit: string, scale: Pick<AxisScale, "ratesKnown">): string {
  switch (row.motion) {
    case "position":
      return unit;
    case "velocity":
      return ratesOf(unit, scale).velocity;
    case "acceleration":
      return ratesOf(unit, scale).acceleration;
    default:
      if (row.id === "angle") return "deg";
      return row.id === "residual" || row.id === "deviation" ? "microsteps" : "";
  }
}

/** Lanes of the switches: lane `index` of `count` from the top, its low and high level. */
export function lane(index: number, count: number): { low: number; height: number } {
  return { low: count - 1 - index + 0.18, height: 0.64 };
}
