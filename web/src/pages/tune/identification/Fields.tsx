import type { FieldsProps } from "../kind";
import { MotorField } from "../motor/MotorField";
import { RATED } from "../motor/motor";
import { type Asked, Numbers } from "../Numbers";
import { type IdentificationForm, withMotor } from "./form";

const NUMBERS: readonly Asked<IdentificationForm>[] = [
  { key: "velocityRps", label: "Speed of the slow turns", min: 0.01, max: 0.5, unit: "turns/s" },
  { key: "hops", label: "Hops", description: "after each of them the rotor rings", min: 6, max: 100, integer: true },
  {
    key: "holdTorqueNm",
    label: "Holding torque",
    description: "with the run current; empty: no inertia",
    min: 0.0001,
    max: 50,
    unit: "N m",
    optional: true,
  },
  {
    key: "supplyV",
    label: "Supply of the motor",
    description: "with the run current: resistance, inductance and back-EMF",
    min: 1,
    max: 100,
    unit: "V",
    optional: true,
  },
  {
    key: "runCurrentA",
    label: "Run current as it is set now, RMS of one coil",
    min: 0.01,
    max: 50,
    unit: "A",
    optional: true,
  },
];

/** How slowly it turns, how often it hops, and the torque that makes an inertia of a resonance. */
export function Fields({ form, change, axis }: FieldsProps<IdentificationForm>) {
  return (
    <>
      <MotorField
        axis={axis}
        choice={form.motor}
        description="of the data base, as its plate names it; it fills in torque and current"
        onType={(motor) => change({ motor })}
        onMotor={(motor, choice, typed) => change(withMotor(motor, choice, typed))}
        note={form.runCurrentA === null ? "" : `${RATED}, and its torque`}
      />
      <Numbers form={form} change={change} of={NUMBERS} />
    </>
  );
}
