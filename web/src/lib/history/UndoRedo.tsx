import { ActionIcon } from "@mantine/core";
import { IconArrowBackUp, IconArrowForwardUp } from "@tabler/icons-react";
import { redo, undo, useSteps } from "./history";

/** Back and forth in the page's one history: what each would do is in its tooltip. */
export function UndoRedo() {
  const { past, future } = useSteps();
  const [back, forth] = [past.at(-1), future[0]];
  return (
    <>
      <ActionIcon
        variant="default"
        aria-label="Undo"
        title={back ? `Undo: ${back.label} (Ctrl Z)` : "Nothing to undo"}
        disabled={back === undefined}
        onClick={undo}
      >
        <IconArrowBackUp size={16} />
      </ActionIcon>
      <ActionIcon
        variant="default"
        aria-label="Redo"
        title={forth ? `Redo: ${forth.label} (Ctrl Shift Z)` : "Nothing to redo"}
        disabled={forth === undefined}
        onClick={redo}
      >
        <IconArrowForwardUp size={16} />
      </ActionIcon>
    </>
  );
}
