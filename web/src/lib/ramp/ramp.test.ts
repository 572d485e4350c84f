import { describe, expect, it } from "vitest";
import { CalmFrame, withHandles } from "./CalmFrame";
import { dragged, stepped, tidy } from "./handles";
import { MOTOR, marginText, motorBody } from "./motor";
import { channelsOf, firstOf, mirrored, thinned } from "./overlay";
import { share } from "./rivals";
import { engineering, unitChoices, unitsOf } from "./scales";

describe("dragging", () => {
  it("follows the pointer by the scale that it began with", () => {
    expect(dragged(1000, 1, 30, 10, 0.25)).toBe(1300);
    expect(dragged(1000, -1, 30, 10, 0.25)).toBe(700);
    expect(dragged(1000, 1, -500, 10, 0.25)).toBe(0);
  });

  it("gives the roundest value within a pixel, on the register's grid", () => {
    expect(tidy(12_345.6, 137, 1)).toBe(12_300);
    expect(tidy(0.4567, 0.001, 0.00390625) % 0.00390625).toBeCloseTo(0);
    expect(tidy(5000, 1, 1862.645)).toBeCloseTo(3 * 1862.645);
  });

  it("goes by keys: a hundredth, with Shift a tenth, up being up on the plot", () => {
    const limits = { least: 1, most: 1e6, step: 1 };
    expect(stepped("ArrowUp", false, 1000, 1, limits)).toBe(1010);
    expect(stepped("ArrowUp", false, 1000, -1, limits)).toBe(990);
    expect(stepped("ArrowRight", true, 1000, -1, limits)).toBe(1100);
    expect(stepped("ArrowDown", false, 1, 1, limits)).toBe(1);
    expect(stepped("End", false, 1000, 1, limits)).toBe(1e6);
    expect(stepped("a", false, 1000, 1, limits)).toBeNull();
    expect(stepped("ArrowUp", false, 0, 1, { ...limits, least: 0 })).toBeGreaterThan(0);
    expect(stepped("ArrowUp", false, 999_999, 1, limits)).toBe(1e6);
  });
});

describe("the range of a plot with handles", () => {
  it("shows a limit that is not reached, but not one far away", () => {
    expect(withHandles(0, 100, [150])).toEqual([0, 150]);
    expect(withHandles(-100, 100, [-120, 5000])).toEqual([-120, 100]);
  });

  it("does not shrink under the hand", () => {
    const frame = new CalmFrame(true);
    const first = frame.next(-100, 100);
    expect(first[0]).toBe(-first[1]);
    frame.held = true;
    expect(frame.next(-10, 10)).toEqual(first);
    expect(frame.next(-10, 400)[1]).toBeGreaterThan(400);
    frame.held = false;
    expect(frame.next(-10, 10)[1]).toBeLessThan(20);
  });
});

describe("the motor", () => {
  it("goes along in the units of the calculator, on this axis", () => {
    const axis = { fullStepsPerRev: 400, microstepsPerFullStep: 16 };
    expect(motorBody(MOTOR, axis)).toMatchObject({
      inductance_h: 0.0044,
      full_steps_per_rev: 400,
      microsteps_per_full_step: 16,
    });
    expect(motorBody(MOTOR, axis)?.inertia_kgm2).toBeCloseTo(2e-4);
    expect(motorBody({ ...MOTOR, shown: false }, axis)).toBeNull();
  });
  it("has its margin in words", () => {
    expect(marginText(0.384)).toBe("38\u202f% of the torque left");
    expect(marginText(-0.2)).toBe("20\u202f% too little torque");
  });
});

describe("the live motion", () => {
  it("asks for what the device offers", () => {
    const channels = ["velocity.0", "acceleration.0", "velocity.1", "mscnt.0"].map((name) => ({ name }));
    const device = { channels } as Parameters<typeof channelsOf>[0];
    expect(channelsOf(device, 0, ["velocity", "acceleration"])).toEqual(["velocity.0", "acceleration.0"]);
    expect(channelsOf(device, 1, ["position", "velocity"])).toEqual(["velocity.1"]);
  });
  it("shows some of many samples, the ends among them", () => {
    expect(thinned(3, 90)).toEqual([0, 1, 2]);
    const rows = thinned(1000, 5);
    expect([rows.length, rows[0], rows[4]]).toEqual([5, 0, 999]);
  });
  it("is mirrored on the way back", () => {
    expect(mirrored([-1, Number.NaN, -2], 1)).toBe(true);
    expect(mirrored([-1, -2], -1)).toBe(false);
  });
  it("begins where the motor stood", () => {
    expect(firstOf([Number.NaN, 7, 9])).toBe(7);
    expect(firstOf([Number.NaN])).toBe(0);
  });
});

describe("scales", () => {
  const scale = {
    fullStepsPerRev: 200,
    microstepsPerFullStep: 256,
    gearRatio: 1,
    travelMmPerRev: null,
    pulseDiv: null,
    rampDiv: null,
    clockHz: 16e6,
  };
  it("offer the units that the axis knows", () => {
    expect(unitChoices(scale).map((units) => units.key)).toEqual(["pps", "fullsteps", "rev", "rpm", "deg"]);
    expect(unitsOf("mm", scale).key).toBe("pps");
    expect(unitsOf("mm", { ...scale, travelMmPerRev: 8 }).jerk).toBe("mm_per_s3");
    expect(unitChoices({ ...scale, microstepsPerFullStep: null }).map((units) => units.key)).toEqual(["pps"]);
  });
  it("write large ticks short", () => {
    expect(engineering([-2_500_000, 0, 2_500_000])).toEqual(["−2.5\u202fM", "0", "2.5\u202fM"]);
    expect(engineering([0, 10, 20.5])).toEqual(["0", "10", "20.5"]);
  });
});

describe("rivals", () => {
  it("are saved time of, by their own time", () => {
    expect(share(-0.1, 0.5)).toBeCloseTo(-0.2);
    expect(share(1, 0)).toBe(0);
  });
});
