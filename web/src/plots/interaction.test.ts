import { describe, expect, it } from "vitest";
import { kept, zoomed } from "./interaction";

describe("zoom and pan", () => {
  it("keeps the place under the pointer", () => {
    for (const factor of [0.25, 0.7, 3]) {
      const { min, max } = zoomed([10, 20], 12, factor, null);
      expect(max - min).toBeCloseTo(10 * factor);
      expect((12 - min) / (max - min)).toBeCloseTo(0.2);
    }
  });

  it("ends above the resolution of a double", () => {
    let window: [number, number] = [1e6, 1e6 + 1];
    for (let turn = 0; turn < 200; turn++) {
      const { min, max } = zoomed(window, 1e6 + 0.5, 0.5, null);
      window = [min, max];
    }
    expect(window[1]).toBeGreaterThan(window[0]);
  });

  it("stays within its limit, and slides along it instead of shrinking", () => {
    expect(zoomed([2, 4], 3, 100, [0, 10])).toEqual({ min: 0, max: 10 });
    expect(kept({ min: -2, max: 3 }, [0, 10])).toEqual({ min: 0, max: 5 });
    expect(kept({ min: 8, max: 13 }, [0, 10])).toEqual({ min: 5, max: 10 });
    expect(kept({ min: -2, max: 3 }, null)).toEqual({ min: -2, max: 3 });
  });
});
