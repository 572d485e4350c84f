import { type CoilForm, coilWith } from "./coil";
import type { FieldsProps } from "./kind";
import { MotorField } from "./motor/MotorField";
import { type NamedMotor, RATED } from "./motor/motor";
import { type Asked, Numbers } from "./Numbers";

const NUMBERS: readonly Asked<CoilForm>[] = [
  {
    key: "resistanceOhm",
    label: "Resistance of one coil",
    description: "by the motor's data sheet",
    min: 0.01,
    max: 200,
    unit: "Ω",
  },
  { key: "inductanceMh", label: "Inductance of one coil", min: 0.01, max: 500, unit: "mH" },
  { key: "runCurrentA", label: "Run current as it is set now, RMS of one coil", min: 0.01, max: 50, unit: "A" },
  { key: "supplyV", label: "Supply of the motor", min: 1, max: 100, unit: "V" },
];

interface Props {
  form: CoilForm;
  change: (part: Partial<CoilForm>) => void;
  axis: FieldsProps<never>["axis"];
  /** what is filled in of a motor that was named, beside its coil */
  onMotor?: (motor: NamedMotor, coil: Partial<CoilForm>) => void;
}

/** A motor's coil, its current and its supply: what a chopper is calculated from. Filled in of a motor that is named. */
export function CoilFields({ form, change, axis, onMotor = (_, coil) => change(coil) }: Props) {
  return (
    <>
      <MotorField
        axis={axis}
        choice={form.motor}
        description="of the data base, as its plate names it; it fills in what is known of it"
        onType={(motor) => change({ motor })}
        onMotor={(motor, choice) => onMotor(motor, coilWith(motor, choice))}
        note={RATED}
      />
      <Numbers form={form} change={change} of={NUMBERS} />
    </>
  );
}
