import { describe, expect, it } from "vitest";
import type { Family } from "../lib/family";
import { insteadOf, PAGES, pageAt, pagesFor } from "./pages";

const FAMILIES: readonly Family[] = ["pmul", "sramp", "sixpoint", "module"];
const names = (family: Family | null) => pagesFor(family).map((entry) => entry.label);

describe("pages", () => {
  it("shows each family its own", () => {
    expect(names("module")).toEqual([
      "Bench",
      "Parameters",
      "Encoder",
      "StallGuard",
      "Rotary",
      "3D",
      "Recordings",
      "Profiles",
      "Console",
      "Audit log",
      "Health",
      "Connections",
    ]);
    expect(names("pmul")).toEqual([
      "Bench",
      "Registers",
      "Ramps",
      "Microsteps",
      "Driver chain",
      "Rotary",
      "3D",
      "Recordings",
      "Profiles",
      "Console",
      "Audit log",
      "Health",
      "Connections",
    ]);
    expect(names("sixpoint")).toEqual([
      "Bench",
      "Registers",
      "SixPoint ramp",
      "Currents",
      "Microsteps",
      "Encoder",
      "StallGuard",
      "Rotary",
      "3D",
      "Recordings",
      "Profiles",
      "Console",
      "Audit log",
      "Health",
      "Connections",
    ]);
    for (const own of [
      "Bench",
      "Registers",
      "S-ramp",
      "Closed loop",
      "Input filters",
      "Microsteps",
      "Console",
      "Audit log",
      "Health",
      "Connections",
    ])
      expect(names("sramp")).toContain(own);
    for (const other of ["Ramps", "Driver chain", "Parameters", "Encoder", "StallGuard"])
      expect(names("sramp")).not.toContain(other);
    for (const alone of [
      "Bench",
      "Ramps",
      "S-ramp",
      "SixPoint ramp",
      "Currents",
      "Microsteps",
      "Driver chain",
      "Audit log",
      "Health",
      "Connections",
    ])
      expect(names(null)).toContain(alone);
  });

  it("leads from a page of other families to one that this one has", () => {
    for (const entry of PAGES) {
      if (entry.families.length === 0) continue;
      for (const family of FAMILIES.filter((candidate) => !entry.families.includes(candidate))) {
        const { href, label } = insteadOf(entry, family);
        expect(pagesFor(family)).toContain(pageAt(href));
        expect(label).toBe(pageAt(href)?.label);
      }
    }
  });
});
