import { describe, expect, it } from "vitest";
import { PAGES, pageAt, pagesFor } from "./pages";

const names = (family: "chip" | "module" | null) => pagesFor(family).map((entry) => entry.label);

describe("pages", () => {
  it("shows each family its own", () => {
    expect(names("module")).toEqual(["Bench", "Parameters", "Encoder", "StallGuard", "Console", "Connections"]);
    expect(names("chip")).toEqual([
      "Bench",
      "Registers",
      "Ramps",
      "Microsteps",
      "Driver chain",
      "Console",
      "Connections",
    ]);
    expect(names(null)).toEqual(["Bench", "Ramps", "Microsteps", "Driver chain", "Connections"]);
  });

  it("leads from a page of one family to one that the other has", () => {
    for (const entry of PAGES) {
      if (entry.family === null) continue;
      const instead = pageAt(entry.instead);
      expect(instead?.family ?? null).not.toBe(entry.family);
    }
  });
});
