import { useCallback, useDeferredValue, useRef, useState } from "react";
import { enter } from "../history/history";
import { useSessionKept } from "../useKept";

/**
 * What is designed on a page, kept for the session under `key`; `fresh` until something is changed. A handle that is
 * dragged changes it many times between two renderings, so `latest` always has the newest.
 */
export function useSketch<S extends object>(key: string, fresh: S) {
  const [kept, keep] = useSessionKept<S | null>(key, null);
  const sketch = kept ?? fresh;
  const latest = useRef(sketch);
  latest.current = sketch;
  const put = useCallback(
    (next: S) => {
      latest.current = next;
      keep(next);
    },
    [keep],
  );
  /** `label` is that of the change in the page's history; null for none */
  const change = useCallback(
    (part: Partial<S>, label: string | null) => {
      const before = latest.current;
      const next = { ...before, ...part };
      if (label === null) put(next);
      else enter({ put, before, next }, { label, of: key, merge: label });
    },
    [key, put],
  );
  return { sketch, latest, change, isFresh: kept === null };
}

/** While a handle is held, plots follow at once and what is beside them when there is time. */
export function useHold<S, A>(sketch: S, answer: A) {
  const [held, hold] = useState(false);
  const laterSketch = useDeferredValue(sketch);
  const laterAnswer = useDeferredValue(answer);
  return { held, hold, shown: held ? laterSketch : sketch, good: held ? laterAnswer : answer };
}
