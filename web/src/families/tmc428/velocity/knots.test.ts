import { describe, expect, it } from "vitest";
import { moved, parsed, shaped, split, textOf } from "./knots";

describe("a profile as text", () => {
  it("comes back as it was written", () => {
    const knots = shaped("there and back", 5000, 2);
    expect(parsed(textOf(knots))).toEqual({ knots });
  });

  it("takes a head line, comments, semicolons and tabs", () => {
    expect(parsed("time,velocity\n# mine\n0;0\n1\t-500\r\n2,0\n")).toEqual({
      knots: [
        { timeS: 0, pps: 0 },
        { timeS: 1, pps: -500 },
        { timeS: 2, pps: 0 },
      ],
    });
  });

  it("names the line that is none", () => {
    expect(parsed("0,0\n1,fast\n2,0")).toEqual({ problem: expect.stringContaining("Line 2") });
    expect(parsed("0,0\n1,\n2,0")).toEqual({ problem: expect.stringContaining("Line 2") });
    expect(parsed("0,0,3\n1,0")).toEqual({ problem: expect.stringContaining("Line 1") });
    expect(parsed("")).toEqual({ problem: expect.stringContaining("two lines") });
  });
});

describe("a profile that is drawn", () => {
  const knots = shaped("trapezoid", 1000, 4);

  it("keeps its ends at rest and its times in order", () => {
    expect(moved(knots, 0, 2, 300)[0]).toEqual({ timeS: 0, pps: 0 });
    expect(moved(knots, 3, 5, 300)[3]).toEqual({ timeS: 5, pps: 0 });
    for (const timeS of [-5, 0.5, 99]) {
      const times = moved(knots, 1, timeS, 800).map((knot) => knot.timeS);
      expect([...times].sort((a, b) => a - b)).toEqual(times);
      expect(new Set(times).size).toBe(4);
    }
    expect(moved(knots, 1, 0.5, 812.4)[1]).toEqual({ timeS: 0.5, pps: 812 });
  });

  it("gets a knot where the widest gap is", () => {
    expect(split(knots)).toHaveLength(5);
    expect(split(knots)[2]).toEqual({ timeS: 2, pps: 1000 });
  });
});
