import type { RegisterRow } from "../../../lib/rows/bits";
import { type Group, matches } from "../../../lib/rows/search";

const TITLES: Record<string, string> = {
  stealthchop: "StealthChop",
  stallguard: "StallGuard",
  coolstep: "CoolStep",
  "step/dir": "Step/direction",
  variables: "User variables",
};

export function subjectTitle(group: string): string {
  return TITLES[group] ?? `${group.charAt(0).toUpperCase()}${group.slice(1)}`;
}

/** Many of a kind, seldom looked at, and each costs a question on the wire: folded until asked for. */
export function foldedAtFirst(group: string, axis: number): boolean {
  if (/^axis \d/.test(group)) return group !== `axis ${axis}`;
  return group === "variables" || group === "coordinates" || group === "interrupts";
}

/** "maximum_positioning_speed" as the manual writes it. */
export function nameText(name: string): string {
  const words = name.replaceAll("_", " ");
  return words.charAt(0).toUpperCase() + words.slice(1);
}

const PLACES: Record<RegisterRow["space"], string> = {
  register: "register",
  ap: "axis parameter",
  gp0: "global parameter, bank 0",
  gp2: "user variable, bank 2",
  gp3: "interrupt parameter, bank 3",
  in: "digital input",
  pullup: "pull-ups",
  ain: "analog input",
  out: "output",
  coord: "coordinate",
};

export function placeText(row: Pick<RegisterRow, "space">): string {
  return PLACES[row.space];
}

/** Rows by subject, whatever bank they live in, in the catalog's order. */
export function subjectsOf(rows: readonly RegisterRow[], query: string): Group[] {
  const found = new Map<string, Group>();
  for (const row of rows) {
    if (!matches(row, query)) continue;
    const group = found.get(row.group) ?? { key: row.group, title: subjectTitle(row.group), axis: null, rows: [] };
    group.rows.push(row);
    found.set(row.group, group);
  }
  return [...found.values()];
}
