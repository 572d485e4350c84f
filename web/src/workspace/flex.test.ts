import { describe, expect, it } from "vitest";
import { BUILT_IN } from "./builtIn";
import type { LayoutDocument, Part } from "./document";
import { type FlexRow, fromFlex, SPLITTER_PX, same, toFlex } from "./flex";
import { read } from "./reading";

const BOX = { width: 1400, height: 800 };
const nobody = () => undefined;
const about = (id: string) => ({ name: id, min: [100, 50] as const });

function withDesktop(desktop: Part): LayoutDocument {
  const ids = ["motion", "axes", "scope", "notes", "stage"];
  const panels = Object.fromEntries(ids.map((type) => [type, { type, v: 1, at: "$", config: {} }]));
  return read({ format: "stepscope.layout", version: 1, screens: { desktop, phone: [] }, panels }) as LayoutDocument;
}

const desktop: Part = {
  row: [
    {
      col: [
        { tabs: ["motion"], size: "content" },
        { tabs: ["axes"], size: 1 },
      ],
      size: "300px",
    },
    {
      col: [
        { tabs: ["stage"], size: "content" },
        { tabs: ["scope", "notes"], shown: "notes" },
      ],
    },
  ],
};

describe("a layout in the dock", () => {
  it("comes back as it went in, sizes in pixels and by content too", () => {
    for (const document of [...BUILT_IN, withDesktop(desktop)]) {
      const { row, given } = toFlex(document, BOX, nobody, about);
      expect(fromFlex(row, given, false)).toEqual(document.screens.desktop);
    }
  });
  it("begins with the sizes that it had", () => {
    const { row } = toFlex(
      withDesktop(desktop),
      BOX,
      (sign) => (sign === "motion" ? { width: 300, height: 500 } : undefined),
      about,
    );
    const px = (parts: FlexRow["children"], all: number) =>
      parts.map(({ weight }) => Math.round((weight * (all - SPLITTER_PX)) / 100));
    expect(px(row.children, BOX.width)).toEqual([300, 1092]);
    const side = row.children[0] as FlexRow;
    expect(px(side.children, BOX.height)).toEqual([538, 254]);
  });
  it("does not make a column as wide as its content because that is how high it was", () => {
    const { row, given } = toFlex(withDesktop(desktop), BOX, nobody, about);
    const [side, main] = row.children as [FlexRow, FlexRow];
    const [motion] = side.children;
    const alone = { ...row, children: [{ ...motion, weight: side.weight }, main] };
    expect(fromFlex(alone, given, false)).toMatchObject({ row: [{ tabs: ["motion"], size: side.weight }, {}] });
  });
  it("has shares of its own where a splitter was moved, and keeps the others as they were", () => {
    const { row, given } = toFlex(withDesktop(desktop), BOX, nobody, about);
    const [side, main] = row.children;
    const moved = {
      ...row,
      children: [
        { ...side, weight: 40 },
        { ...main, weight: 60 },
      ],
    };
    const part = fromFlex(moved, given, true) as { row: Part[] };
    expect(part.row.map(({ size }) => size)).toEqual([40, 60]);
    const { size: _, ...inside } = part.row[0] as Part;
    expect(inside).toEqual({ col: (desktop as { row: { col: Part[] }[] }).row[0]?.col });
  });
  it("keeps pixels and what is as high as its content where others were moved", () => {
    const { row, given } = toFlex(withDesktop(desktop), BOX, nobody, about);
    const main = row.children[1] as FlexRow;
    const [stage, scope] = main.children;
    const only = { ...row, children: [row.children[0], { ...main, children: [scope, { ...stage, weight: 70 }] }] };
    const next = new Map();
    const part = fromFlex(only as FlexRow, given, false, next) as { row: { col: Part[] }[] };
    expect(part.row[1]?.col.map(({ size }) => size)).toEqual([expect.any(Number), "content"]);
    expect(fromFlex(only as FlexRow, next, false)).toEqual(part);
  });
  it("loses frames that are empty", () => {
    const { given } = toFlex(withDesktop(desktop), BOX, nobody, about);
    const tabs = { type: "tabset", weight: 50, selected: 0, children: [{ type: "tab", id: "motion" }] };
    const empty = { type: "tabset", weight: 50, children: [] };
    expect(
      fromFlex({ type: "row", children: [{ type: "row", weight: 100, children: [tabs, empty] }] }, given, false),
    ).toEqual({
      tabs: ["motion"],
    });
    expect(fromFlex({ type: "row", children: [empty] }, given, false)).toBeNull();
  });
});

describe("two parts are the same", () => {
  it("by what they say", () => {
    expect(same({ tabs: ["a", "b"], shown: "a" }, { tabs: ["a", "b"] })).toBe(true);
    expect(same({ tabs: ["a", "b"], shown: "b" }, { tabs: ["a", "b"] })).toBe(false);
    expect(same({ row: [{ tabs: ["a"] }, { tabs: ["b"] }] }, { col: [{ tabs: ["a"] }, { tabs: ["b"] }] })).toBe(false);
    expect(same({ tabs: ["a"], size: 2 }, { tabs: ["a"], size: 3 })).toBe(false);
  });
});
