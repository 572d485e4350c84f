import type { Problem, Schemas } from "../../api/client";
import { stored, useShared } from "../../lib/shared";

export interface Entry {
  id: number;
  atMs: number;
  line: string;
  answer: Schemas["TmclReply"] | null;
  problem: Problem | null;
}

const KEPT = 60;
const NONE: readonly Entry[] = [];

/** What was sent to each device, newest first. */
const all = stored<Readonly<Record<string, readonly Entry[]>>>("localStorage", "stepscope.console", (kept) =>
  Object.fromEntries(
    Object.entries(kept).flatMap(([device, entries]) =>
      Array.isArray(entries) ? [[device, entries.filter(isEntry)]] : [],
    ),
  ),
);

function isEntry(entry: unknown): entry is Entry {
  return typeof entry === "object" && entry !== null && "line" in entry && typeof entry.line === "string";
}

export function remember(device: string, entry: Omit<Entry, "id" | "atMs">): void {
  const before = all.get()[device] ?? NONE;
  const id = (before[0]?.id ?? 0) + 1;
  all.set({ ...all.get(), [device]: [{ ...entry, id, atMs: Date.now() }, ...before].slice(0, KEPT) });
}

export function forget(device: string): void {
  const { [device]: _, ...others } = all.get();
  all.set(others);
}

export function useHistory(device: string): readonly Entry[] {
  return useShared(all)[device] ?? NONE;
}

/** Lines for arrow up: newest first, each once in a row. */
export function linesOf(entries: readonly Entry[]): string[] {
  return entries.map((entry) => entry.line).filter((line, index, lines) => line !== lines[index - 1]);
}
