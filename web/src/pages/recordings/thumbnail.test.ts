import { describe, expect, it } from "vitest";
import { sparkline } from "./Thumbnail";

describe("the thumbnail of a recording", () => {
  const of = (values: number[]) =>
    sparkline({ x: Float64Array.from(values.keys()), columns: [Float64Array.from(values)] }, 0);

  it("fills its box, and leaves gaps open", () => {
    expect(of([0, 10, 5])).toBe("M0.0 24.0L60.0 2.0L120.0 13.0");
    expect(of([0, Number.NaN, 5])).toBe("M0.0 24.0M120.0 2.0");
  });

  it("is level where nothing changes, and nothing where there is nothing", () => {
    expect(of([7, 7])).toBe("M0.0 13.0L120.0 13.0");
    expect(of([7])).toBe("");
    expect(of([Number.NaN, Number.NaN])).toBe("");
    expect(sparkline({ x: new Float64Array(), columns: [] }, 3)).toBe("");
  });
});
