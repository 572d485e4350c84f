import { describe, expect, it } from "vitest";
import { viewOf } from "./camera";
import { numbersOf, stroboscope } from "./numbers";
import type { TwinLook, TwinState } from "./useTwin";

const NOTHING: TwinLook = {
  time_s: null,
  position: null,
  velocity_pps: null,
  commanded_deg: null,
  measured_deg: null,
  place_commanded: null,
  place_measured: null,
  field_deg: null,
  field_from: null,
  field_share: null,
  load_deg: null,
  load_from: null,
  current_a: null,
  current_b: null,
  switch_left: null,
  switch_right: null,
  switch_home: null,
  slips: null,
};

function state(look: Partial<TwinLook> | null, more: Partial<TwinState> = {}): TwinState {
  return {
    state: "on",
    device: "bench",
    axis: 0,
    name: "X",
    place_unit: "mm",
    channels: ["position", "switch_left"],
    scheme: "light",
    path: "/twin/view/",
    following: "telemetry",
    recording: null,
    recording_time_s: null,
    updates_per_s: 0,
    updates_per_s_max: 30,
    viewers: 1,
    look: look && { ...NOTHING, ...look },
    problem: null,
    ...more,
  };
}

function named(from: TwinState, name: string) {
  const found = numbersOf(from).find((row) => row.name === name);
  if (!found) throw new Error(`no row ${name}`);
  return found;
}

describe("numbers beside the picture", () => {
  it("have their unit and their source", () => {
    const shown = state({ place_commanded: 12.3456, field_deg: 90, field_from: "position", load_deg: -3 });
    expect(named(shown, "carriage, by the counter")).toMatchObject({ value: "12.346 mm", known: true });
    expect(named(shown, "field").note).toContain("not measured");
    expect(named(shown, "load angle").value).toBe("−3.0°");
  });

  it("tell what the device has not apart from what is not known now", () => {
    expect(named(state({}), "carriage, by the counter")).toMatchObject({ value: "–", note: "not known now" });
    expect(named(state({}), "current of coil A").note).toBe("this device does not tell it");
    expect(named(state(null), "lost steps").note).toBe("without an encoder they are not seen");
  });

  it("count lost steps, and keep angles of a shaft within its turn", () => {
    const shown = state({ slips: { lost_full_steps: -8, events: 2, last_s: 1 }, commanded_deg: -725 });
    expect(named(shown, "lost steps")).toMatchObject({ value: "8 full steps", note: "2 slips seen" });
    expect(named(shown, "shaft, by the counter").value).toBe("355.0°");
  });

  it("are of a table where nothing travels", () => {
    expect(named(state({ place_commanded: 45 }, { place_unit: "deg" }), "table, by the counter").value).toBe("45.00°");
  });
});

describe("a picture of a fast motor", () => {
  it("is called a stroboscope only where it is one", () => {
    const turning = { position: 3200, commanded_deg: 360 };
    expect(stroboscope(state({ ...turning, velocity_pps: 3200 }))).toBeNull();
    expect(stroboscope(state({ ...turning, velocity_pps: -40_000 }))).toContain("12.5 turns a second");
    expect(stroboscope(state({}))).toBeNull();
  });
});

describe("the camera", () => {
  it("stays where the server has it in a wide frame", () => {
    expect(viewOf("/twin/view/", "light", 1.6)).toBe("/twin/view/");
    expect(viewOf("/twin/view/", "dark", 1.6)).toBe("/twin/view/?darkMode");
  });

  it("goes further away in a narrow one, on its line", () => {
    const [, position] = /initialCameraPosition=([^&]*)/.exec(viewOf("/twin/view/", "light", 0.6)) ?? [];
    expect(position?.split(",").map(Number)).toEqual([8.55, -32.8, 10]);
  });
});
