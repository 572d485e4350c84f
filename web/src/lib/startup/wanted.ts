/** The start-up that somebody has asked for: its dialog outlives the button, which may go with what it has cured. */
export interface StartUpWanted {
  device: string;
  /** null for all axes */
  axes: readonly number[] | null;
  /** names of all axes of the device, where they are known */
  axisNames: readonly string[];
  onDone?: (() => void) | undefined;
}

let wanted: StartUpWanted | null = null;
let ever = false;
const listeners = new Set<() => void>();

export function wantStartUp(next: StartUpWanted | null): void {
  wanted = next;
  ever ||= next !== null;
  for (const listener of listeners) listener();
}

export function wantedStartUp(): StartUpWanted | null {
  return wanted;
}

/** Whether anybody has asked for one since the page was loaded: before, its dialog need not be there. */
export function everWantedStartUp(): boolean {
  return ever;
}

export function onWantedStartUp(listener: () => void): () => void {
  listeners.add(listener);
  return () => listeners.delete(listener);
}
