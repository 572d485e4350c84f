import { describe, expect, it } from "vitest";
import { GEAR_ONE, startOf, stepFindings, stepInputOf, stepsOut } from "./start";

function chipOf(set: Record<string, number>) {
  const all: Record<string, number> = { START_DELAY: 0, START_OUT_ADD: 0, GEAR_RATIO: GEAR_ONE };
  for (const [name, count] of [
    ["trigger_events", 4],
    ["start_en", 5],
    ["pipeline_en", 4],
  ] as const)
    for (let n = 0; n < count; n++) all[`START_CONF.${name}[${n}]`] = 0;
  for (const name of ["pol_start_signal", "immediate_start_in", "busy_state_en"]) all[`START_CONF.${name}`] = 0;
  for (const name of ["sdin_mode", "sd_indirect_control"]) all[`GENERAL_CONF.${name}`] = 0;
  const held = { ...all, ...set };
  return { planned: (register: string, field?: string) => held[field ? `${register}.${field}` : register] ?? null };
}

describe("starts", () => {
  it("makes the pin an input where it is a trigger, with the delay unless it is immediate", () => {
    const delayed = startOf(
      chipOf({ "START_CONF.trigger_events[0]": 1, START_DELAY: 1600, "START_CONF.start_en[0]": 1 }),
      16e6,
    );
    expect(delayed).toMatchObject({ pin: "input", delayS: 1e-4, pinDelayS: 1e-4, findings: [] });
    const at_once = startOf(
      chipOf({
        "START_CONF.trigger_events[0]": 1,
        START_DELAY: 1600,
        "START_CONF.start_en[0]": 1,
        "START_CONF.immediate_start_in": 1,
      }),
      16e6,
    );
    expect(at_once?.pinDelayS).toBe(0);
    expect(at_once?.findings).toEqual(["START_DELAY counts for the other triggers alone."]);
  });

  it("gives a pulse one clock longer than START_OUT_ADD where it is an output", () => {
    expect(startOf(chipOf({ START_OUT_ADD: 15 }), 16e6)).toMatchObject({ pin: "output", pulseS: 1e-6 });
  });

  it("says where what waits would wait for ever, and where starts do nothing", () => {
    expect(startOf(chipOf({ "START_CONF.start_en[1]": 1 }), 16e6)?.findings[0]).toContain("waits for ever");
    expect(startOf(chipOf({ "START_CONF.trigger_events[1]": 1 }), 16e6)?.findings[0]).toContain("do nothing");
    expect(startOf(chipOf({}), 16e6)?.findings).toEqual([]);
    expect(startOf({ planned: () => null }, 16e6)).toBeNull();
  });
});

describe("steps from outside", () => {
  const geared = (ratio: number, mode: 1 | 2 | 3 = 1) => ({ mode, ratio, indirect: false }) as const;

  it("counts whole steps of the accumulator, both ways", () => {
    expect(stepsOut(geared(1), 200, 1000)).toEqual({ counted: 200, steps: 200, pps: 1000 });
    expect(stepsOut(geared(0.3), 10, 1000).steps).toBe(3);
    expect(stepsOut(geared(-0.5), 3, 1000)).toMatchObject({ steps: -2, pps: -500 }); // floor(-1.5)
    expect(stepsOut(geared(2.5), -3, 100)).toMatchObject({ steps: -8, pps: -250 });
    expect(stepsOut(geared(1, 3), 10, 1000)).toEqual({ counted: 20, steps: 20, pps: 2000 });
    expect(stepsOut({ ...geared(1), mode: 0 }, 10, 1000).steps).toBe(0);
  });

  it("reads the ratio out of the chip and says what is wrong with it", () => {
    const input = stepInputOf(chipOf({ "GENERAL_CONF.sdin_mode": 1, GEAR_RATIO: GEAR_ONE / 4 }));
    expect(input).toEqual({ mode: 1, ratio: 0.25, indirect: false });
    expect(stepFindings({ mode: 0, ratio: 1, indirect: false }, 0, 16e6)[0]).toContain("off");
    expect(stepFindings({ mode: 1, ratio: 0, indirect: true }, 0, 16e6)).toEqual([
      "GEAR_RATIO is 0: no step comes out.",
    ]);
    expect(stepFindings({ mode: 1, ratio: 100, indirect: true }, 9e6, 16e6)[0]).toContain("half of the clock");
  });
});
