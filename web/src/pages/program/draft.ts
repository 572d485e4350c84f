import { useCallback, useState } from "react";

/** What was downloaded last from this browser: what the addresses of the module's program mean. */
export interface Stored {
  text: string;
  lines: number[];
  labels: Record<string, number>;
}

/** The text that the user writes for a device; it outlives a reload. */
export interface Draft {
  name: string;
  text: string;
  /** lines, from 1 */
  breakpoints: number[];
  /** numbers of user variables that are watched */
  variables: number[];
  stored: Stored | null;
}

const NEW: Draft = { name: "program.tmc", text: "", breakpoints: [], variables: [], stored: null };

const keyOf = (device: string) => `stepscope.program.${device}`;

export function readDraft(device: string, storage: Pick<Storage, "getItem"> = localStorage): Draft {
  try {
    const found: unknown = JSON.parse(storage.getItem(keyOf(device)) ?? "null");
    return typeof found === "object" && found !== null ? { ...NEW, ...found } : NEW;
  } catch {
    return NEW; // of another version, or edited by hand
  }
}

/** The draft of a device, and how it is changed; each change is kept at once. */
export function useDraft(device: string): [Draft, (change: Partial<Draft>) => void] {
  const [draft, setDraft] = useState(() => readDraft(device));
  const change = useCallback(
    (some: Partial<Draft>) =>
      setDraft((before) => {
        const after = { ...before, ...some };
        try {
          localStorage.setItem(keyOf(device), JSON.stringify(after));
        } catch {
          // a full or closed storage: the text is still on the page
        }
        return after;
      }),
    [device],
  );
  return [draft, change];
}
