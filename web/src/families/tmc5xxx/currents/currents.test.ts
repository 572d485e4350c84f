import { describe, expect, it } from "vitest";
import type { Registers } from "./chip";
import { figureLines, speedLimits } from "./figures";
import { holdLine, holdTimes } from "./hold";
import { bodyOf, wantedBody } from "./sensing";
import {
  axisFor,
  chopperZones,
  coolZones,
  linesOf,
  type Modes,
  ppsOf,
  ppsOfTstep,
  registerOf,
  rpmOf,
  shareOf,
  speedAt,
  ticksOf,
  tstepOfPps,
  velocityOfPps,
} from "./speed";

const SCALE = { clockHz: 16e6, microsteps: 256, fullStepsPerTurn: 200 };
const AXIS = axisFor(SCALE);
const MODES: Modes = {
  stealth: true,
  stealthBelow: 10_000,
  coolAbove: 20_000,
  highAbove: 200_000,
  highChopper: true,
  highFullstep: false,
};

describe("the way to the hold current", () => {
  const DELAY = {
    ihold_delay: 4,
    step_s: 0.1,
    steps: 8,
    lowering_s: 0.8,
    tpowerdown: 10,
    waiting_s: 0.2,
    standstill_s: 0.05,
  };

  it("begins when the chip has seen that the motor stands, and waited", () => {
    const times = holdTimes(DELAY);
    expect([times.seenS, times.fallsS, times.downS].map((time) => Number(time.toFixed(6)))).toEqual([0.05, 0.25, 1.05]);
    expect(holdTimes({ ...DELAY, tpowerdown: null, waiting_s: null }).fallsS).toBe(0.05);
  });

  it("is a staircase, down or up", () => {
    const line = holdLine(DELAY, 16, 8, (scale) => scale / 10);
    expect(line.y[0]).toBe(1.6);
    expect(line.y.at(-1)).toBe(0.8);
    expect(new Set(line.y).size).toBe(9);
    expect(line.x).toEqual([...line.x].sort((a, b) => a - b));
    expect([...new Set(holdLine(DELAY, 2, 4, (scale) => scale).y)]).toEqual([2, 3, 4]);
    expect(holdLine(DELAY, 16, 16, (scale) => scale).y).toEqual([16, 16, 16]);
  });
});

/** A chip of a few registers. */
function chipOf(values: Record<string, number>): Registers {
  const planned = (register: string, field?: string) => values[field ?? register] ?? null;
  const spot = (register: string) => (register in values ? ({} as ReturnType<Registers["spot"]>) : null);
  return { spot, planned, held: planned, isStaged: () => false, origin: () => "read", put: () => {} };
}

describe("the question about a current", () => {
  const BOARD = { senseOhm: 0.1, referenceOhm: 9100, ainV: 1.5 };
  const SCALES = { IRUN: 20, IHOLD: 8, IHOLDDELAY: 6 };

  it("has what each chip has", () => {
    const big = chipOf({ ...SCALES, GLOBAL_SCALER: 130, TPOWERDOWN: 10 });
    expect(bodyOf(big, "tmc5160", 12e6, BOARD)).toEqual({
      model: "tmc5160",
      clock_hz: 12e6,
      sense_resistor_ohm: 0.1,
      irun: 20,
      ihold: 8,
      ihold_delay: 6,
      tpowerdown: 10,
      global_scaler: 130,
    });
    const dual = bodyOf(chipOf({ ...SCALES, vsense: 1 }), "tmc5072", 16e6, BOARD);
    expect(dual).toMatchObject({ vsense: 1, sense_resistor_ohm: 0.1 });
    expect(dual).not.toHaveProperty("tpowerdown");
  });

  it("knows that a TMC5130 can measure inside, or scale with a voltage", () => {
    const set = { ...SCALES, vsense: 0, TPOWERDOWN: 10 };
    const inside = bodyOf(chipOf({ ...set, internal_Rsense: 1, I_scale_analog: 1 }), "tmc5130", 16e6, BOARD);
    expect(inside).toMatchObject({ reference_resistor_ohm: 9100 });
    expect(inside).not.toHaveProperty("sense_resistor_ohm");
    expect(inside).not.toHaveProperty("ain_v");
    expect(bodyOf(chipOf({ ...set, I_scale_analog: 1 }), "tmc5130", 16e6, BOARD)).toMatchObject({ ain_v: 1.5 });
  });

  it("asks for a TMC5240's range by its resistor at IREF", () => {
    const chip = chipOf({ ...SCALES, GLOBAL_SCALER: 200, CURRENT_RANGE: 1 });
    const body = bodyOf(chip, "tmc5240", 12.5e6, { ...BOARD, referenceOhm: 12_000 });
    expect(body).toMatchObject({ reference_resistor_ohm: 12_000, current_range: 1, global_scaler: 200 });
    expect(body).not.toHaveProperty("sense_resistor_ohm");
    if (body === null) throw new Error("no body");
    expect(wantedBody(body, 1.2, 0.4, "rms")).not.toHaveProperty("current_range");
  });

  it("waits for the registers, and takes a scaler that is none for full scale", () => {
    expect(bodyOf(chipOf({}), "tmc5160", 16e6, BOARD)).toBeNull();
    expect(bodyOf(chipOf({ ...SCALES, GLOBAL_SCALER: 5 }), "tmc5160", 16e6, BOARD)?.global_scaler).toBe(0);
  });

  it("the other way leaves out what is to be found", () => {
    const body = bodyOf(chipOf({ ...SCALES, GLOBAL_SCALER: 130 }), "tmc5160", 16e6, BOARD);
    if (body === null) throw new Error("no body");
    const wanted = wantedBody(body, 1.2, 0.4, "peak");
    expect(wanted).toMatchObject({ run_a: 1.2, hold_a: 0.4, measure: "peak", ihold_delay: 6 });
    for (const key of ["irun", "ihold", "vsense", "global_scaler"]) expect(wanted).not.toHaveProperty(key);
  });
});

describe("thresholds as speeds", () => {
  it("TSTEP counts 256ths of a full step whatever the microsteps are", () => {
    expect(ppsOfTstep(1000, SCALE)).toBe(16_000);
    expect(ppsOfTstep(1000, { ...SCALE, microsteps: 16 })).toBe(1000);
    expect(tstepOfPps(1000, { ...SCALE, microsteps: 16 })).toBe(1000);
    expect(tstepOfPps(0, SCALE)).toBe(2 ** 20 - 1);
    expect(tstepOfPps(1e12, SCALE)).toBe(1);
    expect(ppsOf("tstep", 0, SCALE)).toBeNull();
    expect(ppsOf("tstep", null, SCALE)).toBeNull();
    expect(ppsOfTstep(0, SCALE)).toBe(Number.POSITIVE_INFINITY);
  });

  it("velocities of chips with two axes leave their lowest 8 bits aside", () => {
    expect(velocityOfPps(1000, SCALE) % 256).toBe(0);
    expect(registerOf("velocity", 8e6, SCALE)).toBeLessThan(2 ** 23);
    expect(ppsOf("velocity", 2 ** 20, SCALE)).toBe(1e6);
    expect(velocityOfPps(0.1, SCALE)).toBe(256);
    expect(velocityOfPps(0, SCALE)).toBe(0);
    expect(ppsOf("velocity", 0, SCALE)).toBe(0);
  });

  it("stand on a logarithmic axis with round ticks", () => {
    expect(AXIS).toEqual({ least: 51_200 / 60, most: 51_200 * 50 });
    for (const share of [0, 0.3, 1]) expect(shareOf(speedAt(share, AXIS), AXIS)).toBeCloseTo(share);
    expect([shareOf(1e-3, AXIS), shareOf(1e12, AXIS), shareOf(0, AXIS)]).toEqual([0, 1, 0]);
    expect(ticksOf(AXIS, SCALE).map(({ rpm }) => rpm)).toEqual([1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000]);
    expect(rpmOf(51_200, SCALE)).toBe(60);
  });
});

describe("what the driver does at a speed", () => {
  const names = (zones: { name: string; from: number; to: number }[]) =>
    zones.map(({ name, from, to }) => [name, Math.round(from), Math.round(to)]);

  it("is StealthChop, SpreadCycle, and the fast chopper", () => {
    expect(names(chopperZones(MODES, AXIS))).toEqual([
      ["StealthChop", 853, 10_000],
      ["SpreadCycle", 10_000, 200_000],
      ["constant off time", 200_000, 2_560_000],
    ]);
  });

  it("is SpreadCycle alone where nothing is switched on", () => {
    const plain = { ...MODES, stealth: false, highChopper: false };
    expect(names(chopperZones(plain, AXIS))).toEqual([["SpreadCycle", 853, 2_560_000]]);
  });

  it("is StealthChop at all speeds without a threshold, up to the fast chopper", () => {
    const always = { ...MODES, stealthBelow: null, coolAbove: null };
    expect(names(chopperZones(always, AXIS)).map(([name]) => name)).toEqual(["StealthChop", "constant off time"]);
    expect(names(chopperZones({ ...always, highAbove: null }, AXIS))).toHaveLength(1);
  });

  it("is StealthChop no longer where CoolStep begins, or the high threshold is passed", () => {
    const cool = { ...MODES, stealthBelow: null, highChopper: false };
    expect(names(chopperZones(cool, AXIS))[0]).toEqual(["StealthChop", 853, 20_000]);
    expect(names(chopperZones({ ...cool, coolAbove: null }, AXIS))[0]).toEqual(["StealthChop", 853, 200_000]);
    // a velocity of 0 is always passed
    expect(names(chopperZones({ ...cool, coolAbove: 0 }, AXIS))[0]?.[0]).toBe("SpreadCycle");
    expect(coolZones({ ...cool, coolAbove: 0, highAbove: 0 }, AXIS)).toHaveLength(1);
    expect(coolZones({ ...cool, coolAbove: 0 }, AXIS)[0]).toMatchObject({ kind: "cool", from: AXIS.least });
  });

  it("regulates the current between two thresholds", () => {
    expect(names(coolZones(MODES, AXIS)).map(([name]) => name)).toEqual(["off", "CoolStep, StallGuard", "off"]);
    expect(names(coolZones({ ...MODES, coolAbove: null }, AXIS)).map(([name]) => name)).toEqual(["off"]);
    expect(coolZones({ ...MODES, highAbove: null }, AXIS).at(-1)).toMatchObject({ kind: "cool", to: AXIS.most });
  });
});

describe("what follows for a motor", () => {
  const figure = (name: string, value: number, unit: string) => ({
    name,
    label: name,
    value,
    unit,
    reason: "why",
    source: "where",
  });
  const FIGURES = [
    figure("current_limit", 500_000, "pps"),
    figure("current_limit_rpm", 586, "rpm"),
    figure("current_limit_tstep", 32, "clocks"),
    figure("chopper_frequency", 34_676, "Hz"),
    figure("stealthchop_limit", 0, "pps"),
  ];

  it("tells a speed in its units on one line", () => {
    const lines = figureLines(FIGURES);
    expect(lines.map(({ name }) => name)).toEqual(["current_limit", "chopper_frequency", "stealthchop_limit"]);
    expect(lines[0]?.values).toHaveLength(3);
    expect(lines[0]?.values[2]).toBe("TSTEP 32");
  });

  it("marks the limits that there are on the axis of speeds", () => {
    expect(speedLimits(FIGURES)).toEqual([{ name: "full current ends", pps: 500_000 }]);
  });
});

it("names that would cover each other stand on different lines", () => {
  const names = [
    { from: 0, to: 80 },
    { from: 60, to: 140 },
    { from: 150, to: 200 },
    { from: 70, to: 160 },
  ];
  expect(linesOf(names)).toEqual([0, 1, 0, 2]);
});
