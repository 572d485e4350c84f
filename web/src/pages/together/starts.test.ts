import { describe, expect, it } from "vitest";
import { about } from "../../../test/catalog";
import {
  beside,
  type LinePath,
  type LinePlan,
  lineOf,
  lineText,
  movesOf,
  NO_WISH,
  netText,
  pathOf,
  rowsOf,
  skewText,
  withoutVia,
  withVia,
} from "./starts";

const axes = (...names: string[]) => names.map((name, index) => ({ index, name }));
const device = (id: string, model: string, names: string[], state = "connected") =>
  ({ id, name: id, state, axes: axes(...names), about: about(model) }) as unknown as Parameters<typeof rowsOf>[0][0];

const ROWS = rowsOf([device("bench", "tmc428", ["X", "Y", ""]), device("slide", "tmc4361", ["0"])]);

describe("moves that start together", () => {
  it("offers each axis that moves a motor", () => {
    expect(ROWS.map(({ key, title }) => [key, title])).toEqual([
      ["bench/0", "bench X"],
      ["bench/1", "bench Y"],
      ["bench/2", "bench axis 2"],
      ["slide/0", "slide"],
    ]);
    expect(rowsOf([device("driver", "tmc2130", ["M"]), device("off", "tmc4361", ["X"], "disconnected")])).toEqual([]);
  });

  it("names no axis twice", () => {
    const titled = (name: string) => rowsOf([device("slider", "tmc4361", [name])]).map(({ title }) => title);
    expect(titled("slider")).toEqual(["slider"]);
    expect(titled("axis 0")).toEqual(["slider"]);
    expect(titled("X")).toEqual(["slider X"]);
  });

  it("asks for a target of each that is chosen", () => {
    expect(movesOf(ROWS, {}, false)).toBeNull();
    const one = { "bench/0": { chosen: true, target: 100 }, "slide/0": { chosen: false, target: 5 } };
    expect(movesOf(ROWS, one, true)).toEqual([
      { device: "bench", axis: 0, target: 100, relative: true, unit: "microsteps" },
    ]);
    expect(movesOf(ROWS, { ...one, "slide/0": { chosen: true, target: null } }, false)).toBeNull();
  });

  it("makes a line of positions, not of distances", () => {
    const moves = movesOf(ROWS, { "bench/0": { chosen: true, target: 100 } }, false);
    const wish = { ...NO_WISH, pacePercent: 50, legS: 2 };
    const axes = [{ device: "bench", axis: 0 }];
    expect(lineOf(moves, false, wish)).toEqual({ axes, points: [[100]], pace: 0.5, duration_s: 2 });
    expect(lineOf(moves, true, wish)).toBeNull();
    expect(lineOf(null, false, wish)).toBeNull();
  });

  it("goes by points on the way, as long as they are of its axes", () => {
    const to = (key: string, target: number) => movesOf(ROWS, { [key]: { chosen: true, target } }, false);
    const line = (moves: ReturnType<typeof to>, wish = NO_WISH) => lineOf(moves, false, wish) ?? expect.fail();
    const one = withVia(line(to("bench/0", 100)), NO_WISH);
    const two = withVia(line(to("bench/0", 50), one), one);
    expect(line(to("bench/0", 0), two).points).toEqual([[100], [50], [0]]);
    expect(line(to("bench/0", 0), withoutVia(two, 0)).points).toEqual([[50], [0]]);
    expect(line(to("bench/1", 7), two).points).toEqual([[7]]);
  });

  it("makes one path of all legs", () => {
    const leg = (position: number[]) => ({ duration_s: 2, arrival_spread_s: 0, time_s: [0, 2], axes: [{ position }] });
    const plan = { duration_s: 4, legs: [leg([0, 10]), leg([10, 5])] } as unknown as Parameters<typeof pathOf>[0];
    expect(pathOf(plan)).toEqual({ timeS: [0, 2, 2, 4], positions: [[0, 10, 10, 5]] });
  });

  it("puts what was seen beside the plan, each sample at its own time, each leg where it was planned to begin", () => {
    const axis = (device: string, position: number[]) => ({ device, axis: 0, position });
    const leg = (a: number[], b: number[]) => ({ duration_s: 2, time_s: [0, 2], axes: [axis("a", a), axis("b", b)] });
    const plan = { duration_s: 4, legs: [leg([0, 10], [0, 4]), leg([10, 0], [4, 4])] } as unknown as LinePlan;
    const path = {
      plan,
      legs: [
        {
          axes: [
            { ...axis("a", []), time_s: [1, 2.5], position: [5, null] },
            { ...axis("b", [1]), time_s: [0.5] },
          ],
        },
        { axes: [{ ...axis("a", [4]), time_s: [1.25] }] },
      ],
    } as unknown as LinePath;
    const nothing = Number.NaN;
    expect(beside(plan, path)).toEqual({
      timeS: [0, 0.5, 1, 2, 2.5, 3.25, 4],
      expected: [
        [0, 2.5, 5, 10, 7.5, 3.75, 0],
        [0, 1, 2, 4, 4, 4, 4],
      ],
      measured: [
        [nothing, nothing, 5, nothing, nothing, 4, nothing],
        [nothing, 1, nothing, nothing, nothing, nothing, nothing],
      ],
    });
    expect(beside(plan, undefined).measured).toEqual([Array(3).fill(nothing), Array(3).fill(nothing)]);
  });

  it("says how a line went", () => {
    const state = {
      state: "done",
      leg: 0,
      legs: 1,
      started: null,
      message: "",
      arrivals: [],
      off_line: null,
      off_line_uncertainty: null,
    } as const;
    const arrivals = [0.5, 0.51].map((after_s, axis) => ({ device: "a", axis, after_s, uncertainty_s: 0.01 }));
    expect(lineText({ ...state, arrivals })).toMatch(/^done: there after .*51/);
    expect(lineText({ ...state, state: "aborted", arrivals, message: "a stop" })).toBe("aborted: a stop");
    expect(lineText({ ...state, arrivals: [] })).toBe("done: all were there already");
    expect(lineText(undefined)).toBe("");
    const off = { ...state, arrivals, off_line: 12, off_line_uncertainty: 1.5 };
    expect(lineText(off)).toMatch(/; off the line by 12 ± 1.5 µsteps at the most$/);
  });

  it("tells the skew with how sure it is", () => {
    expect(skewText({ skew_s: 0, uncertainty_s: 0 })).toBe("0 s");
    expect(skewText({ skew_s: 0.0015, uncertainty_s: 0 })).toMatch(/1\.5/);
    expect(skewText({ skew_s: 0.0015, uncertainty_s: 2e-4 })).toMatch(/±/);
  });

  it("says how a net is", () => {
    const net = { net: "a", pins: [], open: null, equal_clocks: true, seen_within_s: 0 };
    expect(netText(net)).toMatch(/same clock/);
    expect(netText({ ...net, open: "no other pin is on it" })).toBe("open: no other pin is on it");
    expect(netText({ ...net, equal_clocks: false, seen_within_s: 5e-6 })).toMatch(/within/);
  });
});
