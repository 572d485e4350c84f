import { describe, expect, it } from "vitest";
import { about } from "../../../test/catalog";
import { scaleOf } from "../../lib/units";
import { createBody, newDraft, problemsOf } from "./draft";
import { inMechanics, limitDraftOf, limited, limitProblems, limitsOf, NO_LIMITS, partsOf } from "./softLimits";

const LIMITS = {
  position_min: -3200,
  position_max: 6400,
  velocity_max_pps: 1600,
  acceleration_max_pps2: null,
  current_max_a: null,
  sense_resistor_ohm: null,
  current_full_scale_a: null,
};

describe("soft limits of an axis", () => {
  it("come back as they were, so that saving another field takes none away", () => {
    expect(limitsOf(limitDraftOf(LIMITS))).toEqual(LIMITS);
    expect(limitDraftOf(undefined)).toEqual(NO_LIMITS);
    expect(limited(NO_LIMITS)).toBe(false);
    expect(limited(limitDraftOf(LIMITS))).toBe(true);
    const draft = newDraft(about("tmc428"));
    expect(createBody(draft).axes[0]?.limits).toMatchObject({ position_min: null, velocity_max_pps: null });
  });

  it("ask for what makes amperes of the model's scales, and for nothing that it cannot keep", () => {
    const shown = (name: string) => partsOf(about(name)).map(({ part }) => part);
    expect(shown("tmc5160")).toContain("senseOhm");
    expect(shown("tmc428")).toContain("fullScaleA");
    expect(shown("tmc4210")).not.toContain("current");
    const current = { ...NO_LIMITS, current: "1.2" };
    expect(limitProblems(current, about("tmc5160")).map(([part]) => part)).toEqual(["senseOhm"]);
    expect(limitProblems({ ...current, senseOhm: "0.11" }, about("tmc5160"))).toEqual([]);
  });

  it.each([
    [{ positionMin: "10", positionMax: "5" }, "positionMax"],
    [{ positionMin: "1.5" }, "positionMin"],
    [{ velocity: "0" }, "velocity"],
    [{ acceleration: "fast" }, "acceleration"],
  ])("refuse %o before it is sent", (typed, part) => {
    const draft = { ...newDraft(about("tmc428")), name: "bench" };
    draft.axes = draft.axes.map((axis, index) =>
      index === 1 ? { ...axis, limits: { ...NO_LIMITS, ...typed } } : axis,
    );
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
    expect(inMechanics(limitDraftOf(LIMITS), scale(8))).toMatch(/^from −8.mm, to 16.mm, at most 4.mm\/s$/);
    expect(inMechanics(limitDraftOf(LIMITS), scale(null))).toMatch(/^from −360°, to 720°, at most 30.rpm$/);
    expect(inMechanics(limitDraftOf(LIMITS), undefined)).toBe("");
    expect(inMechanics(NO_LIMITS, scale(8))).toBe("");
  });
});
