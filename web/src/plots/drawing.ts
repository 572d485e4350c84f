import type uPlot from "uplot";
import { FAMILY } from "../font";
import { TEXT_PX } from "./labels";
import { lowerBound } from "./series";
import type { Level, Mark, Overlay } from "./types";

/** More pixels than any plot has from left to right. */
const PLACES_ACROSS = 1 << 16;

/** Lines and dots with their own x columns, levels and marks, on top of the series, clipped to the plot. */
export function drawingPlugin(
  overlays: () => readonly Overlay[],
  marks: () => readonly Mark[],
  levels: () => readonly Level[],
): uPlot.Plugin {
  function draw(plot: uPlot) {
    const { ctx, bbox } = plot;
    const ratio = window.devicePixelRatio || 1;
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    for (const overlay of overlays())
      if (overlay.dots === undefined) drawOverlay(plot, overlay, ratio);
      else drawDots(plot, overlay, overlay.dots * ratio);
    for (const level of levels()) drawLevel(plot, level, ratio);
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
  const last = Math.min((overlay.length ?? overlay.x.length) - 1, lowerBound(overlay.x, max - shift));
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

function drawDots(plot: uPlot, overlay: Overlay, size: number) {
  const { ctx } = plot;
  const scale = overlay.scale ?? "y";
  const { min: left, max: right } = plot.scales.x ?? {};
  const { min: low, max: high } = plot.scales[scale] ?? {};
  if (left == null || right == null || low == null || high == null) return;
  const { bbox } = plot;
  const perX = bbox.width / (right - left);
  const perY = bbox.height / (high - low);
  const shift = overlay.shift ?? 0;
  ctx.fillStyle = overlay.color;
  // squares, and each place once: thousands of arcs, or of squares upon each other, would cost a frame
  const drawn = new Set<number>();
  for (let row = 0; row < (overlay.length ?? overlay.x.length); row++) {
    const px = Math.round(bbox.left + ((overlay.x[row] as number) + shift - left) * perX - size / 2);
    const py = Math.round(bbox.top + (high - (overlay.y[row] as number)) * perY - size / 2);
    const place = py * PLACES_ACROSS + px;
    if (drawn.has(place)) continue;
    drawn.add(place);
    ctx.fillRect(px, py, size, size);
  }
}

/** Where a level is drawn [canvas px], and on which side of the plot it lies if it is not on it. */
export function placeOfLevel(py: number, top: number, height: number): { at: number; beyond: "" | "↑" | "↓" } {
  if (py < top) return { at: top, beyond: "↑" };
  return py > top + height ? { at: top + height, beyond: "↓" } : { at: py, beyond: "" };
}

function drawLevel(plot: uPlot, level: Level, ratio: number) {
  const { ctx, bbox } = plot;
  const scale = level.scale ?? "y";
  if (plot.scales[scale]?.min == null) return;
  const { at, beyond } = placeOfLevel(plot.valToPos(level.y, scale, true), bbox.top, bbox.height);
  if (beyond === "") {
    const py = Math.round(at) + 0.5;
    ctx.beginPath();
    ctx.moveTo(bbox.left, py);
    ctx.lineTo(bbox.left + bbox.width, py);
    ctx.strokeStyle = level.color;
    ctx.lineWidth = 1;
    ctx.setLineDash(level.fixed ? [5 * ratio, 4 * ratio] : []);
    ctx.stroke();
  }
  if (!level.label) return;
  const text = beyond === "" ? level.label : `${level.label} ${beyond}`;
  ctx.font = `600 ${TEXT_PX * ratio}px ${FAMILY}`;
  const wide = ctx.measureText(text).width + 6 * ratio;
  const high = 16 * ratio;
  // above its line, but for the top of the plot
  const top = Math.max(bbox.top, Math.min(bbox.top + bbox.height - high, at - high));
  ctx.fillStyle = level.color;
  ctx.fillRect(bbox.left + bbox.width - wide, top, wide, high);
  ctx.fillStyle = "#fff";
  ctx.textAlign = "left";
  ctx.textBaseline = "middle";
  ctx.fillText(text, bbox.left + bbox.width - wide + 3 * ratio, top + 8.5 * ratio);
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
  ctx.font = `600 ${TEXT_PX * ratio}px ${FAMILY}`;
  const wide = ctx.measureText(mark.label).width + 6 * ratio;
  const right = px + wide > bbox.left + bbox.width;
  const left = right ? px - wide : px;
  const top = mark.low ? bbox.top + bbox.height - 16 * ratio : bbox.top;
  ctx.fillStyle = mark.color;
  ctx.fillRect(left, top, wide, 16 * ratio);
  ctx.fillStyle = "#fff";
  ctx.textAlign = "left";
  ctx.textBaseline = "middle";
  ctx.fillText(mark.label, left + 3 * ratio, top + 8.5 * ratio);
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
    if ((overlay.scale ?? "y") !== scale || overlay.aside) continue;
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
