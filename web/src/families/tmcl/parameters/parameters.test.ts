import { describe, expect, it } from "vitest";
import { parseInput } from "../../../lib/rows/input";
import { register } from "../../../lib/rows/samples";
import { keyOf } from "../../../lib/rows/staging";
import type { Reading } from "../../../lib/rows/useRegisters";
import type { AxisScale } from "../../../lib/units";
import { lackingOf } from "./lacking";
import { controlOf, numberOf } from "./ParameterValue";
import { type Context, meaningOf, rangeOf, scalesOf, unitModeOf, unitText } from "./quantities";
import { foldedAtFirst, nameText, subjectsOf } from "./subjects";

const scale: AxisScale = {
  fullStepsPerRev: 200,
  microstepsPerFullStep: 256,
  gearRatio: 1,
  travelMmPerRev: 5,
  pulseDiv: null,
  rampDiv: null,
  clockHz: 16e6,
};
const context: Context = { scale, mode: "pps", clockHz: 16e6, globalScaler: 0 };

const parameter = (name: string, alias: string, unit: string, more = {}) =>
  register(name, 32, { alias, space: "ap", unit, signed: true, ...more });
const speed = parameter("maximum_positioning_speed", "AP 4", "pps", {
  minimum: 0,
  maximum: 7999774,
  internal_range: [0, 8388096],
});
const current = parameter("maximum_current", "AP 6", "1/255", { minimum: 0, maximum: 255 });

describe("what a firmware lacks", () => {
  const row = (name: string, more = {}) => parameter(name, name, "", { group: "axis 0", ...more });
  const there = row("there");
  const lacking = row("lacking");
  const flags = row("flags", { read_clears: true });
  const rows = [there, lacking, flags, row("pull_ups", { access: "W" }), row("folded", { group: "axis 1" })];

  it("is what an answer has left out of a group that was asked for", () => {
    const answer = new Map([[keyOf(there), {} as Reading]]);
    expect([...lackingOf(rows, answer)]).toEqual([keyOf(lacking)]);
  });

  it("is nothing while there is no answer", () => {
    expect(lackingOf(rows, new Map()).size).toBe(0);
  });
});

describe("what a parameter's number means", () => {
  it("tells turns a second, turns a minute and travel of a speed in pps", () => {
    expect(meaningOf(speed, 51200, context)).toBe("1\u202frps · 60\u202frpm · 5\u202fmm/s");
  });

  it("knows no mechanics without an axis, and no travel of a rotary one", () => {
    expect(meaningOf(speed, 51200, { ...context, scale: null })).toBe("");
    expect(meaningOf(speed, 51200, { ...context, scale: { ...scale, travelMmPerRev: null } })).toBe(
      "1\u202frps · 60\u202frpm",
    );
  });

  it("converts the driver chip's own units while the module counts in them", () => {
    const internal: Context = { ...context, mode: "internal" };
    // f / 2^24 = 0.9537 pps
    expect(meaningOf(speed, 2 ** 20, internal)).toMatch(/^1\u202f000\u202f000\u202fpps/);
    expect(rangeOf(speed, "internal")).toEqual({ minimum: 0, maximum: 8388096 });
    expect(rangeOf(speed, "pps")).toEqual({ minimum: 0, maximum: 7999774 });
    expect(unitText(speed, "internal")).toBe("chip");
    expect(unitModeOf(0)).toBe("internal");
    expect(unitModeOf(undefined)).toBe("pps");
  });

  it("converts by the dividers that the axis knows, where the module counts by those", () => {
    const divided = parameter("maximum_positioning_speed", "AP 4", "fCLK/(65536*2^pulse_div) Hz", { maximum: 2047 });
    const known: Context = { ...context, scale: { ...scale, pulseDiv: 3, rampDiv: 7 } };
    // 16 MHz * 1678 / (2^3 * 2048 * 32) = 51,208 pps
    expect(meaningOf(divided, 1678, known)).toMatch(/^51\u202f208\u202fpps · 1\.000\u202frps/);
    expect(meaningOf(divided, 1678, context)).toBe("");
    expect(unitText(divided, "pps")).toBe("chip");
    const slope = parameter("maximum_acceleration", "AP 5", "fCLK^2/2^(pulse_div+ramp_div+29) Hz/s");
    // 16 MHz^2 * 100 / 2^(7 + 3 + 29) = 46,566 pps^2
    expect(meaningOf(slope, 100, known)).toMatch(/^46\u202f566\u202fpps²/);
  });

  it("tells times of ramp wait, power down ramp and delay", () => {
    expect(meaningOf(parameter("ramp_wait_time", "AP 21", "32 us"), 10000, context)).toBe("320\u202fms");
    expect(meaningOf(parameter("power_down_ramp", "AP 31", "16.384 ms"), 1, context)).toBe("16.4\u202fms");
    expect(meaningOf(parameter("power_down_delay", "AP 214", "10 ms"), 200, context)).toBe("2\u202fs");
  });

  it("tells the current that the driver's 32 steps come to", () => {
    expect(meaningOf(current, 255, context)).toBe("4.20\u202fA peak · 100\u202f%");
    // 128 is step 16 of 0..31: 17 of 32 steps
    expect(meaningOf(current, 128, context)).toBe("2.23\u202fA peak · 50.2\u202f%");
    expect(meaningOf(current, 255, { ...context, globalScaler: 128 })).toMatch(/2\.10\u202fA peak/);
    expect(meaningOf(current, 255, { ...context, globalScaler: null })).toBe("100\u202f%");
  });
});

describe("what is typed", () => {
  const typed = (row: typeof speed, text: string) =>
    parseInput(text, { ...row, ...rangeOf(row, "pps") }, scalesOf(row, scale, "pps", 16e6));
  it("takes physical units", () => {
    expect(typed(speed, "2 rps")).toEqual({ ok: true, value: 102400 });
    expect(typed(speed, "30 rpm")).toEqual({ ok: true, value: 25600 });
    expect(typed(speed, "10 mm/s")).toEqual({ ok: true, value: 102400 });
    expect(typed(current, "50 %")).toEqual({ ok: true, value: 128 });
    const delay = parameter("power_down_delay", "AP 214", "10 ms", { minimum: 0, maximum: 417 });
    expect(typed(delay, "1.5 s")).toEqual({ ok: true, value: 150 });
    expect(typed(delay, "500 ms")).toEqual({ ok: true, value: 50 });
  });

  it("refuses what the module would clip", () => {
    expect(typed(speed, "8000000").ok).toBe(false);
    expect(typed(speed, "-1").ok).toBe(false);
  });
});

describe("controls", () => {
  it("suit the parameter", () => {
    const flag = { minimum: 0, maximum: 1 };
    expect(controlOf(parameter("a", "AP 12", "", { ...flag, values: { 0: "off", 1: "on" } }))).toBe("switch");
    expect(controlOf(parameter("a", "AP 127", "", { ...flag, values: { 0: "target", 1: "position" } }))).toBe("select");
    expect(controlOf(parameter("a", "AP 8", "", { ...flag, access: "R" }))).toBe("none");
    expect(controlOf(speed)).toBe("entry");
  });

  it("read 32 bits as signed", () => {
    expect(numberOf(speed, 0xffffffff)).toBe(-1);
    expect(numberOf(speed, undefined)).toBeNull();
  });
});

describe("subjects", () => {
  const rows = [
    parameter("maximum_positioning_speed", "AP 4", "pps", { group: "ramp" }),
    parameter("serial_baud_rate", "GP0 65", "", { group: "interface", axis: null, values: { 0: "9600" } }),
    parameter("velocity_v1", "AP 16", "pps", { group: "ramp" }),
  ];
  it("gather rows whatever bank they live in", () => {
    expect(subjectsOf(rows, "").map((group) => [group.title, group.rows.length])).toEqual([
      ["Ramp", 2],
      ["Interface", 1],
    ]);
  });

  it.each([
    ["ap 16", "velocity_v1"],
    ["positioning speed", "maximum_positioning_speed"],
    ["9600", "serial_baud_rate"],
  ])("are searched by number, words and values: %s", (query, name) => {
    expect(subjectsOf(rows, query).flatMap((group) => group.rows.map((row) => row.name))).toEqual([name]);
  });

  it("are called as the manual does", () => {
    expect(nameText("maximum_positioning_speed")).toBe("Maximum positioning speed");
    expect(foldedAtFirst("variables", 0)).toBe(true);
    expect(foldedAtFirst("ramp", 0)).toBe(false);
    expect([0, 1, 2].map((axis) => foldedAtFirst("axis 1", axis))).toEqual([true, false, true]);
  });
});
