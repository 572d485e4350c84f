import { describe, expect, it } from "vitest";
import { holdLine, holdTimes } from "./hold";
import {
  axisFor,
  chopperZones,
  coolZones,
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
  const settings = { irun: 16, ihold: 8, iholddelay: 4, tpowerdown: 10, clockHz: 16e6 };

  it("takes TPOWERDOWN and a delay for each of the steps", () => {
    const times = holdTimes(settings);
    expect(times.waitS).toBeCloseTo(0.16384);
    expect(times.stepS).toBeCloseTo(0.065536);
    expect(times.fallS).toBeCloseTo(8 * 0.065536);
    expect(holdTimes({ ...settings, iholddelay: 0 }).fallS).toBe(0);
    // without TPOWERDOWN it begins when the chip sees that the motor stands
    expect(holdTimes({ ...settings, tpowerdown: null }).waitS).toBeCloseTo(0.065536);
  });

  it("is a staircase, down or up", () => {
    const line = holdLine(settings, (scale) => scale / 10);
    expect(line.y[0]).toBe(1.6);
    expect(line.y.at(-1)).toBe(0.8);
    expect(new Set(line.y).size).toBe(9);
    expect(line.x).toEqual([...line.x].sort((a, b) => a - b));
    const up = holdLine({ ...settings, irun: 2, ihold: 4 }, (scale) => scale);
    expect([...new Set(up.y)]).toEqual([2, 3, 4]);
    expect(holdLine({ ...settings, ihold: 16 }, (scale) => scale).y).toEqual([16, 16, 16, 16]);
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
    const always = { ...MODES, stealthBelow: null };
    expect(names(chopperZones(always, AXIS)).map(([name]) => name)).toEqual(["StealthChop", "constant off time"]);
    expect(names(chopperZones({ ...always, highAbove: null }, AXIS))).toHaveLength(1);
  });

  it("regulates the current between two thresholds", () => {
    expect(names(coolZones(MODES, AXIS)).map(([name]) => name)).toEqual(["off", "CoolStep, StallGuard", "off"]);
    expect(names(coolZones({ ...MODES, coolAbove: null }, AXIS)).map(([name]) => name)).toEqual(["off"]);
    expect(coolZones({ ...MODES, highAbove: null }, AXIS).at(-1)).toMatchObject({ kind: "cool", to: AXIS.most });
  });
});
