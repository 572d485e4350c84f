/** Where the cursor of a recording's plot stands: what other views (the 3D twin) scrub to. */
export interface RecordingCursor {
  recording: string;
  /** since the recording's zero, as its plots count [s] */
  time_s: number;
}

let at: RecordingCursor | null = null;
const listeners = new Set<() => void>();

/**
 * One cursor for the whole page. Plots set it while the pointer or the arrow keys move; null where it is on no plot.
 * Past React: it changes with every pixel, and only who subscribes hears of it.
 */
export const recordingCursor = {
  get: (): RecordingCursor | null => at,
  set(next: RecordingCursor | null) {
    if (next?.recording === at?.recording && next?.time_s === at?.time_s) return;
    at = next;
    for (const listener of [...listeners]) listener();
  },
  subscribe(listener: () => void): () => void {
    listeners.add(listener);
    return () => listeners.delete(listener);
  },
};
