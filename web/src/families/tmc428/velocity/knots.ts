import { rounded } from "../../../lib/format";
/** A velocity over time as knots, the lines between them straight. */
export interface Knot {
  timeS: number;
  pps: number;
}

export const KNOTS_DRAWN_MAX = 60;

/** Knots as lines of "time, velocity". */
export const textOf = (knots: readonly Knot[]): string =>
  knots.map(({ timeS, pps }) => `${rounded(timeS, 9)}, ${rounded(pps, 9)}`).join("\n");

/** Two columns, time in seconds and velocity in pps, by comma, semicolon or tab; a head line and # are passed over. */
export function parsed(text: string): { knots: Knot[] } | { problem: string } {
  const knots: Knot[] = [];
  for (const [index, line] of text.split(/\r?\n/).entries()) {
    const row = line.trim();
    if (row === "" || row.startsWith("#")) continue;
    const cells = row.split(/[,;\t]/).map((cell) => cell.trim());
    const [timeS, pps] = cells.map((cell) => (cell === "" ? Number.NaN : Number(cell)));
    if (cells.length !== 2 || !Number.isFinite(timeS) || !Number.isFinite(pps)) {
      if (knots.length === 0 && cells.length === 2 && cells.every((cell) => Number.isNaN(Number(cell)))) continue;
      return { problem: `Line ${index + 1} is not a time in seconds and a velocity in pps: ${row.slice(0, 40)}` };
    }
    knots.push({ timeS: timeS as number, pps: pps as number });
  }
  if (knots.length < 2)
    return { problem: "A profile has two lines or more: 0, 0 at first and a velocity of 0 at last" };
  return { knots };
}

export type Shape = "trapezoid" | "sine" | "there and back";

/** A usual shape to begin with, of that height and length. */
export function shaped(shape: Shape, peakPps: number, durationS: number): Knot[] {
  if (shape === "trapezoid")
    return [
      { timeS: 0, pps: 0 },
      { timeS: durationS / 4, pps: peakPps },
      { timeS: (3 * durationS) / 4, pps: peakPps },
      { timeS: durationS, pps: 0 },
    ];
  const turns = shape === "sine" ? Math.PI : 2 * Math.PI;
  return Array.from({ length: 33 }, (_, index) => ({
    timeS: (index / 32) * durationS,
    pps: index === 32 ? 0 : Math.round(peakPps * Math.sin((index / 32) * turns)),
  }));
}

/** The knots with one of them elsewhere: between its neighbours in time; the first and the last stay at rest. */
export function moved(knots: readonly Knot[], index: number, timeS: number, pps: number): Knot[] {
  const last = knots.length - 1;
  const before = knots[index - 1]?.timeS ?? 0;
  const after = knots[index + 1]?.timeS ?? Number.POSITIVE_INFINITY;
  const room = Math.min(0.001, (Math.min(after, before + 1) - before) / 4);
  const at = index === 0 ? 0 : Math.min(Math.max(timeS, before + room), after - room);
  return knots.map((knot, place) =>
    place === index ? { timeS: at, pps: index === 0 || index === last ? 0 : Math.round(pps) } : knot,
  );
}

/** The knots with one more in the middle of the widest gap, or without one. */
export function split(knots: readonly Knot[]): Knot[] {
  let widest = 0;
  for (let index = 1; index < knots.length - 1; index++) {
    const gap = (at: number) => (knots[at + 1]?.timeS ?? 0) - (knots[at]?.timeS ?? 0);
    if (gap(index) > gap(widest)) widest = index;
  }
  const [left, right] = [knots[widest], knots[widest + 1]];
  if (!left || !right) return [...knots];
  const middle = { timeS: (left.timeS + right.timeS) / 2, pps: Math.round((left.pps + right.pps) / 2) };
  return [...knots.slice(0, widest + 1), middle, ...knots.slice(widest + 1)];
}
