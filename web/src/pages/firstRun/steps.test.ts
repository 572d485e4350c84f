import { expect, test } from "vitest";
import type { Device } from "../../api/queries";
import { after, BEGIN, before, done, stepsFor } from "./steps";

const device = (...capabilities: string[]) => ({ about: { capabilities } }) as unknown as Device;
const ids = (...capabilities: string[]) => stepsFor(device(...capabilities)).map(({ id }) => id);

test("limits and currents come before any motion", () => {
  const steps = ids("motion");
  expect(steps.indexOf("limits")).toBeLessThan(steps.indexOf("setUp"));
  expect(steps.indexOf("setUp")).toBeLessThan(steps.indexOf("turn"));
  expect(steps.indexOf("turn")).toBeLessThan(steps.indexOf("switches"));
});

test("the encoder is looked at where a study can", () => {
  expect(ids("motion")).not.toContain("encoder");
  expect(ids("motion", "encoder")).toContain("encoder");
  expect(ids("motion", "encoder", "parameters")).not.toContain("encoder");
});

test("one step leads to the next, the last to itself, and what is done stays so", () => {
  const steps = stepsFor(device("motion"));
  expect(after(steps, "motor")).toBe("limits");
  expect(after(steps, "turn")).toBe("switches");
  expect(before(steps, "switches")).toBe("turn");
  expect(before(steps, "motor")).toBe("motor");
  expect(after(steps, "keep")).toBe("keep");
  const first = done(BEGIN, steps, "motor");
  expect(first).toMatchObject({ at: "limits", done: ["motor"] });
  expect(done({ ...first, at: "motor" }, steps, "motor").done).toEqual(["motor"]);
});
