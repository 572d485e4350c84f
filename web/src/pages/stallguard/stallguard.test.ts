import { describe, expect, it } from "vitest";
import type { Rows } from "../../lib/rows/settings";
import { TraceBuffer } from "../../live/TraceBuffer";
import { chipCurrent, chipSettings, passedFrom, placeOf, speedOf, thresholdFor } from "./chip";
import { currentOf, topOf } from "./load";
import { AP } from "./names";
import { SPEED_BINS, SpeedMap } from "./speedMap";
import {
  currentA,
  hysteresisFor,
  LOAD_MAX,
  lowerLoad,
  moduleCurrent,
  runCurrentA,
  startFor,
  upperLoad,
  zoneAt,
} from "./thresholds";

describe("CoolStep's thresholds", () => {
  it("are multiples of 32, and none where CoolStep is off or unknown", () => {
    expect([lowerLoad, upperLoad].map((of) => of({ hysteresisStart: 4, hysteresis: 2 }))).toEqual([128, 224]);
    expect([lowerLoad, upperLoad].map((of) => of({ hysteresisStart: 0, hysteresis: 2 }))).toEqual([null, null]);
    expect(upperLoad({ hysteresisStart: 4, hysteresis: null })).toBeNull();
  });

  it("can be dragged anywhere and come to the nearest that the fields can say", () => {
    for (let load = -100; load <= LOAD_MAX + 100; load += 7) {
      const start = startFor(load);
      const lower = lowerLoad({ hysteresisStart: start, hysteresis: 0 }) ?? Number.NaN;
      const reachable = Math.max(32, Math.min(480, load));
      expect(Math.abs(lower - reachable)).toBeLessThanOrEqual(16);
      const hysteresis = hysteresisFor(load, start);
      expect(hysteresis).toBeGreaterThanOrEqual(0);
      expect(hysteresis).toBeLessThanOrEqual(15);
    }
    expect(upperLoad({ hysteresisStart: 3, hysteresis: hysteresisFor(300, 3) })).toBe(288);
  });
});

describe("the current", () => {
  it("is counted in 32 steps of the module's full scale", () => {
    expect(currentA(31, 0)).toBe(3);
    expect(currentA(15, 128)).toBeCloseTo(0.75);
    expect(runCurrentA({ run: 128, scaler: 0 })).toBeCloseTo((3 * 17) / 32);
    expect(currentA(31, null)).toBeNaN();
    const scale = moduleCurrent({ run: 136, scaler: 0 });
    expect(currentOf(8, scale) / scale.run).toBe(0.5);
    expect(currentOf(31, scale)).toBe(3);
    expect(topOf(scale)).toBeCloseTo(((3 * 18) / 32) * 1.1);
    expect(topOf(moduleCurrent({ run: null, scaler: 0 }))).toBe(3);
  });
});

describe("zones of speed", () => {
  const limits = { stealth: 1000, stealthOn: true, coolOn: 5000, coolOff: 20_000, coolStepOn: true };
  it("follow each other", () => {
    expect([0, 999, 1000, -5000, 19_999, -20_000].map((speed) => zoneAt(speed, limits))).toEqual([
      "stealthchop",
      "stealthchop",
      "spreadcycle",
      "coolstep",
      "coolstep",
      "high speed",
    ]);
  });
  it("are SpreadCycle where nothing else is switched on", () => {
    const off = { stealth: null, stealthOn: true, coolOn: 10, coolOff: null, coolStepOn: false };
    expect(zoneAt(500, off)).toBe("spreadcycle");
  });
});

describe("the map over speed", () => {
  it("keeps means while its range grows", () => {
    const map = new SpeedMap(1000);
    for (let index = 0; index < 100; index++) map.add(500, 200 + (index % 2), 10);
    map.add(-30_000, 50, Number.NaN);
    expect(map.top).toBe(32_000);
    const bin = Math.floor((500 / map.top) * SPEED_BINS);
    expect(map.load.mean[bin]).toBeCloseTo(200.5);
    expect(map.load.total).toBe(101);
    expect(map.scale.total).toBe(100);
    expect(map.lowest[bin]).toBe(200);
    expect(map.dots).toBe(101);
  });

  it("forgets its oldest dots, not its means", () => {
    const map = new SpeedMap(1000);
    for (let index = 0; index < 3005; index++) map.add(10, index, 1);
    expect(map.dots).toBe(3000);
    expect([...map.dotLoad]).not.toContain(4);
    expect(map.load.total).toBe(3005);
  });

  it("takes in what moves, once, and leaves out what is missing", () => {
    const map = new SpeedMap();
    const buffer = new TraceBuffer(["s", "l", "v"], 20);
    const column = (...values: number[]) => Float64Array.from(values);
    const channels = { speed: "s", load: "l", scale: "c", velocity: "v" };
    buffer.append({
      sequence: 0,
      rows: 5,
      dropped: 0,
      time: column(1, 2, 3, 4, 5),
      columns: [
        column(0, 100, Number.NaN, 200, 15),
        column(5, 6, 7, Number.NaN, 8),
        column(9, 9, 9, 9, 0), // 15 is what the driver measures of a motor at rest
      ],
    });
    map.read(buffer, channels);
    map.read(buffer, channels);
    expect([map.load.total, map.dotLoad[0], map.dots]).toEqual([1, 6, 1]);
    expect(map.dotScale[0]).toBeNaN();
    map.clear();
    expect([map.dots, map.load.total]).toEqual([0, 0]);
  });
});

/** A chip of these fields, as `useChipRows` shows it; what is put is staged. */
function chipOf(values: Record<string, number>) {
  const staged = new Map<string, number>();
  const key = (register: string, field?: string) => (field === undefined ? register : `${register}.${field}`);
  const rows: Rows = {
    spot: (register, field) => (key(register, field) in values ? ({} as ReturnType<Rows["spot"]>) : null),
    held: (register, field) => values[key(register, field)] ?? null,
    planned: (register, field) => staged.get(key(register, field)) ?? values[key(register, field)] ?? null,
    isStaged: (register, field) => staged.has(key(register, field)),
    put: (register, field, value) => void staged.set(key(register, field), value),
  };
  return { rows, staged };
}

describe("a chip's thresholds of speed", () => {
  const units = { clockHz: 16e6, microstepsPerFullStep: 256 };
  it("count clocks a microstep, 256 of them a full step, or as the ramp generator does", () => {
    expect(speedOf(320, "tstep", units)).toBe(50_000);
    expect(speedOf(320, "tstep", { ...units, microstepsPerFullStep: 16 })).toBe(3125);
    expect(speedOf(53_687, "velocity", units)).toBeCloseTo(51_200, 0);
    expect([speedOf(0, "tstep", units), speedOf(0, "velocity", units)]).toEqual([0, 0]);
  });
  it("are the nearest that the register compares, and 0 for 0 alone", () => {
    expect(thresholdFor(50_000, "tstep", units)).toBe(320);
    expect(thresholdFor(1e9, "tstep", units)).toBe(1);
    expect(thresholdFor(1, "tstep", units)).toBe(2 ** 20 - 1);
    expect(thresholdFor(51_200, "velocity", units) % 256).toBe(0);
    expect(thresholdFor(1, "velocity", units)).toBe(256);
    expect([thresholdFor(0, "tstep", units), thresholdFor(0, "velocity", units)]).toEqual([0, 0]);
    for (const pps of [1000, 20_000, 333_333])
      for (const counting of ["tstep", "velocity"] as const)
        expect(Math.abs(speedOf(thresholdFor(pps, counting, units), counting, units) / pps - 1)).toBeLessThan(0.13);
  });
});

describe("the settings of a chip", () => {
  const units = { clockHz: 16e6, microstepsPerFullStep: 256 };
  it("are in the registers that it has", () => {
    const single = chipOf({ TCOOLTHRS: 320, "COOLCONF.semin": 4, "IHOLD_IRUN.IRUN": 15, GLOBAL_SCALER: 128 });
    const settings = chipSettings(single.rows, units);
    expect(settings.planned(AP.coolOn)).toBe(50_000);
    expect(settings.planned(AP.coolStart)).toBe(4);
    expect(settings.planned(AP.stealthBelow)).toBeNull();
    expect(settings.planned("no such name")).toBeNull();
    expect(chipCurrent(settings)).toMatchObject({ step: 100 / 64, run: 25, symbol: "%" });
    const dual = chipOf({ VCOOLTHRS: 0 });
    expect(placeOf(dual.rows, AP.coolOn)?.register).toBe("VCOOLTHRS");
    expect(chipSettings(dual.rows, units).planned(AP.coolOn)).toBe(0);
    expect(chipCurrent(chipSettings(dual.rows, units)).run).toBeNaN();
  });
  it("are never passed at 0 clocks, and always at a velocity of 0", () => {
    const of = (values: Record<string, number>) => {
      const { rows } = chipOf(values);
      return passedFrom(rows, chipSettings(rows, units), AP.coolOff);
    };
    expect(of({ THIGH: 0 })).toBe(Number.POSITIVE_INFINITY);
    expect(of({ THIGH: 320 })).toBe(50_000);
    expect(of({ VHIGH: 0 })).toBe(0);
    expect(of({})).toBeNull();
  });
  it("are staged as the register counts them", () => {
    const { rows, staged } = chipOf({ TCOOLTHRS: 320, "COOLCONF.sgt": 0 });
    const settings = chipSettings(rows, units);
    settings.stage(AP.coolOn, 100_000);
    settings.stage(AP.stallThreshold, -7);
    settings.stage(AP.scaler, 1);
    expect(Object.fromEntries(staged)).toEqual({ TCOOLTHRS: 160, "COOLCONF.sgt": -7 });
    expect(settings.staged.has(AP.coolOn)).toBe(true);
    expect([settings.held(AP.coolOn), settings.planned(AP.coolOn)]).toEqual([50_000, 100_000]);
    expect(settings.staged.has(AP.scaler)).toBe(false);
  });
});
