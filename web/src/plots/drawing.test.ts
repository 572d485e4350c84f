import { describe, expect, it } from "vitest";
import { placeOfLevel, withOverlays } from "./drawing";

describe("levels", () => {
  it("stand on the plot, or say at its edge where they are", () => {
    expect(placeOfLevel(50, 10, 100)).toEqual({ at: 50, beyond: "" });
    expect(placeOfLevel(-3000, 10, 100)).toEqual({ at: 10, beyond: "↑" });
    expect(placeOfLevel(3000, 10, 100)).toEqual({ at: 110, beyond: "↓" });
  });
});

describe("overlays", () => {
  it("count for the range of their scale where they are seen, unless they stand aside", () => {
    const line = { x: [0, 1, 2, 3], y: [5, -9, 7, 100], color: "" };
    expect(withOverlays([line], "y", [0.5, 1.5], [0, 1])).toEqual([-9, 7]);
    expect(withOverlays([{ ...line, aside: true }], "y", [0, 3], [0, 1])).toEqual([0, 1]);
    expect(withOverlays([{ ...line, scale: "other" }], "y", [0, 3], [0, 1])).toEqual([0, 1]);
  });
});
