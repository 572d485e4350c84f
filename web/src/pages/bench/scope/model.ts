import { can, type Device } from "../../../api/queries";
import { fixed } from "../../../lib/format";
import { colorOf, lineOf } from "../../../lib/palette";
import { type AxisScale, factorOf, scaleOf } from "../../../lib/units";
import type { TelemetryRequest } from "../../../live/request";
import type { PlotSeries } from "../../../plots/types";
import { lane, moreRow, ROWS, type Row, type RowChannel, unitOf } from "./rows";
import { type ExtraAxis, keepS, type ScopeSettings } from "./settings";

/** One line of the scope: a channel of one axis of one device, in the unit of its row. */
export interface ScopeTrace {
  key: string;
  device: string;
  channel: string;
  quantity: string;
  label: string;
  unit: string;
  divisor: number;
  offset: number;
  decimals: number;
  shown: boolean;
  /** of the selected axis, not of an added one */
  main: boolean;
  measured: boolean;
  series: PlotSeries;
}

export interface ScopeRow {
  row: Row;
  unit: string;
  traces: ScopeTrace[];
}

/** Dashes tell further axes apart: a quantity keeps its colour on every page. */
export const DASHES: readonly number[][] = [
  [6, 3],
  [2, 2],
  [9, 3, 2, 3],
  [4, 6],
];

function decimalsFor(factor: number): number {
  // one microstep should be seen to move
  return Math.max(0, Math.min(4, Math.ceil(Math.log10(factor))));
}

export interface AxisRef extends ExtraAxis {
  device: string;
  axis: number;
}

/** Channels of a device without any axis stand under axis 0. */
function find(devices: readonly Device[], ref: AxisRef): { device: Device; scale: AxisScale; name: string } | null {
  const device = devices.find((candidate) => candidate.id === ref.device);
  const axis = device?.axes.find((candidate) => candidate.index === ref.axis);
  if (!device || (!axis && device.axes.length > 0)) return null;
  return { device, scale: scaleOf(axis, device.clock_hz), name: axis ? `${device.name} ${axis.name}` : device.name };
}

interface SeriesLook {
  color: string;
  scheme: "light" | "dark";
  dash: number[] | undefined;
  stepped: boolean;
}

function seriesOf(channel: RowChannel, label: string, { color, scheme, dash, stepped }: SeriesLook) {
  const series: PlotSeries = { label, color: channel.band ? `${color}${scheme === "dark" ? "8c" : "66"}` : color };
  if (channel.band) series.width = 5;
  if (stepped || channel.thin) series.stepped = true;
  if (dash) series.dash = dash;
  else if (channel.thin) series.dash = [4, 3];
  return series;
}

/** The rows of the scope with their traces: those of the selected axis, then those of the added ones. */
export function buildRows(
  devices: readonly Device[],
  main: AxisRef,
  settings: ScopeSettings,
  scheme: "light" | "dark",
): ScopeRow[] {
  const all = [main, ...settings.extras.filter((extra) => extra.device !== main.device || extra.axis !== main.axis)];
  const mainAxis = find(devices, main);
  return rowsOf(mainAxis?.device, main.axis, settings.more).flatMap((row) => {
    if (row.id !== "more" && !settings.rows.includes(row.id)) return [];
    const rates = mainAxis?.scale ?? {};
    const wanted = unitOf(row, settings.unit, rates);
    const known = mainAxis && row.motion ? factorOf(wanted, mainAxis.scale, row.motion) !== null : true;
    const unit = known ? wanted : unitOf(row, "microsteps", rates);
    const traces = all.flatMap((ref, index) => {
      const found = find(devices, ref);
      if (!found) return [];
      const channels = index === 0 ? row.channels : row.channels.filter((channel) => channel.shared);
      return channels.flatMap((channel): ScopeTrace[] => {
        const name = `${channel.quantity}.${ref.axis}`;
        if (!found.device.channels.some((offered) => offered.name === name)) return [];
        const factor = row.motion ? (factorOf(unit, found.scale, row.motion) ?? Number.NaN) : 1;
        const place = row.id === "switches" ? lane(row.channels.indexOf(channel), row.channels.length) : null;
        const label = index === 0 ? channel.label : `${found.name}`;
        const key = index === 0 ? channel.quantity : `${ref.device}/${name}`;
        const shown = !settings.hidden.includes(key);
        // of two of a kind in a row one is dashed, no other: dashes cost frames
        const color = colorOf(channel.quantity, scheme);
        const alone = row.channels.every((other) => other === channel || colorOf(other.quantity, scheme) !== color);
        const own = alone ? undefined : lineOf(channel.quantity, scheme).dash;
        const dash = index === 0 ? own : DASHES[(index - 1) % DASHES.length];
        const series = seriesOf(channel, label, {
          color,
          scheme,
          dash,
          stepped: place !== null,
        });
        if (!shown) series.hidden = true;
        if (place) {
          series.fill = `${color}50`;
          series.fillTo = place.low;
        }
        return [
          {
            key,
            device: ref.device,
            channel: name,
            quantity: channel.quantity,
            label,
            unit,
            divisor: place ? 1 / place.height : factor,
            offset: place?.low ?? 0,
            decimals: row.motion ? decimalsFor(factor) : 0,
            shown,
            main: index === 0,
            measured: index === 0 && channel.measured === true,
            series,
          },
        ];
      });
    });
    return [{ row, unit, traces }];
  });
}

/** The plots that make sense for an axis: those it has channels for, without the channels that it has not. */
export function rowsOf(device: Device | undefined, axis: number, more: readonly string[] = []): readonly Row[] {
  if (device === undefined || device.channels.length === 0) return ROWS;
  const offered = new Set(device.channels.map((channel) => channel.name));
  return [...ROWS, moreRow(more)].flatMap((row) => {
    const channels = row.channels.filter((channel) => offered.has(`${channel.quantity}.${axis}`));
    return channels.length === 0 ? [] : [{ ...row, channels }];
  });
}

/** What has to be asked of each device, the selected one first: its rate as wished, but no faster than it can. */
export function requestsFor(devices: readonly Device[], main: AxisRef, settings: ScopeSettings): TelemetryRequest[] {
  const order = [main.device, ...settings.extras.map((extra) => extra.device)];
  return [...new Set(order)].flatMap((id) => {
    const device = devices.find((candidate) => candidate.id === id);
    if (!device) return [];
    // On a module's wire every channel costs a question: none is asked that is not on show.
    const sparing = can(device, "parameters");
    const wanted = [...ROWS, moreRow(settings.more)].flatMap((row) =>
      row.channels.flatMap((channel) => {
        const chosen = row.id === "more" || settings.rows.includes(row.id);
        if (sparing && !(chosen && !settings.hidden.includes(channel.quantity))) return [];
        const axes = settings.extras
          .filter((extra) => extra.device === id && channel.shared)
          .map((extra) => extra.axis);
        if (id === main.device) axes.unshift(main.axis);
        return axes.map((axis) => `${channel.quantity}.${axis}`);
      }),
    );
    const offered = new Set(device.channels.map((channel) => channel.name));
    const channels = [...new Set(wanted)].filter((name) => offered.has(name));
    if (channels.length === 0) return [];
    const rateHz = Math.min(settings.rateHz, device.rate_max_hz);
    return [{ device: id, channels, rateHz, keepS: keepS(rateHz) }];
  });
}

/** A value of a trace as text, in the unit of its row. Switches say on and off. */
export function valueText(trace: ScopeTrace, raw: number): string {
  if (trace.quantity.startsWith("switch") || trace.quantity === "position_reached")
    return Number.isNaN(raw) ? "–" : raw > 0.5 ? "on" : "off";
  return fixed(raw / trace.divisor, trace.decimals);
}
