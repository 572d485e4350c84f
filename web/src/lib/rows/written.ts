import { useSyncExternalStore } from "react";
import type { Applied } from "./staging";

const STORAGE = "stepscope.written";
type Words = Readonly<Record<string, number>>;
const NOTHING: Words = {};

/**
 * What this browser has last written to registers that cannot be read, by device and address: a chip does not tell it
 * again, and two names of one word are one word. It is a memory, not a reading: a reset of the chip does not clear it.
 */
let all: Readonly<Record<string, Words>> = load();
const listeners = new Set<() => void>();

function load(): Record<string, Words> {
  try {
    const kept: unknown = JSON.parse(sessionStorage.getItem(STORAGE) ?? "{}");
    return typeof kept === "object" && kept !== null ? (kept as Record<string, Words>) : {};
  } catch {
    return {}; // storage that is forbidden or spoilt: nothing is known
  }
}

function keep(next: Readonly<Record<string, Words>>): void {
  all = next;
  try {
    sessionStorage.setItem(STORAGE, JSON.stringify(all));
  } catch {
    // a full or forbidden storage costs the memory only at a reload
  }
  for (const listener of listeners) listener();
}

export function rememberWritten(device: string, applied: readonly Applied[]): void {
  if (applied.length === 0) return;
  const words = Object.fromEntries(applied.map(({ written }) => [String(written.address), written.written]));
  keep({ ...all, [device]: { ...all[device], ...words } });
}

/** After a reset of the chip nothing is known of what it was told. */
export function forgetWritten(device: string): void {
  if (all[device] === undefined) return;
  keep(Object.fromEntries(Object.entries(all).filter(([id]) => id !== device)));
}

function subscribe(listener: () => void): () => void {
  listeners.add(listener);
  return () => listeners.delete(listener);
}

/** The words by address, as text. */
export function useWritten(device: string): Words {
  return useSyncExternalStore(subscribe, () => all[device] ?? NOTHING);
}
