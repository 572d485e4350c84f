import { describe, expect, it } from "vitest";
import { dayText } from "../../lib/time";
import { csvHref, type Entry, EVERYTHING, isFiltered, queryOf } from "./filters";
import { hasFields, outcomeOf, valueText } from "./words";

const ENTRY: Entry = {
  id: 7,
  time: "2026-11-21T21:57:58.8Z",
  who: "Ann",
  kind: "browser",
  address: "127.0.0.1",
  device: "bench",
  axis: 0,
  action: "write",
  subject: "v_max",
  old: 1311,
  new: 1500,
  outcome: "done",
  detail: "",
  call: null,
};

describe("what is asked for", () => {
  const now = new Date("2026-11-21T12:34:56.789Z");

  it("leaves out what is not wanted", () => {
    expect(queryOf(EVERYTHING, now)).toEqual({});
    expect(isFiltered(EVERYTHING)).toBe(false);
    expect(isFiltered({ ...EVERYTHING, text: "  " })).toBe(false);
    expect(isFiltered({ ...EVERYTHING, span: "between" })).toBe(false);
    expect(isFiltered({ ...EVERYTHING, who: "Ann" })).toBe(true);
  });

  it("is the same question for a whole minute", () => {
    const hour = { ...EVERYTHING, span: "hour" as const };
    expect(queryOf(hour, now)).toEqual({ since: "2026-11-21T11:34:00.000Z" });
    expect(queryOf(hour, new Date("2026-11-21T12:34:00.001Z"))).toEqual(queryOf(hour, now));
  });

  it("takes times as the browser's fields give them", () => {
    const between = { ...EVERYTHING, span: "between" as const, from: "2026-11-21T10:00", to: "nonsense" };
    expect(queryOf(between, now)).toEqual({ since: new Date("2026-11-21T10:00").toISOString() });
  });

  it("asks for a file by the same words", () => {
    expect(csvHref({ q: "v max&x", device: "a" })).toBe("/api/v1/audit?q=v+max%26x&device=a&format=csv");
  });
});

describe("words", () => {
  it("tells what came of it", () => {
    expect(outcomeOf(ENTRY)).toEqual({ kind: "done", why: "" });
    expect(outcomeOf({ ...ENTRY, outcome: "done: clipped" })).toEqual({ kind: "done", why: "clipped" });
    expect(outcomeOf({ ...ENTRY, outcome: "refused: v_max is 9: too much" })).toEqual({
      kind: "refused",
      why: "v_max is 9: too much",
    });
    expect(outcomeOf({ ...ENTRY, outcome: "not proven: no reply" }).kind).toBe("not proven");
  });

  it("writes values as people do", () => {
    expect(valueText(-1311000)).toBe("−1\u202f311\u202f000");
    expect(valueText(0.25)).toBe("0.25");
    expect(valueText("COM3")).toBe("COM3");
    expect(valueText(null)).toBe("");
  });

  it("knows fields of a register", () => {
    expect(hasFields({ ...ENTRY, detail: "toff 3 -> 4" })).toBe(true);
    expect(hasFields({ ...ENTRY, detail: "pps" })).toBe(false);
    expect(hasFields({ ...ENTRY, action: "edit device", detail: "a -> b" })).toBe(false);
  });

  it("names days", () => {
    const now = new Date(2026, 10, 21, 0, 5);
    expect(dayText(new Date(2026, 10, 21, 0, 1).toISOString(), now)).toBe("Today");
    expect(dayText(new Date(2026, 10, 20, 23, 59).toISOString(), now)).toBe("Yesterday");
    expect(dayText(new Date(2026, 10, 2, 12).toISOString(), now)).toBe("Monday 2026-11-02");
    expect(dayText(new Date(2025, 10, 2, 12).toISOString(), now)).toBe("Sunday 2025-11-02");
  });
});
