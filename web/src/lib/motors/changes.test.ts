import { describe, expect, it } from "vitest";
import { changesOf, type MeasuredFigure } from "./changes";
import { NOT_KNOWN } from "./figures";

const KEPT = { ...NOT_KNOWN, rated_current_a: 1.5, resistance_ohm: 1.65, inductance_h: 0.004351 };
const sure = (key: MeasuredFigure["key"], value: number): MeasuredFigure => ({ key, value, doubt: "" });

describe("what was measured of a motor that is kept", () => {
  it("is told with the old figure and the new one, in units of data sheets", () => {
    const changes = changesOf(KEPT, [sure("rotor_inertia_kgm2", 6.812_34e-6), sure("resistance_ohm", 2.318_472)]);
    expect(changes.map(({ key, after }) => [key, after])).toEqual([
      ["resistance_ohm", 2.318],
      ["rotor_inertia_kgm2", 6.812e-6],
    ]);
    expect(changes[0]?.text).toMatch(/^Resistance of a coil: 1\.650.Ω, becomes 2\.318.Ω$/);
    expect(changes[1]?.text).toMatch(/^Inertia of the rotor: not known, becomes 68\.12.g cm²$/);
  });

  it("changes nothing that is so already, nor anything that was not measured or cannot be", () => {
    expect(changesOf(KEPT, [sure("inductance_h", 0.004_350_912)])).toEqual([]);
    expect(changesOf(KEPT, [sure("inductance_h", -1e-5)])).toEqual([]);
    expect(changesOf(KEPT, [])).toEqual([]);
  });

  it("has a torque of the current alone that the motor is rated for", () => {
    const torque = (withA: number) => changesOf(KEPT, [{ ...sure("holding_torque_nm", 0.4), withA }]).length;
    expect([1.5, 1.48, 1.53, 1.4, 1.7].map(torque)).toEqual([1, 1, 1, 0, 0]);
  });
});
