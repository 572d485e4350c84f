import type { Problem, Schemas } from "../../api/client";
import { type RegisterRow, readable } from "../../lib/rows/bits";
import { READ_BACK, WRITTEN_BLIND } from "../../lib/rows/proof";
import { byName } from "./diff";
import type { Applied } from "./useProfiles";

export { READ_BACK, WRITTEN_BLIND };

export type Fate = typeof READ_BACK | typeof WRITTEN_BLIND | "written" | "failed" | "gone back" | "left" | "not begun";
type Change = Pick<Schemas["RegisterChange"], "name" | "axis" | "was" | "now" | "why">;

export interface StepLine extends Change {
  fate: Fate;
}

/** Each write of a profile that was applied, and whether the chip could be asked for it: null rows, nobody knows yet. */
export function writtenLines({ written }: Pick<Applied, "written">, rows: readonly RegisterRow[] | null): StepLine[] {
  const known = rows === null ? null : byName(rows);
  return written.map((change) => {
    const find = (axis: number | null) => known?.get(`${axis ?? "-"}/${change.name.toLowerCase()}`);
    const row = find(change.axis) ?? find(null);
    const fate = row === undefined ? "written" : readable(row.access) ? READ_BACK : WRITTEN_BLIND;
    return { ...change, fate };
  });
}

/** What became of each write of a transaction that failed; nothing where it failed before it wrote. */
export function fatesOf(problem: Problem, dry: Pick<Applied, "differences">): StepLine[] {
  const failed = changeOf(problem.facts.failed);
  const done = problem.facts.written;
  if (failed === null || typeof done !== "number") return [];
  const left = Array.isArray(problem.facts.left)
    ? problem.facts.left.map(changeOf).filter((each) => each !== null)
    : [];
  const writes = dry.differences.filter(({ kind, written }) => written && !SETTINGS.has(kind));
  const fateOf = (name: string, axis: number | null, index: number): Fate => {
    if (left.some((each) => each.name === name && each.axis === axis)) return "left";
    if (failed.name === name && failed.axis === axis) return "failed";
    return index < done ? "gone back" : "not begun";
  };
  const lines = writes.map(({ name, axis, left: was }, index): StepLine => {
    const fate = fateOf(name, axis, index);
    const before = typeof was === "number" ? was : null;
    const stuck = left.find((each) => each.name === name && each.axis === axis);
    const why = stuck?.why ?? (fate === "failed" ? failed.why : "");
    return { name, axis, was: before, now: stuck ? stuck.now : before, why, fate };
  });
  // what went astray is no write of the profile's
  const astray = left.filter((each) => !lines.some(({ name, axis }) => name === each.name && axis === each.axis));
  return [...lines, ...astray.map((each) => ({ ...each, fate: "left" as const }))];
}

const SETTINGS: ReadonlySet<string> = new Set(["mechanics", "limits", "clock"]);

function changeOf(fact: unknown): Change | null {
  if (typeof fact !== "object" || fact === null) return null;
  const { name, axis, was, now, why } = fact as Record<string, unknown>;
  const number = (value: unknown) => (typeof value === "number" ? value : null);
  return {
    name: String(name ?? ""),
    axis: number(axis),
    was: number(was),
    now: number(now),
    why: String(why ?? ""),
  };
}
