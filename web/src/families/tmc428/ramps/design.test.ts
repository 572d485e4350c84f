import { describe, expect, it } from "vitest";
import { writesFor } from "../../../lib/ramp/differences";
import {
  accelerationSteps,
  type ChipRamp,
  compared,
  fromReadings,
  idealP,
  pairNear,
  pOf,
  type Reading,
  rampParameters,
  rounded,
  START,
  showingDistance,
} from "./design";

function reading(name: string, value: number, fields: Record<string, number> = {}): Reading {
  return { name, address: 0, space: "register", axis: 0, raw: value, value, fields, unit: "", kept: false };
}

const tmc428: Reading[] = [
  reading("x_target", 50),
  reading("x_actual", 40),
  reading("v_min", 1),
  reading("v_max", 1311),
  reading("a_max", 172),
  reading("pmul_pdiv", 0, { pdiv: 9, pmul: 35, pmul_msb_one: 1 }),
  reading("lp_ref_conf_rm", 0, { rm: 0, SOFT_STOP: 1 }),
  reading("pulse_div_ramp_div_usrs", 0, { usrs: 4, ramp_div: 7, pulse_div: 2 }),
];

const tmc4210: Reading[] = [
  reading("X_TARGET", 0),
  reading("X_ACTUAL", 0),
  reading("V_MIN", 1),
  reading("V_MAX", 1000),
  reading("A_MAX", 100),
  reading("PMUL_PDIV", 0, { PDIV: 8, PMUL: 163 }),
  reading("lp_REF_CONF_RAMP_MODE", 0, { RAMP_MODE: 2 }),
  reading("PULSE_DIV_RAMP_DIV", 0, { RAMP_DIV: 6, PULSE_DIV: 3 }),
];

describe("the ramp of a chip", () => {
  it("is found in the registers of a TMC428", () => {
    expect(fromReadings("tmc428", tmc428)).toEqual({
      design: { v_min: 1, v_max: 1311, a_max: 172, pulse_div: 2, ramp_div: 7, usrs: 4 },
      pair: { pmul: 35, pdiv: 9 },
      mode: 0,
      position: 40,
      target: 50,
    } satisfies ChipRamp);
  });

  it("is found in those of a TMC4210, whose PMUL has its top bit counted and which has no usrs", () => {
    const chip = fromReadings("tmc4210", tmc4210);
    expect(chip?.pair).toEqual({ pmul: 35, pdiv: 8 });
    expect(chip?.design.usrs).toBeNull();
  });

  it("is not made up where a register is missing", () => {
    expect(fromReadings("tmc428", tmc428.slice(0, -1))).toBeNull();
  });
});

describe("what goes to the chip", () => {
  const chip = fromReadings("tmc428", tmc428) as ChipRamp;

  it("is nothing where the chip holds it already", () => {
    expect(writesFor(compared("tmc428", chip.design, chip.pair, "ramp", chip), 0)).toEqual([]);
  });

  it("is the dividers first, then the pair, then the limits, packed fields together", () => {
    const design = { ...chip.design, pulse_div: 3, usrs: 6, v_max: 500, a_max: 20 };
    const writes = writesFor(compared("tmc428", design, { pmul: 1, pdiv: 9 }, "soft", chip), 2);
    expect(writes).toEqual([
      { name: "pulse_div_ramp_div_usrs", axis: 2, fields: { pulse_div: 3, usrs: 6 } },
      { name: "pmul_pdiv", axis: 2, fields: { pmul: 1 } },
      { name: "a_max", axis: 2, value: 20 },
      { name: "v_max", axis: 2, value: 500 },
      { name: "lp_ref_conf_rm", axis: 2, fields: { rm: 1 } },
    ]);
  });

  it("counts PMUL from 128 and spells in capitals for a TMC4210, and leaves velocity mode alone", () => {
    const held = fromReadings("tmc4210", tmc4210) as ChipRamp;
    const writes = writesFor(compared("tmc4210", { ...held.design, v_min: 9 }, { pmul: 0, pdiv: 8 }, "ramp", held), 0);
    expect(writes).toEqual([
      { name: "PMUL_PDIV", axis: 0, fields: { PMUL: 128 } },
      { name: "V_MIN", axis: 0, value: 9 },
    ]);
  });

  it("is everything while the chip is unknown", () => {
    const rows = compared("tmc428", START, { pmul: 0, pdiv: 0 }, "ramp", null);
    expect(writesFor(rows, 0)).toHaveLength(5);
    expect(rows.every((row) => row.from === null)).toBe(true);
  });
});

describe("p", () => {
  it("is a_max / (128 * 2^(ramp_div - pulse_div)) (TMC428 data sheet, 8.11)", () => {
    expect(idealP({ a_max: 128, ramp_div: 5, pulse_div: 5 })).toBe(1);
    expect(idealP({ a_max: 100, ramp_div: 7, pulse_div: 4 })).toBeCloseTo(100 / 1024, 12);
  });

  it("has a nearest pair within half a step, or none", () => {
    for (let p = 0.002; p < 31; p *= 1.013) {
      const pair = pairNear(p);
      expect(pair).not.toBeNull();
      if (pair) {
        expect(pair.pmul).toBeGreaterThanOrEqual(0);
        expect(pair.pmul).toBeLessThanOrEqual(127);
        expect(Math.abs(pOf(pair) / p - 1)).toBeLessThanOrEqual(0.5 / 128);
      }
    }
    expect(pairNear(0)).toBeNull();
    expect(pairNear(1 / 600)).toBeNull();
    expect(pairNear(40)).toBeNull();
  });
});

describe("distances", () => {
  it("counts the steps of an acceleration (TMC428 data sheet, 8.14)", () => {
    const design = { ...START, v_max: 1000, a_max: 100, ramp_div: 6, pulse_div: 5 };
    expect(accelerationSteps(design)).toBe((0.5 * (1000 ** 2 / 100) * 2) / 8);
  });

  it("shows speed-up, cruise and braking, within what a move can be", () => {
    expect(showingDistance(START)).toBeGreaterThan(2 * accelerationSteps(START));
    expect(showingDistance({ ...START, a_max: 0 })).toBe(100);
    expect(showingDistance({ ...START, a_max: 1, v_max: 2047, ramp_div: 13, pulse_div: 0 })).toBe(4_000_000);
    expect(rounded(12_345)).toBe(12_000);
  });
});

describe("the question to the calculator", () => {
  it("bears register names only, and a target velocity in velocity mode", () => {
    const parameters = rampParameters(START, { pmul: 3, pdiv: 4 }, "velocity", 16e6);
    expect(parameters).not.toHaveProperty("usrs");
    expect(parameters).toMatchObject({ pmul: 3, pdiv: 4, ramp_mode: "velocity", v_target: START.v_max });
    expect(rampParameters(START, { pmul: 3, pdiv: 4 }, "ramp", 16e6)).not.toHaveProperty("v_target");
  });
});
