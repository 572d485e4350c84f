import { Shared, useShared } from "../shared";

/** One gesture that can be taken back: a design, a staged edit, or what was written into a device. */
export interface Step {
  id: number;
  label: string;
  /** what it belongs to: entries of one are dropped together once they say nothing any more */
  of: string;
  /** Unix time [ms] of its latest change */
  at: number;
  undo: () => void;
  redo: () => void;
  /** gestures of the same key become one entry while a pointer is held or changes follow each other quickly */
  merge: string | null;
  /** it is taken back by a look at what that would write, and then is no entry of the page any more */
  asks: boolean;
}

export interface Steps {
  past: readonly Step[];
  /** what was taken back, the next to redo first */
  future: readonly Step[];
}

const DEPTH = 200;
/** Changes of one key no further apart than that are one gesture: arrow keys, a wheel, typing. */
const TOGETHER_MS = 700;

let last = 0;
let open = false;
let held = false;

const NOTHING: Steps = { past: [], future: [] };
const all = new Shared<Steps>(NOTHING);

export function useSteps(): Steps {
  return useShared(all);
}

export function stepsNow(): Steps {
  return all.get();
}

type Gesture = Pick<Step, "label" | "of" | "undo" | "redo"> & { merge?: string | null; asks?: boolean };

/** Enter what was just done. What could be redone is gone. */
export function record({ merge = null, asks = false, ...gesture }: Gesture, now = Date.now()): void {
  const { past } = all.get();
  const before = past.at(-1);
  const same = open && before !== undefined && merge !== null && before.merge === merge && before.of === gesture.of;
  open = true;
  if (same && before && (held || now - before.at < TOGETHER_MS)) {
    const whole = { ...before, label: gesture.label, redo: gesture.redo, at: now };
    all.set({ past: [...past.slice(0, -1), whole], future: [] });
    return;
  }
  last += 1;
  const step: Step = { ...gesture, id: last, at: now, merge, asks };
  all.set({ past: [...past, step].slice(-DEPTH), future: [] });
}

/** Make `next` of what was `before`, and enter it. */
export function enter<T>(
  { put, before, next }: { put: (value: T) => void; before: T; next: T },
  entry: Pick<Gesture, "label" | "of" | "merge">,
): void {
  put(next);
  record({ ...entry, undo: () => put(before), redo: () => put(next) });
}

/** Ends a gesture: the next change is an entry of its own, even with the same key. */
export function settle(): void {
  open = false;
}

/** Take the latest entry back; what it was called, or null where there is none. */
export function undo(): string | null {
  settle();
  const { past, future } = all.get();
  const step = past.at(-1);
  if (step === undefined) return null;
  all.set({ past: past.slice(0, -1), future: step.asks ? future : [step, ...future] });
  step.undo();
  return step.label;
}

export function redo(): string | null {
  settle();
  const { past, future } = all.get();
  const [step, ...rest] = future;
  if (step === undefined) return null;
  all.set({ past: [...past, step], future: rest });
  step.redo();
  return step.label;
}

/** Undo or redo until the entry `id` is the latest that is done; 0: until none is. */
export function goTo(id: number): void {
  const done = () => all.get().past.some((step) => step.id === id);
  if (id === 0 || done()) while (all.get().past.length > 0 && all.get().past.at(-1)?.id !== id) undo();
  else while (all.get().future.length > 0 && !done()) redo();
}

/** Drop the entries of something: an edit that was sent is not undone by not staging it. */
export function forget(of: string): void {
  const { past, future } = all.get();
  const kept = (step: Step) => step.of !== of;
  all.set({ past: past.filter(kept), future: future.filter(kept) });
}

export function forgetAll(): void {
  settle();
  all.set(NOTHING);
}

window.addEventListener(
  "pointerdown",
  () => {
    settle();
    held = true;
  },
  { capture: true },
);
for (const end of ["pointerup", "pointercancel", "blur"])
  window.addEventListener(
    end,
    () => {
      held = false;
      // what the release itself changes belongs to the gesture
      setTimeout(settle);
    },
    { capture: true },
  );
