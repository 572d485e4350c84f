import uPlot from "uplot";
import { fixed } from "../lib/format";
import { symbolOf } from "../lib/units";
import { withOverlays } from "./drawing";
import type { Gutters } from "./gutters";
import { FONT, TEXT_PX, tickTexts, widest } from "./labels";
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

/** The least, so that most numbers change nothing; and the steps in which wider labels widen it. */
const Y_AXIS_PX = 56;
const Y_AXIS_STEP_PX = 8;
const X_AXIS_PX = 24;
const TICK_PX = 4;
const GAP_PX = 4;
const RIGHT_PX = 14;
const X_SPACE_PX = 72;
const Y_SPACE_PX = 26;

/** How much room a y axis with these labels takes [px]. */
function axisWidth(labels: readonly (string | null)[]): number {
  const wanted = widest(labels) + TICK_PX + GAP_PX + 2;
  return Math.max(Y_AXIS_PX, Math.ceil(wanted / Y_AXIS_STEP_PX) * Y_AXIS_STEP_PX);
}

/** Room for a label of the x axis [px]: as long as its bounds are with the decimals of some ten ticks. */
function xSpace(min: number, max: number): number {
  if (!(max > min)) return X_SPACE_PX;
  const decimals = decimalsOf(10 ** Math.floor(Math.log10((max - min) / 10)));
  return Math.max(X_SPACE_PX, widest([fixed(min, decimals), fixed(max, decimals)]) + 2 * TEXT_PX);
}

/** Distance of the labels of a y axis [px]: closer where it is low, so that there are two at least. */
function ySpace(heightPx: number): number {
  return Math.max(TEXT_PX + 2, Math.min(Y_SPACE_PX, heightPx / 4));
}

function tickLabels(scale: PlotScale): uPlot.Axis.Values {
  return (_plot, splits, _axis, _space, increment) => scale.ticks?.(splits) ?? tickTexts(splits, increment);
}

/** What the axes of one plot take on each side [px], as they were last laid out. */
class Sides {
  private readonly sizes = new Map<string, { right: boolean; size: number }>();
  /** how far the labels of the x axis reach beyond its ends */
  overhang = RIGHT_PX;

  set(key: string, right: boolean, size: number): number {
    this.sizes.set(key, { right, size });
    return size;
  }

  sum(right: boolean): number {
    let sum = 0;
    for (const axis of this.sizes.values()) if (axis.right === right) sum += axis.size;
    return sum;
  }
}

function axisOptions(key: string, scale: PlotScale, look: Look, sides: Sides, bottom: boolean): uPlot.Axis {
  const title = [scale.label, scale.unit ? `[${symbolOf(scale.unit)}]` : ""].filter(Boolean).join(" ");
  const right = scale.side === "right";
  return {
    scale: key,
    side: bottom ? 2 : right ? 1 : 3,
    show: scale.axis !== false,
    stroke: look.axis,
    font: FONT,
    gap: GAP_PX,
    size: bottom
      ? (_plot, labels) => {
          sides.overhang = Math.max(sides.overhang, Math.ceil(widest(labels ?? []) / 2) + 2);
          return X_AXIS_PX;
        }
      : (_plot, labels) => sides.set(key, right, axisWidth(labels ?? [])),
    space: (_plot, _axis, min, max, px) => (bottom ? xSpace(min, max) : ySpace(px)),
    grid: { show: !right, stroke: look.grid, width: 1 },
    ticks: { stroke: look.tick, width: 1, size: TICK_PX },
    values: tickLabels(scale),
    ...(scale.at ? { splits: () => scale.at ?? [] } : {}),
    ...(bottom && title ? { label: title, labelSize: 16, labelFont: FONT, labelGap: 0 } : {}),
  };
}

/** The x window that the ranges being worked out belong to. `plot.scales.x` still has the one before. */
interface XWindow {
  now: [number, number];
}

function xScale(scale: PlotScale, window: XWindow): uPlot.Scale {
  const fixedRange = Array.isArray(scale.range) ? (scale.range as unknown as [number, number]) : null;
  return {
    time: false,
    range: (_plot, min, max) => {
      const [from, to] = fixedRange ?? [min, max];
      if (from !== null && to !== null) window.now = [from, to];
      return [from, to];
    },
  };
}

function yScale(key: string, scale: PlotScale, overlays: () => readonly Overlay[], window: XWindow): uPlot.Scale {
  const calm = new CalmRange();
  const fixedRange = Array.isArray(scale.range) ? (scale.range as unknown as [number, number]) : null;
  return {
    ...(scale.log ? { distr: 3 as const } : {}),
    range: (_plot, dataMin, dataMax) => {
      if (fixedRange) return [...fixedRange];
      let [min, max] = withOverlays(overlays(), key, window.now, [
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
  gutters: Gutters<uPlot>;
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
  const ratio = globalThis.devicePixelRatio || 1;
  const keys = scalesUsed(build.series, build.scales);
  const bottomless = build.x.axis === false;
  const { gutters } = build;
  const sides = new Sides();
  const window: XWindow = { now: [0, 1] };
  // What the axes leave of the gutters of its stack. uPlot asks for these after it has sized the axes.
  const beside = (right: boolean) => (plot: uPlot) => {
    const own = { left: sides.sum(false), right: Math.max(sides.sum(true), sides.overhang) };
    gutters.claim(plot, own);
    return right ? gutters.right - sides.sum(true) : gutters.left - own.left;
  };
  return {
    ...build.size,
    padding: [TEXT_PX / 2 + 1, beside(true), bottomless ? TEXT_PX / 2 : 0, beside(false)],
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
      x: xScale(build.x, window),
      ...Object.fromEntries(keys.map((key) => [key, yScale(key, build.scales[key] ?? {}, build.overlays, window)])),
    },
    axes: [
      axisOptions("x", build.x, look, sides, true),
      ...keys.map((key) => axisOptions(key, build.scales[key] ?? {}, look, sides, false)),
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
