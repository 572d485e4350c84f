import { stored, useShared } from "../shared";
import type { Applied } from "./staging";

type Words = Readonly<Record<string, number>>;
const NOTHING: Words = {};

/**
 * What this browser has last written to registers that cannot be read, by device and address: a chip does not tell it
 * again, and two names of one word are one word. It is a memory, not a reading: a reset of the chip does not clear it.
 */
const all = stored("sessionStorage", "stepscope.written", (kept) => kept as Readonly<Record<string, Words>>);

export function rememberWritten(device: string, applied: readonly Applied[]): void {
  if (applied.length === 0) return;
  const words = Object.fromEntries(applied.map(({ written }) => [String(written.address), written.written]));
  all.set({ ...all.get(), [device]: { ...all.get()[device], ...words } });
}

/** After a reset of the chip nothing is known of what it was told. */
export function forgetWritten(device: string): void {
  const { [device]: known, ...others } = all.get();
  if (known !== undefined) all.set(others);
}

/** The words by address, as text. */
export function useWritten(device: string): Words {
  return useShared(all)[device] ?? NOTHING;
}
