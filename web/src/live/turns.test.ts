import { describe, expect, it } from "vitest";
import { Turns } from "./turns";

const NAMES = Array.from({ length: 12 }, (_, index) => `plot ${index}`);

/** How often each plot is drawn in so many frames that take `costMs` of each plot drawn, `periodMs` at the least. */
function drawn(
  frames: number,
  costMs: number,
  periodMs = 16,
): { counts: Map<string, number>; rateHz: number; most: number } {
  const turns = new Turns();
  const counts = new Map(NAMES.map((name) => [name, 0]));
  let [nowMs, most, beganMs] = [0, 0, 0];
  for (let frame = 0; frame < 2 * frames; frame += 1) {
    if (frame === frames) {
      for (const name of NAMES) counts.set(name, 0); // it has found its pace
      beganMs = nowMs;
      most = 0;
    }
    const now = NAMES.filter((name) => turns.take(name, nowMs));
    for (const name of now) counts.set(name, (counts.get(name) ?? 0) + 1);
    most = Math.max(most, now.length);
    nowMs += Math.max(periodMs, 10 + now.length * costMs);
  }
  return { counts, rateHz: (frames * 1000) / (nowMs - beganMs), most };
}

describe("turns of plots", () => {
  it("draws all in each frame where that is quick enough", () => {
    const { counts, rateHz } = drawn(600, 0.3);
    expect(rateHz).toBeGreaterThan(60);
    for (const count of counts.values()) expect(count).toBeGreaterThan(590);
  });

  it.each([20.2, 33.4])("draws all in each frame of a display that has one every %d ms", (periodMs) => {
    for (const count of drawn(3000, 0.3, periodMs).counts.values()) expect(count).toBeGreaterThan(2900);
  });

  it.each([3, 8, 20])("leaves the page its frames where one takes %d ms, and forgets none", (costMs) => {
    const { counts, rateHz, most } = drawn(1200, costMs);
    const all = [...counts.values()];
    expect(rateHz).toBeGreaterThan(costMs > 10 ? 35 : 50);
    expect(most).toBeLessThanOrEqual(Math.max(3, 12 / costMs));
    expect(Math.min(...all)).toBeGreaterThan(0.8 * Math.max(...all));
    expect(Math.min(...all) / (1200 / rateHz)).toBeGreaterThan(2);
  });
});
