import { Shared } from "./shared";

/** Where the cursor of a recording's plot stands: what other views (the 3D twin) scrub to. */
export interface RecordingCursor {
  recording: string;
  /** since the recording's zero, as its plots count [s] */
  time_s: number;
}

/**
 * One cursor for the whole page. Plots set it while the pointer or the arrow keys move; null where it is on no plot.
 * Past React: it changes with every pixel, and only who subscribes hears of it.
 */
const cursor = new Shared<RecordingCursor | null>(null);
export const recordingCursor = {
  get: cursor.get,
  subscribe: cursor.subscribe,
  set(next: RecordingCursor | null) {
    const at = cursor.get();
    if (next?.recording !== at?.recording || next?.time_s !== at?.time_s) cursor.set(next);
  },
};
