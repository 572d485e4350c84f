import { type RefObject, useEffect, useRef } from "react";
import type uPlot from "uplot";
import { FAMILY } from "../font";
import { TEXT_PX } from "./labels";
import type { PlotHandle } from "./types";

/** A shaded stretch of x. */
export interface Band {
  from: number;
  to: number;
  /** a CSS colour, translucent */
  color: string;
  label?: string;
  labelColor?: string;
}

function draw(plot: uPlot, bands: readonly Band[]) {
  const { ctx, bbox } = plot;
  const ratio = window.devicePixelRatio || 1;
  ctx.save();
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  for (const band of bands) {
    const left = Math.max(bbox.left, plot.valToPos(band.from, "x", true));
    const right = Math.min(bbox.left + bbox.width, plot.valToPos(band.to, "x", true));
    if (!(right > left)) continue;
    ctx.fillStyle = band.color;
    ctx.fillRect(left, bbox.top, right - left, bbox.height);
    if (!band.label) continue;
    ctx.font = `${TEXT_PX * ratio}px ${FAMILY}`;
    // a name that does not fit is left out: the list of phases has it
    if (ctx.measureText(band.label).width + 8 * ratio > right - left) continue;
    ctx.fillStyle = band.labelColor ?? band.color;
    ctx.textAlign = "center";
    ctx.textBaseline = "top";
    ctx.fillText(band.label, (left + right) / 2, bbox.top + 4 * ratio);
  }
  ctx.restore();
}

/**
 * Shades stretches behind the series of a plot. The plot makes a new uPlot when its colours or series change, in an
 * effect of its own that runs before this one, so each instance is found and hooked once.
 */
export function usePlotBands(handle: RefObject<PlotHandle | null>, bands: readonly Band[]) {
  const latest = useRef(bands);
  const hooked = useRef(new WeakSet<uPlot>());
  useEffect(() => {
    latest.current = bands;
    const plot = handle.current?.uplot;
    if (!plot) return;
    if (!hooked.current.has(plot)) {
      hooked.current.add(plot);
      plot.hooks.drawClear = [...(plot.hooks.drawClear ?? []), (instance) => draw(instance, latest.current)];
    }
    plot.redraw(false, false);
  });
}
