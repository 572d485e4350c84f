import { describe, expect, it } from "vitest";
import { TelemetrySource } from "../../live/TelemetrySource";
import { countOffset, geometryOf } from "./carriage";

describe("the carriage", () => {
  it("stands between its switches, with a margin beyond them", () => {
    const geometry = geometryOf({
      left: 0,
      right: 1000,
      homeFrom: 100,
      homeTo: 200,
    });
    expect(geometry).toMatchObject({ from: -60, to: 1060 });
    expect(geometry.left).toBeGreaterThan(0);
    expect(geometry.left).toBeLessThan(geometry.homeFrom ?? Number.NaN);
    expect(geometry.homeTo).toBeLessThan(geometry.right);
    expect(geometry.right).toBeLessThan(1);
  });

  it("has no home switch where the chip has none", () => {
    const geometry = geometryOf({ left: 0, right: 1000, homeFrom: null, homeTo: null });
    expect(geometry).toMatchObject({ homeFrom: null, homeTo: null });
  });

  it("compares the emulator's answer with the sample of the same chip time", () => {
    const source = new TelemetrySource({ device: "d", channels: ["position.0"], rateHz: 30, keepS: 4 });
    source.buffer.append({
      sequence: 0,
      rows: 3,
      dropped: 0,
      time: new Float64Array([1, 2, 3]),
      columns: [new Float64Array([0, 6400, 12_800])],
    });
    expect(countOffset(3850, 2, { source }, 0, 64)).toBe(3750);
    expect(countOffset(3850, 0.5, { source }, 0, 64)).toBeNaN();
    expect(countOffset(3850, 2, { source: undefined }, 0, 64)).toBeNaN();
  });
});
