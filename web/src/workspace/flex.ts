/** A part of a layout as the tree of the dock library, and back. */
import { idsIn, type LayoutDocument, type Part, partsOf, type Size, shownOf, signOf } from "./document";
import { split } from "./edits";

export interface FlexTab {
  type: "tab";
  id: string;
  name: string;
  component: "panel";
}
export interface FlexTabs {
  type: "tabset";
  weight: number;
  selected: number;
  minWidth: number;
  minHeight: number;
  children: FlexTab[];
}
export interface FlexRow {
  type: "row";
  weight: number;
  children: (FlexRow | FlexTabs)[];
}
/** What comes back: as much of it as is read. */
export interface FlexNode {
  type?: string;
  id?: string;
  weight?: number;
  selected?: number;
  children?: readonly FlexNode[];
}

/** What each part was given, by the way that it lies in and its panels: a size that was not touched is kept as it was written. */
export type Given = ReadonlyMap<string, { weight: number; size: Size | undefined }>;
interface Box {
  width: number;
  height: number;
}

/** What a panel is called, and the least room that it makes sense in. */
export type About = (id: string) => { name: string; min: readonly [width: number, height: number] };

/** What is as high as its content is given so much where nobody has measured it [px]. */
const CONTENT_PX = 120;
/** Above what is arranged there are its tabs [px]. */
const STRIP_PX = 38;
/** Between parts that are arranged [px]. */
export const SPLITTER_PX = 8;

/** The tree, and what was given. `measured` is how large a part is now, by its panels. */
export function toFlex(
  document: LayoutDocument,
  box: Box,
  measured: (sign: string) => Box | undefined,
  about: About,
): { row: FlexRow; given: Given } {
  const given = new Map<string, { weight: number; size: Size | undefined }>();

  function children(parts: readonly Part[], inside: Box, way: "row" | "col"): (FlexRow | FlexTabs)[] {
    const along = way === "row" ? "width" : "height";
    const fixed = parts.map(({ size }, at) => {
      if (typeof size === "number" || size === undefined) return null;
      return size === "content"
        ? (measured(signOf(parts[at] as Part))?.[along] ?? CONTENT_PX) + STRIP_PX
        : Number.parseInt(size, 10);
    });
    const shares = parts.map(({ size }, at) => (fixed[at] === null ? (typeof size === "number" ? size : 1) : 0));
    const room = inside[along] - SPLITTER_PX * (parts.length - 1);
    const left = Math.max(0, room - fixed.reduce((sum: number, px) => sum + (px ?? 0), 0));
    const all = shares.reduce((sum, share) => sum + share, 0);
    const px = parts.map((_, at) => Math.max(1, fixed[at] ?? (left * (shares[at] ?? 0)) / all));
    const total = px.reduce((sum, each) => sum + each, 0);
    return parts.map((part, at) => {
      const weight = rounded((100 * (px[at] ?? 1)) / total);
      given.set(placeOf(way, part), { weight, size: part.size });
      if ("tabs" in part) return tabs(part, weight);
      const own = { ...inside, [along]: px[at] ?? 1 };
      return { type: "row", weight, children: children(partsOf(part), own, "row" in part ? "row" : "col") };
    });
  }

  function tabs(part: Extract<Part, { tabs: string[] }>, weight: number): FlexTabs {
    const [minWidth, minHeight] = about(shownOf(part)).min;
    return {
      type: "tabset",
      weight,
      selected: Math.max(0, part.tabs.indexOf(shownOf(part))),
      minWidth: Math.min(minWidth, box.width / 4),
      minHeight: Math.min(minHeight, box.height / 4),
      children: part.tabs.map((id) => ({ type: "tab", id, name: about(id).name, component: "panel" })),
    };
  }

  const { desktop } = document.screens;
  const rows = "row" in desktop ? desktop.row : [desktop];
  return { row: { type: "row", weight: 100, children: children(rows, box, "row") }, given };
}

/** What was as high as its content in a column is not as wide as that where it stands alone in a row. */
const placeOf = (way: "row" | "col", part: Part) => `${way} ${signOf(part)}`;

const rounded = (weight: number) => Math.round(weight * 100) / 100;

/**
 * The part that the tree stands for, whose root lies, and into `next` what each part was given by it. Null where it has no
 * panel. Sizes in pixels and by content outlive a move of others, but no splitter (`resized`).
 */
export function fromFlex(
  node: FlexNode,
  given: Given,
  resized: boolean,
  next: Map<string, { weight: number; size: Size | undefined }> = new Map(),
  way: "row" | "col" = "row",
): Part | null {
  const children = node.children ?? [];
  if (node.type === "tabset") {
    const tabs = children.flatMap(({ id }) => id ?? []);
    const shown = tabs[node.selected ?? 0];
    return tabs.length === 0 ? null : { tabs, ...(shown !== undefined && shown !== tabs[0] && { shown }) };
  }
  const parts = children.flatMap((child) => {
    const part = fromFlex(child, given, resized, next, way === "row" ? "col" : "row");
    return part === null ? [] : [{ part, weight: child.weight ?? 100 }];
  });
  const total = parts.reduce((sum, { weight }) => sum + weight, 0);
  const shares = parts.map(({ part, weight }) => {
    const share = rounded((100 * weight) / total);
    const before = given.get(placeOf(way, part));
    return { part, share, before, still: before !== undefined && Math.abs(before.weight - share) < 0.1 };
  });
  const untouched = shares.every(({ still }) => still);
  const sizes = shares.map(({ share, before }) => {
    if (untouched) return before?.size;
    return !resized && typeof before?.size === "string" ? before.size : share;
  });
  shares.forEach(({ part, share }, at) => {
    next.set(placeOf(way, part), { weight: share, size: sizes[at] });
  });
  return split(
    way,
    shares.map(({ part }, at) => sized(part, sizes[at])),
  );
}

function sized(part: Part, size: Size | undefined): Part {
  return size === undefined ? part : { ...part, size };
}

/** Whether two parts say the same. */
export function same(one: Part, other: Part): boolean {
  return JSON.stringify(inOrder(one)) === JSON.stringify(inOrder(other));
}

function inOrder(part: Part): unknown {
  const inside = "tabs" in part ? [part.tabs, shownOf(part)] : [Object.keys(part)[0], partsOf(part).map(inOrder)];
  return [inside, part.size ?? null, idsIn(part).length];
}
