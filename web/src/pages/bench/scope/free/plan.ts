import type { Device } from "../../../../api/queries";
import { compile, type Formula } from "../../../../lib/formula/compile";
import { dimensionOf, unitText } from "../../../../lib/formula/dimension";
import { symbolOf } from "../../../../lib/units";
import type { TelemetryRequest } from "../../../../live/request";
import { type Derived, type FreePlot, keepS } from "../settings";

/** More lines than this nobody tells apart, and more plots have no height. */
const CHANNELS_MAX = 8;
const PLOTS_MAX = 12;
/** A plot has a y axis at each side. */
const UNITS_MAX = 2;

/** A channel of any device: `xy:velocity.1`; a derived one: `=:slip`. The device's id is percent-encoded. */
export function pathOf(device: string, channel: string): string {
  return `${encodeURIComponent(device)}:${channel}`;
}

export interface Place {
  device: string;
  channel: string;
}

/** Null for a derived channel, and for what is no path. */
export function placeOf(path: string): Place | null {
  const at = path.indexOf(":");
  if (at <= 0 || path.startsWith("=")) return null;
  try {
    return { device: decodeURIComponent(path.slice(0, at)), channel: path.slice(at + 1) };
  } catch {
    return null;
  }
}

export const derivedPath = (name: string) => `=:${name}`;
export const derivedName = (path: string) => (path.startsWith("=:") ? path.slice(2) : null);

export type Known = Pick<Device, "id" | "name" | "channels" | "rate_max_hz">;

/** What is known of channels: those that devices offer, and those that are derived of them. */
export class Channels {
  private readonly formulas = new Map<string, Formula | null>();

  constructor(
    readonly devices: readonly Known[],
    readonly derived: Readonly<Record<string, Derived>>,
  ) {}

  /** As a device says it; "" for a plain number. Null: there is no such channel now. */
  unit(path: string): string | null {
    const name = derivedName(path);
    if (name !== null) {
      const formula = this.formula(name);
      return formula && unitText(formula.dimension);
    }
    const place = placeOf(path);
    const device = this.devices.find(({ id }) => id === place?.device);
    const unit = device?.channels.find((channel) => channel.name === place?.channel)?.unit;
    return unit === undefined ? null : symbolOf(unit);
  }

  label(path: string): string {
    const name = derivedName(path);
    if (name !== null) return name;
    const place = placeOf(path);
    const device = this.devices.find(({ id }) => id === place?.device);
    return `${device?.name ?? place?.device ?? "?"} ${place?.channel.replaceAll("_", " ") ?? path}`;
  }

  /** Compiled once; null where it cannot be now: its text is wrong, or a channel of it is not there. */
  formula(name: string): Formula | null {
    const known = this.formulas.get(name);
    if (known !== undefined) return known;
    const derived = Object.hasOwn(this.derived, name) ? this.derived[name] : undefined;
    let formula: Formula | null = null;
    try {
      formula = derived ? compiled(derived, this) : null;
    } catch {
      // the form says what is wrong with it
    }
    this.formulas.set(name, formula);
    return formula;
  }
}

/** Throws a FormulaError. An input whose channel is not there now is a plain number. */
export function compiled({ formula, inputs }: Derived, channels: Channels): Formula {
  const dimensions = Object.entries(inputs).map(([letter, path]) => [letter, inputUnit(path, channels)] as const);
  return compile(formula, Object.fromEntries(dimensions.map(([letter, unit]) => [letter, unit.dimension])));
}

/** What is measured by an input, and how much one of its values is of the dimension's own unit. */
export function inputUnit(path: string, channels: Channels): ReturnType<typeof dimensionOf> {
  const place = placeOf(path);
  const device = channels.devices.find(({ id }) => id === place?.device);
  return dimensionOf(device?.channels.find(({ name }) => name === place?.channel)?.unit ?? "");
}

/** The units of a plot, the first at its left side, the second at its right. */
export function unitsOf(plot: FreePlot, channels: Channels): string[] {
  const shown = plot.kind === "xy" ? plot.y.slice(1) : plot.y;
  return [...new Set(shown.flatMap((path) => channels.unit(path) ?? []))];
}

/** Why a channel cannot be in a plot; null where it can. */
export function refusal(plot: FreePlot, path: string, channels: Channels): string | null {
  const unit = channels.unit(path);
  if (unit === null) return `${channels.label(path)} is not there now`;
  if (plot.y.includes(path)) return `${channels.label(path)} is in this plot already`;
  if (plot.y.length >= CHANNELS_MAX) return `A plot takes ${CHANNELS_MAX} channels`;
  if (plot.kind === "xy" && plot.y.length === 0) return null;
  const units = unitsOf(plot, channels);
  if (units.includes(unit)) return null;
  const most = plot.kind === "time" ? UNITS_MAX : 1;
  if (units.length < most) return null;
  const have = units.map((each) => each || "plain numbers").join(" and ");
  const sides = most === 1 ? "its one y axis" : "its two y axes";
  return `${unit || "A plain number"} has no axis here: ${sides} ${most === 1 ? "is" : "are"} ${have}. Put it into another plot`;
}

/** What has to be asked of each device for these plots. */
export function requestsFor(plots: readonly FreePlot[], channels: Channels, rateHz: number): TelemetryRequest[] {
  const paths = plots
    .flatMap(({ y }) => y)
    .flatMap((path) => {
      const name = derivedName(path);
      return name === null ? [path] : Object.values(channels.derived[name]?.inputs ?? {});
    });
  const wanted = new Map<string, Set<string>>();
  for (const path of paths) {
    const place = placeOf(path);
    if (!place) continue;
    wanted.set(place.device, (wanted.get(place.device) ?? new Set()).add(place.channel));
  }
  return channels.devices.flatMap((device) => {
    const names = [...(wanted.get(device.id) ?? [])].filter((name) =>
      device.channels.some((each) => each.name === name),
    );
    const granted = Math.min(rateHz, device.rate_max_hz);
    return names.length === 0 ? [] : [{ device: device.id, channels: names, rateHz: granted, keepS: keepS(granted) }];
  });
}

/** What a channel that is dragged is called. */
export const DRAGGED = "application/x-stepscope-channel";

/** Adds a channel to a plot, or to a new one where `id` is none's. Says why it cannot, and null where it could. */
export function added(
  free: readonly FreePlot[],
  id: string | null,
  path: string,
  channels: Channels,
): { free: FreePlot[] } | { refused: string } {
  const plot = free.find((each) => each.id === id);
  if (!plot) {
    if (free.length >= PLOTS_MAX) return { refused: `The scope takes ${PLOTS_MAX} plots of your own` };
    const number = 1 + Math.max(0, ...free.map((each) => Number(each.id) || 0));
    return { free: [...free, { id: String(number), kind: "time", y: [path] }] };
  }
  const refused = refusal(plot, path, channels);
  if (refused !== null) return { refused };
  return { free: free.map((each) => (each === plot ? { ...plot, y: [...plot.y, path] } : each)) };
}

/** A plot without a channel is none. */
export function without(free: readonly FreePlot[], id: string, path: string): FreePlot[] {
  return free
    .map((each) => (each.id === id ? { ...each, y: each.y.filter((other) => other !== path) } : each))
    .filter(({ y }) => y.length > 0);
}
