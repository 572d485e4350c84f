import type uPlot from "uplot";
import { describe, expect, it, vi } from "vitest";
import { drawingPlugin, placeOfLevel, withOverlays } from "./drawing";

describe("levels", () => {
  it("stand on the plot, or say at its edge where they are", () => {
    expect(placeOfLevel(50, 10, 100)).toEqual({ at: 50, beyond: "" });
    expect(placeOfLevel(-3000, 10, 100)).toEqual({ at: 10, beyond: "↑" });
    expect(placeOfLevel(3000, 10, 100)).toEqual({ at: 110, beyond: "↓" });
  });
});

describe("overlays", () => {
  it("have dots of one place drawn once", () => {
    const fillRect = vi.fn();
    const ctx = new Proxy({} as Record<string, unknown>, {
      get: (_, name) => (name === "fillRect" ? fillRect : vi.fn()),
    });
    const scale = { min: 0, max: 10 };
    const plot = { ctx, bbox: { left: 0, top: 0, width: 100, height: 100 }, scales: { x: scale, y: scale } };
    const dots = { x: [1, 1.01, 5, 1], y: [2, 2.01, 5, 2], color: "", dots: 2 };
    const { draw } = drawingPlugin(
      () => [dots],
      () => [],
      () => [],
    ).hooks as { draw: (plot: uPlot) => void };
    draw(plot as unknown as uPlot);
    expect(fillRect.mock.calls).toEqual([
      [9, 79, 2, 2],
      [49, 49, 2, 2],
    ]);
  });

  it("count for the range of their scale where they are seen, unless they stand aside", () => {
    const line = { x: [0, 1, 2, 3], y: [5, -9, 7, 100], color: "" };
    expect(withOverlays([line], "y", [0.5, 1.5], [0, 1])).toEqual([-9, 7]);
    expect(withOverlays([{ ...line, aside: true }], "y", [0, 3], [0, 1])).toEqual([0, 1]);
    expect(withOverlays([{ ...line, scale: "other" }], "y", [0, 3], [0, 1])).toEqual([0, 1]);
  });
});
