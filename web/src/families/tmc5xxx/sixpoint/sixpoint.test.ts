import { describe, expect, it } from "vitest";
import type { Schemas } from "../../../api/client";
import type { Answer } from "../../../lib/ramp/answer";
import { chipRamp } from "../../../lib/ramp/chip";
import { writesFor } from "../../../lib/ramp/differences";
import { cautionsOn, compared, designOf, shownValue, waits } from "./chip";
import {
  changed,
  type Design,
  locked,
  lockOf,
  PARAMETERS,
  PRESETS,
  rampParameters,
  START,
  showingDistance,
  used,
} from "./design";
import { findingsOn } from "./findings";
import { handlesOf } from "./handles";
import { stretches } from "./phases";
import { designOfRaws, type Raw, REGISTERS, rawOf, rawsOf, typedOf, unitOf } from "./registers";

const CLOCK = 16e6;
const phase = (name: string, start_s: number, end_s: number) => ({ name, start_s, end_s });
const WHOLE = [
  phase("acceleration A1", 0, 0.1),
  phase("acceleration AMAX", 0.1, 0.2),
  phase("constant velocity", 0.2, 0.5),
  phase("deceleration DMAX", 0.5, 0.6),
  phase("deceleration D1", 0.6, 0.7),
];

describe("units of the registers", () => {
  it("are those of the facts at 12, 13.2 and 16 MHz", () => {
    for (const [clock, velocity, acceleration] of [
      [12e6, 0.71526, 65.484],
      [13.2e6, 0.78678, 79.235],
      [16e6, 0.95367, 116.415],
    ] as const) {
      expect(unitOf("vmax", clock)).toBeCloseTo(velocity, 5);
      expect(unitOf("amax", clock)).toBeCloseTo(acceleration, 3);
    }
    expect(REGISTERS.tzerowait.most * unitOf("tzerowait", 16e6)).toBeCloseTo(2.097, 3);
    expect(REGISTERS.vmax.most * unitOf("vmax", 16e6)).toBeCloseTo(8e6, -4);
  });

  it("round to the nearest, and end where the register does", () => {
    expect(rawOf("vmax", 51_200, CLOCK)).toBe(53_687);
    expect(rawOf("vmax", 1e9, CLOCK)).toBe(2 ** 23 - 512);
    expect(rawOf("a1", 1e9, CLOCK)).toBe(65_535);
    expect(rawOf("vstop", 0.4, CLOCK)).toBe(0);
    expect([rawOf("amax", 1, CLOCK), rawOf("d1", 1, CLOCK), rawOf("vmax", 0.1, CLOCK)]).toEqual([1, 1, 1]);
    expect(rawOf("d1", 0, CLOCK)).toBe(0);
    expect(rawOf("tzerowait", 0.1, CLOCK)).toBe(3125);
  });

  it("come back as short numbers that mean the same register", () => {
    expect(typedOf("vmax", 209_715, CLOCK)).toBe(200_000);
    expect(typedOf("amax", 65_535, CLOCK)).toBeLessThanOrEqual(65_535 * unitOf("amax", CLOCK));
    for (const raw of [0, 1, 7, 999, 65_535])
      for (const parameter of PARAMETERS) expect(rawOf(parameter, typedOf(parameter, raw, CLOCK), CLOCK)).toBe(raw);
  });

  it("lose less than half a unit of a design", () => {
    const held = designOfRaws(rawsOf(START, CLOCK), CLOCK);
    for (const parameter of PARAMETERS)
      expect(Math.abs(held[parameter] - START[parameter])).toBeLessThanOrEqual(unitOf(parameter, CLOCK) / 2);
  });
});

describe("the design", () => {
  it("keeps together what the lock ties", () => {
    const next = changed(START, "a1", 5, "mirrored");
    expect([next.a1, next.d1, next.dmax]).toEqual([5, 5, START.dmax]);
    expect(changed(START, "dmax", 7, "mirrored").amax).toBe(7);
    expect(changed(START, "a1", 5, "free").d1).toBe(START.d1);
    expect(lockOf(locked({ ...START, d1: 1 }, "mirrored"))).toBe("mirrored");
    expect(lockOf({ ...START, d1: 1 })).toBe("free");
  });

  it("has presets that keep VMAX and AMAX, and that the chips can drive", () => {
    for (const preset of PRESETS) {
      const design = preset.of(START);
      expect([design.vmax, design.amax]).toEqual([START.vmax, START.amax]);
      const raws = rawsOf(design, CLOCK);
      expect(raws.vstop).toBeGreaterThanOrEqual(Math.max(10, raws.vstart));
      expect(Math.min(raws.d1, raws.dmax, raws.a1)).toBeGreaterThan(0);
    }
  });

  it("shows itself on a way on which it cruises", () => {
    // up and down: 100000² / (2 · 1.5M) + 3 · 100000² / (2 · 0.75M), twice
    expect(showingDistance(START)).toBeCloseTo(1.5 * 2 * (1e10 / 3e6 + 3e10 / 1.5e6), -3);
    expect(showingDistance({ ...START, v1: 0, a1: 0, d1: 0 })).toBe(80_000);
    expect(showingDistance({ ...START, amax: 0 })).toBe(START.vmax);
  });

  it("asks by the names of the calculator", () => {
    const asked = rampParameters({ ...START, tzerowait: 0.5 }, "position", 1);
    expect(asked).toMatchObject({ vmax: 200_000, a1: 1_500_000, t_zero_wait_s: 0.5 });
    expect(asked).not.toHaveProperty("tzerowait");
    expect(asked).not.toHaveProperty("ramp_mode");
    expect(asked).not.toHaveProperty("clock_hz");
    expect(rampParameters(START, "position", 1, CLOCK)).toMatchObject({ clock_hz: CLOCK });
    expect(rampParameters(START, "velocity", -1)).toMatchObject({ ramp_mode: "velocity", v_target: -200_000 });
  });
});

describe("phases and handles", () => {
  it("bear the names of the registers that shape them", () => {
    expect(stretches(WHOLE, "position").map((each) => each.name)).toEqual(["A1", "AMAX", "VMAX", "DMAX", "D1"]);
    const trapezoid = stretches(
      WHOLE.filter((each) => !/1$/.test(each.name)),
      "position",
    );
    expect(trapezoid.filter((each) => each.empty).map((each) => each.name)).toEqual(["A1", "D1"]);
  });

  it("stand on their phases, V1 where A1 ends", () => {
    const handles = new Map(
      handlesOf(START, "position", stretches(WHOLE, "position"), 0.7, -1).map((each) => [each.parameter, each]),
    );
    expect(handles.get("v1")).toMatchObject({ timeS: 0.1, sign: -1, track: "velocity", idle: false });
    expect(handles.get("dmax")).toMatchObject({ timeS: 0.55, sign: 1, track: "acceleration" });
    expect(handles.get("vstop")?.timeS).toBe(0.7);
    expect(handles.get("vstart")?.idle).toBe(true);
    expect(handlesOf(START, "velocity", [], 1, 1).map((each) => each.parameter)).toEqual(used("velocity"));
  });
});

describe("findings", () => {
  const on = (part: Partial<Design>, answer?: Partial<Answer>) => {
    const design = { ...START, ...part };
    return findingsOn(design, rawsOf(design, CLOCK), "position", answer as Answer | undefined).map(
      ({ parameter, level, text }) => `${parameter} ${level}: ${text}`,
    );
  };
  it("are none for a sound ramp", () => expect(on({})).toEqual([]));
  it("are what the calculator warns of, at the parameter that it is about", () => {
    const findings = [
      { code: "vstop_zero", parameter: "vstop", text: "VSTOP is 0" },
      { code: "no_zero_wait", parameter: "t_zero_wait_s", text: "jumps" },
      { code: "other", parameter: null, text: "of the whole ramp" },
    ];
    const phases = [phase("constant velocity", 0, 1)];
    expect(on({}, { findings, phases, velocity_pps: [0] })).toEqual([
      "vstop caution: VSTOP is 0",
      "tzerowait caution: jumps",
    ]);
  });
  it("tell what a V1 of 0 leaves out, once", () => {
    expect(on({ v1: 0 })).toEqual([
      "a1 hint: no part in it: V1 is 0",
      "d1 hint: no part in it: V1 is 0",
      "v1 hint: 0: a trapezoid of AMAX and DMAX",
    ]);
    const findings = [{ code: "v1_zero", parameter: "v1", text: "V1 is 0" }];
    const phases = [phase("constant velocity", 0, 1)];
    expect(on({ v1: 0 }, { findings, phases, velocity_pps: [0] }).filter((each) => each.startsWith("v1"))).toEqual([
      "v1 caution: V1 is 0",
    ]);
    expect(on({ vstart: 150_000, vstop: 150_000 }).join()).toMatch(/v1 hint: VSTART is above it/);
  });
  it("tell what a short way does not reach, and what is rounded hard", () => {
    const short = { velocity_pps: [0, 60_000, 0], phases: [phase("acceleration A1", 0, 1)] };
    expect(on({}, short).join()).toMatch(/v1 hint: not reached/);
    expect(on({}, { ...short, velocity_pps: [0, 150_000, 0] }).join()).toMatch(/vmax hint: not reached/);
    expect(on({ amax: 500 }).join()).toMatch(/amax hint: 4 units: rounded by up to 13 %/);
  });
  it("leave A1, V1, DMAX and D1 out in velocity mode", () => {
    const found = findingsOn(START, rawsOf(START, CLOCK), "velocity", undefined);
    expect(found.map(({ parameter }) => parameter)).toEqual(["a1", "v1", "dmax", "d1"]);
  });
});

describe("chip and design", () => {
  const raws = rawsOf(START, CLOCK);
  const held = (more: Record<string, number> = {}, of: Raw = raws) =>
    new Map<string, number>([
      ...PARAMETERS.map((parameter) => [REGISTERS[parameter].name, of[parameter]] as const),
      ...Object.entries({ RAMPMODE: 0, XACTUAL: 5, XTARGET: 5, VACTUAL: 0, ...more }),
    ]);

  it("reads what is known, and nothing where a register is not", () => {
    expect(designOf(held(), CLOCK)).toEqual({ ...START, vstop: expect.closeTo(START.vstop, 0) });
    const missing = held();
    missing.delete("D1");
    expect(designOf(missing, CLOCK)).toBeNull();
    expect(designOf(held({ VMAX: 0 }), CLOCK)).toBeNull();
    const readings = [{ name: "VMAX", value: 3, fields: {}, kept: true }] as Schemas["RegisterReading"][];
    expect(chipRamp(readings).get("VMAX")).toBe(3);
  });

  it("writes what differs, VMAX last", () => {
    expect(writesFor(compared(raws, held()), 1)).toEqual([]);
    const rows = compared(raws, held({ VMAX: 0, A1: 1 }));
    expect(writesFor(rows, 1)).toEqual([
      { name: "A1", axis: 1, value: raws.a1 },
      { name: "VMAX", axis: 1, value: raws.vmax },
    ]);
    expect(writesFor(compared(raws, null), 0)).toHaveLength(9);
  });

  it("leaves the further corners of a chip of eight points out", () => {
    expect(writesFor(compared(raws, held({ V2: 700, TVMAX: 0 })), 0)).toEqual([{ name: "V2", axis: 0, value: 0 }]);
  });

  it("has a motor that stands in velocity mode hold its place first", () => {
    const chip = held({ RAMPMODE: 1, VMAX: 0, XTARGET: 700, XACTUAL: 5 });
    expect(waits(chip)).toBe(true);
    expect(writesFor(compared(raws, chip), 0)).toEqual([
      { name: "XTARGET", axis: 0, value: 5 },
      { name: "RAMPMODE", axis: 0, value: 0 },
      { name: "VMAX", axis: 0, value: raws.vmax },
    ]);
    expect(shownValue({ label: "RAMPMODE" }, 1)).toBe("velocity forward");
    const turning = held({ RAMPMODE: 2, VACTUAL: -7 });
    expect(compared(raws, turning).map((row) => row.label)).not.toContain("RAMPMODE");
  });

  it("says what a write would set going", () => {
    const notes = (more: Record<string, number>) => {
      const chip = held(more);
      const rows = compared(raws, chip).filter((row) => row.from !== row.to);
      return cautionsOn(chip, rows).join();
    };
    expect(notes({ VMAX: 0, XTARGET: 100 })).toMatch(/95 µsteps away: the motor starts/);
    expect(notes({ VMAX: 0 })).toBe("");
    expect(notes({ VMAX: 9, RAMPMODE: 1, VACTUAL: 9 })).toMatch(/takes on VMAX/);
    expect(notes({ VMAX: 9, RAMPMODE: 1 })).toMatch(/hold its place/);
    expect(notes({ AMAX: 9, VACTUAL: 9 })).toMatch(/beyond its target/);
  });
});
