import { describe, expect, it } from "vitest";
import {
  alike,
  draftOf,
  FURTHER,
  figuresOf,
  figuresText,
  type MotorDraft,
  NEW_MOTOR,
  NOT_KNOWN,
  nameProblem,
  shifted,
} from "./figures";

const SPINDLE: MotorDraft = {
  name: "Spindle",
  rated_current_a: 1.68,
  full_steps_per_rev: 400,
  resistance_ohm: 1.65,
  inductance_h: 0.00435,
  holding_torque_nm: 0.44,
  rotor_inertia_kgm2: 6.8e-6,
};

/** Numbers as data sheets print them, the same in every run. */
function* printed(count: number): Generator<number> {
  let seed = 1;
  const next = (below: number) => {
    seed = (seed * 48_271) % 2_147_483_647;
    return seed % below;
  };
  for (let at = 0; at < count; at++) yield Number(`${1 + next(10 ** (1 + next(8)))}e${next(12) - 7}`);
}

describe("a motor of one's own", () => {
  it("is sent in SI units exactly as it was typed, and shown as it was sent", () => {
    const powersOf = (key: string) => FURTHER.find((each) => each.key === key)?.powers ?? 0;
    // 4.1 / 1000 is 0.0040999999999999995, and 0.00397 * 1000 is 3.9700000000000006
    expect(shifted(4.1, -powersOf("inductance_h"))).toBe(0.0041);
    expect(shifted(0.00397, powersOf("inductance_h"))).toBe(3.97);
    expect(shifted(1.9, -powersOf("rotor_inertia_kgm2"))).toBe(1.9e-7);
    expect(shifted(68, -powersOf("rotor_inertia_kgm2"))).toBe(6.8e-6);
    expect(shifted(1.65, -powersOf("resistance_ohm"))).toBe(1.65);
    for (const typed of printed(500))
      expect(FURTHER.map(({ powers }) => shifted(shifted(typed, -powers), powers))).toEqual(FURTHER.map(() => typed));
  });

  it("tells null, and no 0, for what stays empty, and is none without its current", () => {
    expect(figuresOf(NEW_MOTOR)).toBeNull();
    expect(figuresOf({ ...NEW_MOTOR, name: "Spindle", rated_current_a: 1.2 })).toEqual({
      rated_current_a: 1.2,
      full_steps_per_rev: 200,
      resistance_ohm: null,
      inductance_h: null,
      holding_torque_nm: null,
      rotor_inertia_kgm2: null,
    });
  });

  it("is edited as it is kept, without where it is from", () => {
    const { name, ...figures } = SPINDLE;
    const draft = draftOf({ ...SPINDLE, rated_current_a: 1.68, own: true, source: "kept on this server" });
    expect(draft).toEqual(SPINDLE);
    expect(figuresOf(draft)).toEqual(figures);
    expect(alike(draft, SPINDLE)).toBe(true);
    expect(alike(draft, { ...SPINDLE, inductance_h: null })).toBe(false);
  });

  it("has a name that no other one has and that an address can hold", () => {
    expect(nameProblem("", [])).toBe("A name is needed");
    expect(nameProblem("17/HS", [])).toMatch("slash");
    expect(nameProblem("..", [])).toMatch("dots");
    expect(nameProblem("Spindle", ["Spindle"])).toMatch("has this name");
    expect(nameProblem("Spindle 2.1", ["Spindle"])).toBeUndefined();
  });

  it("is told in words as far as it is known", () => {
    const current = { rated_current_a: 1.68, full_steps_per_rev: 400 };
    expect(figuresText({ ...SPINDLE, ...current })).toMatch(
      /^1\.68.A, 1\.65.Ω, 4\.35.mH, 0\.440.N m, 68.g cm², 400 full steps$/,
    );
    expect(figuresText({ ...current, ...NOT_KNOWN })).toMatch(/^1\.68.A, 400 full steps$/);
  });
});
