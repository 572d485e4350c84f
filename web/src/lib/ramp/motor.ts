import type { Schemas } from "../../api/client";
import type { Mark } from "../../plots/types";
import { percent } from "../format";
import type { Answer } from "./answer";

/** A motor as data sheets give it: mH and g·cm², which POST /calc/ramp takes in H and kg·m². */
export interface Motor {
  shown: boolean;
  holdingNm: number;
  ratedA: number;
  currentA: number;
  ohm: number;
  mH: number;
  supplyV: number;
  inertiaGcm2: number;
  frictionNm: number;
  loadNm: number;
}

export type MotorKey = Exclude<keyof Motor, "shown">;

/** A common 40 mm motor with a slide. */
export const MOTOR: Motor = {
  shown: true,
  holdingNm: 0.45,
  ratedA: 1.5,
  currentA: 1.5,
  ohm: 2.3,
  mH: 4.4,
  supplyV: 24,
  inertiaGcm2: 2000,
  frictionNm: 0.005,
  loadNm: 0,
};

const GCM2 = 1e-7;

export const FIELDS: readonly { key: MotorKey; label: string; unit: string; title: string; zero?: boolean }[] = [
  { key: "holdingNm", label: "holding torque", unit: "Nm", title: "both phases at the rated current" },
  { key: "ratedA", label: "rated current", unit: "A", title: "a phase, from the motor's data sheet" },
  { key: "currentA", label: "set current", unit: "A", title: "peak of the sine that the driver is set to" },
  { key: "supplyV", label: "supply", unit: "V", title: "of the driver" },
  { key: "ohm", label: "resistance", unit: "Ω", title: "of a phase" },
  { key: "mH", label: "inductance", unit: "mH", title: "of a phase" },
  { key: "inertiaGcm2", label: "inertia", unit: "g·cm²", title: "rotor and load, at the motor's shaft" },
  { key: "frictionNm", label: "friction", unit: "Nm", title: "against any motion", zero: true },
  { key: "loadNm", label: "load", unit: "Nm", title: "besides friction, against the motion", zero: true },
];

/** The motor of POST /calc/ramp, on this axis; none while it is not shown. */
export function motorBody(
  motor: Motor,
  axis: { fullStepsPerRev: number; microstepsPerFullStep: number | null },
): Schemas["RampMotor"] | null {
  if (!motor.shown) return null;
  return {
    holding_torque_nm: motor.holdingNm,
    rated_current_a: motor.ratedA,
    current_a: motor.currentA,
    resistance_ohm: motor.ohm,
    inductance_h: motor.mH / 1000,
    supply_v: motor.supplyV,
    inertia_kgm2: motor.inertiaGcm2 * GCM2,
    friction_nm: motor.frictionNm,
    load_nm: motor.loadNm,
    full_steps_per_rev: axis.fullStepsPerRev,
    microsteps_per_full_step: axis.microstepsPerFullStep ?? 256,
  };
}

/** What is left of the torque in words: "38 % left", or by how much it is too little. */
export function marginText(margin: number): string {
  const size = Math.abs(margin);
  const shown = size >= 10 ? "more than 10 times" : percent(size);
  return margin >= 0 ? `${shown} of the torque left` : `${shown} too little torque`;
}

/** Where the least of the torque is left. */
export function marginMark(answer: Answer): Mark[] {
  const { torque } = answer;
  if (torque === null || torque === undefined) return [];
  // the knobs of AMAX stand above, those of DMAX below
  const row = answer.time_s.findIndex((at) => at >= torque.margin_at_s);
  const low = (answer.acceleration_pps2[row] ?? 0) >= 0;
  return [
    { id: "margin", x: torque.margin_at_s, color: "#7a5200", label: marginText(torque.margin), fixed: true, low },
  ];
}
