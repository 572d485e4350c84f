import { describe, expect, it } from "vitest";
import { BUILT_IN } from "./builtIn";
import { alone, idsIn, isNewer, type LayoutDocument, type Part, set, shownIn, VERSION } from "./document";
import { added, arranged, brought, closed, moved } from "./edits";
import { read } from "./reading";

const entry = (type: string) => ({ type, v: 1, at: "$", config: {} });
const bench = BUILT_IN[0] as LayoutDocument;

function layout(desktop: unknown, panels: Record<string, unknown>, phone: unknown = []): unknown {
  return {
    format: "stepscope.layout",
    version: 1,
    id: "own",
    name: "Own",
    revision: 3,
    screens: { desktop, phone },
    panels,
  };
}

describe("a layout that is read", () => {
  it("comes back as it was written, each of ours", () => {
    for (const each of BUILT_IN) expect(read(JSON.parse(JSON.stringify(each)))).toEqual(each);
  });
  it("is none for what is no layout", () => {
    for (const raw of [null, 3, "x", [], {}, { format: "other", screens: {} }, { format: "stepscope.layout" }])
      expect(read(raw)).toBeNull();
  });
  it("keeps a panel that nobody knows, with its config", () => {
    const strange = { type: "oracle", v: 7, at: "xy/1", config: { deep: [1, { a: 2 }] } };
    const document = read(
      layout({ row: [{ tabs: ["motion"] }, { tabs: ["strange"] }] }, { motion: entry("motion"), strange }),
    );
    expect(document?.panels.strange).toEqual(strange);
  });
  it("has what moves the motor, even where it was left out or not placed", () => {
    for (const panels of [{ notes: entry("notes") }, { notes: entry("notes"), motion: entry("motion") }]) {
      const document = read(layout({ tabs: ["notes"] }, panels));
      expect(document && idsIn(document.screens.desktop)).toEqual(["motion", "notes"]);
      expect(document?.screens.phone).toEqual(["notes", "motion"]);
    }
  });
  it("leaves out what is broken, and says nothing twice", () => {
    const desktop = {
      row: [
        { tabs: ["motion", "motion", "nobody", 4], size: "12em", shown: "nobody" },
        { col: [{ tabs: [] }, { tabs: ["notes"], size: -3 }] },
        { row: 5 },
        null,
      ],
      size: Number.NaN,
    };
    const panels = {
      motion: entry("motion"),
      notes: { type: "notes" },
      bad: 4,
      "a/b": entry("notes"),
      lost: entry("notes"),
    };
    const document = read(layout(desktop, panels, ["notes", "notes", "nobody", 7]));
    expect(document?.screens).toEqual({
      desktop: { row: [{ tabs: ["motion"] }, { tabs: ["notes"] }] },
      phone: ["notes", "motion"],
    });
    expect(document?.panels).toEqual({ motion: entry("motion"), notes: { ...entry("notes"), v: 0 } });
  });
  it("never throws, whatever it is", () => {
    let deep: unknown = { tabs: ["motion"] };
    for (let level = 0; level < 50; level++) deep = { row: [deep, { tabs: ["notes"] }] };
    const panels = JSON.parse(
      '{"__proto__": {"type": "notes"}, "constructor": {"type": "notes"}, "motion": {"type": "motion"}}',
    );
    for (const desktop of [deep, { tabs: ["constructor", "toString"] }, [], "x", { row: [[[]]] }]) {
      const document = read(layout(desktop, panels));
      expect(document && idsIn(document.screens.desktop)).toContain("motion");
    }
    const many = Object.fromEntries(Array.from({ length: 500 }, (_, at) => [`n${at}`, entry("notes")]));
    expect(Object.keys(read(layout({ tabs: Object.keys(many) }, many))?.panels ?? {}).length).toBeLessThan(50);
  });
  it("of a newer program is told from ours", () => {
    const document = read({
      ...(layout({ tabs: ["motion"] }, { motion: entry("motion") }) as object),
      version: VERSION + 1,
    });
    expect(document && isNewer(document)).toBe(true);
    expect(isNewer(bench)).toBe(false);
  });
});

describe("a layout that is changed", () => {
  const desktop: Part = { row: [{ tabs: ["motion"], size: "300px" }, { tabs: ["scope", "notes"] }] };
  const start = read(
    layout(desktop, { motion: entry("motion"), scope: entry("scope"), notes: entry("notes") }, [
      "motion",
      "scope",
      "notes",
    ]),
  ) as LayoutDocument;

  it("shows one of its tabs", () => {
    expect(shownIn(start.screens.desktop)).toEqual(["motion", "scope"]);
    expect(shownIn(brought(start, "notes").screens.desktop)).toEqual(["motion", "notes"]);
  });
  it("closes a panel and the room of an empty frame, but never the last that moves the motor", () => {
    const less = closed(closed(brought(start, "notes"), "notes"), "scope");
    expect(less.screens).toEqual({ desktop: { tabs: ["motion"] }, phone: ["motion"] });
    expect(Object.keys(less.panels)).toEqual(["motion"]);
    expect(closed(less, "motion")).toBe(less);
    const [two, second] = added(less, entry("motion"), { size: 1 });
    expect(idsIn(closed(two, "motion").screens.desktop)).toEqual([second]);
  });
  it("takes one more at its right edge or behind another, and on a phone where it belongs", () => {
    const [right, id] = added(start, entry("notes"), { size: "300px" }, "motion");
    expect(id).toBe("notes2");
    expect(right.screens.desktop).toEqual({
      row: [...(desktop as { row: Part[] }).row, { tabs: ["notes2"], size: "300px" }],
    });
    expect(right.screens.phone).toEqual(["motion", "notes2", "scope", "notes"]);
    expect(shownIn(added(start, entry("notes"), { into: "motion" })[0].screens.desktop)).toEqual(["notes2", "scope"]);
    expect(closed(right, id)).toEqual(start);
  });
  it("drops what an arrangement no longer has", () => {
    const next = arranged(start, { row: [{ tabs: ["scope"] }, { tabs: ["motion"] }] });
    expect(next.screens.phone).toEqual(["motion", "scope"]);
    expect(Object.keys(next.panels)).toEqual(["motion", "scope"]);
  });
  it("moves up and down on a phone, and leaves the desktop as it is", () => {
    const up = moved(start, "notes", -1);
    expect(up.screens).toEqual({ desktop: start.screens.desktop, phone: ["motion", "notes", "scope"] });
    expect(moved(up, "motion", -1)).toBe(up);
    expect(moved(up, "scope", 1)).toBe(up);
  });
  it("sets a panel, and makes one large beside what moves the motor", () => {
    expect(set(start, "notes", { at: "xy/1" }).panels.notes?.at).toBe("xy/1");
    expect(set(start, "nobody", { at: "xy/1" })).toBe(start);
    expect(alone(start, "notes")).toEqual({ row: [{ tabs: ["motion"], size: "300px" }, { tabs: ["notes"] }] });
    expect(alone(start, "motion")).toEqual({ tabs: ["motion"] });
  });
});
