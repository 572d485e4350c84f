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
    trail.end(100);
    expect(trail.edges[0]?.at).toBe(-95);
    trail.look(look(3, -95, 0)); // the first sample of the new counting is compared with none of the old
    expect(trail.edges).toHaveLength(1);
    trail.begin(0);
    expect(trail.edges).toEqual([]);
  });

  it("are not made up where the counter is zeroed before that is told", () => {
    const trail = new EdgeTrail();
    trail.begin(0);
    trail.look(look(1, 500, 0));
    trail.look(look(2, 500, 1));
    trail.look(look(3, 0, 1));
    trail.end(500);
    expect(trail.edges).toEqual([{ which: "home", closed: true, at: 0 }]);
    expect(trail.lookedAtS).toBe(3);
  });

  it("take an unknown switch for no edge", () => {
    const trail = new EdgeTrail();
    trail.begin(0);
    trail.look(look(1, 0, Number.NaN));
    trail.look(look(2, 1, 1));
    expect(trail.edges).toEqual([]);
  });
});
