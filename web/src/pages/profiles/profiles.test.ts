import { describe, expect, it } from "vitest";
import type { Schemas } from "../../api/client";
import { fileName } from "../../lib/files";
import type { RegisterRow } from "../../lib/rows/bits";
import { byName, entriesOf, rowsOf, sameRows } from "./diff";
import { type Kind, type Language, tokensOf } from "./highlight";
import { fatesOf } from "./steps";
import type { Diff, Profile } from "./useProfiles";

function piecesOf(text: string, language: Language): [Kind, string][] {
  return tokensOf(text, language)
    .filter(({ text: piece }) => piece.trim() !== "")
    .map(({ kind, text: piece }) => [kind, piece.trim()]);
}

describe("a program in colours", () => {
  it("tells remarks, words, texts and numbers of each language", () => {
    expect(piecesOf("return 'A', 12  # why", "python")).toEqual([
      ["word", "return"],
      ["text", "'A'"],
      ["plain", ","],
      ["number", "12"],
      ["remark", "# why"],
    ]);
    expect(piecesOf("{0x6Cu, 1}, /* a\nb */", "c")).toEqual([
      ["plain", "{"],
      ["number", "0x6Cu"],
      ["plain", ","],
      ["number", "1"],
      ["plain", "},"],
      ["remark", "/* a\nb */"],
    ]);
    expect(piecesOf("SAP 4, 0, 1000 // pps", "tmcl").at(0)).toEqual(["word", "SAP"]);
    expect(piecesOf("put 'V_MAX' # x", "curl")).toEqual([
      ["word", "put"],
      ["text", "'V_MAX'"],
      ["remark", "# x"],
    ]);
  });

  it("loses no letter, whatever the text is", () => {
    const odd = `a "open\n /* never closed ## $\{x#y} $# ' é 漢 0x12g 1.5.2 """ //`;
    for (const language of ["python", "c", "curl", "tmcl"] as const)
      expect(
        tokensOf(odd, language)
          .map(({ text }) => text)
          .join(""),
      ).toBe(odd);
  });

  it("takes a dollar's hash for no remark", () => {
    expect(tokensOf(`$\{a##*x} $#`, "curl").every(({ kind }) => kind !== "remark")).toBe(true);
  });
});

const field = (name: string, lsb: number, width: number, more = {}) => ({
  name,
  lsb,
  width,
  access: "RW",
  signed: false,
  unit: "",
  values: {},
  when: "",
  ...more,
});
const ROWS = [
  { name: "V_MAX", axis: 0, group: "motion", width: 11, signed: false, unit: "pps", values: {}, fields: [] },
  {
    name: "MODE",
    axis: 0,
    group: "switches",
    width: 8,
    signed: false,
    unit: "",
    values: {},
    fields: [
      field("rm", 0, 2, { values: { 0: "RAMP", 1: "SOFT" } }),
      field("flag", 7, 1),
      field("state", 3, 1, { access: "R" }),
    ],
  },
] as unknown as RegisterRow[];
const PROFILE = {
  model: "tmc4210",
  clock_hz: 16e6,
  axes: [
    { name: "x", full_steps_per_rev: 200, driver_microsteps: 16, gear_ratio: 1, travel_mm_per_rev: null, limits: null },
  ],
  registers: [
    { name: "v_max", axis: null, value: 500, fields: null, unit: "" },
    { name: "MODE", axis: 0, value: null, fields: { rm: "SOFT", flag: 1 }, unit: "" },
  ],
  parameters: [],
  tables: { microstep: null, driver_chain: null, mslut: null, user_variables: null },
} as unknown as Profile;
const difference = (more: Partial<Schemas["Difference"]>): Schemas["Difference"] => ({
  kind: "register",
  name: "V_MAX",
  axis: 0,
  table: null,
  left: 400,
  right: 500,
  unit: "pps",
  left_physical: "1.67638e+06 pps^2",
  right_physical: null,
  fields: [],
  written: true,
  why: "",
  ...more,
});

describe("two sides", () => {
  const entries = entriesOf(PROFILE, byName(ROWS));

  it("knows a profile's numbers by register and field, names of values and missing axes included", () => {
    const said = Object.fromEntries(entries.map(({ key, value }) => [key, value]));
    expect(said["0/v_max"]).toBe(500);
    expect(said["0/mode.rm"]).toBe(1);
    expect(said["0/mode.flag"]).toBe(1);
    expect(said["0/mode.state"]).toBeUndefined();
    expect(said["mechanics/0/full steps a turn"]).toBe(200);
  });

  it("shows fields that differ one by one, and all else only on request", () => {
    const fields = [{ name: "rm", left: 0, right: 1, left_meaning: "RAMP", right_meaning: "SOFT" }];
    const diff = { differences: [difference({ name: "MODE", left: 0, right: 129, fields })] } as unknown as Diff;
    const different = rowsOf(diff, entries);
    expect(different.map(({ field: name, before, after }) => [name, before, after])).toEqual([["rm", 0, 1]]);
    expect(different[0]?.part).toBe("switches");
    const same = sameRows(different, entries, PROFILE, false).map(({ name, field: part }) => part ?? name);
    expect(same).toContain("flag");
    expect(same).toContain("V_MAX");
    expect(same).not.toContain("rm");
  });

  it("writes physical numbers as the page does", () => {
    const [row] = rowsOf({ differences: [difference({})] } as unknown as Diff, entries);
    expect(row?.beforeMeaning).toBe("1\u202f676\u202f380\u202fpps²");
    expect(row?.afterMeaning).toBe("");
  });
});

describe("a transaction that failed", () => {
  const dry = {
    differences: [
      difference({}),
      difference({ name: "A_MAX" }),
      difference({ name: "V_MIN" }),
      difference({ kind: "mechanics", name: "gear_ratio" }),
    ],
  };
  const problem = (left: unknown[]) =>
    ({
      facts: { written: 1, failed: { name: "A_MAX", axis: 0, was: 400, now: null, wanted: 500, why: "no" }, left },
    }) as unknown as Parameters<typeof fatesOf>[0];

  it("tells what went back, what failed and what was never begun", () => {
    expect(fatesOf(problem([]), dry).map(({ name, fate }) => [name, fate])).toEqual([
      ["V_MAX", "gone back"],
      ["A_MAX", "failed"],
      ["V_MIN", "not begun"],
    ]);
  });

  it("tells exactly what is left, also what nobody had meant to write", () => {
    const stray = { name: "PMUL", axis: 0, was: 1, now: 2, wanted: 1, why: "gone astray" };
    const stuck = { name: "V_MAX", axis: 0, was: 400, now: 500, wanted: 500, why: "silent" };
    const lines = fatesOf(problem([stuck, stray]), dry);
    expect(lines.filter(({ fate }) => fate === "left").map(({ name, now }) => [name, now])).toEqual([
      ["V_MAX", 500],
      ["PMUL", 2],
    ]);
  });

  it("says nothing of steps where none was written", () => {
    expect(fatesOf({ facts: {} } as unknown as Parameters<typeof fatesOf>[0], dry)).toEqual([]);
  });
});

describe("a file", () => {
  it("has a name that no file system minds", () => {
    expect(fileName("X axis, fast & quiet", ".json")).toBe("x-axis-fast-quiet.json");
    expect(fileName("../..", ".json")).toBe("profile.json");
  });
});
