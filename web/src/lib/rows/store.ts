import { useSyncExternalStore } from "react";
import type { Applied, Edit } from "./staging";

/** What one device has waiting, and how the last Apply went. */
export interface Staged {
  edits: readonly Edit[];
  applied: readonly Applied[];
  appliedAt: number | null;
}

const STORAGE = "stepscope.staged";
const NOTHING: Staged = { edits: [], applied: [], appliedAt: null };

/**
 * Outside React, so that edits outlive the page; in the session's storage, so that they outlive a reload. What another
 * tab stages is its own business: the server alone decides whose write comes last.
 */
let all: Record<string, Staged> = load();
const listeners = new Set<() => void>();

function load(): Record<string, Staged> {
  try {
    const kept: unknown = JSON.parse(sessionStorage.getItem(STORAGE) ?? "{}");
    if (typeof kept !== "object" || kept === null) return {};
    return Object.fromEntries(
      Object.entries(kept).flatMap(([device, edits]) =>
        Array.isArray(edits) ? [[device, { ...NOTHING, edits: edits as Edit[] }]] : [],
      ),
    );
  } catch {
    return {}; // storage that is forbidden or spoilt: start with nothing staged
  }
}

function save(): void {
  const kept = Object.entries(all).filter(([, staged]) => staged.edits.length > 0);
  try {
    sessionStorage.setItem(STORAGE, JSON.stringify(Object.fromEntries(kept.map(([id, staged]) => [id, staged.edits]))));
  } catch {
    // a full or forbidden storage costs the edits only at a reload, of which the browser warns
  }
}

export function stagedOf(device: string): Staged {
  return all[device] ?? NOTHING;
}

export function updateStaged(device: string, change: (staged: Staged) => Partial<Staged>): void {
  const now = stagedOf(device);
  all = { ...all, [device]: { ...now, ...change(now) } };
  save();
  for (const listener of listeners) listener();
}

function subscribe(listener: () => void): () => void {
  listeners.add(listener);
  return () => listeners.delete(listener);
}

export function useStaged(device: string): Staged {
  return useSyncExternalStore(subscribe, () => stagedOf(device));
}

/** Asks before the tab closes while edits wait on any device, whichever page is open. */
window.addEventListener("beforeunload", (event) => {
  if (Object.values(all).some((staged) => staged.edits.length > 0)) event.preventDefault();
});
