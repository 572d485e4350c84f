import { enter } from "../history/history";
import { stored, useShared } from "../shared";
import { type Applied, type Edit, type Key, unstage } from "./staging";

/** What one device has waiting, and how the last Apply went. */
export interface Staged {
  edits: readonly Edit[];
  applied: readonly Applied[];
  appliedAt: number | null;
}

const NOTHING: Staged = { edits: [], applied: [], appliedAt: null };

/**
 * Outside React, so that edits outlive the page; in the session's storage, so that they outlive a reload. What another
 * tab stages is its own business: the server alone decides whose write comes last.
 */
const all = stored<Readonly<Record<string, Staged>>>(
  "sessionStorage",
  "stepscope.staged",
  (kept) =>
    Object.fromEntries(
      Object.entries(kept).flatMap(([device, edits]) =>
        Array.isArray(edits) ? [[device, { ...NOTHING, edits: edits as Edit[] }]] : [],
      ),
    ),
  (staged) => Object.fromEntries(waiting(staged).map(([device, { edits }]) => [device, edits])),
);

function waiting(staged: Readonly<Record<string, Staged>>): [string, Staged][] {
  return Object.entries(staged).filter(([, { edits }]) => edits.length > 0);
}

export function stagedOf(device: string): Staged {
  return all.get()[device] ?? NOTHING;
}

export function updateStaged(device: string, change: (staged: Staged) => Partial<Staged>): void {
  const now = stagedOf(device);
  all.set({ ...all.get(), [device]: { ...now, ...change(now) } });
}

/** What entries of the page's history about a device's staged edits belong to. */
export const stagingOf = (device: string): string => `staged ${device}`;

/** Another list of edits, which can be undone; `merge` is what makes one entry of changes in a row. */
export function editStaged(
  device: string,
  label: string,
  change: (edits: readonly Edit[]) => readonly Edit[],
  merge: string | null = null,
): void {
  const before = stagedOf(device).edits;
  const put = (edits: readonly Edit[]) => updateStaged(device, () => ({ edits }));
  enter({ put, before, next: change(before) }, { label, of: stagingOf(device), merge });
}

/** Without the edit of one register, or of one field of it; null: without any. */
export function discardStaged(device: string, key: Key | null, field?: string): void {
  const what = key === null ? "all edits" : `the edit of ${field ?? key.slice(key.indexOf("/") + 1)}`;
  editStaged(device, `Discard ${what}`, (edits) => (key === null ? [] : unstage(edits, key, field)));
}

export function useStaged(device: string): Staged {
  return useShared(all)[device] ?? NOTHING;
}

/** Asks before the tab closes while edits wait on any device, whichever page is open. */
window.addEventListener("beforeunload", (event) => {
  if (waiting(all.get()).length > 0) event.preventDefault();
});
