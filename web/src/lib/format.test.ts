import { describe, expect, it } from "vitest";
import {
  bound,
  compact,
  counted,
  decimalSum,
  duration,
  exactText,
  fixed,
  frequency,
  hex,
  parseNumber,
  withUnit,
} from "./format";

describe("format", () => {
  it("groups thousands and keeps the sign where there is one", () => {
    expect(fixed(-1234567.891, 1)).toBe("−1\u202f234\u202f567.9");
    expect(fixed(1234)).toBe("1234");
    expect(fixed(-0.0001, 2)).toBe("0.00");
    expect(fixed(Number.NaN)).toBe("–");
  });

  it("counts one in the singular", () => {
    expect([0, 1, 2].map((count) => counted(count, "turn"))).toEqual(["0 turns", "1 turn", "2 turns"]);
  });

  it("shows the significant digits", () => {
    expect(compact(Math.PI)).toBe("3.142");
    expect(compact(0.012345)).toBe("0.01235");
    expect(compact(51200)).toBe("51\u202f200");
    expect(compact(4.2e-7)).toBe("4.200e−7");
    expect(withUnit(90, "deg")).toBe("90°");
    expect(withUnit(1.5, "mm_per_s")).toBe("1.500\u202fmm/s");
  });

  it("gives bounds with all their digits", () => {
    expect(bound(-(2 ** 31))).toBe("−2\u202f147\u202f483\u202f648");
    expect(bound(0.5)).toBe("0.5");
    expect(bound(-1.5e-7)).toBe("−1.5e−7");
    expect(bound(1234.5678)).toBe("1234.568");
    expect(bound(7999511.72)).toBe("7\u202f999\u202f512");
    expect(bound(8e6 + 0.001)).toBe("8\u202f000\u202f000");
  });

  it("picks the prefix", () => {
    expect(duration(0.0000123)).toBe("12.3\u202fµs");
    expect(duration(0.25)).toBe("250\u202fms");
    expect(duration(125)).toBe("2:05\u202fmin");
    expect(frequency(16e6)).toBe("16\u202fMHz");
    expect(hex(0xabc, 24)).toBe("0x000abc");
  });

  it("reads what people type", () => {
    expect(parseNumber("1.5k")).toBe(1500);
    expect(parseNumber("−1 000")).toBe(-1000);
    expect(parseNumber("0x10")).toBe(16);
    expect(parseNumber("1e3")).toBe(1000);
    expect(parseNumber("−1e−3")).toBe(-0.001);
    // thousands are an exponent, not a product with its dust
    const thousands = Array.from({ length: 10_000 }, (_, part) => `${part % 10}.${String(part).padStart(4, "0")}`);
    expect(thousands.filter((text) => parseNumber(`${text}k`) !== Number(`${text}e3`))).toEqual([]);
    for (const nonsense of ["", "abc", "1e999", "NaN", "--3"]) expect(parseNumber(nonsense)).toBeNull();
  });

  it("writes a number so that reading it gives the number again, and without dust", () => {
    expect(exactText(0.1 + 0.2)).toBe("0.3");
    expect(exactText(12_345_678.125)).toBe("12345678.125");
    expect(exactText(-(2 ** 53 - 1))).toBe("-9007199254740991");
    const lost: number[] = [];
    for (let at = 0, seed = 7; at < 5000; at++) {
      seed = (seed * 48_271) % 2_147_483_647;
      const value = (seed - 2 ** 30) * 10 ** ((at % 37) - 18);
      const off = Math.abs((parseNumber(exactText(value)) ?? Number.NaN) - value);
      if (!(off <= 4 * Number.EPSILON * Math.abs(value))) lost.push(value);
      if (parseNumber(exactText(seed)) !== seed) lost.push(seed); // every whole number to the digit
    }
    expect(lost).toEqual([]);
  });

  it("adds decimals as they are written", () => {
    expect([decimalSum(0.1, 0.2), decimalSum(0.3, -0.3), decimalSum(-1.1, 0.1)]).toEqual([0.3, 0, -1]);
    expect(decimalSum(2 ** 53 - 2, 1)).toBe(2 ** 53 - 1);
    const steps = Array.from({ length: 2000 }, (_, at) => at - 1000);
    expect(steps.filter((at) => decimalSum(at / 100, 0.01) !== (at + 1) / 100)).toEqual([]);
  });
});
