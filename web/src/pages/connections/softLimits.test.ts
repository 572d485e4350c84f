import { describe, expect, it } from "vitest";
import { about } from "../../../test/catalog";
import { scaleOf } from "../../lib/units";
import { createBody, newDraft, problemsOf } from "./draft";
import { AXIS_FIELDS, axisForm, complete, fieldsOf, problemsIn, type Values, valuesIn } from "./form";
import { inMechanics } from "./mechanics";

const LIMITS = {
  position_min: -3200,
  position_max: 6400,
  velocity_max_pps: 1600,
  acceleration_max_pps2: null,
  current_max_a: null,
  sense_resistor_ohm: null,
  current_full_scale_a: null,
};

const typedOf = (limits: object): Values => valuesIn({ limits }, AXIS_FIELDS);

describe("soft limits of an axis", () => {
  it("come back as they were, so that saving another field takes none away", () => {
    expect(complete(AXIS_FIELDS, typedOf(LIMITS)).limits).toEqual(LIMITS);
    expect(Object.values(valuesIn({}, AXIS_FIELDS)).every((text) => text === "")).toBe(true);
    const draft = newDraft(about("tmc428"));
    expect(createBody(draft).axes[0]?.limits).toMatchObject({ position_min: null, velocity_max_pps: null });
  });

  it("ask for what makes amperes of the model's scales, and for nothing that it cannot keep", () => {
    const shown = (name: string) => fieldsOf(axisForm(about(name))).map(({ path }) => path);
    expect(shown("tmc5160")).toContain("limits.sense_resistor_ohm");
    expect(shown("tmc428")).toContain("limits.current_full_scale_a");
    expect(shown("tmc4210")).not.toContain("limits.current_max_a");
    const current = { name: "X", "limits.current_max_a": "1.2" };
    const problems = (values: Values) => problemsIn(fieldsOf(axisForm(about("tmc5160"))), values);
    expect(problems(current).map(([path]) => path)).toEqual(["limits.sense_resistor_ohm"]);
    expect(problems({ ...current, "limits.sense_resistor_ohm": "0.11" })).toEqual([]);
  });

  it.each([
    [{ "limits.position_min": "10", "limits.position_max": "5" }, "position_max"],
    [{ "limits.position_min": "1.5" }, "position_min"],
    [{ "limits.velocity_max_pps": "0" }, "velocity_max_pps"],
    [{ "limits.acceleration_max_pps2": "fast" }, "acceleration_max_pps2"],
  ])("refuse %o before it is sent", (typed, part) => {
    const draft = { ...newDraft(about("tmc428")), name: "bench" };
    draft.axes = draft.axes.map((axis, index) => (index === 1 ? { ...axis, ...typed } : axis));
    expect(Object.keys(problemsOf(draft))).toEqual([`axes.1.limits.${part}`]);
  });

  it("are shown in millimetres or degrees where the axis is known", () => {
    const axis = {
      full_steps_per_rev: 200,
      gear_ratio: 1,
      microsteps_per_full_step: 16,
      pulse_div: null,
      ramp_div: null,
    };
    const scale = (travel: number | null) => scaleOf({ ...axis, travel_mm_per_rev: travel } as never, 16e6);
    expect(inMechanics(typedOf(LIMITS), scale(8))).toMatch(/^from −8.mm, to 16.mm, at most 4.mm\/s$/);
    expect(inMechanics(typedOf(LIMITS), scale(null))).toMatch(/^from −360°, to 720°, at most 30.rpm$/);
    expect(inMechanics(typedOf(LIMITS), undefined)).toBe("");
    expect(inMechanics({}, scale(8))).toBe("");
  });
});
