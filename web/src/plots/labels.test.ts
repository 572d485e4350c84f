import { describe, expect, it } from "vitest";
import { prefixed, tickTexts } from "./labels";

describe("tick labels", () => {
  it("are plain while that is short", () => {
    expect(tickTexts([-51_200, 0, 51_200], 51_200)).toEqual(["−51\u202f200", "0", "51\u202f200"]);
    expect(tickTexts([0, 2.5, 5], 2.5)).toEqual(["0.0", "2.5", "5.0"]);
    expect(tickTexts([-2e6, 0], 2e6)).toEqual(["−2\u202f000\u202f000", "0"]);
  });

  it("have one prefix where they are long, and keep sign and leading digits", () => {
    expect(tickTexts([-2e7, -1e7, 0, 1e7], 1e7)).toEqual(["−20\u202fM", "−10\u202fM", "0", "10\u202fM"]);
    expect(tickTexts([-2e9, 2_147_483_648], 5e8)).toEqual(["−2.0\u202fG", "2.1\u202fG"]);
    expect(tickTexts([9.2e18], 2e17)).toEqual(["9.2\u202fE"]);
    expect(tickTexts([0, 2.5e-11], 2.5e-11)).toEqual(["0", "25\u202fp"]);
  });

  it("stay plain where a prefix would not be shorter: they still differ", () => {
    const zoomed = [20_000_001, 20_000_002, 20_000_003];
    const texts = tickTexts(zoomed, 1);
    expect(new Set(texts).size).toBe(3);
    expect(texts[0]).toBe("20\u202f000\u202f001");
  });

  it("are told apart also with a prefix", () => {
    expect(prefixed([1_250_000, 1_500_000, null], 250_000)).toEqual(["1.25\u202fM", "1.50\u202fM", ""]);
    expect(prefixed([0], 1)).toEqual(["0"]);
  });
});
