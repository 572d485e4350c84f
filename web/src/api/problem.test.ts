import { expect, it } from "vitest";
import { ApiError, problemOf } from "./problem";

it("completes a problem that leaves out what may be left out, as one from a proxy does", () => {
  const said = { type: "/problems/store-unavailable", title: "Not now", status: 503, detail: "the disk is full" };
  const whole = { ...said, way_out: null, facts: {}, remedies: [], instance: null };
  expect(problemOf(said)).toEqual(whole);
  expect(problemOf(new ApiError(problemOf({ ...said, way_out: "make room" })))).toEqual({
    ...whole,
    way_out: "make room",
  });
});

it("calls whatever else failed a server that does not answer", () => {
  expect(problemOf(new TypeError("Failed to fetch"))).toMatchObject({
    status: 0,
    detail: "Failed to fetch",
    remedies: [],
  });
});
