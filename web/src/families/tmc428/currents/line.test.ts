import { describe, expect, it } from "vitest";
import { codeOf, currentLine, effectiveMicrosteps, eighthsOf } from "./line";

describe("current scales", () => {
  it("takes code 0 for full scale, and back", () => {
    expect([0, 1, 7].map(eighthsOf)).toEqual([8, 1, 7]);
    expect([8, 1, 7, 0.2, 12].map(codeOf)).toEqual([0, 1, 7, 1, 0]);
  });

  it("draws each span as a level, in percent or ampere", () => {
    const spans = [
      { scale: "is_v0" as const, start_s: -1, end_s: 0, eighths: 2 },
      { scale: "is_agtat" as const, start_s: 0, end_s: 0.5, eighths: 8 },
    ];
    expect(currentLine(spans, null)).toEqual({ x: [-1, 0, 0, 0.5], y: [25, 25, 100, 100] });
    expect(currentLine(spans, 1.6).y).toEqual([0.4, 0.4, 1.6, 1.6]);
  });

  it("halves effective microsteps with the current", () => {
    expect(effectiveMicrosteps(6, 4)).toBe(32);
    expect(effectiveMicrosteps(6, 0)).toBe(64);
  });
});
