import { describe, expect, it } from "vitest";
import { compact, duration, fixed, frequency, hex, parseNumber, withUnit } from "./format";

describe("format", () => {
  it("groups thousands and keeps the sign where there is one", () => {
    expect(fixed(-1234567.891, 1)).toBe("−1\u202f234\u202f567.9");
    expect(fixed(1234)).toBe("1234");
    expect(fixed(-0.0001, 2)).toBe("0.00");
    expect(fixed(Number.NaN)).toBe("–");
  });

  it("shows the significant digits", () => {
    expect(compact(Math.PI)).toBe("3.142");
    expect(compact(0.012345)).toBe("0.01235");
    expect(compact(51200)).toBe("51\u202f200");
    expect(compact(4.2e-7)).toBe("4.200e−7");
    expect(withUnit(90, "deg")).toBe("90°");
    expect(withUnit(1.5, "mm_per_s")).toBe("1.500\u202fmm/s");
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
    for (const nonsense of ["", "abc", "1e999", "NaN", "--3"]) expect(parseNumber(nonsense)).toBeNull();
  });
});
