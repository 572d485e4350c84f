import type { Schemas } from "../../api/client";
import { fixed } from "../../lib/format";

type Written = Pick<Schemas["RegisterWritten"], "name" | "value" | "verified"> & { note?: string };

export function spoken(name: string): string {
  const words = name.replaceAll("_", " ");
  return words.charAt(0).toUpperCase() + words.slice(1);
}

/** What has to be said of writes that did not simply do what was asked. */
export function readBackNotes(asked: ReadonlyMap<string, number>, done: readonly Written[]): string[] {
  return done.flatMap((written) => {
    const wanted = asked.get(written.name);
    if (written.note) return [`${spoken(written.name)}: ${written.note}`];
    if (wanted === undefined || wanted === written.value || written.verified === null) return [];
    return [`${spoken(written.name)}: ${fixed(wanted)} was asked for, the module holds ${fixed(written.value)}.`];
  });
}
