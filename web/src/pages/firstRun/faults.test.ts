import { expect, test } from "vitest";
import { flagAmong, REVERSING, SWAPPING } from "./flags";
import { whyNoTurn } from "./noTurn";
import { answerTo, type Switches } from "./pressed";

const row = (name: string, value: number, fields: Record<string, number> = {}) => ({ name, value, fields });

test("a flag is a field of a register, or a parameter of its own", () => {
  const chip = [row("IFCNT", 3), row("GCONF", 16, { diag0: 0, shaft: 1 })];
  expect(flagAmong(chip, REVERSING)).toEqual({ register: "GCONF", field: "shaft", value: 1, other: 0 });
  expect(flagAmong([row("swap_limit_switches", 0)], SWAPPING)).toMatchObject({ field: null, value: 0, other: 1 });
  expect(flagAmong(chip, SWAPPING)).toBeNull();
});

test("the level of a direction output turns a motor only where steps are given there", () => {
  expect(flagAmong([row("if_configuration", 0, { inv_dir: 0, en_sd: 0 })], REVERSING)).toBeNull();
  expect(flagAmong([row("if_configuration", 32, { inv_dir: 0, en_sd: 1 })], REVERSING)).toMatchObject({ other: 1 });
});

const seen = (flags: Record<string, boolean>, kind = "moving", cause = "") =>
  ({ flags, condition: { kind, cause } }) as unknown as Parameters<typeof whyNoTurn>[0][number];

test("a motor that does not turn is explained by its condition, its coils, or by nothing", () => {
  expect(whyNoTurn([seen({ ola: true }, "driver_fault", "it is too hot")]).found).toBe("it is too hot");
  expect(whyNoTurn([seen({ ola: true, olb: true })]).found).toContain("not connected");
  expect(whyNoTurn([seen({ open_load_a: false, open_load_b: true })]).found).toContain("coil B");
  expect(whyNoTurn([seen({ OLA: false, OLB: false })]).found).toContain("current flows");
  expect(
    whyNoTurn([seen({ driver_ola: false }), seen({ driver_ola: false }), seen({ driver_ola: true })]).found,
  ).toContain("current flows");
  expect(whyNoTurn([seen({ stst: true })]).found).toContain("cannot tell");
});

const switches = (left: boolean | null, right: boolean | null, home: boolean | null = null): Switches => ({
  left,
  right,
  home,
});

test("a pressed switch answers on its own input, on another one, or on none", () => {
  const rest = switches(false, false, false);
  expect(answerTo("left", rest, switches(true, false, false), false).kind).toBe("right one");
  expect(answerTo("left", rest, switches(false, true, false), false)).toEqual({ kind: "other", side: "right" });
  expect(answerTo("left", rest, rest, false).kind).toBe("waiting");
  expect(answerTo("left", rest, rest, true).kind).toBe("none");
  expect(answerTo("left", switches(true, false), switches(false, false), false).kind).toBe("active already");
  expect(answerTo("home", switches(false, false), switches(false, false), true).kind).toBe("none");
});
