import type { Schemas } from "../../api/client";
import { compact } from "../format";

/** A motor of the data base. */
type NamedMotor = Schemas["MotorInfo"];

/** What may be known of a motor beside its rated current and steps, in SI units; null: not known. */
export type FurtherFigures = Pick<
  NamedMotor,
  "resistance_ohm" | "inductance_h" | "holding_torque_nm" | "rotor_inertia_kgm2"
>;

/** A motor as a form has it: as the server keeps it, but that its current may not be told yet. */
export interface MotorDraft extends FurtherFigures {
  name: string;
  rated_current_a: number | null;
  full_steps_per_rev: number;
}

export const NOT_KNOWN: FurtherFigures = {
  resistance_ohm: null,
  inductance_h: null,
  holding_torque_nm: null,
  rotor_inertia_kgm2: null,
};

export const NEW_MOTOR: MotorDraft = { name: "", rated_current_a: null, full_steps_per_rev: 200, ...NOT_KNOWN };

/** A further figure as data sheets print it. */
interface Printed {
  key: keyof FurtherFigures;
  label: string;
  unit: string;
  /** so many powers of ten more than in SI units */
  powers: number;
  min: number;
  max: number;
  step: number;
}

export const FURTHER: readonly Printed[] = [
  { key: "resistance_ohm", label: "Resistance of a coil", unit: "Ω", powers: 0, min: 0.001, max: 10_000, step: 0.1 },
  { key: "inductance_h", label: "Inductance of a coil", unit: "mH", powers: 3, min: 0.001, max: 10_000, step: 0.1 },
  { key: "holding_torque_nm", label: "Holding torque", unit: "N m", powers: 0, min: 0.0001, max: 1000, step: 0.01 },
  { key: "rotor_inertia_kgm2", label: "Inertia of the rotor", unit: "g cm²", powers: 7, min: 0.01, max: 1e5, step: 1 },
];

/** A number by so many powers of ten more or less, digit by digit: 4.1 / 1000 is not 0.0041. */
export function shifted(value: number, powers: number): number {
  const [digits, power = "0"] = String(value).split("e");
  return Number(`${digits}e${Number(power) + powers}`);
}

/** The motor as a form edits it, without where its figures are from. */
export function draftOf({ own: _, source: __, ...draft }: NamedMotor): MotorDraft {
  return draft;
}

/** What the server keeps under its name; null where the current is not told. */
export function figuresOf({ name: _, rated_current_a, ...rest }: MotorDraft): Schemas["MotorFigures"] | null {
  return rated_current_a === null ? null : { rated_current_a, ...rest };
}

/** Whether a form and a motor tell the same. */
export function alike(one: MotorDraft, other: MotorDraft): boolean {
  return (Object.keys(NEW_MOTOR) as (keyof MotorDraft)[]).every((key) => one[key] === other[key]);
}

/** What is wrong with a name for a motor of one's own, where others have the names `taken`; undefined: nothing. */
export function nameProblem(name: string, taken: readonly string[] = []): string | undefined {
  if (name === "") return "A name is needed";
  if (name.includes("/") || /^\.+$/.test(name)) return "Without a slash, and not of dots alone";
  return taken.includes(name) ? "One of your motors has this name" : undefined;
}

/** What is known of a motor, in words. */
export function figuresText(motor: FurtherFigures & Pick<NamedMotor, "rated_current_a" | "full_steps_per_rev">) {
  const told = [
    compact(motor.rated_current_a, 3, "A"),
    ...FURTHER.map(({ key, unit, powers }) => {
      const value = motor[key];
      return value !== null && compact(shifted(value, powers), 3, unit);
    }),
    `${motor.full_steps_per_rev} full steps`,
  ];
  return told.filter(Boolean).join(", ");
}
