import { describe, expect, it } from "vitest";
import { ROWS } from "./rows";
import { settingsOf, textsOf } from "./settings";

const AT_FIRST = { t: "", rows: "", unit: "" };

describe("what the scope shows, in the address", () => {
  it("is not written as it is at first, in whatever order plots were switched on", () => {
    const rows = ["position", "residual", "deviation", "velocity", "acceleration", "load", "switches"] as const;
    expect(textsOf({ spanS: 10, rows: [...rows].reverse(), unit: "microsteps" })).toEqual(AT_FIRST);
    expect(settingsOf(AT_FIRST)).toEqual({});
  });

  it("comes back", () => {
    const some = { spanS: 0.5, rows: ROWS.slice(2, 4).map(({ id }) => id), unit: "mm" } as const;
    expect(settingsOf(textsOf({ ...some, rows: [...some.rows] }))).toEqual(some);
    expect(settingsOf(textsOf({ spanS: 10, rows: [], unit: "microsteps" }))).toEqual({ rows: [] });
  });

  it("is left as it was by nonsense", () => {
    expect(settingsOf({ t: "-7s", rows: "engine", unit: "" })).toEqual({});
  });
});
