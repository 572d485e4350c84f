import type { Schemas } from "../../../api/client";
import { dateTimeOf } from "../../../lib/time";
import type { StudyInfo } from "../study";
import type { Trials } from "../trials/points";

export type Scored = Schemas["Scored"];

/** A scored move of the list. */
export interface Move extends StudyInfo {
  scored: Scored;
}

/** What moves are ranked by: the less, the better, or the more. */
export const FIGURES = {
  time_s: { label: "time", unit: "s", more: false },
  overshoot_fullsteps: { label: "overshoot", unit: "full steps", more: false },
  peak_fullsteps: { label: "deviation", unit: "full steps", more: false },
  vibration_fullsteps: { label: "vibration", unit: "full steps", more: false },
  rest_fullsteps: { label: "vibration at its end", unit: "full steps", more: false },
  load_min: { label: "load, least", unit: "", more: true },
  load_margin: { label: "load above a stall's, least", unit: "", more: true },
  reached: { label: "way until a stall", unit: "1", more: true },
} as const;
export type Figure = keyof typeof FIGURES;

/** As the head of a column. */
export function titleOf(figure: Figure): string {
  const { label, unit } = FIGURES[figure];
  return unit === "" ? label : `${label} [${unit}]`;
}

/** Why a move has no time: steps were lost, or a stall ended it; empty where neither is so. */
export function endedBy({ scored }: Move): string {
  const stall = scored.stalls > 0 ? `stall at ${Math.round(100 * scored.reached)} %` : "";
  return [stall, scored.lost_fullsteps > 0 ? "steps lost" : ""].filter(Boolean).join(", ");
}

export function isMove(study: StudyInfo): study is Move {
  return study.scored !== null;
}

/** How far each of the moves went, either way, the latest's first: moves of one distance can be compared. */
export function distancesOf(moves: readonly Move[]): number[] {
  const latest = [...moves].sort((one, other) => other.started_unix_s - one.started_unix_s);
  return [...new Set(latest.map(({ scored }) => Math.abs(scored.distance)))];
}

/** The best first: behind them those without that figure, those that a stall ended (the farthest first), and last those that lost steps. */
export function ranked(moves: readonly Move[], by: Figure): Move[] {
  const worth = ({ scored }: Move): [group: number, figure: number] => {
    if (scored.lost_fullsteps > 0) return [3, 0];
    if (scored.stalls > 0) return [2, -scored.reached];
    const figure = scored[by];
    return figure === null ? [1, 0] : [0, FIGURES[by].more ? -figure : figure];
  };
  return [...moves].sort((one, other) => {
    const [a, b] = [worth(one), worth(other)];
    return a[0] - b[0] || a[1] - b[1] || one.started_unix_s - other.started_unix_s;
  });
}

/** The settings that are not the same in all moves of which they are known: what somebody has changed. */
export function changedIn(moves: readonly Move[]): string[] {
  const names = [...new Set(moves.flatMap(({ setting }) => Object.keys(setting)))];
  const known = (name: string) => moves.map(({ setting }) => setting[name]).filter((value) => value !== undefined);
  return names.filter((name) => new Set(known(name)).size > 1);
}

/** What taking `move` sets other than it was in the latest move: name, from, to. */
export function differences(move: Move, latest: Move): [name: string, from: number | null, to: number][] {
  return Object.entries(move.setting)
    .filter(([name, value]) => latest.setting[name] !== value)
    .map(([name, value]) => [name, latest.setting[name] ?? null, value]);
}

/** Moves that are ranked by a figure, as points: what was changed between them, and that figure. */
export function pointsOf(moves: readonly Move[], by: Figure): Trials {
  const names = changedIn(moves);
  const { label, unit, more } = FIGURES[by];
  return {
    settings: names.map((text) => {
      const [, name = text, unit = ""] = /^(.*) \[(.*)\]$/.exec(text) ?? [];
      return { name, unit };
    }),
    figures: [{ name: label, unit, more }],
    points: moves.map(({ setting, scored, started_unix_s: started }, index) => ({
      number: index,
      name: `Move of ${dateTimeOf(started * 1000)}`,
      state: scored.lost_fullsteps > 0 || scored.stalls > 0 ? "lost" : "held",
      values: [...names.map((name) => setting[name] ?? null), scored[by]],
    })),
    best: moves[0]?.scored.lost_fullsteps === 0 && moves[0].scored.stalls === 0 ? 0 : null,
    lost: "lost steps, or stalled",
  };
}
