import { expect, test } from "vitest";
import type { Schemas } from "../../../api/client";
import { NOT_KNOWN } from "../../../lib/motors/figures";
import { measuredOf, motorOf } from "./motor";

const told = (value: number) => ({ value, low: value * 0.98, high: value * 1.02 });

test("what a study tells of a motor alone is its coil: neither inertia nor torque", () => {
  const found = {
    resistance_ohm: told(2.318_472_93),
    inductance_h: told(0.004_350_912),
    inertia_kgm2: told(7e-6),
    torque_nm: told(0.4),
  } as unknown as Schemas["Identified"];
  expect(motorOf(found, { full_steps_per_rev: 400 })).toEqual({
    ...NOT_KNOWN,
    name: "",
    rated_current_a: null,
    full_steps_per_rev: 400,
    resistance_ohm: 2.318,
    inductance_h: 0.004351,
  });
  expect(motorOf({ ...found, inductance_h: null }, undefined)).toMatchObject({
    full_steps_per_rev: 200,
    inductance_h: null,
  });
  expect(motorOf({ ...found, resistance_ohm: null, inductance_h: null }, undefined)).toBeNull();
});

test("one that is kept is offered inertia and torque too, with what speaks against them", () => {
  const found = {
    resistance_ohm: told(2.3),
    inductance_h: null,
    inertia_kgm2: told(7e-6),
    torque_nm: told(0.4),
  } as unknown as Schemas["Identified"];
  const measured = measuredOf(found, 1.5);
  expect(measured.map(({ key, value, withA }) => [key, value, withA])).toEqual([
    ["resistance_ohm", 2.3, undefined],
    ["holding_torque_nm", 0.4, 1.5],
    ["rotor_inertia_kgm2", 7e-6, undefined],
  ]);
  expect(measured.map(({ doubt }) => doubt === "")).toEqual([true, false, false]);
  expect(measured[2]?.doubt).toMatch("rotor and load");
  // a torque with no current is none of a motor
  expect(measuredOf(found, null).map(({ key }) => key)).toEqual(["resistance_ohm", "rotor_inertia_kgm2"]);
});
