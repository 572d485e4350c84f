import { describe, expect, it } from "vitest";
import type { Schemas } from "../../../api/client";
import type { Answer } from "../../../lib/ramp/answer";
import { chipRamp } from "../../../lib/ramp/chip";
import { writesFor } from "../../../lib/ramp/differences";
import { compared, designOf } from "./chip";
import {
  changed,
  type Design,
  locked,
  lockOf,
  OPTIONS,
  PRESETS,
  rampParameters,
  START,
  used,
  withRoom,
} from "./design";
import { handlesOf, shownHandles } from "./handles";
import { stretches } from "./phases";
import { corners } from "./rivals";

const phase = (name: string, start_s: number, end_s: number) => ({ name, start_s, end_s });
const WHOLE = [
  phase("B1", 0, 0.1),
  phase("B12", 0.1, 0.2),
  phase("B2", 0.2, 0.3),
  phase("B23", 0.3, 0.5),
  phase("B3", 0.5, 0.6),
  phase("B34", 0.6, 0.7),
  phase("B4", 0.7, 0.8),
];

describe("phases", () => {
  it("are all seven, those without time where they would be", () => {
    const all = stretches(
      [WHOLE[0], WHOLE[2], WHOLE[4], WHOLE[6]].filter((each) => each !== undefined),
      "s",
    );
    expect(all.map((each) => each.name)).toEqual(["B1", "B12", "B2", "B23", "B3", "B34", "B4"]);
    expect(all.filter((each) => each.empty).map((each) => each.name)).toEqual(["B12", "B23", "B34"]);
    expect(all.find((each) => each.name === "B12")?.startS).toBe(0.1);
  });

  it("of a motion that brakes first come as they come", () => {
    const back = [phase("B3", 0, 0.1), phase("B4", 0.1, 0.2), phase("B1", 0.2, 0.3), phase("B2", 0.3, 0.4)];
    expect(stretches(back, "s").map((each) => each.name)).toEqual(["B3", "B4", "B1", "B2"]);
  });
});

describe("handles", () => {
  const parameters = shownHandles(used(OPTIONS), OPTIONS);
  const at = (phases: typeof WHOLE, way: 1 | -1 = 1, design: Design = START) =>
    new Map(
      handlesOf(design, parameters, stretches(phases, "s"), 0.8, way).map((handle) => [handle.parameter, handle]),
    );

  it("stand in the middle of their phases, where their value is drawn", () => {
    const handles = at(WHOLE);
    expect(handles.get("vmax")).toMatchObject({ track: "velocity", sign: 1, idle: false });
    expect(handles.get("vmax")?.timeS).toBeCloseTo(0.444);
    expect(handles.get("amax")?.timeS).toBeCloseTo(0.15);
    expect(handles.get("dmax")).toMatchObject({ track: "acceleration", sign: -1 });
    expect(handles.get("bow2")).toMatchObject({ track: "jerk", sign: -1, value: START.bow2 });
    expect(handles.get("bow4")?.sign).toBe(1);
    expect(handles.get("vstop")?.timeS).toBe(0.8);
  });

  it("turn over for a move the other way", () => {
    const handles = at(WHOLE, -1);
    expect(handles.get("vmax")?.sign).toBe(-1);
    expect(handles.get("bow3")?.sign).toBe(1);
  });

  it("are idle where their phase takes no time, and stay to be taken", () => {
    const short = WHOLE.filter((each) => each.name !== "B23" && each.name !== "B12");
    const handles = at(short);
    expect(handles.get("vmax")).toMatchObject({ idle: true });
    expect(handles.get("vmax")?.timeS).toBeCloseTo(0.3);
    expect(handles.get("amax")).toMatchObject({ idle: true });
    expect(handles.get("amax")?.timeS).toBeCloseTo(0.1);
    expect(handles.get("vstart")?.idle).toBe(true);
  });

  it("leave DFINAL out while positioning, where it is ignored", () => {
    expect(parameters).not.toContain("dfinal");
    expect(shownHandles(used(OPTIONS), { ...OPTIONS, mode: "velocity" })).toContain("dfinal");
  });
});

describe("the design", () => {
  it("keeps together what the lock ties", () => {
    const equal = changed(START, "bow2", 5, "equal");
    expect([equal.bow1, equal.bow2, equal.bow3, equal.bow4]).toEqual([5, 5, 5, 5]);
    const mirrored = changed(changed(START, "bow2", 5, "mirrored"), "amax", 7, "mirrored");
    expect([mirrored.bow1, mirrored.bow2, mirrored.bow3, mirrored.bow4]).toEqual([1e7, 5, 5, 1e7]);
    expect(mirrored.dmax).toBe(7);
    expect(changed(START, "amax", 7, "free").dmax).toBe(START.dmax);
    expect(changed(START, "vmax", 9, "equal")).toEqual({ ...START, vmax: 9 });
  });

  it("knows its lock, and takes one on", () => {
    const free = { ...START, bow3: 1, dmax: 2 };
    expect(lockOf(free)).toBe("free");
    expect(lockOf(locked(free, "mirrored"))).toBe("equal");
    expect(lockOf(locked({ ...free, bow2: 9 }, "mirrored"))).toBe("mirrored");
    expect(lockOf(locked(free, "equal"))).toBe("equal");
  });

  it("has presets that keep VMAX and AMAX and can all be driven", () => {
    for (const preset of PRESETS) {
      const made = preset.of(START);
      expect([made.vmax, made.amax]).toEqual([START.vmax, START.amax]);
      for (const parameter of ["vmax", "amax", "dmax", "bow1", "bow2", "bow3", "bow4"] as const)
        expect(made[parameter]).toBeGreaterThan(0);
    }
  });

  it("takes direct units where the registers could not hold it", () => {
    expect(withRoom(OPTIONS, START)).toEqual(OPTIONS);
    expect(withRoom(OPTIONS, { ...START, bow3: 2 ** 24 })).toMatchObject({
      directBow: true,
      directAcceleration: false,
    });
    expect(withRoom(OPTIONS, { ...START, dmax: 5e6 })).toMatchObject({ directBow: false, directAcceleration: true });
  });

  it("asks for what the registers will hold", () => {
    const body = rampParameters(START, OPTIONS, 16e6, 1);
    expect(body).toMatchObject({ vmax: 400_000, bow4: 10_000_000, rounding: "registers", ramp_mode: "position" });
    expect(body).not.toHaveProperty("vbreak");
    expect(rampParameters(START, { ...OPTIONS, mode: "velocity" }, 16e6, -1).v_target).toBe(-400_000);
    expect(rampParameters(START, { ...OPTIONS, shape: "trapezoid" }, 16e6, 1)).toHaveProperty("vbreak");
  });
});

describe("rivals", () => {
  const rival = { name: "trapezoid", text: "", saved_s: 0, vmax_pps: 100, amax_pps2: 100, dmax_pps2: 50 };
  it("have the corners of a trapezoid, or of a triangle", () => {
    expect(corners({ ...rival, duration_s: 5 }, 1)).toEqual({ x: [0, 1, 3, 5], y: [0, 100, 100, 0] });
    const short = corners({ ...rival, duration_s: 1.5 }, -1);
    expect(short.y[1]).toBeCloseTo(-50);
    expect(short.x[1]).toBeCloseTo(short.x[2] as number);
  });
});

function reading(name: string, value: number, fields: Record<string, number> = {}): Schemas["RegisterReading"] {
  return { name, value, raw: value, fields, axis: 0 } as unknown as Schemas["RegisterReading"];
}

const CHIP = [
  reading("GENERAL_CONF", 0x6020, { use_astart_and_vstart: 0, direct_acc_val_en: 0, direct_bow_val_en: 0 }),
  reading("RAMPMODE", 5, { RAMP_PROFILE: 1, OPERATION_MODE: 1 }),
  ...["VSTART", "VSTOP", "VBREAK", "ASTART", "DFINAL"].map((name) => reading(name, 0)),
  reading("VMAX", 256_000),
  reading("AMAX", 40_000),
  reading("DMAX", 80_000),
  ...["BOW1", "BOW2", "BOW3", "BOW4"].map((name) => reading(name, 1000)),
];

describe("chip and design", () => {
  const registers = [
    { parameter: "vmax", name: "VMAX", raw: 512_000 },
    { parameter: "amax", name: "AMAX", raw: 40_000 },
    { parameter: "bow1", name: "BOW1", raw: 2000 },
  ] as Answer["registers"];

  it("reads a design in physical units, by the units of the chip", () => {
    const held = designOf(chipRamp(CHIP), 16e6);
    expect(held?.design).toMatchObject({ vmax: 1000, amax: 10_000, dmax: 20_000, bow1: 1000 });
    expect(held?.options.shape).toBe("trapezoid");
    const direct = CHIP.map((each) =>
      each.name === "GENERAL_CONF" ? { ...each, fields: { ...each.fields, direct_acc_val_en: 1 } } : each,
    );
    expect(designOf(chipRamp(direct), 16e6)?.design.amax).toBeCloseTo(40_000 * 1862.645, -2);
    expect(designOf(chipRamp(CHIP.filter(({ name }) => name !== "VMAX")), 16e6)).toBeNull();
  });

  it("has a motor that stands in velocity mode hold its place before VMAX would turn it", () => {
    const standing = new Map([...chipRamp(CHIP), ["OPERATION_MODE", 0], ["VMAX", 0], ["VACTUAL", 0], ["XACTUAL", -7]]);
    const rows = compared(registers, OPTIONS, standing);
    const writes = writesFor(rows, 0).slice(-3);
    expect(writes).toEqual([
      { name: "XTARGET", axis: 0, value: -7 },
      { name: "RAMPMODE", axis: 0, fields: { RAMP_PROFILE: 2, OPERATION_MODE: 1 } },
      { name: "VMAX", axis: 0, value: 512_000 },
    ]);
    const turning = new Map([...standing, ["VMAX", 5], ["VACTUAL", 5]]);
    expect(compared(registers, OPTIONS, turning).map((row) => row.label)).not.toContain("OPERATION_MODE");
  });

  it("writes only what differs, units first and VMAX last, and never the mode", () => {
    const rows = compared(registers, { ...OPTIONS, directBow: true }, chipRamp(CHIP));
    expect(rows.map((row) => row.label)).toEqual([
      "use_astart_and_vstart",
      "direct_acc_val_en",
      "direct_bow_val_en",
      "AMAX",
      "BOW1",
      "RAMP_PROFILE",
      "VMAX",
    ]);
    expect(writesFor(rows, 0)).toEqual([
      { name: "GENERAL_CONF", axis: 0, fields: { direct_bow_val_en: 1 } },
      { name: "BOW1", axis: 0, value: 2000 },
      { name: "RAMPMODE", axis: 0, fields: { RAMP_PROFILE: 2 } },
      { name: "VMAX", axis: 0, value: 512_000 },
    ]);
  });
});
