import type { FieldsProps } from "../kind";
import { MotorField } from "../motor/MotorField";
import { type Asked, Numbers } from "../Numbers";
import { SeenByField } from "../SeenByField";
import type { TorqueForm } from "./form";

const NUMBERS: readonly Asked<TorqueForm>[] = [
  {
    key: "travelTurns",
    label: "Room to positions above, or away from the switch",
    min: 10,
    max: 10_000,
    unit: "turns",
  },
  { key: "velocityMaxRps", label: "Never faster than", min: 1, max: 100, unit: "turns/s" },
  { key: "speeds", label: "Speeds", min: 2, max: 30, integer: true },
  { key: "repeats", label: "Times at each speed", min: 2, max: 20, integer: true },
  {
    key: "inertiaKgm2",
    label: "Inertia of rotor and load, at the motor",
    description: "empty: the acceleration over speed is told, not the torque",
    min: 1e-9,
    max: 1,
    unit: "kg m²",
    optional: true,
  },
];

const OF_LOAD: readonly Asked<TorqueForm>[] = [
  { key: "inertiaPercent", label: "It is known within ±", min: 0, max: 50, unit: "%" },
  {
    key: "frictionNm",
    label: "Friction of the axis",
    description: "added to the torque; 0: what is told is beyond friction",
    min: 0,
    max: 50,
    unit: "N m",
  },
];

/** How far and how fast it may go, at how many speeds it is looked at, and what is known of its load. */
export function Fields({ form, change, axis }: FieldsProps<TorqueForm>) {
  return (
    <>
      <SeenByField form={form} change={change} />
      <MotorField
        axis={axis}
        choice={form.motor}
        description="one of your own that tells the inertia of its rotor fills that in: add what hangs on it"
        usable={({ rotor_inertia_kgm2 }) => rotor_inertia_kgm2 !== null}
        onType={(motor) => change({ motor })}
        onMotor={(motor, choice, typed) =>
          change({ motor: choice, ...(typed && { inertiaKgm2: motor.rotor_inertia_kgm2 }) })
        }
      />
      <Numbers form={form} change={change} of={NUMBERS} />
      {form.inertiaKgm2 !== null && <Numbers form={form} change={change} of={OF_LOAD} />}
    </>
  );
}
