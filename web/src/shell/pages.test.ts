import { describe, expect, it } from "vitest";
import { about } from "../../test/catalog";
import { insteadOf, isFor, PAGES, pagesFor } from "./pages";

const ABILITIES = {
  pmul: about("tmc428").capabilities,
  sramp: about("tmc4361").capabilities,
  sixpoint: about("tmc5160").capabilities,
  module: about("pd42-1241").capabilities,
};
const names = (family: keyof typeof ABILITIES | null) =>
  pagesFor(family && ABILITIES[family]).map((entry) => entry.label);

describe("pages", () => {
  it("shows each family its own", () => {
    expect(names("module")).toEqual([
      "Bench",
      "Parameters",
      "SixPoint ramp",
      "Currents",
      "Encoder",
      "StallGuard",
      "Rotary",
      "3D",
      "Program",
      "Tune",
      "Together",
      "Recordings",
      "Profiles",
      "Console",
      "Audit log",
      "Health",
      "First run",
      "Connections",
    ]);
    expect(names("pmul")).toEqual([
      "Bench",
      "Registers",
      "Ramps",
      "Velocity profile",
      "Microsteps",
      "Driver chain",
      "Rotary",
      "3D",
      "Tune",
      "Together",
      "Recordings",
      "Profiles",
      "Console",
      "Audit log",
      "Health",
      "First run",
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
      "Tune",
      "Together",
      "Recordings",
      "Profiles",
      "Console",
      "Audit log",
      "Health",
      "First run",
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
      "First run",
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
    for (const entry of PAGES)
      for (const abilities of Object.values(ABILITIES).filter((candidate) => !isFor(entry, candidate)))
        expect(pagesFor(abilities)).toContain(insteadOf(entry, abilities));
  });

  it("lead to the page of the same topic, where the device has one", () => {
    const from = (path: string, family: keyof typeof ABILITIES) => {
      const entry = PAGES.find((candidate) => candidate.path === path);
      return entry && insteadOf(entry, ABILITIES[family])?.path;
    };
    expect(from("/ramps", "sramp")).toBe("/sramp");
    expect(from("/ramps", "sixpoint")).toBe("/sixpoint");
    expect(from("/sramp", "module")).toBe("/sixpoint");
    expect(from("/closed-loop", "sixpoint")).toBe("/encoder");
    expect(from("/closed-loop", "pmul")).toBe("/registers");
    expect(from("/encoder", "sramp")).toBe("/closed-loop");
    expect(from("/chain", "module")).toBe("/parameters");
  });
});
