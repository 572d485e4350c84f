import { describe, expect, it } from "vitest";
import { TraceBuffer } from "../../live/TraceBuffer";
import { SPEED_BINS, SpeedMap } from "./speedMap";
import {
  currentA,
  hysteresisFor,
  LOAD_MAX,
  lowerLoad,
  runCurrentA,
  shareOfRun,
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
    expect(shareOfRun(8, { run: 136, scaler: 0 })).toBe(0.5);
    expect(currentA(31, null)).toBeNaN();
    expect(shareOfRun(31, { run: null, scaler: 0 })).toBeNaN();
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
