import { coordinate } from "../../lib/format";
/** The share of what there is that is used, 0 to 100; null where nobody knows. */
export function usedPercent(used: number | null, total: number | null): number | null {
  return used === null || total === null || total <= 0 ? null : Math.min(100, (used / total) * 100);
}

/** Nearly used up is told before it is. */
export type Tone = "well" | "soon" | "bad";

export function toneOf(percent: number | null): Tone {
  return percent === null || percent < 80 ? "well" : percent < 95 ? "soon" : "bad";
}

/** A late loop is seen as a jerk in plots from about 50 ms on; a stop has 100 ms. */
export function toneOfLag(ms: number | null): Tone {
  return ms === null || ms < 50 ? "well" : ms < 100 ? "soon" : "bad";
}

/** The lines of a sparkline as points "x,y" of a box 0 to `width` and 0 to `height`; null is a gap. */
export function sparklines(values: readonly (number | null)[], top: number, width: number, height: number): string[] {
  const lines: string[][] = [];
  let open: string[] | null = null;
  values.forEach((value, index) => {
    if (value === null) {
      open = null;
      return;
    }
    if (open === null) {
      open = [];
      lines.push(open);
    }
    const x = values.length < 2 ? 0 : (index / (values.length - 1)) * width;
    const y = height - (Math.min(value, top) / top) * height;
    open.push(`${coordinate(x, 1)},${coordinate(y, 1)}`);
  });
  return lines.map((line) => (line.length === 1 ? `${line[0]} ${line[0]}` : line.join(" ")));
}

const STEPS = [5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10000];

/** What the top of the sparkline stands for: a round figure, so that the scale does not dance. */
export function topOf(values: readonly (number | null)[]): number {
  const most = Math.max(0, ...values.map((value) => value ?? 0));
  return STEPS.find((step) => step >= most) ?? most;
}

/** 2 d 3 h, 4 h 5 min, 6 min, 7 s. */
export function uptime(seconds: number): string {
  const minutes = Math.floor(seconds / 60);
  const hours = Math.floor(minutes / 60);
  const days = Math.floor(hours / 24);
  if (days > 0) return `${days} d ${hours % 24} h`;
  if (hours > 0) return `${hours} h ${minutes % 60} min`;
  return minutes > 0 ? `${minutes} min` : `${Math.floor(seconds)} s`;
}
