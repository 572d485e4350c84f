import { describe, expect, it } from "vitest";
import { EdgeTrail } from "./edges";

function look(timeS: number, position: number, home: number, left = 0) {
  return { timeS, position, speed: 20, left, right: 0, home };
}

describe("the edges of a search", () => {
  it("are told with switch, direction and place, in their order", () => {
    const trail = new EdgeTrail();
    trail.begin(0);
    trail.look(look(1, 0, 0));
    trail.look(look(2, 10, 1));
    trail.look(look(2, 999, 0)); // no new sample
    trail.look(look(3, 20, 1, 1));
    trail.look(look(4, Number.NaN, 0));
    trail.look(look(5, 40, 0, 1));
    expect(trail.edges).toEqual([
      { which: "home", closed: true, at: 5 },
      { which: "left", closed: true, at: 15 },
      { which: "home", closed: false, at: 30 },
    ]);
  });

  it("stay where they are when the counter is zeroed, and go when another search begins", () => {
    const trail = new EdgeTrail();
    trail.begin(0);
    trail.look(look(1, 0, 0));
    trail.look(look(2, 10, 1));
    trail.finish(100);
    trail.look(look(3, -90, 1));
    expect(trail.edges).toEqual([{ which: "home", closed: true, at: -95 }]);
    expect(trail.finishing).toBe(false);
    trail.begin(0);
    expect(trail.edges).toEqual([]);
  });

  it("count that are in samples which come after the answer that the search is done", () => {
    const trail = new EdgeTrail();
    trail.begin(0);
    trail.look(look(1, 480, 0));
    trail.finish(500);
    trail.look(look(1.5, 500, 1));
    trail.look(look(1.6, 0, 1, 1)); // an edge on the way over which the counter was set anew
    expect(trail.edges).toEqual([
      { which: "home", closed: true, at: -10 },
      { which: "left", closed: true, at: 0 },
    ]);
  });

  it("are not made up where the counter is zeroed before that is told", () => {
    const trail = new EdgeTrail();
    trail.begin(0);
    trail.look(look(1, 500, 0));
    trail.look(look(2, 500, 1));
    trail.look(look(3, 0, 1));
    trail.finish(500);
    expect(trail.finishing).toBe(true);
    trail.look(look(4.1, 0, 1));
    expect(trail.edges).toEqual([{ which: "home", closed: true, at: 0 }]);
    expect(trail.finishing).toBe(false);
  });

  it("take an unknown switch for no edge", () => {
    const trail = new EdgeTrail();
    trail.begin(0);
    trail.look(look(1, 0, Number.NaN));
    trail.look(look(2, 1, 1));
    expect(trail.edges).toEqual([]);
  });
});
