import { describe, expect, it } from "vitest";
import { ObservedStage } from "./observed";

let clockS = 0;

function looked(position: number, left: number, right: number, home: number, speed = 0) {
  clockS += 0.01;
  return { timeS: clockS, position, speed, left, right, home };
}

/** A carriage that is moved over a stage with switches, and counts from `zero`. */
function drive(stage: ObservedStage, way: readonly number[], zero = 0, step = 5) {
  let at = way[0] ?? 0;
  const look = () =>
    stage.look(looked(at - zero, Number(at <= 0), Number(at >= 1000), Number(at >= 200 && at <= 260), step * 100));
  look();
  for (const target of way.slice(1))
    while (at !== target) {
      at += Math.sign(target - at) * Math.min(step, Math.abs(target - at));
      look();
    }
}

describe("a stage that nobody tells of", () => {
  it("knows nothing of switches before they were passed", () => {
    const stage = new ObservedStage();
    expect(stage.range(200)).toEqual([-200, 200]);
    drive(stage, [500, 700]);
    expect([stage.left, stage.right, stage.homeFrom, stage.homeTo]).toEqual([null, null, null, null]);
    const [from, to] = stage.range(200);
    expect(from).toBeLessThan(500);
    expect(to).toBeGreaterThan(700);
  });

  it("learns each place from either side", () => {
    for (const way of [
      [500, -5, 1005, 500],
      [500, 1005, -5, 500],
    ]) {
      const stage = new ObservedStage();
      drive(stage, way);
      for (const [seen, is] of [
        [stage.left, 0],
        [stage.right, 1000],
        [stage.homeFrom, 200],
        [stage.homeTo, 260],
      ] as const)
        expect(Math.abs((seen ?? Number.NaN) - is)).toBeLessThanOrEqual(5);
    }
  });

  it("moves with the counter when that is set anew", () => {
    const stage = new ObservedStage();
    drive(stage, [500, -5, 1005, 500]);
    stage.look(looked(500, 0, 0, 0));
    const before = [stage.left, stage.right, stage.homeFrom, stage.homeTo, stage.highest];
    stage.look(looked(490, 0, 0, 0)); // by less than a turn, but at rest
    expect([stage.left, stage.right, stage.homeFrom, stage.homeTo, stage.highest]).toEqual(
      before.map((place) => (place ?? Number.NaN) - 10),
    );
  });

  it("does not take speed for a new counting", () => {
    const stage = new ObservedStage();
    stage.look(looked(0, 0, 0, 0, 2000));
    stage.look(looked(20, 0, 1, 0, 2000));
    expect([stage.right, stage.highest]).toEqual([10, 20]);
  });

  it("takes what is missing for missing", () => {
    const stage = new ObservedStage();
    stage.look(looked(Number.NaN, 1, 0, 0));
    stage.look(looked(10, 0, Number.NaN, 0));
    stage.look(looked(12, 0, 1, 0));
    stage.look(looked(14, Number.NaN, 1, 0));
    expect([stage.left, stage.right, stage.lowest, stage.highest]).toEqual([null, null, 10, 14]);
  });
});
