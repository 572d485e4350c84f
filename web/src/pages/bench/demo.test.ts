import { describe, expect, it } from "vitest";
import { stretchOf } from "./demo";

describe("the demo's way", () => {
  it("lies between the end switches, wherever the counter's zero is", () => {
    for (const count of [0, 5000, -70_000]) {
      const stage = {
        axis: 0,
        positionFullsteps: 3750,
        chipTimeS: 0,
        places: { left: 0, right: 7500, homeFrom: 250, homeTo: 350 },
        switches: {
          left: { active: false, forced: null },
          right: { active: false, forced: null },
          home: { active: false, forced: null },
        },
      };
      const [first, second] = stretchOf(stage, count, 64);
      const mechanical = (microsteps: number) => 3750 + (microsteps - count) / 64;
      expect(mechanical(first)).toBeCloseTo(0.12 * 7500, 1);
      expect(mechanical(second)).toBeCloseTo(0.88 * 7500, 1);
    }
  });
});
