import { ActionIcon } from "@mantine/core";
import { useHotkeys } from "@mantine/hooks";
import { IconArrowBackUp, IconArrowForwardUp } from "@tabler/icons-react";
import { useEffect, useState } from "react";
import { type History, push, redo, settle, start, undo } from "./history";

/** Drafts outlive the page, not a reload: what matters by then is in the chip, or copied. */
const kept = new Map<string, unknown>();

export interface Drafting<T> {
  draft: T;
  history: History<T>;
  /** gestures of the same tag become one step to undo */
  change: (next: T, tag: string | null) => void;
  /** the gesture has ended */
  rest: () => void;
  back: () => void;
  forth: () => void;
}

/** What is being drawn for the table `of`, and every step of it; Ctrl+Z takes one back. */
export function useDraft<T>(of: string, first: T): Drafting<T> {
  const [history, setHistory] = useState<History<T>>(() => (kept.get(of) as History<T> | undefined) ?? start(first));
  useEffect(() => void kept.set(of, history), [of, history]);
  const back = () => setHistory(undo);
  const forth = () => setHistory(redo);
  useHotkeys([
    ["mod+Z", back],
    ["mod+shift+Z", forth],
    ["mod+Y", forth],
  ]);
  return {
    draft: history.present,
    history,
    change: (next, tag) => setHistory((now) => push(now, next, tag)),
    rest: () => setHistory(settle),
    back,
    forth,
  };
}

export function UndoRedo<T>({ drafting: { history, back, forth } }: { drafting: Drafting<T> }) {
  return (
    <>
      <ActionIcon
        variant="default"
        aria-label="Undo"
        title="Undo, Ctrl+Z"
        disabled={history.past.length === 0}
        onClick={back}
      >
        <IconArrowBackUp size={16} />
      </ActionIcon>
      <ActionIcon
        variant="default"
        aria-label="Redo"
        title="Redo, Ctrl+Shift+Z"
        disabled={history.future.length === 0}
        onClick={forth}
      >
        <IconArrowForwardUp size={16} />
      </ActionIcon>
    </>
  );
}
