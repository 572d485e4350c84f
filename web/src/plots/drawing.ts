import type uPlot from "uplot";
import { lowerBound } from "./series";
import type { Mark, Overlay } from "./types";

/** Lines with their own x columns, and marks, on top of the series, clipped to the plot. */
export function drawingPlugin(overlays: () => readonly Overlay[], marks: () => readonly Mark[]): uPlot.Plugin {
  function draw(plot: uPlot) {
    const { ctx, bbox } = plot;
    const ratio = window.devicePixelRatio || 1;
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    for (const overlay of overlays()) drawOverlay(plot, overlay, ratio);
    for (const mark of marks()) drawMark(plot, mark, ratio);
    ctx.restore();
  }
  return { hooks: { draw } };
}

function drawOverlay(plot: uPlot, overlay: Overlay, ratio: number) {
  const { min = 0, max = 1 } = plot.scales.x as { min?: number; max?: number };
  const { ctx } = plot;
  const shift = overlay.shift ?? 0;
  const scale = overlay.scale ?? "y";
  if (plot.scales[scale]?.min == null) return;
  const first = Math.max(0, lowerBound(overlay.x, min - shift) - 1);
  const last = Math.min(overlay.x.length - 1, lowerBound(overlay.x, max - shift));
  ctx.beginPath();
  let pen = false;
  for (let row = first; row <= last; row++) {
    const value = overlay.y[row] as number;
    if (Number.isNaN(value)) {
      pen = false;
      continue;
    }
    const px = plot.valToPos((overlay.x[row] as number) + shift, "x", true);
    const py = plot.valToPos(value, scale, true);
    if (pen) ctx.lineTo(px, py);
    else ctx.moveTo(px, py);
    pen = true;
  }
  ctx.strokeStyle = overlay.color;
  ctx.lineWidth = overlay.width ?? 1;
  ctx.setLineDash((overlay.dash ?? []).map((length) => length * ratio));
  ctx.stroke();
}

function drawMark(plot: uPlot, mark: Mark, ratio: number) {
  const { ctx, bbox } = plot;
  const px = Math.round(plot.valToPos(mark.x, "x", true)) + 0.5;
  if (px < bbox.left - 1 || px > bbox.left + bbox.width + 1) return;
  ctx.beginPath();
  ctx.moveTo(px, bbox.top);
  ctx.lineTo(px, bbox.top + bbox.height);
  ctx.strokeStyle = mark.color;
  ctx.lineWidth = 1;
  ctx.setLineDash(mark.fixed ? [2 * ratio, 4 * ratio] : []);
  ctx.stroke();
  if (!mark.label) return;
  ctx.font = `600 ${10 * ratio}px system-ui, sans-serif`;
  const wide = ctx.measureText(mark.label).width + 6 * ratio;
  const right = px + wide > bbox.left + bbox.width;
  const left = right ? px - wide : px;
  ctx.fillStyle = mark.color;
  ctx.fillRect(left, bbox.top, wide, 14 * ratio);
  ctx.fillStyle = "#fff";
  ctx.textAlign = "left";
  ctx.textBaseline = "middle";
  ctx.fillText(mark.label, left + 3 * ratio, bbox.top + 7.5 * ratio);
}

/** min and max of the overlays of one scale within min..max of x, joined with the data's own. */
export function withOverlays(
  overlays: readonly Overlay[],
  scale: string,
  [xMin, xMax]: readonly [number, number],
  [yMin, yMax]: readonly [number, number],
): [number, number] {
  let low = yMin;
  let high = yMax;
  for (const overlay of overlays) {
    if ((overlay.scale ?? "y") !== scale) continue;
    const shift = overlay.shift ?? 0;
    const last = Math.min(overlay.x.length, lowerBound(overlay.x, xMax - shift) + 1);
    for (let row = Math.max(0, lowerBound(overlay.x, xMin - shift) - 1); row < last; row++) {
      const value = overlay.y[row] as number;
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
  return [low, high];
}
