import { describe, expect, it } from "vitest";
import { sparklines, toneOf, toneOfLag, topOf, uptime, usedPercent } from "./figures";

describe("figures of health", () => {
  it("knows no share of what nobody knows", () => {
    expect(usedPercent(null, 10)).toBeNull();
    expect(usedPercent(3, null)).toBeNull();
    expect(usedPercent(3, 0)).toBeNull();
    expect(usedPercent(3, 12)).toBe(25);
    expect(usedPercent(30, 12)).toBe(100);
  });

  it("warns before it is too late", () => {
    expect([null, 79, 80, 95].map(toneOf)).toEqual(["well", "well", "soon", "bad"]);
    expect([null, 49, 50, 100].map(toneOfLag)).toEqual(["well", "well", "soon", "bad"]);
  });

  it("draws a gap where nothing was measured, and a point that stands alone", () => {
    expect(sparklines([0, 10, null, 5, null], 10, 100, 10)).toEqual(["0.0,10.0 25.0,0.0", "75.0,5.0 75.0,5.0"]);
    expect(sparklines([null, null], 10, 100, 10)).toEqual([]);
    expect(sparklines([99], 10, 100, 10)).toEqual(["0.0,0.0 0.0,0.0"]);
  });

  it("has a scale that does not dance", () => {
    expect(topOf([])).toBe(5);
    expect(topOf([null, 0.2])).toBe(5);
    expect(topOf([51])).toBe(100);
    expect(topOf([123456])).toBe(123456);
  });

  it("says how long in two units at most", () => {
    expect([5, 65, 3700, 90_000].map(uptime)).toEqual(["5 s", "1 min", "1 h 1 min", "1 d 1 h"]);
  });
});
