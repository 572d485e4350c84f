import { describe, expect, it } from "vitest";
import { countsOf, encConst, encConstValue, fractionText, negativeWord } from "../../../pages/encoder/encConst";
import { degrees, onCircle, sector, zoneOf } from "./angle";
import { bestOf, columnOf, farOnes, KEPT, type Recording, type Run, reachOf, type Score, wayOf, withRun } from "./runs";

/** counts a turn, constant, binary word, drift of it [microsteps a turn], decimal word, drift of it. */
const TABLE: readonly (readonly [number, string, number, number, number, number])[] = [
  [200, "256", 0x0100_0000, 0, 0x0100_0000, 0],
  [360, "1280/9", 0x008e_38e4, 0.0024, 0x008e_08ae, -0.008],
  [400, "128", 0x0080_0000, 0, 0x0080_0000, 0],
  [500, "512/5", 0x0066_6666, -0.0031, 0x0066_0fa0, 0],
  [1000, "256/5", 0x0033_3333, -0.0031, 0x0033_07d0, 0],
  [1024, "50", 0x0032_0000, 0, 0x0032_0000, 0],
  [2000, "128/5", 0x0019_999a, 0.0122, 0x0019_1770, 0],
  [4000, "64/5", 0x000c_cccd, 0.0122, 0x000c_1f40, 0],
  [4096, "25/2", 0x000c_8000, 0, 0x000c_1388, 0],
  [10_000, "128/25", 0x0005_1eb8, -0.0488, 0x0005_04b0, 0],
  [16_384, "25/8", 0x0003_2000, 0, 0x0003_04e2, 0],
  [40_000, "32/25", 0x0001_47ae, -0.0488, 0x0001_0af0, 0],
];

describe("ENC_CONST", () => {
  it.each(TABLE)("of %i counts a turn", (counts, exact, binary, drift, decimal, driftOfDecimal) => {
    const found = encConst(counts, 51_200);
    expect(found && fractionText(found.exact)).toBe(exact);
    expect(found?.binary.raw).toBe(binary);
    expect(found?.binary.driftPerTurn).toBeCloseTo(drift, 3);
    expect(found?.decimal.raw).toBe(decimal);
    expect(found?.decimal.driftPerTurn).toBeCloseTo(driftOfDecimal, 3);
    const better = Math.abs(drift) === Math.abs(driftOfDecimal) ? null : Math.abs(drift) < Math.abs(driftOfDecimal);
    expect(found?.better).toBe(better === null ? null : better ? "binary" : "decimal");
    expect(encConstValue(binary, false)).toBeCloseTo(found?.binary.value ?? Number.NaN, 10);
    expect(encConstValue(decimal, true)).toBeCloseTo(found?.decimal.value ?? Number.NaN, 10);
  });

  it("tells the counts back", () => {
    for (const [counts, , binary, , decimal] of TABLE) {
      expect(countsOf(binary, false, 51_200)).toBe(counts);
      expect(countsOf(decimal, true, 51_200)).toBe(counts);
    }
    expect(countsOf(0, false, 51_200)).toBeNull();
  });

  it("counts the other way with a sign, in either form", () => {
    // the words of the TMC5160's data sheet and the facts: -1.28 is -2 + 0.72
    expect(negativeWord(0x1_47ae, false)).toBe(-0x1_47ae);
    expect(negativeWord(65_536 + 2800, true)).toBe(-2 * 65_536 + 7200);
    expect(negativeWord(3 * 65_536, true)).toBe(-3 * 65_536);
    for (const counts of [400, 2000, 8192, 40_000, 7])
      for (const form of ["binary", "decimal"] as const) {
        const found = encConst(counts, 51_200)?.[form];
        const word = negativeWord(found?.raw ?? 0, form === "decimal");
        expect(encConstValue(word, form === "decimal")).toBeCloseTo(-(found?.value ?? 0), 9);
        expect(countsOf(word, form === "decimal", 51_200)).toBe(counts);
      }
  });

  it("has none for what cannot be", () => {
    for (const [counts, microsteps] of [
      [0, 51_200],
      [1, 2 ** 15],
      [2 ** 30, 200],
      [4.5, 51_200],
    ] as const)
      expect(encConst(counts, microsteps)).toBeNull();
  });
});

describe("load angle", () => {
  it("is a quarter turn at 256", () => {
    expect(degrees(256)).toBe(90);
    expect(degrees(255)).toBeCloseTo(89.65, 2);
  });

  it("goes clockwise from the top", () => {
    expect(onCircle(0, 10).y).toBeCloseTo(-10);
    expect(onCircle(90, 10).x).toBeCloseTo(10);
    expect(onCircle(-90, 10).x).toBeCloseTo(-10);
    const path = sector(-90, 90, 40, 50);
    expect(path).toMatch(/^M-50\.00 -?0\.00A50 50 0 0 1 50\.00 -?0\.00L40\.00/);
    expect(sector(-120, 120, 40, 50)).toContain("A50 50 0 1 1");
    expect(sector(0, 360, 40, 50)).not.toContain("NaN");
  });

  it("tells the limit from what lies beyond", () => {
    expect(zoneOf(10, 89.6)).toBe("holding");
    expect(zoneOf(-89, 89.6)).toBe("limit");
    expect(zoneOf(140, 89.6)).toBe("beyond");
    expect(zoneOf(Number.NaN, 89.6)).toBe("unknown");
  });
});

const SCORE = { overshoot: 1, settling_s: 0.1, rms: 2, peak: 5 } as Score;
const RECORDING: Recording = {
  time_s: [-0.001, 0, 0.001],
  target: [100, 200, 200],
  commanded: [100, 150, 200],
  encoder: [100, null, 190],
  deviation: [0, null, -10],
  velocity_pps: [0, 1000, 0],
  encoder_velocity_pps: [0, 900, 0],
  load_angle_deg: [0, 12, 4],
  load_torque_nm: [null, null, null],
};
const run = (id: number, score: Partial<Score> = {}): Omit<Run, "number"> => ({
  id,
  kind: "step",
  recording: RECORDING,
  score: { ...SCORE, ...score },
  settings: "",
});

describe("runs", () => {
  it("numbers them on, keeps the latest, and takes none twice", () => {
    let runs: readonly Run[] = [];
    for (let id = 1; id <= KEPT + 2; id++) runs = withRun(runs, run(id));
    expect(runs.map(({ number }) => number)).toEqual([3, 4, 5, 6, 7, 8]);
    expect(withRun(runs, run(5))).toBe(runs);
  });

  it("draws positions from where the motor was, and gaps as gaps", () => {
    expect([...columnOf(RECORDING, "position")]).toEqual([0, Number.NaN, 90]);
    expect([...columnOf(RECORDING, "position", "commanded")]).toEqual([0, 50, 100]);
    expect([...columnOf(RECORDING, "deviation")]).toEqual([0, Number.NaN, -10]);
    expect([...columnOf(RECORDING, "angle")]).toEqual([0, 12, 4]);
  });

  it("turns a step back round, so that it lies over the one there", () => {
    const back = { ...RECORDING, target: [100, 0, 0], commanded: [100, 50, 0], encoder: [100, null, 10] };
    expect(wayOf(RECORDING)).toBe(1);
    expect(wayOf(back)).toBe(-1);
    expect([...columnOf(back, "position")]).toEqual([-0, Number.NaN, 90]);
    expect([...columnOf(back, "deviation")]).toEqual([-0, Number.NaN, 10]);
  });

  it("names the best only where all can be compared and one is", () => {
    const three = [run(1, { rms: 3 }), run(2, { rms: -1 }), run(3, { rms: 2 })].reduce(withRun, [] as readonly Run[]);
    expect(bestOf(three, (score) => score.rms)).toBe(2);
    expect(bestOf(three, (score) => score.peak)).toBeNull();
    expect(bestOf(withRun(three, run(4, { settling_s: null })), (score) => score.settling_s)).toBeNull();
  });
});

describe("runs that spoil a plot", () => {
  it("are those far beyond the lower half of them, never all", () => {
    expect(
      farOnes([
        [-1, 10],
        [0, 12],
        [-20_000, 3],
      ]),
    ).toEqual([2]);
    expect(
      farOnes([
        [0, 5000],
        [-1, 10],
      ]),
    ).toEqual([0]);
    expect(
      farOnes([
        [0, 10],
        [0, 40],
        [0, 49],
      ]),
    ).toEqual([]);
    expect(farOnes([[0, 5000]])).toEqual([]);
    expect(farOnes([null, [0, 10], [0, 900]])).toEqual([2]);
    expect(farOnes([])).toEqual([]);
  });

  it("are told by the values that there are", () => {
    expect(reachOf([Float64Array.of(Number.NaN, 2, -3)])).toEqual([-3, 2]);
    expect(reachOf([Float64Array.of(Number.NaN)])).toBeNull();
  });
});
