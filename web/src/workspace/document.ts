/** A layout as a document: which panels there are, how each is set, and where they stand. Nothing here knows React. */

export const FORMAT = "stepscope.layout";
export const VERSION = 1;

/** How much room a part takes among its neighbours: a share of what is left, so many pixels, or what is in it. */
export type Size = number | `${number}px` | "content";
/** Panels behind each other: one is shown. */
export interface Tabs {
  tabs: string[];
  shown?: string;
  size?: Size;
}
export type Part = { row: Part[]; size?: Size } | { col: Part[]; size?: Size } | Tabs;

/** The axis that a panel shows: the selected one, or always the same: "device/axis". */
export const SELECTED = "$";

export interface PanelEntry {
  type: string;
  /** of its config */
  v: number;
  at: string;
  config: Readonly<Record<string, unknown>>;
}

export interface LayoutDocument {
  format: typeof FORMAT;
  version: number;
  id: string;
  name: string;
  /** 0: never saved */
  revision: number;
  screens: { desktop: Part; phone: string[] };
  panels: Readonly<Record<string, PanelEntry>>;
}

/** The panel that moves the motor: no layout is without it. */
export const MOTION = "motion";

/** Whether a newer program has written it: it is shown, and never written. */
export function isNewer(document: LayoutDocument): boolean {
  return document.version > VERSION;
}

export function partsOf(part: Part): readonly Part[] {
  return "tabs" in part ? [] : "row" in part ? part.row : part.col;
}

/** Every panel of a part, in the order of reading. */
export function idsIn(part: Part): string[] {
  return "tabs" in part ? [...part.tabs] : partsOf(part).flatMap(idsIn);
}

/** What a part is known by, whatever its size: its panels. */
export function signOf(part: Part): string {
  return idsIn(part).join();
}

export function shownOf(tabs: Tabs): string {
  return tabs.shown ?? tabs.tabs[0] ?? "";
}

/** Those panels that are not behind others. */
export function shownIn(part: Part): string[] {
  return "tabs" in part ? [shownOf(part)] : partsOf(part).flatMap(shownIn);
}

/** With another config, or another axis, of one panel. */
export function set(document: LayoutDocument, id: string, part: Partial<PanelEntry>): LayoutDocument {
  const entry = document.panels[id];
  return entry ? { ...document, panels: { ...document.panels, [id]: { ...entry, ...part } } } : document;
}

/** One panel as large as it can be: beside it only what moves the motor. */
export function alone(document: LayoutDocument, id: string): Part {
  const motion = Object.keys(document.panels).find((each) => document.panels[each]?.type === MOTION && each !== id);
  const large: Part = { tabs: [id] };
  return motion === undefined ? large : { row: [{ tabs: [motion], size: "300px" }, large] };
}
