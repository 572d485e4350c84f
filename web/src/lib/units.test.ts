import { describe, expect, it } from "vitest";
import { exactText } from "./format";
import { type AxisScale, entryIn, fromSteps, ratesOf, toSteps, unitsFor } from "./units";

const stage: AxisScale = {
  fullStepsPerRev: 200,
  microstepsPerFullStep: 64,
  gearRatio: 2,
  travelMmPerRev: 5,
  pulseDiv: 3,
  rampDiv: 5,
  clockHz: 16e6,
};

describe("units", () => {
  it("counts a turn of the load in microsteps of the motor", () => {
    expect(toSteps(1, "rev", stage, "position")).toBe(200 * 64 * 2);
    expect(toSteps(5, "mm", stage, "position")).toBe(200 * 64 * 2);
    expect(fromSteps(25_600, "deg", stage, "position")).toBe(360);
    expect(toSteps(60, "rpm", stage, "velocity")).toBe(25_600);
  });

  it("knows the chip's own units (TMC428 data sheet, 8.14)", () => {
    expect(toSteps(2047, "chip", stage, "velocity")).toBeCloseTo((16e6 * 2047) / (8 * 2048 * 32), 6);
    expect(toSteps(1, "chip", stage, "acceleration")).toBeCloseTo(16e6 ** 2 / 2 ** 37, 6);
  });

  it("goes there and back in every unit that the axis offers", () => {
    for (const motion of ["position", "velocity", "acceleration"] as const) {
      for (const unit of unitsFor(motion, stage)) {
        expect(fromSteps(toSteps(123.25, unit, stage, motion), unit, stage, motion)).toBeCloseTo(123.25, 9);
      }
    }
  });

  it("keeps an entry as it was typed, and every microstep through every unit that shows it", () => {
    expect(entryIn({ value: 0.1, unit: "mm" }, "mm", stage, "position")).toBe(0.1);
    const lost: string[] = [];
    for (let at = 0, seed = 3; at < 2000; at++) {
      seed = (seed * 48_271) % 2_147_483_647; // any position of 32 bits
      const steps = at % 2 ? seed : -seed;
      for (const unit of unitsFor("position", stage)) {
        const shown = Number(exactText(entryIn({ value: steps, unit: "microsteps" }, unit, stage, "position")));
        if (Math.round(toSteps(shown, unit, stage, "position")) !== steps) lost.push(`${steps} in ${unit}`);
      }
    }
    expect(lost).toEqual([]);
  });

  it("does not offer what the axis does not know", () => {
    const unknown: AxisScale = { ...stage, microstepsPerFullStep: null, travelMmPerRev: null, pulseDiv: null };
    expect(unitsFor("position", unknown)).toEqual(["microsteps"]);
    expect(unitsFor("velocity", unknown)).toEqual(["pps"]);
    const own = { ...stage, ratesKnown: false };
    expect(unitsFor("velocity", own)).toEqual([]);
    expect(ratesOf("mm", own)).toEqual({ velocity: "internal", acceleration: "internal" });
    expect([fromSteps(7, "internal", own, "velocity"), toSteps(7, "internal", own, "velocity")]).toEqual([7, 7]);
    expect(fromSteps(1, "pps", own, "velocity")).toBeNaN();
    expect(fromSteps(1, "mm", { ...stage, travelMmPerRev: null }, "position")).toBeNaN();
    expect(fromSteps(1, "rpm", stage, "position")).toBeNaN();
  });
});
