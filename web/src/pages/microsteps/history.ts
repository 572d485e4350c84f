/** What can be undone: past and future around the present. */
export interface History<T> {
  past: readonly T[];
  present: T;
  future: readonly T[];
  /** gestures with the same tag become one entry: a drag, a slider, arrow keys on one point */
  tag: string | null;
}

const DEPTH = 200;

export function start<T>(present: T): History<T> {
  return { past: [], present, future: [], tag: null };
}

export function push<T>(history: History<T>, next: T, tag: string | null = null): History<T> {
  if (tag !== null && tag === history.tag) return { ...history, present: next, future: [] };
  return { past: [...history.past, history.present].slice(-DEPTH), present: next, future: [], tag };
}

/** Ends a gesture: the next change is an entry of its own, even with the same tag. */
export function settle<T>(history: History<T>): History<T> {
  return history.tag === null ? history : { ...history, tag: null };
}

export function undo<T>(history: History<T>): History<T> {
  const last = history.past.at(-1);
  if (last === undefined) return history;
  return {
    past: history.past.slice(0, -1),
    present: last,
    future: [history.present, ...history.future],
    tag: null,
  };
}

export function redo<T>(history: History<T>): History<T> {
  const [next, ...future] = history.future;
  if (next === undefined) return history;
  return { past: [...history.past, history.present], present: next, future, tag: null };
}
