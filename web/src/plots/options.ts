import uPlot from "uplot";
import { fixed } from "../lib/format";
import { symbolOf } from "../lib/units";
import { withOverlays } from "./drawing";
import { CalmRange, decimalsOf } from "./ranges";
import type { Overlay, PlotScale, PlotSeries } from "./types";

interface Look {
  axis: string;
  grid: string;
  tick: string;
}

const LOOKS: Record<"light" | "dark", Look> = {
  light: { axis: "#4b5563", grid: "rgba(15, 23, 42, 0.09)", tick: "rgba(15, 23, 42, 0.18)" },
  dark: { axis: "#a9b1bb", grid: "rgba(255, 255, 255, 0.08)", tick: "rgba(255, 255, 255, 0.16)" },
};

const FONT = '11px system-ui, -apple-system, "Segoe UI", Roboto, sans-serif';
/** Fixed, so that plots above each other line up and nothing moves when a number gets longer. */
const Y_AXIS_PX = 68;
const X_AXIS_PX = 24;

function tickLabels(scale: PlotScale): uPlot.Axis.Values {
  return (_plot, splits, _axis, _space, increment) =>
    scale.ticks
      ? scale.ticks(splits)
      : splits.map((value) => (value === null ? "" : fixed(value, decimalsOf(increment))));
}

function axisOptions(key: string, scale: PlotScale, look: Look, bottom: boolean): uPlot.Axis {
  const title = [scale.label, scale.unit ? `[${symbolOf(scale.unit)}]` : ""].filter(Boolean).join(" ");
  const right = scale.side === "right";
  return {
    scale: key,
    side: bottom ? 2 : right ? 1 : 3,
    show: scale.axis !== false,
    stroke: look.axis,
    font: FONT,
    gap: 4,
    size: bottom ? X_AXIS_PX : Y_AXIS_PX,
    space: bottom ? 72 : 26,
    grid: { show: !right, stroke: look.grid, width: 1 },
    ticks: { stroke: look.tick, width: 1, size: 4 },
    values: tickLabels(scale),
    ...(scale.at ? { splits: () => scale.at ?? [] } : {}),
    ...(bottom && title ? { label: title, labelSize: 16, labelFont: FONT, labelGap: 0 } : {}),
  };
}

function yScale(key: string, scale: PlotScale, overlays: () => readonly Overlay[]): uPlot.Scale {
  const calm = new CalmRange();
  const fixedRange = Array.isArray(scale.range) ? (scale.range as unknown as [number, number]) : null;
  return {
    ...(scale.log ? { distr: 3 as const } : {}),
    range: (plot, dataMin, dataMax) => {
      if (fixedRange) return [...fixedRange];
      const window: [number, number] = [plot.scales.x?.min ?? 0, plot.scales.x?.max ?? 1];
      let [min, max] = withOverlays(overlays(), key, window, [
        dataMin ?? Number.POSITIVE_INFINITY,
        dataMax ?? Number.NEGATIVE_INFINITY,
      ]);
      for (const value of scale.include ?? []) {
        min = Math.min(min, value);
        max = Math.max(max, value);
      }
      if (typeof scale.range === "function") return scale.range(min, max);
      return scale.log ? uPlot.rangeLog(min, max, 10, true) : calm.next(min, max);
    },
  };
}

export interface Build {
  size: { width: number; height: number };
  scheme: "light" | "dark";
  series: readonly PlotSeries[];
  x: PlotScale;
  scales: Readonly<Record<string, PlotScale>>;
  syncKey: string | undefined;
  overlays: () => readonly Overlay[];
  plugins: uPlot.Plugin[];
  selects: boolean;
}

export function scalesUsed(series: readonly PlotSeries[], scales: Readonly<Record<string, PlotScale>>): string[] {
  return [...new Set(["y", ...series.map((entry) => entry.scale ?? "y"), ...Object.keys(scales)])].filter(
    (key) => key in scales || series.some((entry) => (entry.scale ?? "y") === key),
  );
}

/** uPlot's options out of ours. */
export function buildOptions(build: Build): uPlot.Options {
  const look = LOOKS[build.scheme];
  const ratio = window.devicePixelRatio || 1;
  const keys = scalesUsed(build.series, build.scales);
  const bottomless = build.x.axis === false;
  const rightAxis = keys.some((key) => build.scales[key]?.side === "right" && build.scales[key]?.axis !== false);
  return {
    ...build.size,
    padding: [6, rightAxis ? 0 : 14, bottomless ? 4 : 0, 0],
    legend: { show: false },
    cursor: {
      y: false,
      points: { size: 5, width: 1 },
      drag: { x: build.selects, y: false, setScale: false, dist: 5 },
      focus: { prox: -1 },
      ...(build.syncKey
        ? { sync: { key: build.syncKey, scales: ["x", null] as [string, null], setSeries: false } }
        : {}),
    },
    scales: {
      x: { time: false, ...(Array.isArray(build.x.range) ? { range: [...build.x.range] as [number, number] } : {}) },
      ...Object.fromEntries(keys.map((key) => [key, yScale(key, build.scales[key] ?? {}, build.overlays)])),
    },
    axes: [
      axisOptions("x", build.x, look, true),
      ...keys.map((key) => axisOptions(key, build.scales[key] ?? {}, look, false)),
    ],
    series: [
      {},
      ...build.series.map(
        (entry): uPlot.Series => ({
          label: entry.label,
          scale: entry.scale ?? "y",
          show: entry.hidden !== true,
          stroke: entry.color,
          width: entry.line === false ? 0 : (entry.width ?? 1) / ratio,
          points: { show: entry.dots !== undefined, size: entry.dots ?? 4, fill: entry.color, stroke: entry.color },
          ...(entry.dash ? { dash: entry.dash } : {}),
          ...(entry.fill ? { fill: entry.fill, fillTo: entry.fillTo ?? 0 } : {}),
          ...(entry.stepped && uPlot.paths.stepped ? { paths: uPlot.paths.stepped({ align: 1 }) } : {}),
          ...(entry.line === false ? { paths: () => null } : {}),
        }),
      ),
    ],
    plugins: build.plugins,
  };
}
