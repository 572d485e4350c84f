import { expect, test } from "vitest";
import type { Device } from "../../api/queries";
import { after, BEGIN, before, done, encoderLook, STEPS, turnsBy } from "./steps";

const device = (...capabilities: string[]) => ({ about: { capabilities } }) as unknown as Device;
const place = (wanted: string) => STEPS.findIndex(({ id }) => id === wanted);

test("current and limits come before any motion, limits behind the microsteps that they are counted in", () => {
  expect(place("setUp")).toBeLessThan(place("limits"));
  expect(place("limits")).toBeLessThan(place("turn"));
  expect(place("turn")).toBeLessThan(place("switches"));
});

test("a motor turns to a position, at a velocity, or as it is stepped", () => {
  expect(turnsBy(device("motion"))).toBe("position");
  expect(turnsBy(device("motion", "step_input", "own_velocity"))).toBe("velocity");
  expect(turnsBy(device("motion", "step_input"))).toBe("steps from outside");
});

test("the encoder is looked at by who can", () => {
  expect(encoderLook(device("motion"))).toBe("none");
  expect(encoderLook(device("motion", "encoder"))).toBe("study");
  expect(encoderLook(device("motion", "encoder", "parameters"))).toBe("condition");
});

test("one step leads to the next, the last to itself, and what is done stays so", () => {
  expect(after("motor")).toBe("setUp");
  expect(before("switches")).toBe("encoder");
  expect(before("link")).toBe("link");
  expect(after("keep")).toBe("keep");
  expect(done(BEGIN, "link")).toMatchObject({ at: "motor", done: ["link"] });
  const first = done({ ...BEGIN, at: "motor" }, "motor");
  expect(first).toMatchObject({ at: "setUp", done: ["motor"] });
  expect(done({ ...first, at: "motor" }, "motor").done).toEqual(["motor"]);
});
