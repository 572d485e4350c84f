import type uPlot from "uplot";
import type { PlotData } from "./series";

export interface PlotSeries {
  label: string;
  /** for the current colour scheme: `colorOf(quantity, useScheme())`, or any CSS colour */
  color: string;
  unit?: string;
  /** which y scale; "y" by default */
  scale?: string;
  /** in device pixels, 1 by default: thin lines are several times cheaper to draw in software */
  width?: number;
  dash?: number[];
  /** held until the next sample: switches, register values */
  stepped?: boolean;
  /** dots of this diameter [px]; with `line: false` dots alone */
  dots?: number;
  line?: boolean;
  /** a CSS colour between the line and `fillTo` (0 by default) */
  fill?: string;
  fillTo?: number;
  hidden?: boolean;
  /** it goes with another one, and has no place of its own in the legend */
  unnamed?: boolean;
}

export interface PlotScale {
  label?: string;
  unit?: string;
  side?: "left" | "right";
  /** fixed, or from the data; by default a calm range on round numbers */
  range?: readonly [number, number] | ((min: number, max: number) => [number, number]);
  /** values that must always be seen, such as 0 */
  include?: readonly number[];
  /** false: no axis is drawn for it */
  axis?: boolean;
  /** tick labels; by default numbers with as many decimals as the ticks need */
  ticks?: (values: number[]) => string[];
  /** where the ticks are, when round numbers are not wanted */
  at?: number[];
  log?: boolean;
}

/** A line with its own x column over the plot: a predicted ramp, a reference curve. It counts for the y range. */
export interface Overlay {
  x: ArrayLike<number>;
  y: ArrayLike<number>;
  shift?: number;
  scale?: string;
  color: string;
  dash?: number[];
  width?: number;
  /** dots of this diameter [px] instead of a line; their x need not rise */
  dots?: number;
  /** how many of the columns count; all by default */
  length?: number;
  /** it does not count for the y range */
  aside?: boolean;
}

/** A horizontal line: a limit, a threshold. It does not count for the y range: beyond it, its name stands at the edge. */
export interface Level {
  id: string;
  y: number;
  color: string;
  scale?: string;
  label?: string;
  /** it cannot be dragged */
  fixed?: boolean;
}

/** A vertical line that can be dragged: a measuring cursor, a limit, the trigger. */
export interface Mark {
  id: string;
  x: number;
  color: string;
  label?: string;
  /** its name stands at the lower end: where the upper one is taken */
  low?: boolean;
  fixed?: boolean;
}

export interface PlotHandle {
  /** New columns, drawn now. `window` also sets what part of x is seen; without it that stays (or, at first, is all). */
  setData(data: PlotData, window?: readonly [number, number]): void;
  setWindow(min: number, max: number): void;
  /** Back to the whole x range. */
  reset(): void;
  /** Draw again: overlays or marks have changed. */
  redraw(): void;
  readonly uplot: uPlot | null;
}

/** How the x window was changed, for a parent that follows: wheel, drag, keys, or asked back to the whole. */
export type WindowChange = { min: number; max: number } | "reset";
