import { describe, expect, it } from "vitest";
import { pointsOf as byHand, type Move } from "../byHand/moves";
import { type ChopperTried, pointsOf as ofChopper } from "../chopper/tried";
import { type CustomFound, pointsOf as ofOwnSearch } from "../customSearch/found";
import { pointsOf as ofFastestMove } from "../fastestMove/trials";
import { type CoolStepFound, coolPointsOf } from "../leastCurrent/tried";
import { pointsOf as ofStallGuard } from "../stallguard/rates";
import { pointsOf as ofStealthChop, type StealthTried } from "../stealthchop/tried";
import type { Study, Trial } from "../study";
import { frontOf, historyOf, nearestTo, parallelOf, saidOf, spaceOf, type Trials } from "./points";

function trial(number: number, state: Trial["state"], setting: Trial["setting"], time: number | null = null): Trial {
  const figures = { time_s: time, spread_s: null, deviation_fullsteps: number, lost_fullsteps: 0, runs: 20 };
  return {
    number,
    state,
    setting,
    registers: [],
    figures: { ...figures, by_distance_s: [] },
    expected_s: 0.5,
    why: "",
    at_s: 0,
  };
}

const ramp = (number: number, state: Trial["state"], speed: number, time: number | null) =>
  trial(number, state, { speed, acceleration: speed * 4 }, time);

const TRIALS = [
  ramp(0, "feasible", 100, 1),
  ramp(1, "pruned", 50, null),
  ramp(2, "infeasible", 1000, null),
  ramp(3, "feasible", 400, 0.6),
  ramp(4, "feasible", 300, 0.8),
];
const FASTEST = {
  document: { study: { kind: "fastest_move", quiet: true } },
  trials: TRIALS,
  units: { speed: "pps", acceleration: "pps^2" },
  best: 3,
} as unknown as Study;

function study(trials: Trial[], units: Study["units"], best: number | null): Study {
  return { ...FASTEST, trials, units, best };
}

const across = (trials: Trials) => parallelOf(trials).axes.map(({ name, low, high }) => [name, low, high]);

describe("trials as points", () => {
  it("shows what held, what lost steps, and the best so far; what was not tried is left out", () => {
    expect(historyOf(ofFastestMove(FASTEST))).toEqual([
      [0, 2, 3, 4],
      [1, null, 0.6, 0.8],
      [null, 0.5, null, null],
      [1, 1, 0.6, 0.6],
    ]);
  });

  it("draws the space in rising order of the first setting, and of one setting alone what came of it", () => {
    expect(spaceOf(ofFastestMove(FASTEST))).toEqual([
      [100, 300, 400, 1000],
      [400, 1200, 1600, null],
      [null, null, null, 4000],
    ]);
    expect(spaceOf(ofFastestMove(study(TRIALS, { speed: "pps" }, 3)))).toEqual([
      [100, 300, 400, 1000],
      [1, 0.8, 0.6, null],
      [null, null, null, 0.5],
    ]);
  });

  it("marks the front of two figures, and the chosen one where one is", () => {
    const points = ofFastestMove(FASTEST);
    const front = [
      [0.6, 0.8, 1],
      [3, 4, 0],
      [3, null, 0],
    ];
    expect(frontOf(points, [0, 3], null)).toEqual(front);
    expect(frontOf(points, [0, 3], 0)).toEqual([...front, [null, null, 0]]);
  });

  it("crosses parallel axes between the least and the greatest, settings with a unit by their ratio", () => {
    const points = ofFastestMove(FASTEST);
    expect(across(points)).toEqual([
      ["speed", 100, 1000],
      ["acceleration", 400, 4000],
      ["time", 0.5, 1],
      ["deviation", 0, 4],
    ]);
    const { lines } = parallelOf(points);
    expect(lines.map(({ point }) => point.number)).toEqual([0, 2, 3, 4]);
    expect(lines[0]?.heights).toEqual([0, 0, 1, 0]);
    expect(lines[2]?.heights[0]).toBeCloseTo(Math.log10(4));
    // Settings that may be 0 or below, as a threshold of StallGuard, and fields without a unit are no ratios.
    const heights = (unit: string, ...values: number[]) => {
      const trials = values.map((speed, number) => trial(number, "feasible", { speed }));
      return parallelOf(ofFastestMove(study(trials, { speed: unit, none: "" }, null))).lines.map(
        (line) => line.heights,
      );
    };
    expect(heights("pps", -5, 5, 15).map(([first]) => first)).toEqual([0, 0.5, 1]);
    expect(heights("", 1, 8, 15).map(([first]) => first)).toEqual([0, 0.5, 1]);
    // What no trial has is no axis, and what is the same in all is crossed in the middle.
    expect(heights("", 3, 3)).toEqual([
      [0.5, 0],
      [0.5, 1],
    ]);
  });

  it("finds the trial whose line passes next, and tells all its values", () => {
    const points = ofFastestMove(FASTEST);
    const { lines } = parallelOf(points);
    expect(nearestTo(lines, 0.5, 0.02)?.number).toBe(0);
    expect(nearestTo(lines, 0.5, 0.97)?.number).toBe(2);
    expect(nearestTo(lines, 1.5, 0.4)?.number).toBe(3);
    expect(nearestTo(lines, 0.5, 0.2)).toBeNull();
    const [, , fastest, slower] = lines;
    if (!fastest || !slower) throw new Error("four lines");
    expect(saidOf(points, fastest.point)).toBe(
      "Trial 3, the best, held: speed 400\u202fpps, acceleration 1600\u202fpps², time 0.6000\u202fs, deviation 3\u202ffull steps",
    );
    expect(saidOf(points, slower.point)).toMatch(/^Trial 4, held: speed 300/);
  });

  it("takes the figures of an own search by the numbers of its trials, the more the better of a load value", () => {
    const tried = [0, 2, 3, 4].map((number) => ({ number, figures: { load_min: 10 * number, time_s: null } }));
    const points = ofOwnSearch(FASTEST, { objectives: ["load_min", "time_s"], tried } as unknown as CustomFound);
    expect(across(points).map(([name]) => name)).toEqual(["speed", "acceleration", "least load value"]);
    expect(historyOf(points)).toEqual([
      [0, 2, 3, 4],
      [0, null, 30, 40],
      [null, 20, null, null],
      [0, 0, 30, 40],
    ]);
  });

  it("takes what was seen of a chopper and of StealthChop in the order of their trials", () => {
    const setting = { TOFF: 3, TBL: 1, hysteresis: 4 };
    const calm = [trial(0, "feasible", setting), trial(7, "feasible", { ...setting, TOFF: 5 })];
    const tried = [0.05, 0.02].map((ripple) => ({ ripple_fullsteps: ripple, chopper_hz: 3e4 }) as ChopperTried);
    const chopper = ofChopper(study(calm, { TOFF: "", TBL: "", hysteresis: "" }, 7), { tried });
    expect(across(chopper)).toEqual([
      ["TOFF", 3, 5],
      ["TBL", 1, 1],
      ["hysteresis", 4, 4],
      ["ripple", 0.02, 0.05],
      ["chopper, about", 3e4, 3e4],
    ]);
    expect(historyOf(chopper)[1]).toEqual([0.05, 0.02]);

    const silent = [
      trial(1, "infeasible", { PWM_OFS: 30, PWM_GRAD: 12, "switch-over": 0.8 }),
      trial(2, "feasible", { PWM_OFS: 30, PWM_GRAD: 12, "switch-over": 0.4 }),
    ];
    const seen = [0.6, 0.2].map(
      (jolt) => ({ jolt_fullsteps: jolt, added_share: 0.1, amplitude_share: null }) as StealthTried,
    );
    const units = { PWM_OFS: "", PWM_GRAD: "", "switch-over": "turns/s" };
    const stealth = ofStealthChop(study(silent, units, 2), { tried: seen });
    expect(historyOf(stealth)).toEqual([
      [1, 2],
      [null, 0.2],
      [0.6, null],
      [null, 0.2],
    ]);
    expect(across(stealth).slice(-2)).toEqual([
      ["jolt", 0.2, 0.6],
      ["off by", 10, 10],
    ]);
  });

  it("takes settings of CoolStep, and marks the one that was proved", () => {
    const setting = { semin: 5, semax: 2, seup: 1, sedn: 0, seimin: 1 };
    const tried = [
      { setting, held: true, scale: 20, cycles: 4, heat_share: 0.7 },
      { setting: { ...setting, semin: 2 }, held: false, scale: 20, cycles: 1, heat_share: null },
    ] satisfies CoolStepFound["tried"];
    const points = coolPointsOf({ tried, setting: { ...setting } });
    expect(points.best).toBe(1);
    expect(points.points.map(({ state, values }) => [state, values.at(-1)])).toEqual([
      ["held", 70],
      ["lost", null],
    ]);
    expect(coolPointsOf({ tried, setting: null }).best).toBeNull();
  });

  it("takes choices of StallGuard that were tried on held-out runs", () => {
    const choices = [
      trial(0, "infeasible", { SGT: 2, SFILT: 0 }),
      trial(1, "feasible", { SGT: 5, SFILT: 1, "armed above": 900 }),
    ];
    const points = ofStallGuard(study(choices, { SGT: "", SFILT: "0/1", "armed above": "pps" }, 1));
    expect(points.points.map(({ values }) => values)).toEqual([
      [2, 0, null, 20],
      [5, 1, 900, 20],
    ]);
  });

  it("takes moves by hand as they are ranked, by what was changed between them", () => {
    const move = (id: string, speed: number, time: number | null, lost = 0) =>
      ({
        id,
        started_unix_s: Number(id),
        setting: { "speed [pps]": speed, TOFF: 3 },
        scored: { time_s: time, lost_fullsteps: lost, stalls: 0 },
      }) as unknown as Move;
    const points = byHand([move("3", 200, 1), move("1", 100, 2), move("2", 400, null, 4)], "time_s");
    expect(points.settings).toEqual([{ name: "speed", unit: "pps" }]);
    expect(points.points.map(({ state, values }) => [state, ...values])).toEqual([
      ["held", 200, 1],
      ["held", 100, 2],
      ["lost", 400, null],
    ]);
    expect(points.best).toBe(0);
    expect(byHand([move("2", 400, 1, 4)], "time_s").best).toBeNull();
  });
});
