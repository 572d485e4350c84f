import type { Schemas } from "../../../api/client";
import type { StudyInfo } from "../study";

export type Scored = Schemas["Scored"];

/** A scored move of the list. */
export interface Move extends StudyInfo {
  scored: Scored;
}

/** What moves are ranked by; the less, the better. */
export const FIGURES = {
  time_s: { label: "time", unit: "s" },
  overshoot_fullsteps: { label: "overshoot", unit: "full steps" },
  peak_fullsteps: { label: "deviation", unit: "full steps" },
  vibration_fullsteps: { label: "vibration", unit: "full steps" },
  rest_fullsteps: { label: "vibration at its end", unit: "full steps" },
} as const;
export type Figure = keyof typeof FIGURES;

export function isMove(study: StudyInfo): study is Move {
  return study.scored !== null;
}

/** How far each of the moves went, either way, the latest's first: moves of one distance can be compared. */
export function distancesOf(moves: readonly Move[]): number[] {
  const latest = [...moves].sort((one, other) => other.started_unix_s - one.started_unix_s);
  return [...new Set(latest.map(({ scored }) => Math.abs(scored.distance)))];
}

/** The best first: those that lost steps, and those without that figure, come last. */
export function ranked(moves: readonly Move[], by: Figure): Move[] {
  const worth = ({ scored }: Move) => (scored.lost_fullsteps > 0 ? Number.POSITIVE_INFINITY : (scored[by] ?? 1e300));
  return [...moves].sort((one, other) => {
    const [a, b] = [worth(one), worth(other)];
    return a === b ? one.started_unix_s - other.started_unix_s : a - b;
  });
}

/** The settings that are not the same in all moves: what somebody has changed. */
export function changedIn(moves: readonly Move[]): string[] {
  const names = [...new Set(moves.flatMap(({ setting }) => Object.keys(setting)))];
  return names.filter((name) => new Set(moves.map(({ setting }) => setting[name])).size > 1);
}

/** What taking `move` sets other than it was in the latest move: name, from, to. */
export function differences(move: Move, latest: Move): [name: string, from: number | null, to: number | null][] {
  return Object.keys({ ...latest.setting, ...move.setting })
    .filter((name) => latest.setting[name] !== move.setting[name])
    .map((name) => [name, latest.setting[name] ?? null, move.setting[name] ?? null]);
}

/** Axes of parallel coordinates, and how high each move crosses them: 0 to 1, null where it has no such figure. */
export function parallelOf(moves: readonly Move[], by: Figure) {
  const { label, unit } = FIGURES[by];
  const axes = [
    ...changedIn(moves).map((name) => ({ name, of: ({ setting }: Move) => setting[name] ?? null })),
    { name: `${label} [${unit}]`, of: ({ scored }: Move) => scored[by] },
  ].map(({ name, of }) => {
    const values = moves.map(of).filter((value) => value !== null);
    return { name, of, low: Math.min(...values), high: Math.max(...values) };
  });
  const heights = (move: Move) =>
    axes.map(({ of, low, high }) => {
      const value = of(move);
      return value === null ? null : high > low ? (value - low) / (high - low) : 0.5;
    });
  return { axes, heights };
}
