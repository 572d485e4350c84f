import { describe, expect, it } from "vitest";
import type { Schemas } from "../../api/client";
import { scaleOf } from "../units";
import { bitOf, editorOf, type FieldRow, packField, segments, summary, toRaw, toSigned, unpackField } from "./bits";
import { parseInput } from "./input";
import { derived, liveScale, pairText, physicalText, scalesOf, speedsOf } from "./physical";
import { field, register } from "./samples";
import { besideText, groupRows, matches, matchingFields } from "./search";
import { batchOf, changes, countChanges, type Edit, keyOf, merge, settle, stage, stagedRaw, unstage } from "./staging";

const VELOCITY = "fCLK/(65536*2^pulse_div) Hz";
const ACCELERATION = "fCLK^2/2^(pulse_div+ramp_div+29) Hz/s";

const DIVIDERS = register("pulse_div_ramp_div_usrs", 16, {
  fields: [
    field("usrs", 0, 3, { maximum: 6, values: { 0: "full step", 6: "64 microsteps" } }),
    field("ramp_div", 8, 4, { maximum: 13, unit: "fCLK/32/2^n" }),
    field("pulse_div", 12, 4, { maximum: 13, unit: "fCLK/32/2^n" }),
  ],
});
const FLAGS = register("interrupt_mask_interrupt_flags", 16, {
  volatile: true,
  fields: [field("INT_STOP", 3, 1, { access: "R+WC" }), field("MASK_STOP", 11, 1, { values: { 0: "off", 1: "on" } })],
});
const X_TARGET = register("x_target", 24, { signed: true, unit: "microsteps", address: 0x00 });
const V_MAX = register("v_max", 11, { unit: VELOCITY, address: 0x03 });
const POWER_DOWN = register("power_down", 24, { access: "W", axis: null, reset: null });

const usrs = DIVIDERS.fields[0] as FieldRow;
const rampDiv = DIVIDERS.fields[1] as FieldRow;

describe("bits", () => {
  it("packs a field without touching its neighbours, up to the top bit of 32", () => {
    for (const part of [
      ...DIVIDERS.fields,
      field("top", 28, 4),
      field("signed", 20, 6, { signed: true, minimum: -32 }),
    ]) {
      for (const word of [0, 0x5706, 0xffff_ffff, 0xa5a5_a5a5]) {
        for (const value of [part.minimum, part.maximum - (part.signed ? 32 : 0)]) {
          const packed = packField(word, part, value);
          expect(unpackField(packed, part)).toBe(value);
          expect(packField(packed, part, unpackField(word, part))).toBe(word);
        }
      }
    }
  });

  it("keeps two's complement both ways", () => {
    expect(toSigned(0xffffff, 24)).toBe(-1);
    expect(toRaw(-1, 24)).toBe(0xffffff);
    expect(toRaw(toSigned(0x800000, 24), 24)).toBe(0x800000);
    expect(bitOf(0x800000, 23)).toBe(1);
  });

  it("cuts the word into fields and gaps that fill all bits once", () => {
    for (const row of [DIVIDERS, FLAGS, X_TARGET, V_MAX]) {
      const drawn = segments(row);
      expect(drawn[0]?.msb).toBe(23);
      expect(drawn.at(-1)?.lsb).toBe(0);
      drawn.slice(1).forEach((part, index) => {
        expect(part.msb).toBe((drawn[index]?.lsb ?? 0) - 1);
      });
    }
    expect(segments(DIVIDERS).map((part) => part.field?.name ?? "-")).toEqual([
      "-",
      "pulse_div",
      "ramp_div",
      "-",
      "usrs",
    ]);
  });

  it("chooses the editor by what the bits mean", () => {
    expect(editorOf(usrs)).toBe("select");
    expect(editorOf(rampDiv)).toBe("number");
    expect(editorOf(field("plain", 0, 1))).toBe("check");
    expect(editorOf(field("switch", 0, 1, { values: { 0: "off", 1: "on" } }))).toBe("check");
    expect(editorOf(field("level", 0, 1, { values: { 0: "low", 1: "high" } }))).toBe("select");
  });

  it("sums a packed register up by name", () => {
    expect(summary(DIVIDERS, 0x5706)).toBe("usrs 64 microsteps · ramp_div 7 · pulse_div 5");
    expect(summary(FLAGS, 0)).toBe("nothing set");
    expect(summary(FLAGS, 0x0808)).toBe("INT_STOP · MASK_STOP");
    expect(summary(X_TARGET, 0xffffff)).toBe("−1");
  });
});

describe("input", () => {
  const pps = [{ unit: "pps", perChip: 7.62939453125 }];
  it.each([
    ["100", 100],
    [" 1_000 ", 1000],
    ["0x7FF", 2047],
    ["0b101", 5],
    ["7629.4 pps", 1000],
    ["7629.4pps", 1000],
  ])("takes %s", (text, value) => {
    expect(parseInput(text, V_MAX, pps)).toEqual({ ok: true, value });
  });

  it.each(["", "2048", "-1", "1.5", "NaN", "Infinity", "1e3", "12 rpm", "ten", "0x", "99999 pps", "0x800"])(
    "refuses %j and says what is allowed",
    (text) => {
      const parsed = parseInput(text, V_MAX, pps);
      expect(parsed.ok).toBe(false);
      if (!parsed.ok) expect(parsed.why).toMatch(/0 to 2047|it takes pps|11 bits/);
    },
  );

  it("reads hex as raw bits of a signed register", () => {
    expect(parseInput("0xFFFFFF", X_TARGET)).toEqual({ ok: true, value: -1 });
    expect(parseInput("\u22128388608", X_TARGET)).toEqual({ ok: true, value: -8388608 });
    expect(parseInput("8388608", X_TARGET).ok).toBe(false);
    expect(parseInput("0x1000000", X_TARGET).ok).toBe(false);
  });

  it("takes names of enumerated values, in their range", () => {
    expect(parseInput("64 Microsteps", usrs)).toEqual({ ok: true, value: 6 });
    expect(parseInput("7", usrs).ok).toBe(false);
  });
});

describe("staging", () => {
  const chip = 0x5706;

  it("stages fields one by one and drops the one that is set back", () => {
    let edits = stage([], DIVIDERS, rampDiv, 9, chip);
    edits = stage(edits, DIVIDERS, usrs, 4, chip);
    expect(countChanges(edits)).toBe(2);
    expect(
      changes(edits[0] as Edit, DIVIDERS, chip).map(({ field: part, from, to }) => [part?.name, from, to]),
    ).toEqual([
      ["usrs", 6, 4],
      ["ramp_div", 7, 9],
    ]);
    expect(stagedRaw(edits[0] as Edit, DIVIDERS, chip)).toBe(0x5904);
    edits = stage(edits, DIVIDERS, rampDiv, 7, chip);
    expect(edits).toHaveLength(1);
    expect(unstage(edits, keyOf(DIVIDERS), "usrs")).toEqual([]);
  });

  it("drops a register that is set back, but keeps what acts when written", () => {
    expect(stage(stage([], V_MAX, null, 5, 1000), V_MAX, null, 1000, 1000)).toEqual([]);
    expect(stage([], { ...V_MAX, volatile: true }, null, 1000, 1000)).toHaveLength(1);
    expect(stage([], POWER_DOWN, null, 0, null)).toHaveLength(1);
    expect(stage([], FLAGS, FLAGS.fields[0] as FieldRow, 1, 0x0008)).toHaveLength(1);
  });

  it("sends them in the order of staging, signed values signed", () => {
    const edits = stage(stage([], X_TARGET, null, -5, 0), DIVIDERS, usrs, 4, chip);
    expect(batchOf(edits)).toEqual([
      { name: "x_target", axis: 0, value: -5 },
      { name: "pulse_div_ramp_div_usrs", axis: 0, fields: { usrs: 4 } },
    ]);
    expect(changes(edits[0] as Edit, X_TARGET, 0xffffff)).toEqual([{ field: null, from: -1, to: -5 }]);
  });

  it("loses nothing that failed, and nothing that changed meanwhile", () => {
    const first = stage([], X_TARGET, null, 10, 0);
    const second = stage(first, V_MAX, null, 7, 0);
    const sent = stage(second, DIVIDERS, usrs, 4, chip);
    const written = { raw: 10, verified: true } as Schemas["RegisterWritten"];
    const problem = { type: "/problems/write-refused", title: "Refused", status: 409, detail: "no" } as never;
    const { applied, left } = settle(sent, { done: [written], failed: problem, not_tried: 1 });
    expect(applied.map(({ edit }) => edit.name)).toEqual(["x_target"]);
    expect(left.map((edit) => [edit.name, edit.fate?.kind])).toEqual([
      ["v_max", "refused"],
      ["pulse_div_ramp_div_usrs", "not tried"],
    ]);
    const meanwhile = stage(sent, X_TARGET, null, 20, 10);
    expect(merge(meanwhile, sent, left).map((edit) => [edit.name, edit.value, edit.fate?.kind])).toEqual([
      ["x_target", 20, undefined],
      ["v_max", 7, "refused"],
      ["pulse_div_ramp_div_usrs", null, "not tried"],
    ]);
    expect(merge([], sent, left)).toEqual([]);
  });

  it("counts a read-back that differs as failed", () => {
    const sent = stage([], V_MAX, null, 7, 0);
    const { applied, left } = settle(sent, {
      done: [{ raw: 6, verified: false } as Schemas["RegisterWritten"]],
      failed: null,
      not_tried: 0,
    });
    expect(applied).toEqual([]);
    expect(left[0]?.fate).toEqual({ kind: "differs", readBack: 6 });
  });
});

describe("search", () => {
  const rows = [X_TARGET, V_MAX, DIVIDERS, { ...V_MAX, axis: 1 }, POWER_DOWN];
  it("finds by name, address, field and help, every word", () => {
    expect(matches(V_MAX, "0x03")).toBe(true);
    expect(matches(DIVIDERS, "ramp_div help")).toBe(true);
    expect(matches(DIVIDERS, "ramp_div nowhere")).toBe(false);
    expect(matchingFields(DIVIDERS, "64 micro")).toEqual(["usrs"]);
    expect(matchingFields(DIVIDERS, "usrs")).toEqual([]);
  });

  it("shows one axis and the whole chip, or every axis", () => {
    expect(groupRows(rows, 0, "").map((group) => [group.axis, group.rows.length])).toEqual([
      [0, 3],
      [null, 1],
    ]);
    expect(groupRows(rows, null, "v_max").map((group) => group.axis)).toEqual([0, 1]);
  });
});

describe("physical", () => {
  const axis = {
    index: 0,
    name: "x",
    full_steps_per_rev: 200,
    driver_microsteps: 16,
    gear_ratio: 2,
    travel_mm_per_rev: 5,
    microsteps_per_full_step: 16,
    pulse_div: 3,
    ramp_div: 3,
  };
  const device = { clock_hz: 16e6, axes: [axis] } as unknown as Schemas["DeviceInfo"];
  const readings = [
    { name: "pulse_div_ramp_div_usrs", axis: 0, fields: { usrs: 6, ramp_div: 7, pulse_div: 5 } },
  ] as unknown as Schemas["RegisterReading"][];

  it("takes the dividers from the chip, else from what the server knew", () => {
    expect(liveScale(device, 0, readings)).toMatchObject({ pulseDiv: 5, rampDiv: 7, microstepsPerFullStep: 64 });
    expect(liveScale(device, 0, undefined)).toMatchObject({ pulseDiv: 3, microstepsPerFullStep: 16 });
    expect(scalesOf("microsteps", liveScale(device, 4, undefined))).toEqual([]);
  });

  it("follows the data sheet's formulas", () => {
    const context = liveScale(device, 0, readings);
    expect(scalesOf(VELOCITY, context)[0]?.perChip).toBeCloseTo(16e6 / 65536 / 32, 10);
    expect(scalesOf(ACCELERATION, context)[0]?.perChip).toBeCloseTo(16e6 ** 2 / 2 ** (5 + 7 + 29), 10);
    const turn = scalesOf("microsteps", context).map((unit) => unit.perChip * 25_600);
    expect(turn.map((size) => Number(size.toFixed(9)))).toEqual([1, 360, 5]);
    expect(physicalText(1000, scalesOf(VELOCITY, context))).toBe("7629\u202fpps · 17.88\u202frpm · 1.490\u202fmm/s");
    expect(scalesOf(VELOCITY, { ...context, pulseDiv: null })).toEqual([]);
  });

  it("tells what dividers and pairs come to", () => {
    expect(derived(rampDiv, 7, 16e6)).toBe("3906\u202fHz");
    expect(derived(field("clk2_div", 8, 8), 7, 16e6)).toBe("1\u202fMHz");
    const pair = (pmul: FieldRow) => register("pmul_pdiv", 16, { fields: [field("pdiv", 0, 4), pmul] });
    expect(pairText(pair(field("pmul", 8, 7)), 0x8000 | (64 << 8) | 3)).toBe("p 3");
    expect(pairText(pair(field("PMUL", 8, 8)), (192 << 8) | 3)).toBe("p 3");
  });
});

describe("a word with several names", () => {
  const latch = register("X_LATCH", 32, { address: 0x36, access: "R" });
  const turns = register("REV_CNT", 32, { address: 0x36, access: "R", when: "circular_cnt_as_xlatch is on" });
  const range = register("X_RANGE", 32, { address: 0x36, access: "W" });
  const other = register("X_HOME", 32, { address: 0x35 });
  const rows = [latch, turns, range, other];

  it("tells who else is at an address, and when", () => {
    expect(besideText(latch, rows)).toBe("REV_CNT when read, if circular_cnt_as_xlatch is on; X_RANGE when written");
    expect(besideText(range, rows)).toContain("X_LATCH when read");
    expect(besideText(other, rows)).toBe("");
  });

  it("draws bits once, by the name that always holds", () => {
    const scales = register("SCALE_VALUES", 16, {
      fields: [
        field("boost", 0, 8),
        field("drive", 8, 8),
        field("cl_imin", 0, 8, { when: "closed_loop_scale_en" }),
        field("cl_imax", 8, 8, { when: "closed_loop_scale_en" }),
      ],
    });
    const drawn = segments(scales, 16);
    expect(drawn.map((part) => part.field?.name)).toEqual(["drive", "boost"]);
    expect(summary(scales, 0x0102)).toBe("boost 2 · drive 1");
  });
});

describe("velocities that are kept as steps", () => {
  it("have their physical units, and clocks their time", () => {
    const scale = scaleOf({ microsteps_per_full_step: 256, full_steps_per_rev: 200 } as Schemas["AxisInfo"], 16e6);
    expect(scalesOf("1/256 pps", scale)[0]).toMatchObject({ unit: "pps", perChip: 1 / 256 });
    expect(scalesOf("pps", scale)[0]).toMatchObject({ unit: "pps", perChip: 1 });
    expect(scalesOf("tCLK", scale)).toEqual([{ unit: "µs", perChip: 1 / 16 }]);
    expect(derived({ name: "START_DELAY", unit: "tCLK" }, 1600, 16e6)).toBe("100\u202fµs");
  });

  it("know a TMC5xxx's units, which hang on its clock alone (TMC5160A data sheet, 12.1)", () => {
    const scale = scaleOf({ microsteps_per_full_step: 256, full_steps_per_rev: 200 } as Schemas["AxisInfo"], 16e6);
    expect(scalesOf("fCLK/2^24 pps", scale)[0]).toEqual({ unit: "pps", perChip: 16e6 / 2 ** 24 });
    expect(scalesOf("fCLK^2/2^41 pps^2", scale)[0]).toEqual({ unit: "pps²", perChip: 16e6 ** 2 / 2 ** 41 });
    expect(scalesOf("512 tCLK", scale)).toEqual([{ unit: "ms", perChip: 512e3 / 16e6 }]);
    expect(scalesOf("2^18 tCLK", scale)[0]?.perChip).toBeCloseTo(16.384, 9);
  });

  it("come from times between steps, in the axis's own microsteps", () => {
    const scale = scaleOf({ microsteps_per_full_step: 16, full_steps_per_rev: 200 } as Schemas["AxisInfo"], 16e6);
    const tstep = { name: "TSTEP", unit: "tCLK", width: 20 };
    expect(speedsOf(tstep, 1000, scale)).toEqual(["1000\u202fpps", "18.8\u202frpm"]);
    expect(speedsOf(tstep, 0xf_ffff, scale)).toEqual(["at rest"]);
    expect(speedsOf({ ...tstep, name: "TPWMTHRS" }, 0, scale)).toEqual([]);
    expect(speedsOf({ ...tstep, name: "TZEROWAIT" }, 1000, scale)).toEqual([]);
  });
});

describe("times in clocks", () => {
  const clocks = (name: string, unit: string, value: number, values = {}) =>
    derived({ ...field(name, 0, 8), unit, values }, value, 16e6);

  it("take the number that a value's name is, where it has one", () => {
    expect(clocks("tbl", "tCLK", 2, { 0: "16", 1: "24", 2: "36", 3: "54" })).toBe("2.25\u202fµs");
    expect(clocks("faststandstill", "tCLK", 0, { 0: "2^20", 1: "2^18" })).toBe("65.5\u202fms");
    expect(scalesOf("tCLK", null)).toEqual([]);
  });

  it("count from one where the register does", () => {
    expect(clocks("STPDIV_4210", "16 tCLK", 15)).toBe("16\u202fµs");
    expect(clocks("DC_SG", "16 tCLK", 15)).toBe("15\u202fµs");
    expect(clocks("IHOLDDELAY", "2^18 tCLK", 1)).toBe("16.4\u202fms");
  });
});
