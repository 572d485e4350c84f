import { describe, expect, it } from "vitest";
import { CalmRange, decimalsOf, roundRange } from "./ranges";

describe("ranges", () => {
  it("holds the data on round numbers", () => {
    for (const [min, max] of [
      [0, 51_200],
      [-3.2, 3.1],
      [1e-6, 2e-6],
      [999_999, 1_000_001],
      [-5, -4],
    ] as const) {
      const [low, high] = roundRange(min, max);
      expect(low).toBeLessThanOrEqual(min);
      expect(high).toBeGreaterThanOrEqual(max);
      expect(high - low).toBeLessThan((max - min) * 1.6);
    }
    const [low, high] = roundRange(7, 7);
    expect(low).toBeLessThan(7);
    expect(high).toBeGreaterThan(7);
    expect(roundRange(Number.POSITIVE_INFINITY, Number.NEGATIVE_INFINITY)).toEqual([-1, 1]);
  });

  it("labels ticks with the decimals that tell them apart", () => {
    expect([20, 2.5, 0.25, 1e-3, 0.1 + 0.2].map(decimalsOf)).toEqual([0, 1, 2, 3, 1]);
  });

  it("grows at once and shrinks late", () => {
    const range = new CalmRange();
    const first = range.next(0, 100);
    expect(range.next(10, 95)).toEqual(first);
    const grown = range.next(0, 150);
    expect(grown[1]).toBeGreaterThanOrEqual(150);
    expect(range.next(0, 100)).toEqual(grown);
    expect(range.next(0, 20)[1]).toBeLessThan(40);
  });
});
