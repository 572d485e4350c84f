import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { repeatFrames } from "./useFrame";

beforeEach(
  () =>
    void vi.useFakeTimers({ toFake: ["setTimeout", "clearTimeout", "requestAnimationFrame", "cancelAnimationFrame"] }),
);
afterEach(() => {
  vi.restoreAllMocks();
  vi.useRealTimers();
});

describe("repeatFrames", () => {
  it("draws in every frame without a pause", () => {
    const draw = vi.fn();
    const end = repeatFrames(draw, () => 0);
    vi.advanceTimersByTime(16 * 10);
    expect(draw).toHaveBeenCalledTimes(10);
    end();
  });

  it.each([
    [100, 10],
    [66, 15],
  ])("draws every %i ms: about %i times a second", (periodMs, times) => {
    const draw = vi.fn();
    const end = repeatFrames(draw, () => periodMs);
    vi.advanceTimersByTime(1000);
    expect(draw.mock.calls.length).toBeGreaterThanOrEqual(times - 1);
    expect(draw.mock.calls.length).toBeLessThanOrEqual(times + 1); // the first comes at once
    end();
  });

  it("asks for the period each time: a system's setting may change", () => {
    const draw = vi.fn();
    let period = 0;
    const end = repeatFrames(draw, () => period);
    vi.advanceTimersByTime(160);
    period = 1000;
    vi.advanceTimersByTime(160);
    expect(draw.mock.calls.length).toBeLessThanOrEqual(12);
    end();
  });

  it.each([0, 100])("draws nothing after its end, with a period of %i ms", (period) => {
    const draw = vi.fn();
    const end = repeatFrames(draw, () => period);
    vi.advanceTimersByTime(40);
    const before = draw.mock.calls.length;
    end();
    vi.advanceTimersByTime(1000);
    expect(draw).toHaveBeenCalledTimes(before);
  });

  it("may be ended by what it draws", () => {
    let end = () => {};
    const draw = vi.fn(() => end());
    end = repeatFrames(draw, () => 0);
    vi.advanceTimersByTime(1000);
    expect(draw).toHaveBeenCalledTimes(1);
  });

  it("asks for one frame for all that draw, plots before texts", () => {
    const asked = vi.spyOn(globalThis, "requestAnimationFrame");
    const order: string[] = [];
    const ends = (["texts", "plots", "texts", "plots"] as const).map((turn, index) =>
      repeatFrames(
        () => order.push(`${turn}${index}`),
        () => 0,
        turn,
      ),
    );
    vi.advanceTimersByTime(16);
    expect(order).toEqual(["plots1", "plots3", "texts0", "texts2"]);
    asked.mockClear();
    vi.advanceTimersByTime(16 * 10);
    expect(asked).toHaveBeenCalledTimes(10);
    for (const end of ends) end();
    expect(vi.getTimerCount()).toBe(0);
  });

  it("rests between the frames of those that draw seldom, whenever they began", () => {
    const asked = vi.spyOn(globalThis, "requestAnimationFrame");
    const ends = [0, 1, 2, 3].map(() => {
      vi.advanceTimersByTime(17);
      return repeatFrames(vi.fn(), () => 100);
    });
    vi.advanceTimersByTime(200);
    asked.mockClear();
    vi.advanceTimersByTime(1000);
    expect(asked.mock.calls.length).toBeLessThanOrEqual(11);
    for (const end of ends) end();
  });

  it("goes on with the others where one fails", () => {
    const failed = vi.fn();
    const fails = () => {
      throw new Error("no plot");
    };
    vi.stubGlobal("reportError", failed);
    const draw = vi.fn();
    const ends = [fails, draw].map((each) => repeatFrames(each, () => 0));
    vi.advanceTimersByTime(16 * 3);
    expect(draw).toHaveBeenCalledTimes(3);
    expect(failed).toHaveBeenCalledTimes(3);
    for (const end of ends) end();
    vi.unstubAllGlobals();
  });
});
