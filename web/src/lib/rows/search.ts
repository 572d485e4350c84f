import { hex } from "../format";
import type { RegisterRow } from "./bits";

export interface Group {
  key: string;
  title: string;
  axis: number | null;
  rows: RegisterRow[];
}

/** RAM words are many and seldom wanted: folded until asked for. */
export function foldedByDefault(group: Pick<Group, "title">): boolean {
  return group.title.includes("RAM");
}

/** True when each word of the query is found in the name, address, group, help or fields of the row. */
export function matches(row: RegisterRow, query: string): boolean {
  const words = query.toLowerCase().split(/\s+/).filter(Boolean);
  if (words.length === 0) return true;
  const text = [
    row.name,
    row.name.replaceAll("_", " "),
    row.alias,
    hex(row.address, 8),
    row.group,
    row.help,
    ...Object.values(row.values),
  ]
    .concat(row.fields.flatMap((field) => [field.name, field.help, ...Object.values(field.values)]))
    .join("\n")
    .toLowerCase();
  return words.every((word) => text.includes(word));
}

/** Names of the fields by which a search found the row; none where the row itself matches. */
export function matchingFields(row: RegisterRow, query: string): string[] {
  const words = query.toLowerCase().split(/\s+/).filter(Boolean);
  if (words.length === 0 || matches({ ...row, fields: [] }, query)) return [];
  return row.fields
    .filter((field) => {
      const text = [field.name, field.help, ...Object.values(field.values)].join("\n").toLowerCase();
      return words.some((word) => text.includes(word));
    })
    .map((field) => field.name);
}

/** The other registers at a row's address, and when each is the one that is meant; nothing where it is alone. */
export function besideText(row: RegisterRow, rows: readonly RegisterRow[]): string {
  return rows
    .filter(
      (other) => other !== row && other.address === row.address && other.space === row.space && other.axis === row.axis,
    )
    .map((other) => {
      const way = other.access === "R" ? " when read" : other.access === "W" ? " when written" : "";
      return `${other.name}${way}${other.when ? `, if ${other.when}` : ""}`;
    })
    .join("; ");
}

/** Rows of the axis (null: of every axis) and of the whole chip, grouped in the catalog's order. */
export function groupRows(rows: readonly RegisterRow[], axis: number | null, query: string): Group[] {
  const groups = new Map<string, Group>();
  for (const row of rows) {
    if (axis !== null && row.axis !== null && row.axis !== axis) continue;
    if (!matches(row, query)) continue;
    const key = `${row.axis ?? "-"}/${row.group}`;
    const group = groups.get(key) ?? { key, title: row.group, axis: row.axis, rows: [] };
    group.rows.push(row);
    groups.set(key, group);
  }
  return [...groups.values()];
}
