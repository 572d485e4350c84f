import { coordinate } from "../../lib/format";
import type { BinStats } from "./bins";

/** A round number (1, 2 or 5 times a power of ten) not below `value`. */
export function roundAbove(value: number): number {
  if (!(value > 0)) return 1;
  const power = 10 ** Math.floor(Math.log10(value));
  const lead = value / power;
  return (lead <= 1 ? 1 : lead <= 2 ? 2 : lead <= 5 ? 5 : 10) * power;
}

/** The deviation at the outer ring: the largest mean with its spread, rounded up; `before` stays while it still fits. */
export function reachOf(tables: readonly BinStats[], before: number): number {
  let most = 0;
  for (const bins of tables)
    for (let bin = 0; bin < bins.size; bin++)
      if ((bins.count[bin] as number) > 0)
        most = Math.max(most, Math.abs(bins.mean[bin] as number) + (bins.spread(bin) || 0));
  const wanted = roundAbove(most * 1.05);
  return most <= before && wanted > before * 0.35 ? before : wanted;
}

export interface Ring {
  /** radius of deviation 0, and of the largest one either way */
  zero: number;
  span: number;
  centre: number;
}

/** Angle 0 is on top, and the shaft turns clockwise with a rising count. */
export function pointAt(
  { zero, span, centre }: Ring,
  share: number,
  deviation: number,
  reach: number,
): [number, number] {
  const radius = zero + (deviation / reach) * span;
  const angle = 2 * Math.PI * share;
  return [centre + radius * Math.sin(angle), centre - radius * Math.cos(angle)];
}

/** The mean as a path, broken where bins are empty; closed where none is. */
export function meanPath(bins: BinStats, ring: Ring, reach: number): string {
  let path = "";
  let pen = false;
  let holes = false;
  for (let bin = 0; bin < bins.size; bin++) {
    if ((bins.count[bin] as number) === 0) {
      pen = false;
      holes = true;
      continue;
    }
    const [x, y] = pointAt(ring, (bin + 0.5) / bins.size, bins.mean[bin] as number, reach);
    path += `${pen ? "L" : "M"}${coordinate(x, 1)} ${coordinate(y, 1)}`;
    pen = true;
  }
  return path === "" || holes ? path : `${path}Z`;
}

/** One standard deviation to both sides of the mean, as a filled band of one piece for each run of bins. */
export function bandPath(bins: BinStats, ring: Ring, reach: number): string {
  const edge = (bin: number, sign: number) => {
    const at = ((bin % bins.size) + bins.size) % bins.size;
    const value = (bins.mean[at] as number) + sign * (bins.spread(at) || 0);
    const [x, y] = pointAt(ring, (bin + 0.5) / bins.size, value, reach);
    return `${coordinate(x, 1)} ${coordinate(y, 1)}`;
  };
  const pieces: string[] = [];
  let run: number[] = [];
  const end = () => {
    if (run.length > 1) {
      const out = run.map((bin) => edge(bin, 1));
      const back = [...run].reverse().map((bin) => edge(bin, -1));
      pieces.push(`M${[...out, ...back].join("L")}Z`);
    }
    run = [];
  };
  for (let bin = 0; bin < bins.size; bin++) {
    if ((bins.count[bin] as number) > 0) run.push(bin);
    else end();
  }
  if (run.length === bins.size) run.push(bins.size); // all round: back to the first
  end();
  return pieces.join("");
}
