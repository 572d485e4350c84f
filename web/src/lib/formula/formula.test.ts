import { describe, expect, it } from "vitest";
import { compile, FormulaError } from "./compile";
import { type Dimension, dimensionOf, unitText } from "./dimension";
import { LENGTH_MAX } from "./parse";

const MICROSTEPS = dimensionOf("microsteps").dimension;
const PPS = dimensionOf("pps").dimension;
const INPUTS: Record<string, Dimension> = { p: MICROSTEPS, e: MICROSTEPS, v: PPS, n: dimensionOf("").dimension };
const NONE = Number.NaN;

function run(formula: string, columns: Record<string, number[]>, from = 0, stepS = 1): number[] {
  const rows = Object.values(columns)[0]?.length ?? 0;
  const times = Float64Array.from({ length: rows }, (_, row) => row * stepS);
  const typed = Object.fromEntries(Object.entries(columns).map(([name, values]) => [name, Float64Array.from(values)]));
  return [...compile(formula, INPUTS).run({ times, columns: typed, from })];
}
const unitOf = (formula: string) => unitText(compile(formula, INPUTS).dimension);
const wrong = (formula: string): FormulaError => {
  try {
    compile(formula, INPUTS);
  } catch (error) {
    expect(error).toBeInstanceOf(FormulaError);
    return error as FormulaError;
  }
  throw new Error(`${formula} is no error`);
};

describe("a formula", () => {
  it.each([
    ["n + 2 * 3", 8],
    ["(n + 2) * 3", 12],
    ["-n ^ 2", -4],
    ["(-n) ^ 2", 4],
    ["2 ^ 3 ^ 2 + n", 514],
    ["7 - n - 1", 4],
    ["n < 3 && n > 1 || 0", 1],
    ["!n", 0],
    ["n == 2 ? 10 : n == 3 ? 20 : 30", 10],
    ["1e-1 + .5 + n", 2.6],
    ["7 % n + max(n, 3) + clamp(9, 0, n)", 6],
    ["wrap(n * 100, 360)", -160],
    ["atan2(n, n) / pi", 0.25],
    ["sqrt(n * n) + hypot(3, 4) + sign(-n) + abs(-n) + cos(0 * n) + sin(0 * n) + min(n, 1)", 10],
  ])("%s", (formula, expected) => {
    expect(run(formula, { n: [2] })[0]).toBeCloseTo(expected, 12);
  });

  it("has the units of what it is made of", () => {
    expect(unitOf("p - e")).toBe("µsteps");
    expect(unitOf("d(p)")).toBe("pps");
    expect(unitOf("d(v)")).toBe("pps²");
    expect(unitOf("int(v)")).toBe("µsteps");
    expect(unitOf("p / v")).toBe("s");
    expect(unitOf("p / e")).toBe("");
    expect(unitOf("sqrt(p * p)")).toBe("µsteps");
    expect(unitOf("p * v")).toBe("µstep²·s⁻¹");
    expect(unitOf("p + 100")).toBe("µsteps");
    expect(unitOf("lowpass(v, 20)")).toBe("pps");
  });

  it.each([
    ["p + v", "what is added has two units: µsteps and pps", 2],
    ["p < v", "what is compared has two units: µsteps and pps", 2],
    ["1 + sin(p)", "sin takes a plain number, this is in µsteps", 4],
    ["max(p, v)", "what max takes has two units: µsteps and pps", 0],
    ["p + n", "what is added has two units: µsteps and a plain number", 2],
    ["q + 1", "there is no input “q”", 0],
    ["p + foo(p)", "there is no function “foo”", 4],
    ["mean(p)", "mean takes 2 values, not 1", 0],
    ["mean(p, n)", "the second of mean is a number above 0 [s]", 0],
    ["mean(p, -1)", "the second of mean is a number above 0 [s]", 0],
    ["mean(p, 61)", "it looks 61 s back; 60 s is the most", 0],
    ["lowpass(p, 0.001)", "it looks 1000 s back", 0],
    ["p ^ n", "what is behind ^ is a number", 2],
    ["p +", "the formula ends too early", 3],
    ["(p", "the formula ends too early", 2],
    ["p p", "“p” does not fit here", 2],
    ["p.q", "“.” is no part of a formula", 1],
    ["p = 1", "“=” is no part of a formula", 2],
    ["1 + 2", "it has no input", 0],
  ])("refuses %s and says why and where", (formula, message, at) => {
    const error = wrong(formula);
    expect(error.message).toContain(message);
    expect(error.at).toBe(at);
  });

  it.each([
    "constructor",
    "__proto__",
    "toString(p)",
    "p.constructor.constructor('return 1')()",
    "hasOwnProperty(p)",
    "p[0]",
    "new Date()",
    "p = p",
    "`p`",
    "(() => p)()",
    "import('x')",
    "valueOf",
    '"a" + p',
    "p;p",
    "p // q",
  ])("is nothing of the language that it is written in: %s", (formula) => {
    wrong(formula);
  });

  it("is bounded in length, parts and depth", () => {
    expect(wrong("p".padEnd(LENGTH_MAX + 1)).message).toContain("characters at the most");
    expect(wrong(Array(70).fill("p").join("+")).message).toContain("parts at the most");
    expect(wrong("(".repeat(100)).message).toContain("deep at the most");
    expect(wrong("-".repeat(200)).message).toContain("deep at the most");
    expect(wrong("mean(".repeat(30)).message).toContain("deep at the most");
    expect(wrong(`${"mean(".repeat(20)}p${", 10)".repeat(20)}`).message).toContain("s back");
  });
});

describe("functions with a memory", () => {
  it("begin anew after a gap", () => {
    const x = [1, 3, NONE, 10, 20];
    expect(run("d(n)", { n: x })).toEqual([NONE, 2, NONE, NONE, 10]);
    expect(run("int(n)", { n: x })).toEqual([0, 2, NONE, 0, 15]);
    expect(run("mean(n, 10)", { n: x })).toEqual([1, 2, NONE, 10, 15]);
    expect(run("rms(n, 10)", { n: [3, 4, NONE, 5] })).toEqual([3, Math.sqrt(12.5), NONE, 5]);
    const [first, second, gap, again] = run("lowpass(n, 1)", { n: x });
    expect([first, gap, again]).toEqual([1, NONE, 10]);
    expect(second).toBeCloseTo(1 + 2 * (1 - Math.exp(-2 * Math.PI)), 12);
    expect(run("unwrap(n, 360)", { n: [350, 10, 30, NONE, 350, 340] })).toEqual([350, 370, 390, NONE, 350, 340]);
  });

  it("look back by time, not by rows", () => {
    expect(run("mean(n, 1)", { n: [1, 2, 3, 4, 5] }, 0, 0.5)).toEqual([1, 1.5, 2.5, 3.5, 4.5]);
    expect(run("delay(n, 2)", { n: [1, 2, 3, 4] })).toEqual([NONE, NONE, 1, 2]);
  });

  it("have an area that begins where the picture does", () => {
    expect(run("int(n)", { n: [1, 1, 1, 1] }, 2)).toEqual([0, 0, 0, 1]);
  });

  it("say how much of before they need", () => {
    expect(compile("mean(lowpass(p, 10), 2) + delay(e, 1)", INPUTS).leadS).toBeCloseTo(2.1);
    expect(compile("lowpass(e, 10) - p", INPUTS).inputs).toEqual(["e", "p"]);
  });
});
