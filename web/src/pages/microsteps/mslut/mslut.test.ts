import { describe, expect, it } from "vitest";
import { withStroke } from "../table";
import { Seen } from "./seen";
import {
  bent,
  cArray,
  clamp,
  currentAt,
  DEFAULT,
  decode,
  entryAt,
  exponentFor,
  hexLines,
  parseWave,
  period,
  phasesOf,
  questionOf,
  type Register,
  rippleOf,
  SINE,
  wordsOf,
} from "./wave";

/** What every chip of the family holds after power-on. */
const WORDS = [
  0xaaaab554, 0x4a9554aa, 0x24492929, 0x10104222, 0xfbffffff, 0xb5bb777d, 0x49295556, 0x00404222, 0xffff8056,
  0x00f70000,
];
const REGISTERS: Register[] = WORDS.map((value, at) => ({
  name: at < 8 ? `MSLUT[${at}]` : at === 8 ? "MSLUTSEL" : "MSLUTSTART",
  address: at < 9 ? 0x70 + at : 0x7e,
  value,
  hex: value.toString(16).toUpperCase().padStart(8, "0"),
}));
const POWER_ON = decode(WORDS.slice(0, 8), 0xffff8056, 0x00f70000);

describe("the phases", () => {
  it("bear the names of the chip's data sheet", () => {
    expect(phasesOf("tmc4361").sine).toBe("phase A");
    expect(phasesOf("tmc5xxx")).toEqual({ sine: "CUR_B", cosine: "CUR_A" });
    expect(phasesOf("tmcdrivers", "tmc2130").sine).toBe("CUR_A");
    expect(phasesOf("tmcdrivers", "tmc2240").sine).toBe("CUR_B");
  });
});

describe("the wave of register words", () => {
  it("is what real chips show", () => {
    expect(POWER_ON.mirror).toBe(-1);
    expect(POWER_ON.values.slice(0, 8)).toEqual([0, 1, 3, 4, 6, 7, 9, 10]);
    const at = (position: number) => currentAt(POWER_ON.values, POWER_ON.mirror, position);
    for (const [position, a, b] of [
      [8, 12, 247],
      [68, 100, 225],
      [584, -107, -224],
      [648, -184, -166],
    ] as const) {
      expect([at(position), at(position + 256)]).toEqual([a, b]);
    }
  });

  it("stays within a count of the sine", () => {
    for (const [index, value] of POWER_ON.values.entries())
      expect(Math.abs(value - (SINE[index] ?? 0))).toBeLessThan(1.01);
  });

  it("comes back from what it is exported as, and from its values", () => {
    expect(parseWave(cArray(REGISTERS))).toEqual(POWER_ON);
    expect(parseWave(hexLines(REGISTERS))).toEqual(POWER_ON);
    expect(parseWave(WORDS.map((word) => `0x${word.toString(16)}`).join(", "))).toEqual(POWER_ON);
    expect(parseWave(POWER_ON.values.join(" "))).toEqual(POWER_ON);
    expect(wordsOf(REGISTERS)).toEqual({ mslut: WORDS.slice(0, 8), mslutsel: 0xffff8056, mslutstart: 0xf70000 });
  });

  it("says what is wrong with a text", () => {
    const wrong = (text: string) => {
      const parsed = parseWave(text);
      return "wrong" in parsed ? parsed.wrong : null;
    };
    expect(wrong("")).toMatch(/No numbers/);
    expect(wrong("1 2 three")).toMatch(/“three”/);
    expect(wrong("1 2 3")).toMatch(/here are 3 numbers/);
    expect(wrong([...POWER_ON.values.slice(1), 256].join(" "))).toMatch(/Value 255 is 256/);
    expect(wrong([...WORDS.slice(1), 2 ** 32].join(" "))).toMatch(/Word 9/);
  });
});

describe("a period", () => {
  it("reads the quarter forth and back, then its negative half", () => {
    expect(entryAt(0)).toEqual({ index: 0, negative: false });
    expect(entryAt(256)).toEqual({ index: 255, negative: false });
    expect(entryAt(511)).toEqual({ index: 0, negative: false });
    expect(entryAt(512)).toEqual({ index: 0, negative: true });
    expect(entryAt(1023)).toEqual({ index: 0, negative: true });
    expect(entryAt(-1)).toEqual(entryAt(1023));
    expect(
      period(POWER_ON.values, -1)
        .map((value) => -1 - value)
        .slice(0, 512),
    ).toEqual(period(POWER_ON.values, -1).slice(512));
  });
});

describe("drawing", () => {
  it("bends the neighbours along and leaves the rest", () => {
    const there = bent(POWER_ON.values, 128, 200);
    expect(there[128]).toBe(200);
    expect(there.slice(0, 88)).toEqual(POWER_ON.values.slice(0, 88));
    expect(there.slice(168)).toEqual(POWER_ON.values.slice(168));
    expect(Math.max(...bent(POWER_ON.values, 250, 900))).toBe(255);
  });

  it("takes a stroke of the pen up to its own top", () => {
    const flat = new Array<number>(256).fill(0);
    const there = withStroke(flat, { index: 10, value: 0 }, { index: 20, value: 400 }, clamp);
    expect(there.slice(9, 18)).toEqual([0, 0, 40, 80, 120, 160, 200, 240, 255]);
  });
});

describe("a formula", () => {
  it("asks for what differs from nothing", () => {
    expect(questionOf({ kind: "formula", formula: DEFAULT }, "minimax", "tmc4361")).toMatchObject({
      chip: "tmc4361",
      harmonics: [],
      corrections: [],
      norm: "minimax",
    });
    const [third, ...others] = DEFAULT.harmonics;
    const formula = { ...DEFAULT, harmonics: [{ order: 3, amount: 0.05, phase_deg: 180 }, ...others] };
    expect(third?.amount).toBe(0);
    expect(questionOf({ kind: "formula", formula }, "minimax", "tmc4361").harmonics).toEqual([
      { order: 3, amplitude: 0.05, phase_deg: 180 },
    ]);
  });

  it("knows the law of thumb for a torque ripple", () => {
    expect(exponentFor(0.02)).toBeCloseTo(1.06);
    expect(rippleOf(1.15)).toBeCloseTo(0.05);
  });
});

describe("what a turning motor shows", () => {
  it("covers both phases' places, and finds what is not of the table", () => {
    const seen = new Seen();
    seen.add(8, 12, 247, POWER_ON, 0);
    expect([seen.places, seen.wrong]).toEqual([2, 0]);
    seen.add(584, -107, -224, POWER_ON, 0);
    expect([seen.places, seen.wrong]).toEqual([4, 0]);
    seen.add(100, 5, 5, POWER_ON, 0);
    expect([seen.places, seen.wrong]).toEqual([6, 2]);
    seen.add(Number.NaN, 0, 0, POWER_ON, 0);
    expect(seen.places).toBe(6);
    seen.clear();
    expect([seen.places, seen.wrong, seen.dots(true, -1).length]).toEqual([0, 0, 0]);
  });

  it("allows for readings that follow one another, and folds them onto the quarter", () => {
    const seen = new Seen();
    seen.add(12, 12, 247, POWER_ON, 8);
    expect(seen.wrong).toBe(0);
    seen.clear();
    seen.add(584, -107, -224, POWER_ON, 0);
    expect(seen.dots(false, -1)).toEqual([
      [584, -107],
      [840, -224],
    ]);
    expect(seen.dots(true, -1)).toEqual([
      [72, 106],
      [183, 223],
    ]);
  });
});
