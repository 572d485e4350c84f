import { describe, expect, it } from "vitest";
import {
  cellOf,
  edgesOf,
  exampleOf,
  type Filtered,
  fates,
  levelsOf,
  painted,
  passedOf,
  ticksOf,
  timeText,
  wavePath,
} from "./waves";

/** The rule of DS-TMC4361 6.1.2 once more: a level counts after `length` + 1 equal samples. */
function filtered(input: number[], sampleRate: number, length: number): Pick<Filtered, "input" | "output" | "bounds"> {
  const period = 2 ** sampleRate;
  let level = input[0] ?? 0;
  const latest = new Array<number>(length + 1).fill(level);
  const output = input.map((pin, clock) => {
    if (clock % period === 0) {
      latest.push(pin);
      latest.shift();
      if (latest.every((sample) => sample === pin)) level = pin;
    }
    return level;
  });
  const bounds = {
    period_clocks: period,
    delay_min_clocks: length * period,
    delay_max_clocks: (length + 1) * period - 1,
    stopped_clocks: length * period,
    passed_clocks: (length + 1) * period,
  } as Filtered["bounds"];
  return { input, output, bounds };
}

describe("waveforms", () => {
  it("goes from edges to levels and back", () => {
    const levels = levelsOf([3, 5, 9], 12);
    expect(levels.join("")).toBe("000110000111");
    expect(edgesOf(levels)).toEqual([3, 5, 9]);
    expect(levelsOf([], 3, 1)).toEqual([1, 1, 1]);
  });

  it("has examples for every setting, short enough to be sent, with pulses that pass and pulses that do not", () => {
    for (let sampleRate = 0; sampleRate < 8; sampleRate++)
      for (let length = 0; length < 8; length++)
        for (const kind of ["bounce", "glitches"] as const) {
          const setting = { sampleRate, length };
          const levels = exampleOf(kind, setting);
          expect(levels.length).toBeLessThanOrEqual(32_768); // what the server works on at once;
          const { passed, stopped } = fates(filtered(levels, sampleRate, length));
          expect(passed.length).toBeGreaterThanOrEqual(2);
          if (length > 0) expect(stopped.length).toBeGreaterThan(0);
          for (const { from, to } of passed) {
            expect(to - from).toBeGreaterThanOrEqual(length * 2 ** sampleRate);
            expect(to - from).toBeLessThan(passedOf(setting));
          }
          for (const { from, to } of stopped) expect(to - from).toBeLessThan(passedOf(setting));
        }
  });

  it("paints whole cells, whichever way the pen goes", () => {
    const levels = levelsOf([], 40);
    expect(cellOf(40)).toBe(1);
    expect(edgesOf(painted(levels, 4, 7, 1))).toEqual([4, 8]);
    expect(painted(levels, 7, 4, 1)).toEqual(painted(levels, 4, 7, 1));
    const long = levelsOf([], 4096);
    const cell = cellOf(long.length);
    expect(cell).toBe(32);
    expect(edgesOf(painted(long, 100, 100, 1))).toEqual([96, 128]);
  });

  it("draws each edge once", () => {
    const path = wavePath(
      [0, 1, 1, 0],
      (clock) => 10 * clock,
      (level) => 5 - level,
    );
    expect(path).toBe("M0.00 5H10.00V4H30.00V5H40.00");
  });

  it("writes times as data sheets do", () => {
    expect(timeText(62.5e-9)).toBe("62.5\u202fns");
    expect(timeText(1.5e-6)).toBe("1.5\u202fµs");
    expect(timeText(0.512e-3)).toBe("512\u202fµs");
    expect(timeText(1.024e-3)).toBe("1.024\u202fms");
    expect(ticksOf(36 / 16e6, 8).map(timeText)).toEqual([
      "0\u202fns",
      "500\u202fns",
      "1\u202fµs",
      "1.5\u202fµs",
      "2\u202fµs",
    ]);
  });
});
