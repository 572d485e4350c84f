/** A layout out of what a file, a server or a browser kept. */
import { FORMAT, type LayoutDocument, MOTION, type PanelEntry, type Part, SELECTED, type Size } from "./document";
import { rowsOf, split } from "./edits";

const PANELS_MAX = 40;
const DEPTH_MAX = 8;
const NAME_MAX = 80;
const ID = /^[a-z][\w-]{0,39}$/i;
const SIZE_PX = /^([1-9]\d{0,3})px$/;

type Raw = Readonly<Record<string, unknown>>;

export const isObject = (value: unknown): value is Raw =>
  typeof value === "object" && value !== null && !Array.isArray(value);
const list = (value: unknown): readonly unknown[] => (Array.isArray(value) ? value : []);
const text = (value: unknown, otherwise: string): string =>
  typeof value === "string" && value !== "" ? value.slice(0, NAME_MAX) : otherwise;
const count = (value: unknown): number =>
  typeof value === "number" && Number.isSafeInteger(value) && value >= 0 ? value : 0;

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
