import { type LayoutDocument, SELECTED } from "./document";
import { added } from "./edits";
import type { PanelType } from "./panel";

/** From this least width on a panel gets a share of the window, a narrower one a column of its own [px]. */
const WIDE_PX = 400;

/** The layout with a panel of that kind at its right edge. */
export function addOf(document: LayoutDocument, { type, version, min, config }: PanelType): LayoutDocument {
  const { desktop } = document.screens;
  const shares = ("row" in desktop ? desktop.row : []).flatMap(({ size }) => (typeof size === "number" ? [size] : []));
  const mean = shares.reduce((sum, share) => sum + share, 0) / shares.length || 1;
  const entry = { type, v: version, at: SELECTED, config: { ...config({}, version) } };
  return added(document, entry, { size: min[0] < WIDE_PX ? "300px" : mean })[0];
}
