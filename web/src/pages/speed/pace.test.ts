import { describe, expect, it } from "vitest";
import { Pace } from "./pace";

describe("Pace", () => {
  it("gives each sample of a device once, however frames fall", () => {
    const pace = new Pace();
    const due = [0, 16.7, 33.4, 100, 100, 1000].map((nowMs) => pace.rowsDue(50 + nowMs, 1000));
    expect(due).toEqual([0, 16, 17, 67, 0, 900]);
  });

  it("counts the rate of the frames that it keeps, not of those long ago", () => {
    const pace = new Pace();
    expect(pace.figures()).toBeNull();
    for (let frame = 0; frame < 100; frame++) pace.frame(frame * 100, 50);
    for (let frame = 0; frame < 300; frame++) pace.frame(10_000 + frame * 20, 4);
    const figures = pace.figures();
    expect(figures?.fps).toBeCloseTo(50);
    expect(figures?.scriptMs).toBeCloseTo(4);
    expect(figures?.frames).toBe(400);
    expect(figures?.atMs).toBe(10_000 + 299 * 20);
  });
});
