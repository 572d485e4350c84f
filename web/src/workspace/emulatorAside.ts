import { type LayoutDocument, SELECTED } from "./document";
import { added, closed } from "./edits";

/** The layout with the emulator's panel at its right edge, on a phone after the stage; or without the one that is `open`. */
export function toggled(document: LayoutDocument, open: string | undefined, stage: string): LayoutDocument {
  if (open !== undefined) return closed(document, open);
  const entry = { type: "emulator", v: 1, at: SELECTED, config: {} };
  return added(document, entry, { size: "300px" }, stage)[0];
}
