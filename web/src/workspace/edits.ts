/** What is done to a layout, but for what the first page needs. */
import {
  idsIn,
  type LayoutDocument,
  MOTION,
  type PanelEntry,
  type Part,
  partsOf,
  type Size,
  type Tabs,
} from "./document";

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

export function rowsOf(part: Part): Part[] {
  return "row" in part ? part.row : [part];
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

/** The layout with its panels placed as `desktop` says, which has all of those that stay. */
export function arranged(document: LayoutDocument, desktop: Part): LayoutDocument {
  const left = new Set(idsIn(desktop));
  return {
    ...document,
    screens: { desktop, phone: document.screens.phone.filter((id) => left.has(id)) },
    panels: Object.fromEntries(Object.entries(document.panels).filter(([id]) => left.has(id))),
  };
}

/** Without one panel; the last one that moves the motor stays. */
export function closed(document: LayoutDocument, id: string): LayoutDocument {
  const { [id]: gone, ...left } = document.panels;
  if (gone === undefined || !mayClose(document, id)) return document;
  const desktop = changed(document.screens.desktop, ({ shown, ...tabs }) => {
    const kept = tabs.tabs.filter((other) => other !== id);
    return kept.length === 0 ? null : { ...tabs, tabs: kept, ...(shown !== undefined && shown !== id && { shown }) };
  });
  return desktop === null ? document : arranged({ ...document, panels: left }, desktop);
}

export function mayClose({ panels }: LayoutDocument, id: string): boolean {
  return panels[id]?.type !== MOTION || Object.values(panels).filter(({ type }) => type === MOTION).length > 1;
}

/**
 * With one panel more: at the right edge, or, where that says so, into the tabs of another; on a phone `after` one, or last.
 * Returns its id, too.
 */
export function added(
  document: LayoutDocument,
  entry: PanelEntry,
  place: { size: Size } | { into: string },
  after?: string,
): readonly [LayoutDocument, string] {
  let id = entry.type;
  for (let number = 2; Object.hasOwn(document.panels, id); number++) id = `${entry.type}${number}`;
  const { desktop, phone } = document.screens;
  const placed =
    "into" in place
      ? changed(desktop, (tabs) =>
          tabs.tabs.includes(place.into) ? { ...tabs, tabs: [...tabs.tabs, id], shown: id } : tabs,
        )
      : split("row", [...rowsOf(desktop), { tabs: [id], size: place.size }]);
  const panels = { ...document.panels, [id]: entry };
  const at = after === undefined ? phone.length : phone.indexOf(after) + 1;
  return [{ ...document, screens: { desktop: placed ?? desktop, phone: phone.toSpliced(at, 0, id) }, panels }, id];
}

/** On a phone one place up (-1) or down (1). */
export function moved(document: LayoutDocument, id: string, by: -1 | 1): LayoutDocument {
  const phone = [...document.screens.phone];
  const from = phone.indexOf(id);
  const to = from + by;
  if (from < 0 || to < 0 || to >= phone.length) return document;
  phone.splice(to, 0, ...phone.splice(from, 1));
  return { ...document, screens: { ...document.screens, phone } };
}
