import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { repeatFrames } from "./useFrame";

beforeEach(
  () =>
    void vi.useFakeTimers({ toFake: ["setTimeout", "clearTimeout", "requestAnimationFrame", "cancelAnimationFrame"] }),
);
afterEach(() => void vi.useRealTimers());

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
});
