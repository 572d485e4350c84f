import { describe, expect, it } from "vitest";
import { START } from "../sramp/design";
import { type Entered, mostTargets, obstacle, questionOf, SETS, shadowOf } from "./sequence";

const HELD: Record<string, number> = {
  ...{ VMAX: 256 * 5000, AMAX: 4 * 9000, DMAX: 4 * 8000, BOW1: 7000, BOW2: 7000, BOW3: 7000, BOW4: 7000 },
  ...{ VSTART: 0, VSTOP: 0, VBREAK: 0, ASTART: 0, DFINAL: 0, TZEROWAIT: 77, VACTUAL: 0 },
  ...{ "RAMPMODE.RAMP_PROFILE": 2, "RAMPMODE.OPERATION_MODE": 1, "START_CONF.pol_start_signal": 1 },
  ...{ "GENERAL_CONF.use_astart_and_vstart": 0, "GENERAL_CONF.direct_acc_val_en": 0 },
  "GENERAL_CONF.direct_bow_val_en": 0,
};
const ENTERED: Entered = { targets: [5, -5], trigger: "target", delayS: 0.5, everyS: 2, ring: false, shadow: null };

function chipOf(set: Record<string, number> = {}) {
  const read = (register: string, field?: string) =>
    ({ ...HELD, ...set })[field ? `${register}.${field}` : register] ?? null;
  return { planned: read, held: read };
}

describe("what is asked about a sequence", () => {
  it("has the ramp of the chip, its times in clocks and its pin's level", () => {
    const question = questionOf(chipOf(), ENTERED, 16e6, 42);
    expect(question).toMatchObject({ position: 42, targets: [5, -5], delay: 8e6, zero_wait: 77, active_high: true });
    expect(question?.ramp).toMatchObject({ shape: "s", values: { vmax: 5000, amax: 9000, dmax: 8000, bow4: 7000 } });
    expect(question?.pulses_s).toEqual([]);
  });

  it("has a pulse for each target, in a ring some more", () => {
    expect(questionOf(chipOf(), { ...ENTERED, trigger: "start" }, 16e6, 0)?.pulses_s).toEqual([0, 2]);
    expect(questionOf(chipOf(), { ...ENTERED, trigger: "start", ring: true }, 16e6, 0)?.pulses_s).toHaveLength(12);
  });

  it("is nothing while the chip holds no ramp", () => {
    expect(questionOf(chipOf({ VMAX: 0 }), ENTERED, 16e6, 0)).toBeNull();
  });

  it("keeps a delay in its register", () => {
    expect(questionOf(chipOf(), { ...ENTERED, delayS: 1e6 }, 16e6, 0)?.delay).toBe(2 ** 32 - 1);
  });
});

describe("shadow registers", () => {
  it("begin with the ramp at half its speed, in as many sets as the option has", () => {
    expect(shadowOf(0, START).sets).toHaveLength(1);
    const two = shadowOf(1, START);
    expect(two.sets.map((set) => set.vmax)).toEqual([START.vmax / 2, START.vmax]);
    expect(Object.keys(two.sets[0] ?? {})).toEqual([...SETS[1]]);
  });
});

describe("a sequence", () => {
  it("has one target more where the first goes into XTARGET", () => {
    expect([mostTargets("target"), mostTargets("start")]).toEqual([9, 8]);
  });

  it("is not staged for a chip that turns or is in velocity mode", () => {
    expect(obstacle(chipOf())).toBeNull();
    expect(obstacle(chipOf({ VACTUAL: 5 }))).toContain("turns");
    expect(obstacle(chipOf({ "RAMPMODE.OPERATION_MODE": 0 }))).toContain("velocity mode");
  });
});
