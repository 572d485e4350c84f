import { describe, expect, it } from "vitest";
import { readBackNotes, spoken } from "./staged";

describe("what came back", () => {
  it("is told where it is not what was asked", () => {
    const asked = new Map([
      ["maximum_encoder_deviation", 5000],
      ["stop_on_stall", 10],
      ["encoder_position", 0],
      ["smartenergy_hysteresis", 3],
    ]);
    const notes = readBackNotes(asked, [
      { name: "maximum_encoder_deviation", value: 5000, verified: true },
      { name: "stop_on_stall", value: 12, verified: false },
      { name: "encoder_position", value: 3, verified: null },
      { name: "smartenergy_hysteresis", value: 3, verified: true, note: "clipped" },
    ]);
    expect(notes).toEqual(["Stop on stall: 10 was asked for, the module holds 12.", "Smartenergy hysteresis: clipped"]);
  });

  it("speaks names as words", () => {
    expect(spoken("stop_on_stall")).toBe("Stop on stall");
  });
});
