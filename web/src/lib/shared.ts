import { useSyncExternalStore } from "react";

/** A value outside of React: it outlives the pages that show it. */
export class Shared<T> {
  private readonly listeners = new Set<() => void>();

  constructor(private value: T) {}

  readonly get = (): T => this.value;

  readonly set = (next: T): void => {
    if (next === this.value) return;
    this.value = next;
    for (const listener of [...this.listeners]) listener();
  };

  readonly subscribe = (listener: () => void): (() => void) => {
    this.listeners.add(listener);
    return () => this.listeners.delete(listener);
  };
}

export function useShared<T>(shared: Shared<T>): T {
  return useSyncExternalStore(shared.subscribe, shared.get);
}

/**
 * One that outlives a reload in the browser's storage, as JSON of an object. `read` is given an empty one where nothing
 * is kept, or what is kept is spoilt or forbidden; storage that is full or forbidden costs the value at a reload alone.
 */
export function stored<T>(
  storage: "localStorage" | "sessionStorage",
  key: string,
  read: (kept: Record<string, unknown>) => T,
  write: (value: T) => unknown = (value) => value,
): Shared<T> {
  const shared = new Shared(read(load(storage, key)));
  shared.subscribe(() => {
    try {
      window[storage].setItem(key, JSON.stringify(write(shared.get())));
    } catch {
      // see above
    }
  });
  return shared;
}

function load(storage: "localStorage" | "sessionStorage", key: string): Record<string, unknown> {
  try {
    const kept: unknown = JSON.parse(window[storage].getItem(key) ?? "{}");
    return typeof kept === "object" && kept !== null ? (kept as Record<string, unknown>) : {};
  } catch {
    return {};
  }
}
