import { describe, expect, it } from "vitest";
import { aligned, gapped, lowerBound, nearest, resampled } from "./series";

describe("series", () => {
  it("passes a whole column on and turns NaN into null", () => {
    const whole = new Float64Array([1, 2, 3]);
    expect(gapped(whole)).toBe(whole);
    expect(gapped(new Float64Array([Number.NaN, 2, Number.NaN, 4]))).toEqual([null, 2, null, 4]);
    expect(gapped([null, 1, Number.NaN])).toEqual([null, 1, null]);
    expect(aligned([[0, 1], new Float64Array([Number.NaN, 1])])).toEqual([
      [0, 1],
      [null, 1],
    ]);
  });

  it("finds rows by time", () => {
    const times = [0, 1, 2, 4];
    expect([-1, 0, 0.5, 2, 3, 4, 5].map((x) => lowerBound(times, x))).toEqual([0, 0, 1, 2, 3, 3, 4]);
    expect([-1, 0.4, 0.6, 2.9, 3.1, 9].map((x) => nearest(times, x))).toEqual([0, 0, 1, 2, 3, 3]);
    expect(nearest([], 1)).toBe(-1);
  });

  it("puts another device's samples on this one's rows, and leaves a gap as a gap", () => {
    const mapped = resampled([10, 11, 12, 13, 20], [0.1, 1.1, 3.1], [5, 6, 7], 10, 0.5);
    expect([...mapped]).toEqual([5, 6, Number.NaN, 7, Number.NaN]);
    expect([...resampled([1, 2], [], [], 0, 1)]).toEqual([Number.NaN, Number.NaN]);
  });
});
