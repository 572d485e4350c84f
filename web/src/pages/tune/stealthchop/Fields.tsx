import { CoilFields } from "../CoilFields";
import type { FieldsProps } from "../kind";
import { type Asked, Numbers } from "../Numbers";
import { type StealthChopForm, torqueFrom } from "./form";

const NUMBERS: readonly Asked<StealthChopForm>[] = [
  {
    key: "holdingTorqueNm",
    label: "Holding torque",
    description: "empty: the chip alone tunes what velocity adds",
    min: 0.001,
    max: 50,
    unit: "N m",
    optional: true,
  },
  {
    key: "ratedCurrentA",
    label: "Rated current, RMS of one coil",
    description: "at that torque; empty: the run current",
    min: 0.01,
    max: 50,
    unit: "A",
    optional: true,
  },
  {
    key: "velocityMaxRps",
    label: "Up to a speed of",
    description: "runs go through all speeds up to it",
    min: 0.3,
    max: 20,
    unit: "turns/s",
  },
  {
    key: "joltMax",
    label: "Jolt that is allowed",
    description: "swing of the shaft as the choppers change",
    min: 0.02,
    max: 2,
    unit: "full steps",
  },
];

/** The motor and its supply, up to which speed it is run, and how much of a jolt is allowed. */
export function Fields({ form, change, axis }: FieldsProps<StealthChopForm>) {
  return (
    <>
      <CoilFields
        form={form}
        change={change}
        axis={axis}
        onMotor={(motor, coil) => change({ ...coil, ...torqueFrom(motor) })}
      />
      <Numbers form={form} change={change} of={NUMBERS} />
    </>
  );
}
