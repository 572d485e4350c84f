import type { TabRun } from "../pages/module/heldRuns";

let underWay: readonly TabRun[] = [];
const watchers = new Set<() => void>();

/** Called when a run begins, goes on to its next speed, or ends. */
export function watchRuns(listener: () => void): () => void {
  watchers.add(listener);
  return () => watchers.delete(listener);
}

/**
 * The runs of this tab that turn a motor now, or that ended by themselves without anybody having seen it; always the same
 * array until one begins, goes on, ends or is seen.
 */
export const runsUnderWay = (): readonly TabRun[] => underWay;

/** Tells which these are now. */
export function tellRuns(runs: readonly TabRun[]): void {
  underWay = runs;
  for (const watcher of watchers) watcher();
}
