/** A layout as a document: which panels there are, how each is set, and where they stand. Nothing here knows React. */

export const FORMAT = "stepscope.layout";
export const VERSION = 1;

const PANELS_MAX = 40;
const DEPTH_MAX = 8;
const NAME_MAX = 80;
const ID = /^[a-z][\w-]{0,39}$/i;
const SIZE_PX = /^([1-9]\d{0,3})px$/;

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

type Raw = Readonly<Record<string, unknown>>;

const isObject = (value: unknown): value is Raw => typeof value === "object" && value !== null && !Array.isArray(value);
const list = (value: unknown): readonly unknown[] => (Array.isArray(value) ? value : []);
const text = (value: unknown, otherwise: string): string =>
  typeof value === "string" && value !== "" ? value.slice(0, NAME_MAX) : otherwise;
const count = (value: unknown): number =>
  typeof value === "number" && Number.isSafeInteger(value) && value >= 0 ? value : 0;

/** The panel that moves the motor: no layout is without it. */
export const MOTION = "motion";

/**
 * What can be understood of something that is to be a layout; null where it is none. Never throws. A panel of a type that
 * nobody knows keeps its place and its config; what is broken is left out; what moves the motor is always there.
 */
export function read(raw: unknown): LayoutDocument | null {
  if (!isObject(raw) || raw.format !== FORMAT || !isObject(raw.screens)) return null;
  const panels: Record<string, PanelEntry> = {};
  for (const [id, entry] of Object.entries(isObject(raw.panels) ? raw.panels : {}).slice(0, PANELS_MAX)) {
    if (!ID.test(id) || !isObject(entry) || typeof entry.type !== "string") continue;
    const config = isObject(entry.config) ? entry.config : {};
    panels[id] = { type: entry.type, v: count(entry.v), at: text(entry.at, SELECTED), config };
  }
  const placed = new Set<string>();
  let desktop = readPart(raw.screens.desktop, panels, placed, 0);
  if (!Object.values(panels).some(({ type }) => type === MOTION)) {
    panels[MOTION] = { type: MOTION, v: 1, at: SELECTED, config: {} };
  }
  for (const [id, { type }] of Object.entries(panels)) {
    if (placed.has(id)) continue;
    if (type !== MOTION) {
      delete panels[id];
      continue;
    }
    const alone: Part = { tabs: [id], size: "300px" };
    desktop = desktop === null ? alone : { row: [alone, ...rowsOf(desktop)] };
  }
  const wanted = list(raw.screens.phone).filter((id): id is string => typeof id === "string");
  const phone = [...new Set([...wanted, ...Object.keys(panels)])].filter((id) => Object.hasOwn(panels, id));
  return {
    ...raw,
    format: FORMAT,
    version: count(raw.version),
    id: text(raw.id, ""),
    name: text(raw.name, "Layout"),
    revision: count(raw.revision),
    screens: { desktop: desktop ?? { tabs: [] }, phone },
    panels,
  };
}

/** Whether a newer program has written it: it is shown, and never written. */
export function isNewer(document: LayoutDocument): boolean {
  return document.version > VERSION;
}

export function rowsOf(part: Part): Part[] {
  return "row" in part ? part.row : [part];
}

function readSize(raw: unknown): Size | undefined {
  if (raw === "content") return raw;
  if (typeof raw === "number" && Number.isFinite(raw) && raw > 0 && raw <= 1e6) return raw;
  return typeof raw === "string" && SIZE_PX.test(raw) ? (raw as Size) : undefined;
}

function readPart(raw: unknown, panels: Raw, placed: Set<string>, depth: number): Part | null {
  if (!isObject(raw) || depth > DEPTH_MAX) return null;
  const known = readSize(raw.size);
  const size = known === undefined ? {} : { size: known };
  if (Array.isArray(raw.tabs)) {
    const tabs: string[] = [];
    for (const id of raw.tabs.slice(0, PANELS_MAX)) {
      if (typeof id !== "string" || !Object.hasOwn(panels, id) || placed.has(id)) continue;
      placed.add(id);
      tabs.push(id);
    }
    const shown = tabs.find((id) => id === raw.shown);
    return tabs.length === 0 ? null : { tabs, ...(shown !== undefined && shown !== tabs[0] && { shown }), ...size };
  }
  const parts = list(raw.row ?? raw.col)
    .slice(0, PANELS_MAX)
    .flatMap((part) => readPart(part, panels, placed, depth + 1) ?? []);
  return split(Array.isArray(raw.row) ? "row" : "col", parts, known);
}

/** Parts beside each other or one below the other; one alone needs no frame, and none is nothing. */
export function split(way: "row" | "col", parts: readonly Part[], size?: Size): Part | null {
  const [first, ...others] = parts;
  if (first === undefined) return null;
  const own = size === undefined ? {} : { size };
  if (others.length === 0) {
    const { size: _, ...rest } = first;
    return { ...rest, ...own } as Part;
  }
  return way === "row" ? { row: [...parts], ...own } : { col: [...parts], ...own };
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

/** The part with each set of tabs as `change` says; null takes one away. */
export function changed(part: Part, change: (tabs: Tabs) => Tabs | null): Part | null {
  if ("tabs" in part) return change(part);
  const parts = partsOf(part).flatMap((each) => changed(each, change) ?? []);
  return split("row" in part ? "row" : "col", parts, part.size);
}

function withDesktop(document: LayoutDocument, desktop: Part | null): LayoutDocument {
  return desktop === null ? document : { ...document, screens: { ...document.screens, desktop } };
}

/** One panel before the others of its tabs. */
export function brought(document: LayoutDocument, id: string): LayoutDocument {
  const bring = (tabs: Tabs) => (tabs.tabs.includes(id) ? { ...tabs, shown: id } : tabs);
  return withDesktop(document, changed(document.screens.desktop, bring));
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
