import { useSyncExternalStore } from "react";
import type { Problem, Schemas } from "../../api/client";

export interface Entry {
  id: number;
  atMs: number;
  line: string;
  answer: Schemas["TmclReply"] | null;
  problem: Problem | null;
}

const KEPT = 60;
const STORAGE = "stepscope.console";
const NONE: readonly Entry[] = [];

/** What was sent to each device, newest first; in the browser's storage, so that it outlives a reload. */
let all: Record<string, readonly Entry[]> = load();
const listeners = new Set<() => void>();

function load(): Record<string, readonly Entry[]> {
  try {
    const kept: unknown = JSON.parse(localStorage.getItem(STORAGE) ?? "{}");
    if (typeof kept !== "object" || kept === null) return {};
    return Object.fromEntries(
      Object.entries(kept).flatMap(([device, entries]) =>
        Array.isArray(entries) ? [[device, entries.filter(isEntry)]] : [],
      ),
    );
  } catch {
    return {}; // storage that is forbidden or spoilt: start with nothing sent
  }
}

function isEntry(entry: unknown): entry is Entry {
  return typeof entry === "object" && entry !== null && "line" in entry && typeof entry.line === "string";
}

function publish(): void {
  try {
    localStorage.setItem(STORAGE, JSON.stringify(all));
  } catch {
    // a full or forbidden storage costs the history only at a reload
  }
  for (const listener of listeners) listener();
}

export function remember(device: string, entry: Omit<Entry, "id" | "atMs">): void {
  const before = all[device] ?? NONE;
  const id = (before[0]?.id ?? 0) + 1;
  all = { ...all, [device]: [{ ...entry, id, atMs: Date.now() }, ...before].slice(0, KEPT) };
  publish();
}

export function forget(device: string): void {
  all = Object.fromEntries(Object.entries(all).filter(([id]) => id !== device));
  publish();
}

export function useHistory(device: string): readonly Entry[] {
  return useSyncExternalStore(
    (listener) => {
      listeners.add(listener);
      return () => listeners.delete(listener);
    },
    () => all[device] ?? NONE,
  );
}

/** Lines for arrow up: newest first, each once in a row. */
export function linesOf(entries: readonly Entry[]): string[] {
  return entries.map((entry) => entry.line).filter((line, index, lines) => line !== lines[index - 1]);
}
