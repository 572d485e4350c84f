import { expect, test } from "vitest";
import { BENCH } from "./benchLayout";
import { readScope, withScope } from "./scopeKept";

const FREE = [{ id: "a", kind: "xy", y: ["$:position", "$:velocity"] }];

test("a save puts what the scope shows into its panel, and nowhere else", () => {
  localStorage.setItem("stepscope.scope", JSON.stringify({ spanS: 5, rows: ["velocity"], free: FREE, unit: "mm" }));
  const kept = withScope(BENCH);
  expect(kept.panels.scope?.config).toEqual({ scope: { spanS: 5, rows: ["velocity"], free: FREE } });
  expect(kept.panels.motion).toEqual(BENCH.panels.motion);
  expect(BENCH.panels.scope?.config).toEqual({});
  localStorage.setItem("stepscope.scope", "no JSON");
  expect(withScope(BENCH).panels.scope?.config).toEqual({ scope: {} });
});

test("what a file says is taken as far as it can be a setting", () => {
  expect(readScope({ spanS: 7, rateHz: 100, rows: ["position", "colour"], hidden: [1], marks: true, else: 1 })).toEqual(
    {
      rateHz: 100,
      marks: true,
    },
  );
  expect(
    readScope({ free: [...FREE, { id: 1 }], derived: { slip: { formula: "a - b", inputs: { a: "$:x" } } } }),
  ).toEqual({
    derived: { slip: { formula: "a - b", inputs: { a: "$:x" } } },
  });
  const extras = [{ device: "bench", axis: 2 }];
  expect(readScope({ extras, marks: true })).toEqual({ extras, marks: true });
  expect(readScope({ extras: [...extras, { device: "bench" }] })).toEqual({});
  expect(readScope(null)).toEqual({});
});
