import { describe, expect, it } from "vitest";
import { type BaseMode, choiceOf, codeOf, openOf, stepsOf, titleOf } from "./searchModes";

const BASES: readonly BaseMode[] = [1, 2, 3, 4, 5, 6, 7, 8];

describe("reference search modes", () => {
  it("are the sixteen numbers of AP 193, there and back", () => {
    const codes = BASES.flatMap((base) =>
      [false, true].map((extra) => codeOf({ base, mirrored: extra, inverted: extra })),
    );
    expect([...codes].sort((a, b) => a - b)).toEqual([1, 2, 3, 4, 5, 6, 7, 8, 65, 66, 67, 68, 133, 134, 135, 136]);
    for (const code of codes) {
      const choice = choiceOf(code);
      expect(choice && codeOf(choice)).toBe(code);
    }
    expect([0, 9, 69, 129, 132, 193].map(choiceOf)).toEqual([null, null, null, null, null, null]);
  });

  it("mirror left and right", () => {
    const straight = stepsOf({ base: 2, mirrored: false, inverted: false });
    const mirrored = stepsOf({ base: 2, mirrored: true, inverted: false });
    expect(straight.map((step) => step.to)).toEqual(["right", "left", "right", "left"]);
    expect(mirrored.map((step) => step.to)).toEqual(["left", "right", "left", "right"]);
    expect(titleOf({ base: 3, mirrored: true, inverted: false })).toBe("left, then middle of right switch");
  });

  it("begin fast and end slowly", () => {
    for (const base of BASES) {
      const steps = stepsOf({ base, mirrored: false, inverted: false });
      expect(steps[0]?.fast).toBe(true);
      expect(steps.at(-1)?.fast).toBe(false);
      expect(titleOf({ base, mirrored: false, inverted: false })).not.toBe("");
    }
  });

  it("say what no public source tells", () => {
    const open = BASES.filter((base) => openOf({ base, mirrored: false, inverted: false }) !== "");
    expect(open).toEqual([3, 4, 7, 8]);
  });
});
