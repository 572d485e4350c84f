import { afterEach, describe, expect, it, vi } from "vitest";
import { type PredictedRamp, PredictionKeeper, positionAt } from "./predictions";

const RAMP: PredictedRamp = {
  startedAtS: 100,
  durationS: 2,
  time: new Float64Array([0, 1, 2]),
  position: new Float64Array([0, 1000, 4000]),
  velocity: new Float64Array([0, 2000, 0]),
};

afterEach(() => vi.restoreAllMocks());

describe("predictions", () => {
  it("interpolates within the ramp and knows nothing outside", () => {
    expect(positionAt(RAMP, 100)).toBe(0);
    expect(positionAt(RAMP, 101.5)).toBe(2500);
    expect(positionAt(RAMP, 99.9)).toBeNaN();
    expect(positionAt(RAMP, 102.1)).toBeNaN();
  });

  it("shows the ramp only while telemetry agrees, and asks again when it does not", () => {
    const keeper = new PredictionKeeper("d", 0);
    const asked = vi.spyOn(keeper, "fetch").mockResolvedValue();
    keeper.ramp = RAMP;
    expect(keeper.inForce(101, 1003, 0)).toBe(RAMP);
    expect(keeper.inForce(101, Number.NaN, 0)).toBeNull();
    expect(keeper.inForce(103, 4000, 0)).toBeNull();
    expect(asked).not.toHaveBeenCalled();
    expect(keeper.inForce(101, 500, 10_000)).toBeNull();
    expect(asked).toHaveBeenCalledOnce();
  });
});
