import type { TabRun } from "../pages/module/heldRuns";

let underWay: readonly TabRun[] = [];
const watchers = new Set<() => void>();

/** Called when a run begins, goes on to its next speed, or ends. */
export function watchRuns(listener: () => void): () => void {
  watchers.add(listener);
  return () => watchers.delete(listener);
}

/** The runs of this tab that turn a motor now; always the same array until one begins, goes on or ends. */
export const runsUnderWay = (): readonly TabRun[] => underWay;

/** Tells which these are now. */
export function tellRuns(runs: readonly TabRun[]): void {
  underWay = runs;
  for (const watcher of watchers) watcher();
}
