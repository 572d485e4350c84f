import { describe, expect, it } from "vitest";
import type { Device } from "../api/queries";
import { choicesOf, namesOf } from "./choices";

function device(id: string, name: string, axes: string[]): Device {
  return { id, name, title: "TMC5072", axes: axes.map((axis, index) => ({ index, name: axis })) } as unknown as Device;
}

describe("the choice of an axis", () => {
  it("has a group a device, with its axes", () => {
    expect(choicesOf([device("bench", "bench", ["X", "Y"])])).toEqual([
      {
        group: "bench · TMC5072",
        items: [
          { value: "bench/0", label: "bench · X" },
          { value: "bench/1", label: "bench · Y" },
        ],
      },
    ]);
  });

  it("has an entry for a device without axes", () => {
    expect(choicesOf([device("chip", "chip", [])])[0]?.items).toEqual([
      { value: "chip/0", label: "chip · registers only" },
    ]);
  });

  it("tells two devices of one name apart, for React and for people", () => {
    const both = [device("bench", "bench", ["X"]), device("bench-2", "bench", ["X"]), device("far", "far", ["X"])];
    const groups = choicesOf(both);
    expect(groups.map(({ group }) => group)).toEqual([
      "bench (bench) · TMC5072",
      "bench (bench-2) · TMC5072",
      "far · TMC5072",
    ]);
    expect(new Set(groups.flatMap(({ items }) => items.map(({ label }) => label))).size).toBe(3);
    expect(namesOf(both).get("bench-2")).toBe("bench (bench-2)");
  });
});
