import { useRef } from "react";
import { enter, settle } from "../../lib/history/history";
import { Shared, useShared } from "../../lib/shared";

/** Drafts outlive the page, not a reload: what matters by then is in the chip, or copied. */
const drafts = new Shared<Readonly<Record<string, unknown>>>({});

export interface Drafting<T> {
  draft: T;
  /** gestures of the same tag become one step to undo */
  change: (next: T, tag: string | null) => void;
  /** the gesture has ended */
  rest: () => void;
}

/** What is being drawn for the table `of`; each step of it is in the page's history as `label`. */
export function useDraft<T>(of: string, label: string, first: T): Drafting<T> {
  const begin = useRef(first);
  const draft = (useShared(drafts)[of] ?? begin.current) as T;
  const put = (next: T) => drafts.set({ ...drafts.get(), [of]: next });
  return {
    draft,
    change: (next, tag) => {
      const before = (drafts.get()[of] ?? begin.current) as T;
      enter({ put, before, next }, { label, of, merge: tag });
    },
    rest: settle,
  };
}
